"""Bench of rtl/streamer.v: whole runs equal to the twin's, rests and stops on the way."""

from dataclasses import replace
from itertools import accumulate

import cocotb
import numpy as np
import pytest
from cocotb.triggers import ClockCycles, FallingEdge, RisingEdge

from cocotb_tests.bench import WATCHDOG, load_bus, met, reset, simulate
from cocotb_tests.streamer_driver import Machine
from nurbs_lab import NurbsCurve, plan_feed
from nurbs_lab.hardware import Format, build_exact_program, run_exact
from nurbs_lab.hardware.arithmetic import round_shift
from nurbs_lab.hardware.exact_program import S_GUARD
from nurbs_lab.hardware.feed import distances
from nurbs_lab.motion import plan_windows
from nurbs_lab.motion.feed import concatenate


@pytest.mark.parametrize(("dim", "word"), [(2, 35), (3, 29)])
def test_streamer(dim, word):
    simulate("streamer", __file__, DIM=dim, WORD=word)


@cocotb.test(**WATCHDOG)
async def runs_one_after_another(dut):
    """Every degree without a reset, fast and with stalls; many pieces in one step; rests in mid path."""
    machine = Machine(dut)
    await reset(dut)
    for degree in (1, 2, 3):
        for stalls in (0.0, 0.9):
            await machine.check(machine.plan(degree), stalls=stalls)
    plan = machine.plan(2)
    # A piece that ends with a period, and one that is longer by one unit.
    moves = (round_shift(move, Format.ramp_guard - S_GUARD) for move in distances(plan.feed))
    first, *others = plan.pieces
    end = max(along for along in accumulate(moves) if along <= first.length)
    for length in (end, end + 1):
        pieces = (replace(first, length=length), *others)
        await machine.check(replace(plan, pieces=pieces, largest_step=3 * plan.largest_step))
    rest = [(5, 0, 0, 0)]
    await machine.check(replace(plan, feed=(*rest, plan.feed[0], *rest, *plan.feed[1:], *rest)))
    knots = np.array([0, 0, 0.5, 0.5001, 0.5002, 1, 1])
    line = NurbsCurve(1, knots, 8.0 * np.outer(knots[1:-1], np.arange(1, machine.dim + 1)))
    feed = plan_feed(line, speed=300.0, acceleration=30_000.0, period_s=1e-3)
    await machine.check(build_exact_program(line, feed, 1e-3, format=machine.format))


@cocotb.test(**WATCHDOG)
async def a_step_takes_17_or_24_cycles(dut):
    """Every one but the last, knots and new records of the feed included."""
    machine = Machine(dut)
    await reset(dut)
    dut.ready.value = 1
    for degree, cycles in ((2, 17), (3, 24)):
        plan = machine.plan(degree)
        await machine.begin(plan)
        gaps, since = [], 0
        while dut.busy.value == 1 or not gaps:
            await FallingEdge(dut.clk)
            since += 1
            if dut.valid.value == 1:
                gaps.append(since)
                since = 0
        assert set(gaps[2:-1]) == {cycles}
        assert len(gaps) == len(run_exact(plan).u)


