"""Bench of rtl/boards/watchdog.v."""

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge, Timer

from cocotb_tests.bench import WATCHDOG, reset, simulate

CYCLES = 20


def test_watchdog():
    simulate("watchdog", __file__, CYCLES=CYCLES)


@cocotb.test(**WATCHDOG)
async def expires_after_silence(dut):
    """To the cycle; it stays expired until it is disarmed, and does not count while it is."""
    dut.armed.value = dut.fed.value = 0
    await reset(dut)
    await ClockCycles(dut.clk, 3 * CYCLES)
    for silence in (CYCLES - 1, CYCLES):
        dut.armed.value = 1
        await ClockCycles(dut.clk, CYCLES - 2)
        dut.fed.value = 1
        await RisingEdge(dut.clk)
        dut.fed.value = 0
        await ClockCycles(dut.clk, silence)
        await Timer(1, "ns")
        assert dut.expired.value == (silence == CYCLES)
        dut.fed.value = 1  # too late, or just in time
        await ClockCycles(dut.clk, CYCLES // 2)
        assert dut.expired.value == (silence == CYCLES)
        dut.fed.value = dut.armed.value = 0
        await ClockCycles(dut.clk, 2 * CYCLES)
        assert dut.expired.value == 0
