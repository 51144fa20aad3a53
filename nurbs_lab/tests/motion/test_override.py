"""Feed override and hold: on the path, within the limits, and as quickly as they allow."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion import apply_override
from nurbs_lab.tests.motion.least_stop import least_periods

PERIOD, SPEED, ACCELERATION = 1e-3, 4.0, 40.0
PLANS = {
    jerk: nl.plan_feed(
        nl.paper.CURVE,
        speed=SPEED,
        acceleration=ACCELERATION,
        jerk=jerk,
        period_s=PERIOD,
        tangential_only=True,
    )
    for jerk in (None, 800.0)
}


def samples(feed):
    return feed.displacement(PERIOD * np.arange(int(feed.duration / PERIOD) + 1))


@pytest.mark.parametrize("jerk", PLANS)
def test_a_hold_stops_in_the_least_time(jerk):
    feed = apply_override(PLANS[jerk], [(0.5, 0.0), (1.0, 1.0)])
    stopped = np.flatnonzero(np.diff(samples(feed))[500:] == 0.0)[0]
    least = SPEED / ACCELERATION + (ACCELERATION / jerk if jerk else 0.0)
    assert round(least / PERIOD) <= stopped <= round(least / PERIOD) + 1
    assert feed.duration - PLANS[jerk].duration == pytest.approx(0.5, abs=2 * PERIOD)  # both ramps are alike


@pytest.mark.parametrize("jerk", PLANS)
def test_a_constant_rate_stretches_time(jerk):
    half = apply_override(PLANS[jerk], 0.5)
    assert half.duration == pytest.approx(2.0 * PLANS[jerk].duration, rel=1e-9)
    t = np.linspace(0.0, half.duration, 1001)
    np.testing.assert_allclose(half.displacement(t), PLANS[jerk].displacement(0.5 * t), atol=1e-12)
    assert apply_override(PLANS[jerk], 1.5) is PLANS[jerk]


@pytest.mark.parametrize("jerk", PLANS)
def test_a_plan_at_twice_the_programmed_feed_runs_at_200_percent(jerk):
    programmed = 0.5 * SPEED
    feed = apply_override(PLANS[jerk], [(0.0, 0.5), (0.7, 1.0), (1.2, 0.25)])
    for time, percent in ((0.6, 100.0), (1.1, 200.0), (1.6, 50.0)):
        assert feed.speed(time) == pytest.approx(programmed * percent / 100.0, rel=5e-4)  # whole periods


@pytest.mark.parametrize("jerk", [None, 8000.0])
def test_ten_thousand_random_commands_keep_the_limits_and_stop_in_the_least_time(jerk):
    limit, rng = 400.0, np.random.default_rng(18)
    curve = nl.motion.benchmark_curves()["butterfly"].curve
    plan = nl.plan_feed(curve, speed=40.0, acceleration=limit, jerk=jerk, chord_error=1e-4, period_s=PERIOD)
    commands, stops, jumping = 0, 0, [0.0]
    while commands < 10_000:
        times = PERIOD * np.unique(rng.integers(0, int(2.0 * plan.duration / PERIOD), 100))
        rates = rng.choice([0.0, 0.0, 0.0, 0.1, 0.3, 0.5, 0.9, 1.0, 1.0, 1.0, 2.0], len(times))
        commands += len(times)
        feed = apply_override(plan, np.column_stack([[*times, times[-1] + 0.5], [*rates, 1.0]]))
        assert feed.length == pytest.approx(plan.length, rel=1e-12)
        s = samples(feed)
        tau = plan.time_at(s)
        planned, v = plan.speed(tau), feed.speed(PERIOD * np.arange(len(s)))
        assert (v <= planned * (1.0 + 1e-6) + 1e-6).all()
        assert np.diff(s).max() <= 40.0 * PERIOD * (1.0 + 1e-9)
        rate = np.divide(v, planned, out=np.ones_like(v), where=planned > 1e-6)
        slow = np.maximum(np.minimum(planned[2:], planned[:-2]), 1e-9)
        bound = limit * (1.0 + limit * PERIOD / slow) if jerk else 2.0 * limit
        assert (np.abs(np.diff(s, 2)) / PERIOD**2 <= bound + 1e-5).all()
        if jerk:
            goal = np.append(1.0, rates)[np.searchsorted(times, PERIOD * (np.arange(len(s)) + 1e-9), "right")]
            arrived = np.abs([rate - np.minimum(goal, 1.0), rate, rate - 1.0]).min(axis=0) < 1e-9
            jerks = np.abs(np.diff(v, 2)) / PERIOD**2
            assert (jerks <= 2.0 * limit * (1.0 + limit * PERIOD / slow) / PERIOD).all()
            jumps = np.flatnonzero(jerks > 1.001 * (2.0 * jerk + 2.0 * limit**2 / slow))
            assert arrived[jumps[:, None] + np.arange(4)].any(axis=1).all()
            jumping.append(len(jumps) / len(s))
        starts = np.flatnonzero((rates == 0.0) & (np.append(1.0, rates[:-1]) > 0.0))
        for row in starts[:-1]:
            after = row + np.flatnonzero(rates[row:] > 0.0)
            first, last = np.rint(
                np.array([times[row], times[after[0] if len(after) else -1]]) / PERIOD
            ).astype(int)
            rest = np.flatnonzero(v[first : last + 1] == 0.0)
            if first < 2 or last >= len(v) - 2 or v[first] < 1e-6 or not len(rest):
                continue
            if np.ptp(rate[first - 2 : first + 1]) > 1e-9:  # tests/hardware stops in the middle of a change
                continue
            stops += 1
            beta = jerk * PERIOD**2 if jerk else np.inf
            assert rest[0] <= 1.05 * least_periods(v[first], v[first - 1] - v[first], limit * PERIOD, beta)
    assert stops > 500
    assert np.mean(jumping) < 3e-4  # of the periods, and only where the rate arrives


@pytest.mark.parametrize("stepper", ["exact", "adams", "history-arc", "taylor2"])
@pytest.mark.parametrize("jerk", PLANS)
def test_an_abort_ends_at_rest_on_the_path(stepper, jerk):
    curve, plan = nl.paper.CURVE, PLANS[jerk]
    path = nl.trace(curve, plan, stepper=stepper, override=[(0.5, 0.0)])
    resumed = nl.trace(curve, plan, stepper=stepper, override=[(0.5, 0.0), (0.9, 1.0)])
    assert path.feed.rests
    assert (
        path.feed.duration <= 0.5 + SPEED / ACCELERATION + (ACCELERATION / jerk if jerk else 0.0) + 3 * PERIOD
    )
    np.testing.assert_allclose(path.u[:-1], resumed.u[: len(path.u) - 1], atol=1e-14)
    np.testing.assert_array_equal(path.points, curve(path.u))
    assert path.u[-1] == pytest.approx(curve.parameter_at(path.feed.length), rel=1e-9)


def test_the_path_is_the_same_at_another_time():
    path = nl.trace(nl.paper.CURVE, PLANS[None], stepper="exact", override=[(0.5, 0.0), (1.0, 1.0)])
    held = np.flatnonzero(np.diff(path.u) == 0.0)
    assert 395 <= len(held) <= 405
    assert (path.arc_fluctuation[held] == 0.0).all()
    np.testing.assert_allclose(path.points, nl.paper.CURVE(path.u), atol=1e-14)
    assert np.abs(path.arc_fluctuation).max() < 1e-9


def test_a_feed_without_limits_follows_at_once():
    path = nl.trace(
        nl.paper.CURVE, SPEED, stepper="exact", period_s=PERIOD, override=[(0.5, 0.0), (1.0, 1.0)]
    )
    assert np.count_nonzero(np.diff(path.u) == 0.0) == 499
