"""Bench of rtl/boards/uart_bridge.v: every request is answered, damaged ones too, whatever the slave does."""

import binascii

import cocotb
import numpy as np
from cocotb.triggers import ClockCycles, RisingEdge, Timer
from cocotbext.axi import AddressSpace, AxiLiteBus, AxiLiteSlave, Region

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, reset, simulate
from cocotb_tests.serial_line import SerialLine
from nurbs_lab.hardware import load_host

say = load_host().say
ANSWER, ASK, Conversation, encode = say.ANSWER, say.ASK, say.Conversation, say.encode

DIVIDER, GAP, BUS_CYCLES = 4, 60, 200
ALARM_ADDRESS = 0x20


def test_uart_bridge():
    simulate("uart_bridge", __file__, DIVIDER=DIVIDER, GAP=GAP, BUS_CYCLES=BUS_CYCLES, ALARM_DATA=7)


class Registers(Region):
    """Memory that counts its writes and refuses the upper half."""

    def __init__(self):
        super().__init__(512)
        self.words, self.writes = {}, []

    async def _read(self, address, length, **_):
        if address >= 256:
            raise ValueError("refused")
        return self.words.get(address, 0).to_bytes(4, "little")

    async def _write(self, address, data, **_):
        if address >= 256:
            raise ValueError("refused")
        self.words[address] = int.from_bytes(data, "little")
        self.writes.append((address, self.words[address]))


async def begin(dut, stalls=0.0):
    dut.alarm.value = 0
    space, registers = AddressSpace(512), Registers()
    space.register_region(registers, 0)
    slave = AxiLiteSlave(AxiLiteBus.from_prefix(dut, "m_axil"), dut.clk, dut.rst, target=space)
    rng = np.random.default_rng(SEED)

    def pauses():
        while True:
            yield bool(rng.random() < stalls)

    ends = slave.write_if, slave.read_if
    for channel in (
        ends[0].aw_channel,
        ends[0].w_channel,
        ends[0].b_channel,
        ends[1].ar_channel,
        ends[1].r_channel,
    ):
        channel.set_pause_generator(pauses())
    line = SerialLine(dut.rx, dut.tx, DIVIDER)
    await reset(dut)
    await ClockCycles(dut.clk, 20)
    return line, registers, ends, rng


def error(code):
    return encode(ANSWER, 0, code, 0)


@cocotb.test(**WATCHDOG)
async def requests_under_back_pressure(dut):
    """The protocol code of the package, against a slave that stalls on every channel."""
    line, registers, _, rng = await begin(dut, stalls=0.7)
    talk, kept = Conversation(), {}
    for _ in range(40):
        address, data = 4 * int(rng.integers(64)), int(rng.integers(1 << 32))
        if rng.random() < 0.6:
            kept[address] = data
            assert await line.converse(talk.ask(address, data)) == 0
        else:
            assert await line.converse(talk.ask(address)) == kept.get(address, 0)
    assert registers.words == kept
    await line.send(encode(ASK, 5, 0x80 | 300 >> 2, 1))
    assert await line.take() == encode(ANSWER, 5, 2, 0)  # SLVERR is handed on


