"""Bench of rtl/cuk.v: cu at a parameter shifted by none, half or the whole of a period."""

import cocotb
import pytest
from cocotb.triggers import ClockCycles

from cocotb_tests.bench import WATCHDOG, Unit, extremes, load_bus, simulate, words
from cocotb_tests.curves import random_curve
from nurbs_lab.hardware import Format, evaluate, load
from nurbs_lab.hardware.arithmetic import round_shift


@pytest.mark.parametrize(("word", "dim"), [(35, 2), (21, 3)])
def test_cuk(word, dim):
    simulate("cuk", __file__, WORD=word, DIM=dim)


class Shifter(Unit):
    def __init__(self, dut):
        super().__init__(dut, ["u", "k", "half", "whole"])
        self.format, self.dim = Format(dut.WORD.value.to_unsigned()), dut.DIM.value.to_unsigned()

    async def load(self, degree, rational):
        self.loaded = load(random_curve(self.rng, degree, self.dim, rational), self.format)
        self.middle = (self.loaded.first_u + self.loaded.last_u) // 2
        await load_bus(self.dut, self.loaded.writes())

    async def check(self, u, k, half, whole):
        """Compare with the twin; return the shifted parameter."""
        await self.ask(u, k, half, whole)
        dut, factor = self.dut, 24 if whole else 12 if half else 0
        moved = u + round_shift(factor * k, self.format.guard)
        expected = evaluate(self.loaded, min(max(moved, 0), self.format.largest))
        flags = (flag.value == 1 for flag in (dut.out_of_range, dut.overflow, dut.by_zero))
        assert (words(dut.point.value.to_unsigned(), self.format.word, self.dim), *flags) == tuple(expected)
        return moved


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    """One curve after the other without a reset; shifts inside the curve, out of it, and out of the word."""
    unit = Shifter(dut)
    dut.load.value = 0
    await unit.reset()
    largest = unit.format.largest
    for degree, rational in ((1, False), (2, True), (3, False), (5, True)):
        await unit.load(degree, rational)
        found = []
        for k in extremes(unit.rng, unit.format.word, 20):
            anywhere = int(unit.rng.integers(0, largest + 1))
            for u, half, whole in ((0, 1, 0), (largest, 0, 1), (anywhere, 1, 1), (anywhere, 0, 0)):
                found.append(await unit.check(u, k, half, whole))
            small = int(unit.rng.integers(-(1 << 12), 1 << 12))
            found.append(await unit.check(unit.middle, small, 1, 0))
        assert min(found) < 0
        assert max(found) > largest
        assert any(unit.loaded.first_u < u < unit.loaded.last_u for u in found)


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit = Shifter(dut)
    dut.load.value = 0
    await unit.reset()
    await unit.load(3, True)
    for clocks in range(0, 60, 7):
        await unit.begin(unit.loaded.last_u, -5000, 0, 1)
        await ClockCycles(dut.clk, clocks + 1)
        dut.rst.value = 1
        await ClockCycles(dut.clk, 1)
        dut.rst.value = 0
        await unit.check(unit.middle, 7777, 1, 0)


@cocotb.test(**WATCHDOG)
async def division_flags(dut):
    """Weights that the loader would refuse raise the flags of the division; a good curve clears them."""
    unit = Shifter(dut)
    dut.load.value = 0
    await unit.reset()
    await unit.load(2, True)
    good = unit.loaded
    for weight, flags in ((0, (True, False)), (1, (False, True))):
        await load_bus(dut, [(2, i << 2 | 3, weight) for i in range(len(good.points))])
        await unit.ask(unit.middle, 99, 1, 0)
        assert (dut.by_zero.value == 1, dut.overflow.value == 1) == flags
    await load_bus(dut, good.writes())
    await unit.check(unit.middle, 99, 1, 0)
