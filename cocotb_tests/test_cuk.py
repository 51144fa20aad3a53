"""Bench of rtl/cuk.v: cu at a parameter shifted by none, half or the whole of a period."""

import cocotb
import pytest

from cocotb_tests.bench import WATCHDOG, extremes, load_bus, simulate
from cocotb_tests.curves import CurveUnit
from nurbs_lab.hardware import evaluate_cu
from nurbs_lab.hardware.arithmetic import round_shift


@pytest.mark.parametrize(("word", "dim"), [(35, 2), (21, 3)])
def test_cuk(word, dim):
    simulate("cuk", __file__, WORD=word, DIM=dim)


async def ready(dut):
    """A reset unit."""
    unit = CurveUnit(dut, ["u", "k", "half", "whole"])
    await unit.reset()
    return unit


def middle(unit):
    """A parameter inside the curve."""
    return (unit.loaded.first_u + unit.loaded.last_u) // 2


async def check(unit, u, k, half, whole):
    """Compare with the twin; return the shifted parameter."""
    await unit.ask(u, k, half, whole)
    moved = u + round_shift((24 if whole else 12 if half else 0) * k, unit.format.guard)
    assert unit.answer() == tuple(evaluate_cu(unit.loaded, min(max(moved, 0), unit.format.largest)))
    return moved


@cocotb.test(**WATCHDOG)
async def equals_the_twin(dut):
    """One curve after the other without a reset; shifts inside the curve, out of it, and out of the word."""
    unit = await ready(dut)
    largest = unit.format.largest
    for degree, rational in ((1, False), (2, True), (3, False), (5, True)):
        await unit.load_random(degree, rational)
        found = []
        for k in extremes(unit.rng, unit.format.word, 20):
            anywhere = int(unit.rng.integers(0, largest + 1))
            for u, half, whole in ((0, 1, 0), (largest, 0, 1), (anywhere, 1, 1), (anywhere, 0, 0)):
                found.append(await check(unit, u, k, half, whole))
            small = int(unit.rng.integers(-(1 << 12), 1 << 12))
            found.append(await check(unit, middle(unit), small, 1, 0))
        assert min(found) < 0
        assert max(found) > largest
        assert any(unit.loaded.first_u < u < unit.loaded.last_u for u in found)


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    unit = await ready(dut)
    await unit.load_random(3, True)
    for cycles in range(0, 60, 7):
        await unit.cut_short(unit.loaded.last_u, -5000, 0, 1, after=cycles + 1)
        await check(unit, middle(unit), 7777, 1, 0)


@cocotb.test(**WATCHDOG)
async def division_flags(dut):
    """Weights that the loader would refuse raise the flags of the division; a good curve clears them."""
    unit = await ready(dut)
    await unit.load_random(2, True)
    for weight, flags in ((0, (False, True)), (1, (True, False))):
        await unit.load_weight(weight)
        await unit.ask(middle(unit), 99, 1, 0)
        assert unit.answer()[2:] == flags
    await load_bus(dut, unit.loaded.writes())
    await check(unit, middle(unit), 99, 1, 0)