@cocotb.test(**WATCHDOG)
async def faults_end_the_run(dut):
    """A step that turns too much, one above its limit: nothing moves there."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.plan(2)
    points = run_exact(plan).points
    longest = int(np.abs(np.diff(points, axis=0)).max())
    (writes,) = plan.batches()
    for step in (longest, longest - 1):  # less than the bank's bound: it is not closed, or the bound is wrong
        tight = spoiled(writes, {(5, 4): step})
        await machine.begin(plan, batches=[tight])
        await RisingEdge(dut.clk)
        assert (dut.busy.value, dut.closed.value) == (0, 0)
        await machine.begin(plan, batches=[spoiled(tight, {(3, 116): step})])
        _, found, void = await machine.points()
        inside = [*(np.abs(np.diff(points, axis=0)).max(axis=1) <= step), False]
        kept = 1 + inside.index(False)
        assert (found, void) == (points[:kept], kept < len(points))
        assert void == (step < longest)
        assert dut.faults.value.to_unsigned() == void << 3
    await machine.check(replace(plan, end=tuple(x[0] for x in plan.pieces[0].points)), ("too_far",))
    first = replace(plan.pieces[0], root=plan.pieces[0].root // 2)
    await machine.check(replace(plan, pieces=(first, *plan.pieces[1:])), ("overflow",))
    fastest = max(plan.feed, key=lambda record: record[1])
    longer = [(row[0] + 30 * (row == fastest), *row[1:]) for row in plan.feed]  # than the path
    await machine.check(replace(plan, feed=tuple(longer)), ("overflow",))
    await machine.check(plan)


def spoiled(writes, change):
    """Writes on the load bus, those at (space, index) in ``change`` with another number."""
    return [(space, index, change.get((space, index), data)) for space, index, data in writes]


@cocotb.test(**WATCHDOG)
async def no_point_beyond_a_limit_leaves(dut):
    """A bank whose bounds lie beyond is not closed; if the bounds are wrong, the last check ends the run."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.plan(2)
    points = run_exact(plan).points
    low, high = min(p[0] for p in points), max(p[0] for p in points)
    await machine.check(replace(plan, axis_limits=((low - 3, high + 3), *plan.axis_limits[1:])))
    (writes,) = plan.batches()
    for limits in ((low - 3, high - 1), (low + 1, high + 3)):
        tight = spoiled(writes, dict(zip([(5, 8), (5, 9)], limits, strict=True)))
        await machine.begin(plan, batches=[tight])
        await RisingEdge(dut.clk)
        assert (dut.busy.value, dut.closed.value) == (0, 0)
        lying = spoiled(tight, {(3, 4): limits[0], (3, 20): limits[1]})
        await machine.begin(plan, batches=[lying])
        _, found, void = await machine.points()
        inside = [limits[0] <= point[0] <= limits[1] for point in points]
        assert (found, void) == (points[: inside.index(False)], True)
        assert dut.faults.value.to_unsigned() == 1 << 4
    for missing in (4, 20, 36):  # a bound that is not there, and one that comes before its limit
        bound = [write for write in writes if write[:2] == (3, missing)]
        rest = [write for write in writes if write[:2] != (3, missing)]
        for order in (rest, bound + rest):
            await machine.begin(plan, batches=[order])
            await RisingEdge(dut.clk)
            assert (dut.busy.value, dut.closed.value) == (0, 0)
    await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def a_bank_beyond_a_limit_brings_the_tool_to_rest(dut):
    """Loaded in mid run: the tool slows down on its path, and a void beat ends the run where it rests.

    So it does for a bank whose feed would exceed the largest step.
    """
    machine = Machine(dut)
    await reset(dut)
    plan = job(machine.dim, 70, machine.format)
    first, *_ = plan.batches()
    far = (1 << machine.format.word - 2) * 15 // 8
    first = spoiled(first, {(5, 9): far})
    for n, wait in enumerate(machine.rng.integers(1, 300, 4).tolist()):
        bound = {(3, 28): far + 1} if n < 2 else {(3, 124): plan.largest_step + 1}
        second = spoiled(plan.batches()[1], bound)

        async def host(wait=wait):
            await ClockCycles(dut.clk, wait)
            await machine.load_next(1)

        await machine.begin(plan, batches=[first, second])
        cocotb.start_soon(host())
        u, points, void = await machine.points()
        expected = run_exact(plan, machine.rates, abort=machine.abort)
        assert (u, points, void) == (expected.u, expected.points, True)
        assert points[-1] == points[-2]
        assert (dut.closed.value.to_unsigned() >> 1, dut.faults.value) == (0, 0)
        dut.rst.value = 1
        await RisingEdge(dut.clk)
        dut.rst.value = 0


@cocotb.test(**WATCHDOG)
async def a_cubic_bank_leaves_the_other_as_it_is(dut):
    """Degree 3 loaded at any time while degree 2 runs, and degree 2 while degree 3 does: as the twin."""
    machine = Machine(dut)
    await reset(dut)
    for cubic in (range(32, 64), range(32)):
        plan = job(machine.dim, 64, machine.format, cubic)
        for wait in machine.rng.integers(1, 120, 4).tolist():

            async def host(wait=wait):
                await ClockCycles(dut.clk, wait)
                await machine.load_next(1)

            await machine.begin(plan)
            hosting = cocotb.start_soon(host())
            u, points, void = await machine.points()
            await hosting
            expected = run_exact(plan, machine.rates)
            assert (u, points, void) == (expected.u, expected.points, False)


@cocotb.test(**WATCHDOG)
async def a_stop_brings_the_tool_to_rest_on_its_path(dut):
    """In every state, with a consumer that waits: the path of the twin, then the void beat."""
    machine = Machine(dut)
    await reset(dut)
    plan = machine.plan(3, 160)
    for cycles in (0, 1, 2, 3, *machine.rng.integers(1, 700, 8).tolist()):
        await machine.begin(plan)
        dut.ready.value = int(machine.rng.random() < 0.7)

        async def stop(cycles=cycles):
            await ClockCycles(dut.clk, 1 + cycles)
            dut.stop.value = 1
            await RisingEdge(dut.clk)
            dut.stop.value = 0

        cocotb.start_soon(stop())
        # Once the consumer waits for longer than a period takes, so that the void beat has to wait as well.
        u, points, void = await machine.points(0.999 if cycles == 3 else 0.5)
        expected = run_exact(plan, abort=machine.abort)
        assert (u, points, void) == (expected.u, expected.points, True)
        assert expected.flags == ("aborted",)
        assert points[-1] == points[-2]
    await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def reset_in_mid_work(dut):
    machine = Machine(dut)
    await reset(dut)
    plan = machine.plan(2)
    for cycles in (1, 9, 30, 100):
        await machine.begin(plan)
        dut.ready.value = 1
        await ClockCycles(dut.clk, cycles)
        dut.rst.value = 1
        await ClockCycles(dut.clk, 2)
        dut.rst.value = 0
        await machine.check(plan)


