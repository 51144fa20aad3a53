"""Bench of rtl/boards/uart_rx.v: every byte, at rates off by 4 %, with wrong stop bits, spikes and breaks."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import RisingEdge, Timer

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, reset, simulate


@pytest.mark.parametrize("divider", [4, 16])
def test_uart_rx(divider):
    simulate("uart_rx", __file__, DIVIDER=divider)


class Receiver:
    def __init__(self, dut):
        self.dut, self.found = dut, []
        self.divider = dut.DIVIDER.value.to_unsigned()
        dut.line.value = 1
        cocotb.start_soon(self.watch())

    async def watch(self):
        while True:
            await RisingEdge(self.dut.clk)
            if self.dut.valid.value == 1:
                self.found.append(self.dut.data.value.to_unsigned())
            if self.dut.failed.value == 1:
                self.found.append("failed")

    async def send(self, byte, rate=1.0, stop=1):
        bit_ps = round(self.divider * CLOCK_NS * 1000 / rate)
        for level in (0, *(byte >> i & 1 for i in range(8)), stop):
            self.dut.line.value = level
            await Timer(bit_ps, "ps")
        self.dut.line.value = 1


@cocotb.test(**WATCHDOG)
async def every_byte(dut):
    """Back to back and with pauses, at the rate and, where a bit has cycles enough, 4 % off."""
    receiver = Receiver(dut)
    await reset(dut)
    await RisingEdge(dut.clk)  # the line has been high
    rng = np.random.default_rng(SEED)
    sent = []
    for rate in (1.0, 0.96, 1.04) if receiver.divider >= 16 else (1.0,):
        for byte in rng.permutation(256 if rate == 1.0 else 64).tolist():
            sent.append(byte)
            await receiver.send(byte, rate)
            if rng.random() < 0.3:
                await Timer(int(rng.integers(1, 500)), "ns")
        await Timer(2 * receiver.divider * CLOCK_NS, "ns")
    assert receiver.found == sent


@cocotb.test(**WATCHDOG)
async def what_is_no_byte(dut):
    """A low stop bit fails; a spike is nothing; a line that stays low fails once; then bytes come again."""
    receiver = Receiver(dut)
    await reset(dut)
    await RisingEdge(dut.clk)  # the line has been high
    bit = receiver.divider * CLOCK_NS
    await receiver.send(0x5A, stop=0)
    await Timer(3 * bit, "ns")
    dut.line.value = 0
    await Timer(bit // 4, "ns")
    dut.line.value = 1
    await Timer(12 * bit, "ns")
    assert dut.active.value == 0
    dut.line.value = 0
    await Timer(50 * bit, "ns")
    assert dut.active.value == 0
    dut.line.value = 1
    await Timer(2 * bit, "ns")
    await receiver.send(0xC3)
    await Timer(bit, "ns")
    assert receiver.found == ["failed", "failed", 0xC3]
    dut.line.value = 0
    await Timer(4 * bit, "ns")
    await RisingEdge(dut.clk)
    dut.rst.value = 1
    await RisingEdge(dut.clk)
    await Timer(1, "ns")
    assert dut.active.value == 0
    dut.rst.value = 0
    await Timer(12 * bit, "ns")
    assert receiver.found == ["failed", "failed", 0xC3]
