"""Bench of rtl/feed_override_program.v: every way through ends, every instruction lies on one."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from cocotb_tests.bench import CLOCK_NS, WATCHDOG, simulate

INIT, AS_PLANNED, SLOW = 0, 10, 15  # where feed_override.v begins
NUMBERS = 32
JUMP, CALL, RETURN, ENDS = 0x8, 0x9, 0xA, (0xC0, 0xC1, 0xC2)
ALWAYS = (0x80, 0xA0)


def test_feed_override_program():
    simulate("feed_override_program", __file__)


@cocotb.test(**WATCHDOG)
async def every_way_ends(dut):
    program = []
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    await FallingEdge(dut.clk)
    dut.read.value = 1
    for at in range(256):
        dut.at.value = at
        await FallingEdge(dut.clk)
        program.append(divmod(dut.code.value.to_unsigned(), 256))
    seen = set()
    ways = [(start, False) for start in (INIT, AS_PLANNED, SLOW)]
    while ways:
        at, called = ways.pop()
        if (at, called) in seen:
            continue
        seen.add((at, called))
        what, number = program[at]
        if what in ENDS:
            assert not called, f"line {at} ends the period inside a subroutine"
            continue
        if what >> 4 == RETURN:
            assert called, f"line {at} returns to nowhere"
        if what >> 4 == JUMP:
            ways.append((number, called))
        elif what >> 4 == CALL:
            assert not called, f"line {at} calls from inside a subroutine"
            ways.append((number, True))
        else:
            assert number < NUMBERS, f"line {at} speaks of number {number}"
        if what not in ALWAYS:
            ways.append((at + 1, called))
    lines = {at for at, _ in seen}
    assert lines == set(range(len(lines))), "instructions that no way reaches, or a way past the end"
    assert {program[at] for at in range(len(lines), 256)} == {(0xC2, 0)}
    assert not {at for at in lines if (at, True) in seen and (at, False) in seen}
