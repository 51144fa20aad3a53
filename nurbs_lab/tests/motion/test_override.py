"""Feed override and hold: on the path, within the limits, and as quickly as they allow."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import nurbs_lab as nl
from nurbs_lab.motion import apply_override

PERIOD, SPEED, ACCELERATION = 1e-3, 4.0, 40.0
PLANS = {
    jerk: nl.plan_feed(nl.paper.CURVE, speed=SPEED, acceleration=ACCELERATION, jerk=jerk, period_s=PERIOD)
    for jerk in (None, 800.0)
}


def samples(feed):
    return feed.displacement(PERIOD * np.arange(int(feed.duration / PERIOD) + 1))


@pytest.mark.parametrize("jerk", PLANS)
def test_a_hold_stops_in_the_least_time_and_three_periods(jerk):
    feed = apply_override(PLANS[jerk], [(0.5, 0.0), (1.0, 1.0)])
    stopped = np.flatnonzero(np.diff(samples(feed))[500:] == 0.0)[0] * PERIOD
    least = SPEED / ACCELERATION + (ACCELERATION / jerk if jerk else 0.0)
    assert least - 1e-9 <= stopped <= min(least + 3 * PERIOD, 1.05 * least)
    assert feed.duration - PLANS[jerk].duration == pytest.approx(0.5, abs=2 * PERIOD)  # both ramps are alike


@pytest.mark.parametrize("jerk", PLANS)
def test_a_constant_rate_stretches_time(jerk):
    half = apply_override(PLANS[jerk], 0.5)
    assert half.duration == pytest.approx(2.0 * PLANS[jerk].duration, rel=1e-9)
    t = np.linspace(0.0, half.duration, 1001)
    np.testing.assert_allclose(half.displacement(t), PLANS[jerk].displacement(0.5 * t), atol=1e-12)
    assert apply_override(PLANS[jerk], 1.5) is PLANS[jerk]


ROWS = st.lists(st.tuples(st.floats(0.0, 3.0), st.sampled_from([0.0, 0.1, 0.5, 0.9, 1.0, 2.0])), max_size=6)


@settings(max_examples=40, deadline=None)
@given(ROWS, st.sampled_from(list(PLANS)))
def test_no_limit_is_exceeded_beyond_its_bound(rows, jerk):
    plan = PLANS[jerk]
    rows = sorted({round(t, 3): rate for t, rate in [*rows, (3.5, 1.0)]}.items())
    feed = apply_override(plan, rows)
    s = samples(feed)
    t = np.linspace(0.0, feed.duration, 20_001)
    assert np.diff(s).min() >= -1e-15  # rounding
    assert feed.length == pytest.approx(plan.length, rel=1e-12)
    assert (
        feed.speed(t) <= np.interp(feed.displacement(t), plan.displacement(t), plan.speed(t)) + 0.02
    ).all()
    slow = np.minimum(np.diff(s)[1:], np.diff(s)[:-1]) / PERIOD
    bound = ACCELERATION * (1.0 + 3.0 * ACCELERATION * PERIOD / np.maximum(slow, 1e-3))
    assert (np.abs(np.diff(s, 2)) / PERIOD**2 <= bound + 1e-6).all()
    v = feed.terms[:, 1] + np.diff(feed.times) * (
        2 * feed.terms[:, 2] + 3 * np.diff(feed.times) * feed.terms[:, 3]
    )
    assert np.abs(v[:-1] - feed.terms[1:, 1]).max(initial=0.0) < 1e-9


def test_the_path_is_the_same_at_another_time():
    path = nl.trace(nl.paper.CURVE, PLANS[None], stepper="exact", override=[(0.5, 0.0), (1.0, 1.0)])
    held = np.flatnonzero(np.diff(path.u) == 0.0)
    assert 395 <= len(held) <= 405
    assert (path.arc_fluctuation[held] == 0.0).all()
    np.testing.assert_allclose(path.points, nl.paper.CURVE(path.u), atol=1e-14)
    assert np.abs(path.arc_fluctuation).max() < 1e-9


@pytest.mark.parametrize(
    ("override", "message"),
    [
        (-0.1, "rates from 0"),
        (2.1, "rates from 0"),
        (0.0, "ends with the rate 0"),
        ([(0.0, 1.0), (0.5, 0.0)], "ends with the rate 0"),
        ([(1.0, 0.5), (0.5, 1.0)], "times that increase"),
        ([(1e6, 0.5)], "1e\\+08 periods"),
        ([1.0, 0.5, 1.0], "one rate or rows"),
    ],
)
def test_refusals_name_the_argument(override, message):
    with pytest.raises(ValueError, match=f"override.*{message}"):
        nl.trace(nl.paper.CURVE, PLANS[None], override=override)


def test_a_feed_without_limits_follows_at_once():
    path = nl.trace(
        nl.paper.CURVE, SPEED, stepper="exact", period_s=PERIOD, override=[(0.5, 0.0), (1.0, 1.0)]
    )
    assert np.count_nonzero(np.diff(path.u) == 0.0) == 499
