"""Bench of rtl/boards/watchdog.v."""

import cocotb
from cocotb.triggers import ClockCycles, RisingEdge, Timer

from cocotb_tests.bench import WATCHDOG, reset, simulate

CYCLES = 20


def test_watchdog():
    simulate("watchdog", __file__, CYCLES=CYCLES)


@cocotb.test(**WATCHDOG)
async def every_silence_is_told(dut):
    """To the cycle, and each time anew; silent tells of an earlier one until it is to forget."""
    dut.armed.value = dut.fed.value = dut.forget.value = 0
    await reset(dut)
    await ClockCycles(dut.clk, 3 * CYCLES)

    async def pulse(port):
        port.value = 1
        await RisingEdge(dut.clk)
        port.value = 0

    async def flags():
        await Timer(1, "ns")
        return dut.expired.value, dut.silent.value

    for armed in range(2):
        assert await flags() == (0, 0)
        dut.armed.value = 1
        await ClockCycles(dut.clk, CYCLES - 2)
        told = 0
        for silence in (CYCLES - 1, CYCLES, CYCLES - 1, CYCLES, CYCLES + 1, 3 * CYCLES, 1):
            await pulse(dut.fed)
            assert await flags() == (0, told), "a host that is heard is not silent"
            await ClockCycles(dut.clk, silence)
            told |= silence >= CYCLES
            assert await flags() == (silence >= CYCLES, told), (armed, silence)
            if silence > CYCLES:
                await pulse(dut.forget)
                told = 0
                assert await flags() == (1, told)
        dut.armed.value = 0
        await ClockCycles(dut.clk, 2 * CYCLES)
