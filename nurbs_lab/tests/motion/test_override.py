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
def test_thousands_of_random_commands_keep_the_limits_and_stop_in_the_least_time(jerk):
    limit, rng, stops = 400.0, np.random.default_rng(18), 0
    curve = nl.motion.benchmark_curves()["butterfly"].curve
    given = {"speed": 40.0, "acceleration": limit, "jerk": jerk, "chord_error": 1e-4, "period_s": PERIOD}
    plan = nl.plan_feed(curve, **given, tangential_only=True)
    for _ in range(25):
        times = PERIOD * np.unique(rng.integers(0, int(2.0 * plan.duration / PERIOD), 100))
        rates = rng.choice([0.0, 0.0, 0.0, 0.1, 0.3, 0.5, 0.9, 1.0, 1.0, 1.0, 2.0], len(times))
        feed = apply_override(plan, np.column_stack([[*times, times[-1] + 0.5], [*rates, 1.0]]))
        assert feed.length == pytest.approx(plan.length, rel=1e-12)
        _, h, s, v, a, j = feed.segments.T
        last = s + h * (v + h * (a / 2 + h * j / 6)), v + h * (a + h * j / 2), a + h * j
        # speeds are met to a part in 1e9 of the highest, accelerations to one in 1e6 of the limit
        # at the last bits of the length, where rounding of it decides on the acceleration, to one in 1e4
        last_bits = np.where(plan.length - s[1:] < 4.0 * np.spacing(plan.length), 100.0, 1.0)
        for ends, starts, most in zip(last, (s, v, a), (1e-11, 4e-8, 4e-4 if jerk else 800.0), strict=True):
            assert (np.abs(ends[:-1] - starts[1:]) <= most * last_bits).all()
        assert max(np.abs(a).max(), np.abs(last[2]).max()) <= limit * (1.0 + 1e-5)
        assert jerk is None or np.abs(j).max() <= jerk * (1.0 + 1e-9)
        assert (v <= plan.speed(plan.time_at(s)) + 1e-7).all()
        for row in np.flatnonzero((rates == 0.0) & (np.append(1.0, rates[:-1]) > 0.0)):
            after = times[row:][rates[row:] > 0.0]
            before, state = feed.speed(times[row] - PERIOD), feed.speed(times[row])
            if state < 1e-3 or not len(after) or abs(feed.jerk(times[row] - 0.5 * PERIOD)) > 1e-2:
                continue
            beta = jerk * PERIOD**2 if jerk else np.inf
            least = least_periods(state, before - state, limit * PERIOD, beta)
            if after[0] - times[row] > (least + 2) * PERIOD:
                stops += 1
                assert feed.speed(times[row] + (least + 1) * PERIOD) <= 1e-6
    assert stops > 50


def used(curve, feed, limits, dt):
    """Largest parts of the limits that differences of positions take."""
    t = np.arange(0.0, feed.duration + dt, dt)
    s = feed.displacement(np.minimum(t, feed.duration))
    points = curve(curve.parameter_at(np.clip(s, 0.0, curve.length())))
    points = np.vstack([points[:1]] * 3 + [points] + [points[-1:]] * 3)
    second, third = (np.diff(points, k, axis=0) / dt**k for k in (2, 3))
    measured = {"acceleration": np.linalg.norm(second, axis=1), "axis_acceleration": second}
    measured |= {"axis_jerk": third, "jerk": np.diff(s, 3) / dt**3}
    return {name: np.abs(one).max() / limits[name] for name, one in measured.items() if name in limits}


@pytest.mark.parametrize("rows", [(), ("axis_acceleration",), ("jerk",), ("axis_acceleration", "axis_jerk")])
@pytest.mark.parametrize("shape", ["spline", "corners"])
def test_an_override_keeps_every_limit_of_the_plan_between_periods(shape, rows):
    rng = np.random.default_rng(len(rows))
    points = np.cumsum(rng.normal(size=(8, 2 + len(rows) % 2)) * 4.0, axis=0)
    curve = nl.interpolate_curve(points, 3 if shape == "spline" else 1)
    limits = {"speed": 60.0, "acceleration": 600.0, "period_s": PERIOD} | {
        name: 12000.0 if "jerk" in name else 480.0 for name in rows
    }
    plan = nl.plan_feed(curve, **limits)
    for count in (2, 8, 30):
        times = np.sort(rng.uniform(0.0, 1.3 * plan.duration, count)) + PERIOD * np.arange(count)
        rates = np.append(rng.choice([0.0, 0.0, 0.3, 0.6, 0.9, 1.0], count - 1), 1.0)
        feed = apply_override(plan, np.column_stack([times, rates]))
        assert feed.length == pytest.approx(plan.length, rel=1e-9)
        # corners take their part of an acceleration within a period
        parts = used(curve, feed, limits, PERIOD / 4 if shape == "spline" else PERIOD)
        assert max(parts.values()) <= 1.005, parts


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


ARCH = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), (3, 8), (8, -4), (10, 3)], [1, 1.3, 0.8, 1])
LINE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (50, 0)])


@pytest.mark.parametrize(
    ("curve", "hold"), [(ARCH, (1.14, 1.889)), (LINE, (3.301, 3.685)), (LINE, (1.881, 2.577))]
)
def test_every_stepper_comes_out_of_a_hold(curve, hold):
    """Neither the last bits of lengths nor steps of 1e-15 mm matter."""
    plan = nl.plan_feed(curve, speed=10.0, acceleration=100.0, period_s=PERIOD)
    for name in {*nl.motion.software_steppers()} - {"rk4-plus", "rk4-minus"}:
        path = nl.trace(curve, plan, stepper=name, override=[(hold[0], 0.0), (hold[1], 1.0)])
        assert path.feed.rests
        assert path.moved.max() <= 1.02 * 10.0 * PERIOD, name
        assert path.t[-1] == pytest.approx(path.feed.duration, abs=5 * PERIOD), name


@pytest.mark.parametrize("before_s", [0.12, 0.02, 0.002])
def test_an_abort_while_the_plan_brakes_ends_where_the_feed_does(before_s):
    """The last 10 µm of ten metres are left, and no step leaps over them."""
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (1e4, 0)])
    plan = nl.plan_feed(line, speed=500.0, acceleration=2000.0, jerk=2e4, period_s=1e-3)
    path = nl.trace(line, plan, stepper="exact", override=[(plan.duration - before_s, 0.0)])
    assert path.points[-1, 0] == pytest.approx(path.feed.length, abs=1e-11)
    assert path.feed.length < plan.length
    np.testing.assert_allclose(path.moved, path.commanded, atol=1e-11)


def test_a_feed_without_limits_follows_at_once():
    path = nl.trace(
        nl.paper.CURVE, SPEED, stepper="exact", period_s=PERIOD, override=[(0.5, 0.0), (1.0, 1.0)]
    )
    assert np.count_nonzero(np.diff(path.u) == 0.0) == 500


def test_a_portion_is_a_motion_where_rounding_makes_two_times_one():
    last = 13.0 + 2.0**-49
    feed = nl.motion.FeedProfile(
        [0.0, 13.0, last, 14.0], [[s, 1.0, 0.0, 0.0] for s in (0.0, 13.0, last)], 1e-3
    )
    part = feed.portion(4.0 + 2.0**-50, 14.0)
    assert len(part.terms) == 2
    assert part.length == part.duration
