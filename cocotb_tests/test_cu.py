"""Bench of rtl/cu.v: equal to its twin bit for bit, in the cycles its header says, whatever came before."""

from math import ceil, log2

import cocotb
import numpy as np
import pytest
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge, with_timeout
from cocotb.utils import get_sim_time

from cocotb_tests.bench import CLOCK_NS, SEED, WATCHDOG, load_bus, simulate, unknown, words
from cocotb_tests.curves import random_curve
from nurbs_lab import paper
from nurbs_lab.hardware import Format, evaluate, load


@pytest.mark.parametrize(("word", "dim"), [(35, 2), (35, 3), (21, 3)])
def test_cu(word, dim):
    simulate("cu", __file__, WORD=word, DIM=dim)


class Driver:
    """Drives the ports of ``cu``; idle inputs are X."""

    def __init__(self, dut):
        self.dut = dut
        self.format = Format(dut.WORD.value.to_unsigned())
        self.dim = dut.DIM.value.to_unsigned()
        self.rng = np.random.default_rng(SEED)

    async def reset(self):
        dut = self.dut
        Clock(dut.clk, CLOCK_NS, unit="ns").start()
        dut.load.value = 0
        dut.start.value = 0
        self.idle()
        dut.rst.value = 1
        await RisingEdge(dut.clk)
        dut.rst.value = 0

    def idle(self):
        for handle in (self.dut.u, self.dut.load_space, self.dut.load_index, self.dut.load_data):
            unknown(handle)

    async def load(self, writes):
        await load_bus(self.dut, writes)

    async def begin(self, u):
        self.dut.start.value = 1
        self.dut.u.value = u
        await RisingEdge(self.dut.clk)
        self.dut.start.value = 0
        unknown(self.dut.u)

    async def point(self, u):
        """Evaluate, and return what the twin returns, and the cycles."""
        dut = self.dut
        await self.begin(u)
        began = get_sim_time("ns")
        await with_timeout(RisingEdge(dut.done), 200 * CLOCK_NS, "ns")
        cycles = 1 + round(get_sim_time("ns") - began) // CLOCK_NS
        await FallingEdge(dut.clk)
        assert dut.busy.value == 0
        flags = (dut.out_of_range, dut.overflow, dut.by_zero)
        point = words(dut.point.value.to_unsigned(), self.format.word, self.dim)
        return (point, *(bool(flag.value) for flag in flags)), cycles

    async def check(self, loaded, parameters):
        """Compare with the twin at these parameters; return the cycles."""
        found = []
        for u in parameters:
            answer, cycles = await self.point(int(u))
            assert answer == tuple(evaluate(loaded, int(u))), f"u = {u}"
            found.append(cycles)
        return found

    def parameters(self, loaded, count):
        """Every knot and its neighbours, then random ones, inside the domain and a little outside."""
        knots = [knot + step for knot in set(loaded.knots) for step in (-1, 0, 1)]
        low, high = max(loaded.first_u - 9, 0), min(loaded.last_u + 10, 2 * loaded.format.one)
        inside = [knot for knot in knots if low <= knot < high]
        return [*inside, *self.rng.integers(low, high, count)]


def latency(loaded):
    """Cycles of a point in the span of the point before; and the most that a search adds."""
    degree, axes = loaded.degree, loaded.dim + loaded.rational
    levels = sum(max(level, 4) for level in range(2, degree + 1))
    held = 5 + max(degree * (degree + 1) // 2, 6) + levels + (degree + 1) * axes
    division = ceil(loaded.format.word / 3) + 2
    return held + loaded.rational * division, 2 + 2 * ceil(log2(max(len(loaded.points) - degree, 1)))


@cocotb.test(**WATCHDOG)
async def paper_curve(dut):
    """The curve of section 4 in at most 40 cycles a point."""
    driver = Driver(dut)
    await driver.reset()
    if driver.dim != 2:
        return
    loaded = load(paper.CURVE, driver.format)
    await driver.load(loaded.writes())
    cycles = await driver.check(loaded, driver.parameters(loaded, 500))
    assert max(cycles) <= 40


@cocotb.test(**WATCHDOG)
async def random_curves(dut):
    """Every degree, with weights and without, one after the other without a reset."""
    driver = Driver(dut)
    await driver.reset()
    for degree in range(1, 6):
        for rational in (False, True):
            loaded = load(random_curve(driver.rng, degree, driver.dim, rational), driver.format)
            await driver.load(loaded.writes())
            cycles = await driver.check(loaded, driver.parameters(loaded, 40))
            held, search = latency(loaded)
            assert held <= min(cycles)
            assert max(cycles) <= held + search
            assert (degree, rational) != (3, True) or max(cycles) <= 90
            (again,) = await driver.check(loaded, [loaded.last_u])
            (again,) = await driver.check(loaded, [loaded.last_u])
            assert again == held


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    """A reset at any clock of the work leaves nothing behind."""
    driver = Driver(dut)
    await driver.reset()
    loaded = load(random_curve(driver.rng, 3, driver.dim, True), driver.format)
    await driver.load(loaded.writes())
    for clocks in range(0, 60, 7):
        await driver.begin(loaded.first_u)
        for _ in range(clocks):
            await RisingEdge(dut.clk)
        dut.rst.value = 1
        await RisingEdge(dut.clk)
        dut.rst.value = 0
        await driver.check(loaded, [loaded.last_u, loaded.first_u])


@cocotb.test(**WATCHDOG)
async def division_flags(dut):
    """A curve that the loader would refuse raises the flags of the division, and the next one clears them."""
    driver = Driver(dut)
    await driver.reset()
    loaded = load(random_curve(driver.rng, 2, driver.dim, True), driver.format)
    await driver.load(loaded.writes())
    for weight, flags in ((0, (False, False, True)), (1, (False, True, False))):
        await driver.load([(2, i << 2 | 3, weight) for i in range(len(loaded.points))])
        (_, *raised), _ = await driver.point(loaded.first_u)
        assert tuple(raised) == flags
    await driver.load(loaded.writes())
    await driver.check(loaded, [loaded.first_u])
