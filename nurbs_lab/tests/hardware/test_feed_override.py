"""Feed override in integers: the limits, the least time, and the rule in floating point."""

from itertools import chain, repeat

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import build_exact_program, run_exact
from nurbs_lab.hardware.arithmetic import Format
from nurbs_lab.hardware.feed_override import ON_THE_WAY, FeedOverride, OverrideLimits, override_limits
from nurbs_lab.motion import apply_override
from nurbs_lab.tests.motion.least_stop import least_periods

PERIOD, SPEED, ACCELERATION, WORD = 1e-3, 40.0, 400.0, 35
BUTTERFLY = nl.motion.benchmark_curves()["butterfly"].curve


def planned(jerk):
    """A plan with its distances and limits in integers, which are those along the path; the unit of 1 mm."""
    given = {"speed": SPEED, "acceleration": ACCELERATION, "jerk": jerk, "chord_error": 1e-4}
    plan = nl.plan_feed(BUTTERFLY, **given, period_s=PERIOD, tangential_only=True)
    return plan, *in_integers(plan)


def in_integers(plan):
    """Distances of a plan and its limits, and the unit of 1 mm."""
    unit = 2.0 ** (WORD - 2 + Format.ramp_guard - int(np.frexp(1.01 * SPEED * PERIOD)[1]))
    ends = plan.displacement(PERIOD * np.arange(np.ceil(plan.duration / PERIOD) + 1))
    moves = [round(x * unit) for x in np.diff(ends)]
    return moves, override_limits(plan, PERIOD, unit, *moves[:2], WORD), unit


def follow(moves, limits, rows):
    """Ends of the periods under rows (period, command of 0 to 256): distance, path time, rate; and speeds.

    Each speed is that at the start of its period, as the rule counts it.
    """
    override, start = FeedOverride(moves, limits, WORD), FeedOverride(moves, limits, WORD)
    commands = [256] * rows[0][0]
    for (first, command), (last, _) in zip(rows, [*rows[1:], (rows[-1][0] + 1, 0)], strict=True):
        commands += [command] * (last - first)
    s, tau, rate, speed = [0], [0.0], [1.0], []
    for moved in override.run(chain(commands, repeat(commands[-1]))):
        speed.append(override.before[1] if override.before else start.speed(len(speed), 0))
        s.append(s[-1] + moved)
        tau.append(override.number + override.tau / override.one)
        rate.append(override.rate / override.one)
    assert s[-1] == sum(moves)
    return s, np.array(tau), np.array(rate), speed


def stops_of(rows, rate, speed, limits):
    """Periods and least periods of every hold among the rows that comes to rest."""
    for n, (first, command) in enumerate(rows[:-1]):
        rest = np.flatnonzero(rate[first : rows[n + 1][0] + 1] == 0.0)
        if command == 0 and 0 < first < len(speed) - 2 and len(rest) and speed[first] > 0 and rest[0]:
            braking = speed[first - 1] - speed[first]
            yield rest[0], least_periods(speed[first], braking, limits.alpha, limits.beta)


def test_ten_thousand_random_commands_at_any_limits_stop_in_the_least_time():
    """On a straight line: stops of 1 to 100 periods, at any rate and in the middle of a change of rate."""
    rng, commands, stops = np.random.default_rng(5), 0, []
    while commands < 10_000:
        move = int(2.0 ** rng.uniform(50, 61.9))
        alpha = int(move * rng.uniform(0.005, 1.5))
        beta = min(int(alpha * 10.0 ** rng.uniform(-2, 1)), (1 << 62) - 1)
        limits = OverrideLimits(alpha, beta, move, 0)
        starts = np.cumsum(rng.integers(1, 50, 60)).tolist()
        rows = [*zip(starts, rng.choice([0, 0, 0, 30, 64, 200, 256], 60).tolist(), strict=True)]
        rows.append((starts[-1] + 1, 256))
        _, _, rate, speed = follow([move] * starts[-1], limits, rows)
        commands += 60
        stops += stops_of(rows, rate, speed, limits)
    assert len(stops) > 2000
    assert sum(least < 20 for _, least in stops) > 1000
    assert all(periods <= 1.05 * least for periods, least in stops)