@cocotb.test(**WATCHDOG)
async def holds_and_overrides_stay_on_the_path(dut):
    """Random commands in mid path: bit for bit the twin, no fault, rest and end as they should be."""
    machine = Machine(dut)
    await reset(dut)
    degree, jerk = (2, None) if machine.dim == 2 else (3, 800)
    plan = machine.plan(degree, 160, jerk)

    async def command():
        for rate in machine.rng.permutation([0, 0, 256, 30, 511]).tolist():
            dut.rate.value = rate
            for _ in range(machine.rng.integers(1, 9) + (9 if rate == 0 else 0)):
                await met(dut, dut.sampled)
        dut.rate.value = 256

    await machine.begin(plan, banks=len(plan.batches()))
    cocotb.start_soon(command())
    u, points, void = await machine.points(0.3)
    expected = run_exact(plan, machine.rates)
    assert (u, points, void, expected.flags) == (expected.u, expected.points, False, ())
    assert points[-1] == run_exact(plan).points[-1]
    assert machine.rested
    assert 0 in machine.rates


def job(dim, count, format, cubic=()):
    """Short arcs, one after the other: through smooth junctions without a stop, with one at every tenth.

    The curves whose numbers are in ``cubic`` have degree 3.
    """
    curves, here, angle = [], np.zeros(dim), 0.0
    for n in range(count):
        turned = angle + (0.3 if n // 10 % 2 else -0.3)
        ahead, then = ([np.cos(a), np.sin(a), 0.2][:dim] for a in (angle, turned))
        points = np.array([here, here + 0.05 * np.array(ahead), here + 0.05 * np.add(ahead, then)])
        if n in cubic:
            points = np.array([[3, 0, 0], [1, 2, 0], [0, 1.9, 1.1], [0, 0, 3]]) / 3 @ points
        curves.append(NurbsCurve(len(points) - 1, np.repeat([0, 1], len(points)), points))
        here, angle = points[-1], turned + (1.0 if n % 10 == 9 else 0.0)
    feeds = [feed for _, feed in plan_windows(curves, speed=30.0, acceleration=6000.0, period_s=1e-3)]
    outputs = [n % 16 for n in range(count)]
    return build_exact_program(curves, concatenate(feeds), 1e-3, outputs=outputs, format=format)


@cocotb.test(**WATCHDOG)
async def go_waits_for_the_loader(dut):
    """With a write to bank 0 nothing begins; with the close of bank 1 the run begins a cycle later."""
    machine = Machine(dut)
    await reset(dut)
    plan = job(machine.dim, 70, machine.format)
    first, second, third = plan.batches()
    machine.later, machine.filled = [first], 0
    await machine.load_next(0)
    dut.go.value = 1
    await load_bus(dut, first[:1])
    dut.go.value = 0
    await FallingEdge(dut.clk)
    assert (dut.busy.value, dut.closed.value) == (0, 0)
    machine.later, machine.filled = [first, third], 0
    await machine.load_next(0)
    await load_bus(dut, second)
    dut.load_space.value, dut.load_index.value = 7, 1
    dut.close.value = dut.go.value = 1
    await RisingEdge(dut.clk)
    dut.close.value, machine.filled = 0, 2
    await RisingEdge(dut.clk)
    dut.go.value = 0

    async def host():
        await met(dut, dut.starved)
        await ClockCycles(dut.clk, 30_000)
        assert dut.resting.value == 1
        await machine.load_next(0)

    hosting = cocotb.start_soon(host())
    u, points, void = await machine.points()
    await hosting
    expected = run_exact(plan, machine.rates)
    assert (u, points, void) == (expected.u, expected.points, False)
    machine.check_starved(plan)


@cocotb.test(**WATCHDOG)
async def a_job_streams_through_two_banks(dut):
    """A prompt host never slows the job; a late one makes it rest on the path and go on; as the twin."""
    machine = Machine(dut)
    await reset(dut)
    plan = job(machine.dim, 70, machine.format)
    assert len(plan.batches()) == 3
    whole = run_exact(plan)
    assert whole.flags == ()
    for late in (False, True):

        async def host(late=late):
            for bank in (1, 0) if late else (0,):
                await FallingEdge(dut.clk)
                while dut.closed.value.to_unsigned() >> bank & 1:
                    await dut.closed.value_change
                if late:
                    await ClockCycles(dut.clk, 6_000)
                await machine.load_next(bank)

        await machine.begin(plan, banks=1 if late else 2)
        hosting = cocotb.start_soon(host())
        u, points, void = await machine.points(0.0 if late else 0.9)
        await hosting
        expected = run_exact(plan, machine.rates) if late else whole
        assert (u, points, void) == (expected.u, expected.points, False)
        assert machine.outputs == expected.outputs
        machine.check_starved(plan)
        assert len(set(expected.outputs)) == 16
        assert machine.rested == late
        assert points[-1] == whole.points[-1]
        assert np.abs(np.diff(points, axis=0)).max() <= plan.largest_step
