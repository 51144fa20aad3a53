"""Bench of rtl/boards/emergency_stop.v."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge, Timer

from cocotb_tests.bench import CLOCK_NS, WATCHDOG, reset, simulate


def test_emergency_stop():
    simulate("emergency_stop", __file__)


async def order(dut, name):
    getattr(dut, name).value = 1
    await RisingEdge(dut.clk)
    getattr(dut, name).value = 0
    await Timer(1, "ns")


@cocotb.test(**WATCHDOG)
async def cuts_without_a_clock(dut):
    """Not an edge of the clock comes between the press and the cut, and the release gives nothing back."""
    for name in ("clk", "stop", "on", "off"):
        getattr(dut, name).value = 0
    dut.rst.value = 1
    await Timer(1, "ns")
    clock = Clock(dut.clk, CLOCK_NS, unit="ns")
    clock.start()
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    await order(dut, "on")
    assert dut.enable.value == 1
    clock.stop()
    await Timer(3 * CLOCK_NS, "ns")
    dut.stop.value = 1
    await Timer(1, "ns")
    assert (dut.enable.value, dut.enabled.value, dut.tripped.value, dut.pressed.value) == (0, 0, 1, 1)
    dut.stop.value = 0
    await Timer(1, "ns")
    assert dut.enable.value == 0
    clock.start()
    await ClockCycles(dut.clk, 3)
    assert (dut.enable.value, dut.tripped.value, dut.pressed.value) == (0, 1, 0)
    await order(dut, "on")
    assert (dut.enable.value, dut.tripped.value) == (1, 0)


@cocotb.test(**WATCHDOG)
async def orders(dut):
    """On is ignored while pressed, and off wins over on; a spike shorter than a cycle stops as well."""
    for name in ("stop", "on", "off"):
        getattr(dut, name).value = 0
    await reset(dut)
    await ClockCycles(dut.clk, 2)
    await order(dut, "on")
    assert dut.enable.value == 1
    await order(dut, "off")
    assert (dut.enable.value, dut.tripped.value) == (0, 0)
    dut.on.value = 1
    await order(dut, "off")
    assert dut.enable.value == 0
    await order(dut, "on")
    dut.stop.value = 1
    await Timer(2, "ns")
    dut.stop.value = 0
    await Timer(1, "ns")
    assert (dut.enable.value, dut.tripped.value) == (0, 1)
    await order(dut, "on")
    assert dut.enable.value == 0  # still pressed, as far as the clock knows
    dut.stop.value = 1
    await order(dut, "on")
    assert (dut.enable.value, dut.enabled.value) == (0, 0)


@cocotb.test(**WATCHDOG)
async def a_level_is_one_order(dut):
    """Held high, `on` enables nothing after a stop or a reset, which both cut without a clock."""
    for name in ("stop", "on", "off"):
        getattr(dut, name).value = 0
    dut.rst.value = 1
    clock = Clock(dut.clk, CLOCK_NS, unit="ns")
    clock.start()
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 0
    for cut in (dut.stop, dut.rst):
        dut.on.value = 0
        await ClockCycles(dut.clk, 4)
        dut.on.value = 1
        await ClockCycles(dut.clk, 3)
        assert dut.enable.value == 1
        clock.stop()
        await Timer(3 * CLOCK_NS, "ns")
        cut.value = 1
        await Timer(1, "ns")
        assert dut.enable.value == 0
        clock.start()
        await ClockCycles(dut.clk, 3)
        cut.value = 0
        await ClockCycles(dut.clk, 9)
        assert dut.enable.value == 0
