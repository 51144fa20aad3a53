"""The family of twelve: slope exact, quotient or history, over time or arc, knots ignored or cut."""

import itertools

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion import benchmark_curves
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.steppers.multistep import KNOTS, OVER, SLOPES

PERCENT = 100.0
#: Speed [mm/s], acceleration [mm/s²] and jerk [mm/s³] that suit the size of each curve.
LIMITS = {
    "paper": (4.0, 40.0, 800.0),
    "butterfly": (50.0, 500.0, 2e4),
    "circle": (2.0, 20.0, 400.0),
    "figure-of-eight": (50.0, 500.0, 5e3),
    "zigzag": (100.0, 1000.0, 2e4),
}
FAMILY = list(itertools.product(SLOPES, OVER, KNOTS))


def planned(name, *, jerk=False, period_s=1e-3):
    curve = benchmark_curves()[name].curve
    speed, acceleration, most = LIMITS[name]
    jerk = most if jerk else None
    limits = {"speed": speed, "acceleration": acceleration, "jerk": jerk, "chord_error": 1e-3}
    return curve, nl.plan_feed(curve, period_s=period_s, **limits)


def worst(path):
    return np.abs(path.arc_fluctuation).max()


def test_on_the_papers_run_from_rest_no_step_errs_by_a_hundred_thousandth_of_a_percent():
    """Knots, corners of v(t), start and end included; from one C a step and derivatives at knots alone."""
    curve, feed = planned("paper")
    path = nl.trace(curve, feed, stepper="history-arc")
    assert PERCENT * worst(path) <= 1e-5
    assert path.u[-1] == 1.0
    assert path.final_lag == pytest.approx(0.0, abs=1e-8)
    points, *derivatives = path.evaluations_by_order
    assert points <= len(path.moved) + 4
    assert derivatives == [5, 5, 5]  # at the start and at the four knots


@pytest.mark.parametrize("period_s", [1e-3, 2e-4])
@pytest.mark.parametrize("jerk", [False, True])
@pytest.mark.parametrize("name", LIMITS)
def test_history_over_arc_errs_as_its_series_or_as_rounding(name, jerk, period_s):
    """The series' error is that of the formula with the exact |C'|; of rounding, that of 'exact'."""
    curve, feed = planned(name, jerk=jerk, period_s=period_s)
    exact, series, history = (
        worst(nl.trace(curve, feed, stepper=name)) for name in ("exact", "adams-arc", "history-arc")
    )
    assert history <= 10.0 * max(exact, series)
    if name != "butterfly":
        assert history < 1e-5
    else:
        assert history < 6e-3  # radius 0.024 mm at steps of 0.014 mm, where the exact rule steps in


def test_a_step_of_history_over_arc_needs_one_point_and_on_sharp_curves_a_few_slopes_more():
    curve, feed = planned("butterfly")
    path = nl.trace(curve, feed, stepper="history-arc")
    per_step = path.evaluations_by_order / len(path.moved)
    np.testing.assert_allclose(per_step, [1.0, 0.3, 0.0, 0.0], atol=0.05)


@pytest.mark.parametrize(("slope", "name"), [("exact", "adams"), ("quotient", "adams-quotient")])
def test_over_time_across_knots_the_family_is_the_printed_formula(slope, name):
    """The start differs; once under way the steps are those of Eq. (15) and Eq. (17)."""
    ours = nl.trace(
        nl.paper.CURVE, 4.0, stepper="multistep", slope=slope, over="time", knots="ignored", period_s=1e-3
    )
    u = ours.u[:-1]
    if slope == "exact":
        speeds = np.linalg.norm(nl.paper.CURVE.derivative(u), axis=1)
    else:
        speeds = np.linalg.norm(np.diff(ours.points[:-1], axis=0), axis=1) / np.diff(u)
    expected = 1e-3 / 24.0 * np.convolve(4.0 / speeds, [55, -59, 37, -9], "valid")
    found = np.diff(u)[-len(expected) + 1 :]
    np.testing.assert_allclose(found, expected[:-1], rtol=1e-11)
    assert worst(ours) == pytest.approx(
        worst(nl.trace(nl.paper.CURVE, 4.0, stepper=name, period_s=1e-3)), 0.01
    )


@pytest.mark.parametrize(("slope", "over", "knots"), FAMILY)
def test_the_order_is_that_of_the_slope(slope, over, knots):
    """One smooth span at constant speed: neither the knots nor the variable play a part."""
    smooth = nl.NurbsCurve(3, [0, 0, 0, 0, 1, 1, 1, 1], [(0, 0), (1, 1), (3, 2), (6, 2)])
    length, counts, errors = prepare(smooth).length, np.array([160, 320, 640]), []
    options = {"slope": slope, "over": over, "knots": knots}
    for count in counts:
        path = nl.trace(smooth, length, stepper="multistep", period_s=1.0 / count, **options)
        errors.append(abs(path.lag[3 * count // 4]))
    order = np.polyfit(np.log(1.0 / counts), np.log(errors), 1)[0]
    assert order == pytest.approx(1 if slope == "quotient" else 4, abs=0.15)


def test_on_the_papers_run_each_of_the_three_choices_tells():
    """Largest error in percent: of the slope where speed and |C'| change, at corners of v(t), at knots."""
    curve, feed = planned("paper")
    errors = {
        choice: PERCENT
        * worst(
            nl.trace(
                curve, feed, stepper="multistep", **dict(zip(("slope", "over", "knots"), choice, strict=True))
            )
        )
        for choice in FAMILY
    }
    assert all(0.2 < errors[choice] < 1.0 for choice in FAMILY if choice[0] == "quotient")
    assert all(errors[slope, "time", knots] > 0.5 for slope in ("exact", "history") for knots in KNOTS)
    assert all(errors[slope, "arc", "ignored"] > 0.1 for slope in ("exact", "history"))
    assert all(errors[slope, "arc", "cut"] <= 1e-5 for slope in ("exact", "history"))


@pytest.mark.parametrize("seed", range(6))
def test_the_family_passes_any_knots_from_rest_to_rest(seed):
    random = np.random.default_rng(seed)
    count = 12
    inner = np.sort(random.uniform(0.05, 0.95, count - 4))
    inner[1], inner[4] = inner[0] + 1e-9, inner[5]
    knots = np.r_[[0.0] * 4, np.sort(inner), [1.0] * 4]
    points = np.cumsum(random.normal(size=(count, 3)), axis=0) + 3.0 * np.arange(count)[:, None]
    curve = nl.NurbsCurve(3, knots, points, np.exp(0.3 * random.normal(size=count)))
    length = curve.length()
    feed = nl.plan_feed(curve, speed=length, acceleration=8 * length, jerk=99 * length, period_s=1e-3)
    path = nl.trace(curve, feed, stepper="history-arc")
    assert PERCENT * worst(path) < 1.0
    assert path.u[-1] == 1.0


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
    if name in ("history-arc", "adams-arc", "multistep"):
        assert PERCENT * worst(path) <= 1e-5  # slowing down, standing and speeding up included
