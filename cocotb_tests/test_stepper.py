"""Bench of rtl/stepper.v: whole runs equal to the twin's, in every arrangement."""

from dataclasses import replace

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import SEED, WATCHDOG, load_bus, reset, simulate, unknown, words
from cocotb_tests.curves import planned, random_curve, with_feed
from nurbs_lab import NurbsCurve
from nurbs_lab.hardware import Format, run_twin


@pytest.mark.parametrize(
    ("arrangement", "dim", "rational", "word", "points"),
    [(0, 2, 0, 35, 64), (1, 3, 1, 35, 64), (2, 3, 1, 35, 64), (2, 2, 1, 29, 24)],
)
def test_stepper(arrangement, dim, rational, word, points):
    parameters = {"ARRANGEMENT": arrangement, "DIM": dim, "RATIONAL": rational}
    simulate("stepper", __file__, WORD=word, MAX_POINTS=points, **parameters)


FAULTS = ("overflow", "by_zero", "backward", "too_far", "beyond")


class Machine:
    """Loads, runs, takes the points with stalls; what idles is X."""

    def __init__(self, dut):
        self.dut, self.rng = dut, np.random.default_rng(SEED)
        self.dim, self.rational = (p.value.to_unsigned() for p in (dut.DIM, dut.RATIONAL))
        self.format = Format(dut.WORD.value.to_unsigned())
        dut.load.value = dut.go.value = dut.ready.value = dut.stop.value = 0

    def curve(self, degree, rational=False):
        return random_curve(self.rng, degree, self.dim, rational)

    def planned(self, curve, periods, **options):
        return planned(curve, periods, format=self.format, **options)

    async def begin(self, plan):
        await load_bus(self.dut, plan.batches()[0])
        self.dut.go.value = 1
        await RisingEdge(self.dut.clk)
        unknown(self.dut.go)  # while busy it is ignored

    async def points(self, stalls=0.5):
        """What leaves up to the last beat: u and points, and whether that beat is void."""
        dut, u, points, last = self.dut, [], [], False
        while not last:
            ready = int(self.rng.random() >= stalls)
            dut.ready.value = ready
            await RisingEdge(dut.clk)
            if ready and dut.valid.value == 1:
                u.append(dut.u_out.value.to_unsigned())
                points.append(words(dut.point_out.value.to_unsigned(), self.format.word, self.dim))
                last = dut.last.value == 1
                void = dut.stopped.value == 1
        dut.go.value = 0
        await FallingEdge(dut.clk)
        assert (dut.done.value, dut.busy.value, dut.valid.value) == (1, 0, 0)
        if void:  # it repeats the point before, if there is one
            before = (u[-2], points[-2]) if len(u) > 1 else (0, (0,) * self.dim)
            assert (u.pop(), points.pop()) == before
        return u, points, void

    async def check(self, plan, flags=(), stalls=0.5):
        """Compare a run with the twin's; ``flags`` are those it is meant to raise."""
        await self.begin(plan)
        u, points, void = await self.points(stalls)
        expected = run_twin(plan)
        assert expected.flags == flags
        assert u == expected.u
        assert points == [tuple(point) for point in expected.points]
        assert void == bool(flags)
        raised = self.dut.faults.value.to_unsigned()
        assert tuple(name for bit, name in enumerate(FAULTS) if raised >> bit & 1) == flags


@cocotb.test(**WATCHDOG)
async def runs_one_after_another(dut):
    """Every degree without a reset, cut short and up to the curve's end."""
    machine = Machine(dut)
    await reset(dut)
    for degree in range(1, 6):
        curve = machine.curve(degree, rational=bool(machine.rational) and degree != 3)
        await machine.check(machine.planned(curve, periods=int(machine.rng.integers(1, 9))))
    line = NurbsCurve(1, [0, 0, 1, 1], np.eye(2, machine.dim))
    end = machine.planned(line, periods=99, speed=20.0)
    assert len(run_twin(end).u) < 99
    await machine.check(end)
    # Nobody takes a point for longer than a step needs.
    await machine.check(machine.planned(line, periods=3), stalls=0.999)


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    machine = Machine(dut)
    await reset(dut)
    for cycles in (1, 2, 7, 40, 200, 700, 1300):
        await machine.begin(machine.planned(machine.curve(2), 30))
        dut.ready.value = 1
        await ClockCycles(dut.clk, cycles)
        dut.rst.value, dut.go.value = 1, 0
        await ClockCycles(dut.clk, 2)
        dut.rst.value = 0
        await machine.check(machine.planned(machine.curve(2), 2))


