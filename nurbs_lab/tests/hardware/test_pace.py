"""Feed override in integers: the limits, the least time, and the rule in floating point."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import build_exact_program, run_exact
from nurbs_lab.hardware.exact_program import F_GUARD
from nurbs_lab.hardware.pace import Pace, pace_limits
from nurbs_lab.motion import apply_override
from nurbs_lab.tests.motion.least_stop import least_stop

PERIOD, SPEED, ACCELERATION, WORD = 1e-3, 40.0, 400.0, 35
BUTTERFLY = nl.motion.benchmark_curves()["butterfly"].curve


def planned(jerk):
    """A plan with its distances and limits in integers, and the unit of 1 mm."""
    plan = nl.plan_feed(
        BUTTERFLY, speed=SPEED, acceleration=ACCELERATION, jerk=jerk, chord_error=1e-4, period_s=PERIOD
    )
    unit = 2.0 ** (WORD - 2 + F_GUARD - int(np.frexp(1.01 * SPEED * PERIOD)[1]))
    ends = plan.displacement(PERIOD * np.arange(np.ceil(plan.duration / PERIOD) + 1))
    moves = [round(x * unit) for x in np.diff(ends)]
    return plan, moves, pace_limits(plan, PERIOD, unit, *moves[:2], WORD), unit


def follow(plan, moves, limits, unit, rows):
    """Places, path times and rates at the ends of the periods, under rows (period, command of 0 to 256)."""
    pace = Pace(moves, limits, WORD)
    commands = [256] * rows[0][0]
    for (first, command), (last, _) in zip(rows, [*rows[1:], (rows[-1][0] + 1, 0)], strict=True):
        commands += [command] * (last - first)
    s, tau, rate = [0], [0.0], [1.0]
    for moved in pace.run(commands):
        s.append(s[-1] + moved)
        tau.append((pace.number + pace.tau / pace.one) * PERIOD)
        rate.append(pace.rate / pace.one)
    assert s[-1] == sum(moves)
    return np.array([x / unit for x in s]), np.minimum(tau, plan.duration), np.array(rate)


@pytest.mark.parametrize("jerk", [None, 8000.0])
def test_five_thousand_random_commands_keep_the_limits_and_stop_in_the_least_time(jerk):
    """Ten thousand in all. As in floating point, but for A T / 8 of speed where the acceleration jumps."""
    plan, moves, limits, unit = planned(jerk)
    rng, commands, stops = np.random.default_rng(18), 0, 0
    while commands < 5_000:
        starts = np.unique(rng.integers(0, 2 * len(moves), 100)).tolist()
        rates = rng.choice([0, 0, 0, 32, 64, 128, 224, 256, 256, 256, 400], len(starts)).tolist()
        rows = [*zip(starts, rates, strict=True), (starts[-1] + 500, 256)]
        s, tau, rate = follow(plan, moves, limits, unit, rows)
        commands += np.sum(np.array(starts) < len(s))
        v, moved = rate * plan.speed(tau), np.diff(s)
        assert moved.min() >= 0.0
        assert moved.max() <= (SPEED + ACCELERATION * PERIOD / 8) * PERIOD
        slow = np.maximum(np.minimum(plan.speed(tau[2:]), plan.speed(tau[:-2])), 1e-9)
        bound = ACCELERATION * (1.0 + ACCELERATION * PERIOD / slow) if jerk else 2.0 * ACCELERATION
        over = np.abs(np.diff(moved)) - bound * PERIOD**2
        assert over[:-2].max() <= 1e-9  # the feed ends within its last period
        for row in np.flatnonzero((np.array(rates) == 0) & (np.append(1, rates[:-1]) > 0))[:-1]:
            first = starts[row]
            last = next((n for n, r in zip(starts[row:], rates[row:], strict=True) if r), first)
            rest = np.flatnonzero(v[first : last + 1] == 0.0)
            if first < 1 or last >= len(v) - 2 or v[first] < 1e-6 or not len(rest):
                continue
            stops += 1
            gained = (v[first] - v[first - 1]) / PERIOD
            assert rest[0] * PERIOD <= 1.05 * least_stop(v[first], gained, ACCELERATION, jerk) + 2 * PERIOD
    assert stops > 500


@pytest.mark.parametrize("jerk", [None, 8000.0, 20_000.0])
def test_a_command_is_followed_as_in_floating_point(jerk):
    """Both need the least time and at most 3 periods, so they lie at most 3 periods of travel apart."""
    plan, moves, limits, unit = planned(jerk)
    rng = np.random.default_rng(3)
    for first in rng.integers(1, len(moves), 20).tolist():
        command = int(rng.choice([32, 64, 128, 192]))
        s, *_ = follow(plan, moves, limits, unit, [(first, command)])
        feed = apply_override(plan, [(first * PERIOD, command / 256)])
        t = PERIOD * np.arange(min(len(s), int(feed.duration / PERIOD) + 1))
        assert np.abs(feed.displacement(t) - s[: len(t)]).max() <= 3 * SPEED * PERIOD
        assert s[first] == sum(moves[:first]) / unit


@pytest.mark.parametrize("jerk", [None, 800.0])
def test_five_thousand_random_commands_raise_no_fault(jerk):
    """Ten thousand in all, with the largest step at the bound of the test above."""
    curve, speed, acceleration = nl.paper.CURVE, 4.0, 40.0
    feed = nl.plan_feed(curve, speed=speed, acceleration=acceleration, jerk=jerk, period_s=PERIOD)
    step = (speed + acceleration * PERIOD / 8) * PERIOD
    program = build_exact_program(curve, feed, PERIOD, largest_step=step)
    rng, commands = np.random.default_rng(18), 0
    while commands < 5_000:
        rates, periods = rng.choice([0, 32, 64, 128, 224, 256, 256, 400], 200), rng.integers(1, 40, 200)
        run = run_exact(program, np.append(np.repeat(rates, periods), 256))
        assert run.flags == ()
        assert run.points[-1] == program.end
        commands += np.sum(np.cumsum(periods) < len(run.u))


def test_an_abort_ends_at_rest_on_the_path():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, jerk=800.0, period_s=PERIOD)
    program = build_exact_program(nl.paper.CURVE, feed, PERIOD)
    run = run_exact(program, abort=500)
    assert run.flags == ("aborted",)
    assert run.points[-1] == run.points[-2] != run.points[-3]
    assert 4.0 / 40.0 + 40.0 / 800.0 <= (len(run.points) - 502) * PERIOD <= 0.15 + 3 * PERIOD
    assert run.points[:500] == run_exact(program).points[:500]
    at_once = run_exact(program, [0], abort=0)  # from rest nothing moves
    assert at_once.points == [run.points[0]] * 3


def test_a_stop_ends_within_the_reserve():
    for jerk in (None, 8000.0):
        plan, moves, limits, unit = planned(jerk)
        fastest = int(np.argmax(moves))
        for first in (fastest, fastest - 3):
            _, _, rate = follow(plan, moves, limits, unit, [(first, 0), (first + 2000, 256)])
            assert np.flatnonzero(rate == 0.0)[0] - first <= limits.reserve - 4
