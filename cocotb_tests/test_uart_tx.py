"""Bench of rtl/boards/uart_tx.v: the line bit by bit, and its time to the cycle."""

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge, Timer
from cocotb.utils import get_sim_time

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, reset, simulate, unknown


@pytest.mark.parametrize("divider", [4, 15])
def test_uart_tx(divider):
    simulate("uart_tx", __file__, DIVIDER=divider)


@cocotb.test(**WATCHDOG)
async def bytes_follow_one_another(dut):
    """Back to back 10 bits a byte; data is X unless it is taken."""
    divider = dut.DIVIDER.value.to_unsigned()
    dut.valid.value = 0
    unknown(dut.data)
    await reset(dut)
    await ClockCycles(dut.clk, 2)
    assert dut.line.value == 1
    rng = np.random.default_rng(SEED)
    for byte in (0x00, 0xFF, 0xA5, *rng.integers(0, 256, 40).tolist()):
        await FallingEdge(dut.clk)
        assert dut.ready.value == 1
        dut.valid.value, dut.data.value = 1, byte
        await RisingEdge(dut.clk)
        began = get_sim_time("ns")
        await Timer(1, "ns")
        dut.valid.value = 0
        unknown(dut.data)
        levels = []
        await Timer(divider * CLOCK_NS // 2, "ns")
        for _ in range(10):
            levels.append(int(dut.line.value))
            assert dut.ready.value == 0
            await Timer(divider * CLOCK_NS, "ns")
        assert levels == [0, *(byte >> i & 1 for i in range(8)), 1]
        assert dut.ready.value == 1
        assert get_sim_time("ns") - began < (10 * divider + divider) * CLOCK_NS
        if rng.random() < 0.5:
            await ClockCycles(dut.clk, 3)
        assert dut.line.value == 1
    dut.valid.value, dut.data.value = 1, 0
    await ClockCycles(dut.clk, 3)
    dut.rst.value = 1
    await ClockCycles(dut.clk, 2)
    assert dut.line.value == 1
