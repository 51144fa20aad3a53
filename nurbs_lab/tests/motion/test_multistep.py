"""Multistep formulas that end at knots: slope exact or of the history, over time or arc."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion import benchmark_curves

PERCENT = 100.0
#: Speed [mm/s], acceleration [mm/s²] and jerk [mm/s³] that suit the size of each curve.
LIMITS = {
    "paper": (4.0, 40.0, 800.0),
    "butterfly": (50.0, 500.0, 2e4),
    "circle": (2.0, 20.0, 400.0),
    "figure-of-eight": (50.0, 500.0, 5e3),
    "zigzag": (100.0, 1000.0, 2e4),
}


def planned(name, *, jerk=False, period_s=1e-3):
    curve = benchmark_curves()[name].curve
    speed, acceleration, most = LIMITS[name]
    jerk = most if jerk else None
    limits = {"speed": speed, "acceleration": acceleration, "jerk": jerk, "chord_error": 1e-3}
    return curve, nl.plan_feed(curve, period_s=period_s, **limits)


def worst(path):
    return np.abs(path.arc_fluctuation[:-1]).max()


def test_on_the_papers_run_from_rest_no_step_errs_by_a_hundred_thousandth_of_a_percent():
    """Knots, corners of v(t), start and end included; from one C a step, and C' behind knots alone."""
    curve, feed = planned("paper")
    path = nl.trace(curve, feed, stepper="history-arc")
    assert PERCENT * worst(path) <= 1e-5
    assert path.u[-1] == 1.0
    assert path.final_lag == pytest.approx(0.0, abs=1e-8)
    assert abs(path.commanded[-1] - path.moved[-1]) < 1e-8  # the last step ends on the schedule
    points, *derivatives = path.evaluations_by_order
    assert points <= len(path.moved) + 4
    assert derivatives[0] <= 5 * 40  # behind the start and the four knots
    assert derivatives[1:] == [0, 0]


@pytest.mark.parametrize("period_s", [1e-3, 2e-4])
@pytest.mark.parametrize("jerk", [False, True])
@pytest.mark.parametrize("name", LIMITS)
def test_history_over_arc_errs_as_its_series_or_as_rounding(name, jerk, period_s):
    """The series' error is that of the formula with the exact |C'|; of rounding, that of 'exact'."""
    curve, feed = planned(name, jerk=jerk, period_s=period_s)
    exact, series, history = (
        worst(nl.trace(curve, feed, stepper=name)) for name in ("exact", "adams-arc", "history-arc")
    )
    made_good = 2.5e-4 * LIMITS[name][2] * period_s**2 / LIMITS[name][0]  # by a step, at most
    if name != "butterfly":
        assert history <= max(10.0 * exact, 10.0 * series, made_good)
        assert history < 1e-5
    else:
        assert history < 1e-3  # radius 0.024 mm at steps of 0.014 mm, where the exact rule steps in


def test_a_step_of_history_over_arc_needs_one_point_and_on_sharp_curves_a_few_slopes_more():
    curve, feed = planned("butterfly")
    path = nl.trace(curve, feed, stepper="history-arc")
    per_step = path.evaluations_by_order / len(path.moved)
    np.testing.assert_allclose(per_step, [1.0, 1.05, 0.0, 0.0], atol=0.1)


def wild(seed):
    """A rational curve whose weights of 1e-3 to 1e3 turn it within a step, and limits."""
    random = np.random.default_rng(seed)
    points = np.cumsum(3.0 * random.normal(size=(8, 2)) + (3.0, 0.0), axis=0)
    knots = np.r_[np.zeros(4), np.sort(random.uniform(0.05, 0.95, 4)), np.ones(4)]
    curve = nl.NurbsCurve(3, knots, points, 10.0 ** random.uniform(-3.0, 3.0, 8))
    speed = 2.0 * curve.length()
    return curve, nl.Limits(speed, 20.0 * speed, jerk=1e3 * speed, axis_acceleration=15.0 * speed)


@pytest.mark.parametrize("name", ["exact", "adams-arc", "history-arc"])
def test_wild_weights_keep_a_plan_within_its_limits(name):
    """By differences of points; 'adams-arc' took twice the jerk, 'history-arc' 30 times the acceleration."""
    for seed in range(6):
        curve, limits = wild(seed)
        path = nl.trace(curve, nl.plan_feed(curve, limits), stepper=name)
        points, lengths = np.pad(path.points, ((3, 3), (0, 0)), "edge"), np.append(0.0, np.cumsum(path.moved))
        second = np.diff(points, 2, axis=0) / limits.period_s**2
        third = np.diff(np.pad(lengths, 3, "edge"), 3) / limits.period_s**3
        assert np.linalg.norm(second, axis=1).max() <= 1.003 * limits.acceleration
        assert np.abs(second).max() <= 1.003 * limits.axis_acceleration
        assert np.abs(third).max() <= 1.01 * limits.jerk


def test_a_slow_path_around_sharp_turns_keeps_the_acceleration():
    """Its history must be shorter than the turns: nodes 5e-6 of the curve's size apart took 1.16 of it."""
    curve, period_s = nl.motion.benchmark_curves()["butterfly"].curve, 1e-3
    speed = curve.length() / 10.0
    feed = nl.plan_feed(curve, speed=speed, acceleration=speed / 4.0, period_s=period_s)
    steps = np.diff(nl.trace(curve, feed, stepper="history-arc").points, 2, axis=0)
    assert np.linalg.norm(steps, axis=1).max() <= 1.01 * speed / 4.0 * period_s**2


@pytest.mark.parametrize("jerk", [False, True])
@pytest.mark.parametrize("name", [name for name in nl.motion.software_steppers() if name != "rk4-plus"])
def test_a_held_feed_moves_nothing_and_every_stepper_goes_on_after_it(name, jerk):
    curve, feed = planned("paper", jerk=jerk)
    override = [(0.0, 1.0), (0.5, 0.0), (0.9, 1.2), (1.2, 0.3), (1.6, 1.0)]
    path = nl.trace(curve, feed, stepper=name, override=override)
    held = path.commanded == 0.0
    assert held.sum() > 200
    assert path.moved[held].max() == 0.0
    assert path.u[-1] == 1.0
    if name in ("history-arc", "adams-arc"):
        assert PERCENT * worst(path) <= 1e-5  # slowing down, standing and speeding up included
