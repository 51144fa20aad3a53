"""Bench of rtl/soft_limits.v: both flags at and beside every limit."""

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, drive, extremes, packed, simulate


@pytest.mark.parametrize(("word", "dim"), [(35, 2), (35, 3), (9, 3)])
def test_limits(word, dim):
    simulate("soft_limits", __file__, WORD=word, DIM=dim)


@cocotb.test(**WATCHDOG)
async def equals_the_comparison(dut):
    rng = np.random.default_rng(SEED)
    word, dim = dut.WORD.value.to_unsigned(), dut.DIM.value.to_unsigned()
    dut.load.value = 0
    Clock(dut.clk, CLOCK_NS, unit="ns", impl="gpi").start(start_high=False)
    numbers = extremes(rng, word, 60)
    found = set()
    for _ in range(40):
        step = abs(int(rng.choice(numbers)))
        axes = [sorted(int(x) for x in rng.choice(numbers, 2)) for _ in range(dim)]
        dut.load.value = 1
        for index, limit in [(4, step), *((8 + i, limit) for i, limit in enumerate(np.ravel(axes).tolist()))]:
            dut.load_index.value = index
            drive(dut.load_data, limit)
            await RisingEdge(dut.clk)
        dut.load.value = 0
        for given in (step - 1, step, step + 1, int(rng.choice(numbers))):
            given &= (1 << word) - 1  # a bank's largest step has no sign
            dut.bound.value = 7
            drive(dut.load_data, given)
            await FallingEdge(dut.clk)
            assert dut.bound_beyond.value == int(given > step)
        for _ in range(40):
            before = [int(rng.integers(low, high + 1)) for low, high in axes]
            moves = rng.choice([0, step, -step, step + 1, -step - 1, 1, -1], dim)
            here = [
                min(max(x + int(m), -(1 << word - 1)), (1 << word - 1) - 1)
                for x, m in zip(before, moves, strict=True)
            ]
            dut.point.value, dut.point_before.value = packed(here, word), packed(before, word)
            await ClockCycles(dut.clk, 2)
            await FallingEdge(dut.clk)
            flags = (
                any(abs(x - y) > step for x, y in zip(here, before, strict=True)),
                any(not low <= x <= high for x, (low, high) in zip(here, axes, strict=True)),
            )
            assert (dut.too_far.value == 1, dut.beyond.value == 1) == flags
            found.add(flags)
    assert len(found) == 4