@cocotb.test(**WATCHDOG)
async def every_flag_ends_the_run(dut):
    """With a last point, after which the next run is clean."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.planned(machine.curve(2), 12)
    for broken, flag in (
        (with_feed(plan, (), 0), "by_zero"),
        (replace(plan, first_chord=1), "overflow"),
        # Adams takes 59 parts of the step before and 55 of a speed that is all at once 0.
        (with_feed(plan, ((2 * 5 - 1, *plan.feed.records[0][1:]),), 0), "backward"),
    ):
        await machine.check(broken, (flag,))
        await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def a_speed_out_of_range_ends_the_run(dut):
    """No program has one, so it is written over a record."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.planned(machine.curve(2), 12)
    await load_bus(dut, plan.batches()[0])
    await load_bus(dut, [(4, 1, -1 << 40)])
    dut.go.value = 1
    await RisingEdge(dut.clk)
    found, _, void = await machine.points()
    assert (found, void, dut.faults.value.to_unsigned()) == ([], True, 1)
    await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def a_flag_of_the_last_point_is_told(dut):
    """Weights that the loader would refuse, at the end of the curve only."""
    machine = Machine(dut)
    await reset(dut)
    if not machine.rational:
        return
    line = NurbsCurve(1, [0, 0, 1, 1], np.eye(2, machine.dim), [1, 0.5])
    plan = machine.planned(line, periods=3)
    start, (*end, _) = plan.curve.points
    for weight, flag in ((0, "by_zero"), (1, "overflow")):
        await machine.check(replace(plan, curve=replace(plan.curve, points=(start, (*end, weight)))), (flag,))
    await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def no_step_is_too_large(dut):
    """Neither a path cut short by its periods, nor a step above its limit, nor a point beyond an axis."""
    machine = Machine(dut)
    await reset(dut)
    curve = machine.curve(2)
    await machine.check(machine.planned(curve, 8, largest_step=None), ("too_far",))
    plan = machine.planned(curve, 12)
    points = run_twin(plan).points
    steps = np.abs(np.diff(points, axis=0)).max(axis=1)
    await machine.check(replace(plan, largest_step=int(steps.max())))
    await machine.check(replace(plan, largest_step=int(steps[4]) - 1), ("too_far",))
    for axis in range(machine.dim):
        low, high = np.min(points, axis=0)[axis], np.max(points, axis=0)[axis]
        for limits, flags in (
            ((low, high), ()),
            ((low + 1, high), ("beyond",)),
            ((low, high - 1), ("beyond",)),
        ):
            of_axes = list(plan.axis_limits)
            of_axes[axis] = tuple(int(limit) for limit in limits)
            await machine.check(replace(plan, axis_limits=tuple(of_axes)), flags)


@cocotb.test(**WATCHDOG)
async def a_stop_is_answered_in_every_state(dut):
    """After it only what was already offered leaves, then a void beat; the next run is clean."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.planned(machine.curve(2), 6)
    whole = run_twin(plan).u
    for cycles in (1, 2, 5, 30, 31, 300, *machine.rng.integers(1, 1500, 12).tolist()):
        await machine.begin(plan)
        dut.ready.value = 0
        await ClockCycles(dut.clk, cycles)
        dut.stop.value = 1
        await RisingEdge(dut.clk)
        dut.stop.value = 0
        await FallingEdge(dut.clk)
        offered = int(dut.valid.value == 1)
        u, _, void = await machine.points(stalls=0.5)
        assert void
        assert u == whole[:offered]
    dut.go.value = dut.stop.value = 1  # together they begin nothing
    await ClockCycles(dut.clk, 2)
    assert dut.busy.value == 0
    dut.go.value = dut.stop.value = 0
    await machine.check(plan)