@pytest.mark.parametrize("jerk", [None, 8000.0, 20_000.0])
def test_a_command_is_followed_as_in_floating_point(jerk):
    """Both need about the least time; only the integers end at once what is left of the acceleration."""
    plan, moves, limits, unit = planned(jerk)
    rng = np.random.default_rng(3)
    for first in rng.integers(1, len(moves), 5).tolist():
        command = int(rng.choice([32, 64, 128, 192]))
        s = np.array(follow(moves, limits, [(first, command)])[0]) / unit
        feed = apply_override(plan, [(first * PERIOD, command / 256)])
        t = PERIOD * np.arange(min(len(s), int(feed.duration / PERIOD) + 1))
        assert np.abs(feed.displacement(t) - s[: len(t)]).max() <= 4 * SPEED * PERIOD
        assert s[first] == sum(moves[:first]) / unit


@pytest.mark.parametrize("jerk", [None, 20_000.0])
@pytest.mark.parametrize(("along", "across", "most"), [(1.0, 1.0, 1.42), (0.8, 0.6, 1.01)])
def test_the_vector_takes_what_the_docstring_says(jerk, along, across, most):
    """Differences of positions under random commands, beside a limit that is M along and across the path."""
    given = {"acceleration": along * ACCELERATION, "centripetal_acceleration": across * ACCELERATION}
    plan = nl.plan_feed(BUTTERFLY, speed=SPEED, jerk=jerk, period_s=PERIOD, **given)
    moves, limits, unit = in_integers(plan)
    rng = np.random.default_rng(47)
    starts = np.cumsum(rng.integers(1, 100, 150)).tolist()
    rows = [*zip(starts, rng.choice([0, 64, 128, 256], 150).tolist(), strict=True), (starts[-1] + 1, 256)]
    lengths = np.array(follow(moves, limits, rows)[0]) / unit
    points = BUTTERFLY(BUTTERFLY.parameter_at(np.minimum(lengths, plan.length)))
    used = np.linalg.norm(np.diff(points, n=2, axis=0), axis=1).max() / PERIOD**2 / ACCELERATION
    assert 0.8 * most < used <= most


@pytest.mark.parametrize("jerk", [None, 800.0])
def test_five_thousand_random_commands_raise_no_fault(jerk):
    """Ten thousand in all, with the largest step at the bound of the test above."""
    curve, speed, acceleration = nl.paper.CURVE, 4.0, 40.0
    feed = nl.plan_feed(curve, speed=speed, acceleration=acceleration, jerk=jerk, period_s=PERIOD)
    step = 1.002 * (speed + acceleration * PERIOD / 8) * PERIOD  # the loader adds 1/1000
    program = build_exact_program(curve, feed, PERIOD, largest_step=step)
    slower = build_exact_program(curve, feed, PERIOD, largest_step=0.99 * step)
    assert run_exact(slower).flags == ("bad curve", "beyond")  # its bank is not closed
    rng, commands = np.random.default_rng(18), 0
    while commands < 5_000:
        rates, periods = rng.choice([0, 32, 64, 128, 224, 256, 256, 400], 200), rng.integers(1, 40, 200)
        run = run_exact(program, np.append(np.repeat(rates, periods), 256))
        assert run.flags == ()
        assert run.points[-1] == program.end
        commands += np.sum(np.cumsum(periods) < len(run.u))


def test_an_abort_ends_at_rest_on_the_path():
    limits = {"speed": 4.0, "acceleration": 40.0, "jerk": 800.0, "tangential_only": True}
    feed = nl.plan_feed(nl.paper.CURVE, **limits, period_s=PERIOD)
    program = build_exact_program(nl.paper.CURVE, feed, PERIOD)
    run = run_exact(program, abort=500)
    assert run.flags == ("aborted",)
    assert run.points[-1] == run.points[-2] != run.points[-3]
    assert len(run.points) - 502 == 150  # the least number: 4 / 40 s and 40 / 800 s
    assert run.points[:500] == run_exact(program).points[:500]
    at_once = run_exact(program, [0], abort=0)  # from rest nothing moves
    assert at_once.points == [run.points[0]] * 3


def test_a_stop_ends_within_the_reserve():
    for jerk in (None, 8000.0):
        _, moves, limits, _ = planned(jerk)
        fastest = int(np.argmax(moves))
        for first in (fastest, fastest - 3):
            _, _, rate, _ = follow(moves, limits, [(first, 0), (first + 2000, 256)])
            assert np.flatnonzero(rate == 0.0)[0] - first <= limits.reserve - ON_THE_WAY
