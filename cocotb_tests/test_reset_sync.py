"""Bench of rtl/boards/reset_sync.v."""

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge, Timer

from cocotb_tests.bench import CLOCK_NS, WATCHDOG, simulate


def test_reset_sync():
    simulate("reset_sync", __file__)


@cocotb.test(**WATCHDOG)
async def rises_at_once_and_falls_with_the_clock(dut):
    dut.clk.value, dut.ok.value = 0, 0
    await Timer(1, "ns")
    assert dut.rst.value == 1  # no clock has come yet
    clock = Clock(dut.clk, CLOCK_NS, unit="ns")
    clock.start()
    for early in (3, 7, 13):
        await RisingEdge(dut.clk)
        await Timer(early, "ns")
        dut.ok.value = 1
        for _ in range(3):
            assert dut.rst.value == 1
            await RisingEdge(dut.clk)
        await Timer(1, "ns")
        assert dut.rst.value == 0
        await Timer(3 * CLOCK_NS + early, "ns")
        dut.ok.value = 0
        await Timer(1, "ns")
        assert dut.rst.value == 1
        await RisingEdge(dut.clk)
        await RisingEdge(dut.clk)
        assert dut.rst.value == 1
