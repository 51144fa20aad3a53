"""The host's end of a serial line, for benches."""

import cocotb
from cocotb.triggers import FallingEdge, Timer
from cocotb.utils import get_sim_time

from cocotb_tests.bench import CLOCK_NS


class SerialLine:
    """Bytes to ``rx`` and from ``tx`` of a design, ``divider`` cycles a bit."""

    def __init__(self, rx, tx, divider, bit_ns=None):
        self.rx, self.tx = rx, tx
        self.bit_ns = bit_ns or divider * CLOCK_NS
        self.heard = bytearray()
        rx.value = 1
        cocotb.start_soon(self.listen())

    async def send(self, message, stop=1):
        """Send bytes; ``stop`` is the level of their stop bits."""
        for byte in message:
            for level in (0, *(byte >> i & 1 for i in range(8)), stop):
                self.rx.value = level
                await Timer(self.bit_ns, "ns")
            self.rx.value = 1

    async def listen(self):
        while True:
            if self.tx.value != 0:
                await FallingEdge(self.tx)
            await Timer(self.bit_ns * 3 // 2, "ns")
            byte = 0
            for i in range(8):
                byte |= int(self.tx.value) << i
                await Timer(self.bit_ns, "ns")
            assert self.tx.value == 1, "a stop bit is missing"
            self.heard.append(byte)

    async def take(self, count=9, within_bits=2000):
        """The next bytes; fewer if no more come in time."""
        end = get_sim_time("ns") + within_bits * self.bit_ns
        while len(self.heard) < count and get_sim_time("ns") < end:
            await Timer(self.bit_ns, "ns")
        taken = bytes(self.heard[:count])
        del self.heard[:count]
        return taken

    async def converse(self, steps, pause_ns=20_000):
        """Run a generator of rtl/boards/conversation.py; its result."""
        answer = None
        while True:
            try:
                wish = steps.send(answer)
            except StopIteration as end:
                return end.value
            answer = None
            if isinstance(wish, float):
                await Timer(pause_ns, "ns")
            else:
                await self.send(wish)
                answer = await self.take()
