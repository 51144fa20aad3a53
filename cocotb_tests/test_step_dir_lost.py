"""Bench of rtl/boards/step_dir.v beyond its bound: steps beyond pulses are told and left out."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import CLOCK_NS, WATCHDOG, simulate


def test_step_dir_lost():
    simulate("step_dir", __file__, WIDTH=8, PULSE=20, SETUP=20)


@cocotb.test(**WATCHDOG)
async def steps_that_are_lost_are_told(dut):
    """Those that are made go the way of the advances, and position is that of the pins."""
    dut.modulus.value, dut.rst.value, dut.clear.value = 60, 1, 0
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    made = []

    async def watch():
        while True:
            await RisingEdge(dut.step)
            made.append(-1 if dut.dir.value == 1 else 1)

    cocotb.start_soon(watch())
    for advance, lost in ((50, 1), (1, 0), (-50, 1), (-1, 0)):
        dut.advance.value, dut.origin.value = 0, 1
        await ClockCycles(dut.clk, 50)
        made.clear()
        dut.advance.value, dut.origin.value, dut.rst.value = advance, 0, 0
        await ClockCycles(dut.clk, 200)
        await FallingEdge(dut.clk)
        assert dut.lost.value == lost
        dut.clear.value = 1
        await ClockCycles(dut.clk, 50)
        assert dut.position.value.to_signed() == sum(made)
        assert set(made) == {1 if advance > 0 else -1}
        dut.clear.value = 0