@cocotb.test(**WATCHDOG)
async def damaged_requests(dut):
    """Each is answered once with its code and does not reach the bus; the next good one does."""
    line, registers, *_, rng = await begin(dut)
    good = encode(ASK, 3, 0x81, 0x12345678)
    for bit in rng.permutation(8 * 8)[:24]:
        broken = bytearray(good)
        broken[1 + bit // 8] ^= 1 << bit % 8
        await line.send(broken)
        assert await line.take() == error(0x10), bit
    await line.send(good[:6])
    assert await line.take() == error(0x12)
    await line.send(b"\x00" + good)
    assert await line.take() == error(0x13)
    for at in (0, 4):
        await line.send(good[:at])
        await line.send(good[at : at + 1], stop=0)
        await line.send(good[at + 1 :])
        assert await line.take() == error(0x11)
    line.rx.value = 0
    await Timer(60 * line.bit_ns, "ns")
    line.rx.value = 1
    assert await line.take() == error(0x11)
    await line.send(rng.bytes(200))
    code = (await line.take())[2]
    assert code in (0x10, 0x11, 0x12, 0x13)
    assert await line.take(1, within_bits=300) == b""
    assert registers.writes == []
    await line.send(good + good)  # the second one comes before the first is answered
    assert await line.take() == encode(ANSWER, 3, 0, 0)
    assert await line.take() == error(0x14)
    await line.send(good)
    assert await line.take() == encode(ANSWER, 3, 0, 0)
    assert registers.writes == [(4, 0x12345678)]


@cocotb.test(**WATCHDOG)
async def a_pause_within_a_request(dut):
    """A line may rest for little less than GAP after any byte; a little more breaks the request off."""
    line, registers, *_ = await begin(dut)
    block = say.encode_block(7, [(4, 1), (8, 2)])
    await line.send(block[:1])
    for byte in block[1:]:
        await ClockCycles(dut.clk, GAP - 10)
        await line.send(bytes([byte]))
    assert await line.take() == encode(ANSWER, 7, 0, 2)
    assert registers.writes == [(4, 1), (8, 2)]
    for at in (1, 4, len(block) - 1):
        await line.send(block[:at])
        await ClockCycles(dut.clk, GAP + 10)
        await line.send(block[at:])
        assert await line.take() == error(0x12)
        assert await line.take() == error(0x14)  # the rest of it
    assert registers.writes == [(4, 1), (8, 2)]


@cocotb.test(**WATCHDOG)
async def a_repeated_request_is_carried_out_once(dut):
    """Also with damaged ones between, and except for number 0; its answer is that of the first time."""
    line, registers, *_ = await begin(dut)
    request = encode(ASK, 9, 0x82, 5)
    for message in (request, request, b"\xa5\x01", request):
        await line.send(message)
        assert await line.take() == (error(0x12) if len(message) < 9 else encode(ANSWER, 9, 0, 0))
    assert registers.writes == [(8, 5)]
    registers.words[8] = 77
    for number, value, now in ((10, 77, 78), (10, 77, 79), (11, 79, 80), (0, 80, 81), (0, 81, 82)):
        await line.send(encode(ASK, number, 2, 0))
        assert await line.take() == encode(ANSWER, number, 0, value)
        registers.words[8] = now
    heard = bytearray(b"123456789")
    assert binascii.crc_hqx(heard, 0xFFFF) == 0x29B1  # the published check value of this checksum


@cocotb.test(**WATCHDOG)
async def blocks_of_writes(dut):
    """In their order and once, however often they are sent; up to the first refused; none if damaged."""
    line, registers, *_, rng = await begin(dut, stalls=0.5)
    for count in (0, 1, 2, 3, 40, 255):
        writes = [(4 * int(rng.integers(64)), int(rng.integers(1 << 32))) for _ in range(count)]
        block = say.encode_block(1 + count % 99, writes)
        assert len(block) == 5 + 5 * count
        for _ in range(2):
            registers.writes.clear()
            await line.send(block)
            assert await line.take(within_bits=9000) == encode(ANSWER, 1 + count % 99, 0, count)
            if _ == 0:
                assert registers.writes == writes
        assert registers.writes == []
    writes = [(4, 1), (8, 2), (300, 3), (12, 4)]
    await line.send(say.encode_block(7, writes))
    assert await line.take() == encode(ANSWER, 7, 2, 2)
    assert registers.writes == writes[:2]
    registers.writes.clear()
    good = say.encode_block(9, writes[:2])
    for bit in rng.permutation(8 * len(good[1:]))[:20]:
        broken = bytearray(good)
        broken[1 + bit // 8] ^= 1 << bit % 8
        await line.send(broken)
        assert (await line.take())[2] in (0x10, 0x12, 0x14)
        await ClockCycles(dut.clk, 2 * GAP)
        line.heard.clear()
    assert registers.writes == []
    await line.send(good)
    assert await line.take() == encode(ANSWER, 9, 0, 2)
    talk = Conversation()
    await line.converse(talk.write([(0xC, 5), (0xC, 5), (0x10, 6), (0xC, 7)]))  # an upper half is sent once
    assert registers.writes == [*writes[:2], (0xC, 5), (0x10, 6), (0xC, 7)]
    assert await line.converse(talk.ask(0x10)) == 6


@cocotb.test(**WATCHDOG)
async def a_bus_that_does_not_answer(dut):
    """Is told, again and again; when it comes back, so does the bridge."""
    line, registers, ends, _ = await begin(dut)
    registers.words[4] = 99
    for channel, request in ((ends[1].ar_channel, 1), (ends[0].b_channel, 0x81)):
        channel.clear_pause_generator()
        channel.pause = True
        for number in (20, 21, 21):
            await line.send(encode(ASK, number, request, 4))
            assert await line.take() == encode(ANSWER, number, 0x15, 0)
        channel.pause = False
        await ClockCycles(dut.clk, 10)
        await line.send(encode(ASK, 22, 1, 0))
        assert await line.take() == encode(ANSWER, 22, 0, 99 if request == 1 else 4)
        await line.send(encode(ASK, 0, 2, 0))
        await line.take()
    assert registers.writes == [(4, 4)]


@cocotb.test(**WATCHDOG)
async def the_alarm_writes_once(dut):
    """By itself, between two requests, also when it comes in the middle of one."""
    line, registers, *_ = await begin(dut)
    for wait in (0, 300, 359, 360, 361, 362, 363, 364, 365, 420):
        registers.writes.clear()
        sending = cocotb.start_soon(line.send(encode(ASK, 0, 0x81, wait)))
        await ClockCycles(dut.clk, 1 + wait)
        dut.alarm.value = 1
        await sending
        assert await line.take() == encode(ANSWER, 0, 0, 0)
        await ClockCycles(dut.clk, 30)
        assert sorted(registers.writes) == sorted([(4, wait), (ALARM_ADDRESS, 7)])
        dut.alarm.value = 0
        await RisingEdge(dut.clk)
    dut.rst.value = 1
    await ClockCycles(dut.clk, 2)
    dut.rst.value = 0
    await Timer(100 * CLOCK_NS, "ns")
    assert dut.tx.value == 1
