"""Bench of rtl/cu.v: equal to its twin bit for bit, in the cycles its header says, whatever came before."""

from math import ceil, log2

import cocotb
import pytest
from cocotb.triggers import FallingEdge, RisingEdge

from cocotb_tests.bench import WATCHDOG, drive, load_bus, simulate
from cocotb_tests.curves import CurveUnit
from nurbs_lab import paper
from nurbs_lab.hardware import evaluate_cu


@pytest.mark.parametrize(("word", "dim"), [(35, 2), (35, 3), (21, 3)])
def test_cu(word, dim):
    simulate("cu", __file__, WORD=word, DIM=dim)


async def ready(dut):
    """A reset unit."""
    unit = CurveUnit(dut, ["u"])
    await unit.reset()
    return unit


async def check(unit, parameters):
    """Compare with the twin at these parameters; return the cycles."""
    found = []
    for u in map(int, parameters):
        found.append(await unit.ask(u))
        assert unit.answer() == tuple(evaluate_cu(unit.loaded, u)), f"u = {u}"
    return found


def parameters(unit, count):
    """Every knot and its neighbours, then random ones, inside the domain and a little outside."""
    loaded = unit.loaded
    knots = [knot + step for knot in set(loaded.knots) for step in (-1, 0, 1)]
    low, high = max(loaded.first_u - 9, 0), min(loaded.last_u + 10, 2 * loaded.format.one)
    inside = [knot for knot in knots if low <= knot < high]
    return [*inside, *unit.rng.integers(low, high, count)]


def latency(loaded):
    """Cycles of a point in the span of the point before; and the most that a search adds."""
    degree, dim = loaded.degree, loaded.dim
    ratios = degree * (degree + 1) // 2
    division = ceil(loaded.format.word / 4) + 1
    # The axes are divided in turn once the weight and the first of them are summed.
    sums = 2 * (degree + 1) + dim * division if loaded.rational else dim * (degree + 1)
    held = 2 + max(ratios, 3) + ratios + sums
    return held, 3 + 2 * ceil(log2(max(len(loaded.points) - degree, 1)))


@cocotb.test(**WATCHDOG)
async def paper_curve(dut):
    """The curve of section 4 in at most 23 cycles a point."""
    unit = await ready(dut)
    if unit.dim != 2:
        return
    await unit.load(paper.CURVE)
    cycles = await check(unit, parameters(unit, 500))
    assert max(cycles) <= 23


@cocotb.test(**WATCHDOG)
async def random_curves(dut):
    """Every degree, with weights and without, one after the other without a reset."""
    unit = await ready(dut)
    for degree in range(1, 6):
        for rational in (False, True):
            await unit.load_random(degree, rational)
            cycles = await check(unit, parameters(unit, 40))
            held, search = latency(unit.loaded)
            assert held <= min(cycles)
            assert max(cycles) <= held + search
            _, again = await check(unit, [unit.loaded.last_u] * 2)
            assert again == held


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    """A reset at any clock of the work leaves nothing behind."""
    unit = await ready(dut)
    await unit.load_random(3, True)
    for cycles in range(1, 60, 7):
        await unit.cut_short(unit.loaded.first_u, after=cycles)
        await check(unit, [unit.loaded.last_u, unit.loaded.first_u])


@cocotb.test(**WATCHDOG)
async def division_flags(dut):
    """A curve that the loader would refuse raises the flags of the division, and the next one clears them."""
    unit = await ready(dut)
    await unit.load_random(2, True)
    for weight, flags in ((0, (False, False, True)), (1, (False, True, False))):
        await unit.load_weight(weight)
        await unit.ask(unit.loaded.first_u)
        assert unit.answer()[1:] == flags
    await load_bus(dut, unit.loaded.writes())
    await check(unit, [unit.loaded.first_u])


@cocotb.test(**WATCHDOG)
async def points_may_overlap(dut):
    """The next point starts as soon as busy is low: each done has the point and the flag of its own u."""
    unit = await ready(dut)
    for degree, rational in ((1, False), (2, False), (3, False), (5, False), (2, True)):
        await unit.load_random(degree, rational)
        loaded = unit.loaded
        outside = [u for u in (loaded.first_u - 5, loaded.last_u + 5) if 0 <= u <= unit.format.largest]
        wanted = [*unit.rng.integers(loaded.first_u, loaded.last_u, 20).tolist(), *outside * 5]
        unit.rng.shuffle(wanted)
        found, left, overlapped = [], list(wanted), False
        while len(found) < len(wanted):
            if left and dut.busy.value == 0:
                drive(dut.u, left.pop(0))
                dut.start.value = 1
            await RisingEdge(dut.clk)
            dut.start.value = 0
            await FallingEdge(dut.clk)
            if dut.done.value == 1:
                found.append(unit.answer())
                overlapped |= dut.busy.value == 1
        assert found == [tuple(evaluate_cu(loaded, u)) for u in wanted]
        assert overlapped != rational
