"""What holds for every stepper on any curve, and the closed forms that a few curves have."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import gamma

import nurbs_lab as nl
from nurbs_lab.motion import benchmark_curves
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.steppers.registry import find_stepper

NAMES = list(nl.motion.software_steppers())
#: Eq. (20) with minus signs divides 0 by 0 wherever |C'| is level; with plus signs it is unstable.
SOUND = [name for name in NAMES if name not in ("rk4-minus", "rk4-plus")]


@st.composite
def curves(draw):
    """Any degree, plane or not, rational or not, clamped or not, knots of any multiplicity; x rises, so there
    is no cusp."""
    degree, dim = draw(st.integers(1, 5)), draw(st.integers(2, 3))
    inner = draw(st.lists(st.tuples(st.floats(0.05, 0.95), st.integers(1, degree)), max_size=4))
    places = {round(place, 2): times for place, times in inner}
    end = draw(st.sampled_from([0.0, 0.1])) * np.arange(degree + 1)
    knots = [*-end[::-1], *(p for p in sorted(places) for _ in range(places[p])), *(1.0 + end)]
    count = len(knots) - degree - 1
    within = st.floats(0.0, 0.6).map(lambda value: round(value, 3))
    points = [[k + draw(within), *(3 * draw(within) for _ in range(dim - 1))] for k in range(count)]
    weights = [draw(st.floats(0.3, 3.0)) for _ in range(count)] if draw(st.booleans()) else None
    return nl.NurbsCurve(degree, knots, points, weights)


def may_leap(name, curve):
    """Whether a stepper may refuse a plan on a curve: a rule over u(t), where |C'| rises steeply."""
    slopes = np.linalg.norm(curve.derivatives(np.linspace(*curve.domain, 999), 1)[1], axis=1)
    return find_stepper(name).order is not None and slopes.max() > 3.0 * slopes.min()


@pytest.mark.parametrize("name", SOUND)
@settings(max_examples=12, deadline=None)
@given(curves(), st.integers(30, 300), st.sampled_from([None, {}, {"jerk": 99.0}]))
def test_a_path_rises_strictly_from_start_to_end_on_its_curve(name, curve, steps, limits):
    """At one speed, on a trapezoid and on an S-curve."""
    length = prepare(curve).length
    feed = length
    if limits is not None:
        limits = {"speed": length, "acceleration": 8 * length, **{k: v * length for k, v in limits.items()}}
        feed = nl.plan_feed(curve, **limits, period_s=1 / steps)
    try:
        path = nl.trace(curve, feed, stepper=name, period_s=1 / steps)
    except ValueError as error:
        if "leaps" in str(error) and limits is not None and may_leap(name, curve):
            return
        raise
    assert (np.diff(path.u) > 0.0).all()
    assert (path.u[0], path.u[-1]) == curve.domain
    np.testing.assert_array_equal(path.points, curve(path.u))
    assert path.moved.sum() == pytest.approx(length, rel=1e-12)
    assert len(path.t) == len(path.u) == len(path) == len(path.arc_fluctuation) + 1
    assert np.isfinite(path.chord_error).all()


@settings(max_examples=30, deadline=None)
@given(curves(), st.sampled_from(SOUND), st.integers(-20, 20))
def test_a_curve_as_large_again_at_a_speed_as_high_again_takes_the_same_u(curve, name, power):
    """By powers of two, which round nothing: not a bit may differ."""
    factor, speed = 2.0**power, prepare(curve).length
    larger = nl.NurbsCurve(curve.degree, curve.knots, factor * curve.control_points, curve.weights)
    here = nl.trace(curve, speed, stepper=name, period_s=0.01)
    there = nl.trace(larger, factor * speed, stepper=name, period_s=0.01)
    np.testing.assert_array_equal(here.u, there.u)


@settings(max_examples=30, deadline=None)
@given(curves(), st.integers(3, 300))
def test_exact_moves_what_is_commanded(curve, steps):
    path = nl.trace(curve, prepare(curve).length * 0.999, stepper="exact", period_s=1 / steps)
    assert np.abs(path.arc_fluctuation).max() < 1e-10


@pytest.mark.parametrize("steps", [7, 50, 1000])
def test_exact_on_a_line_run_through_ever_faster(steps):
    """Closed form: s = 1000 u / (1 + 999 u). Newton alone goes to and fro where s(u) is curved so."""
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (1, 0)], [1, 1000])
    path = nl.trace(line, 0.9999, stepper="exact", period_s=1 / steps)
    s = 0.9999 * path.t[:-1]
    np.testing.assert_allclose(path.u[:-1], s / (1000.0 - 999.0 * s), rtol=1e-11, atol=1e-15)


def test_exact_needs_few_trials_where_it_runs_ever_faster_and_then_slower():
    """Newton's method alone takes 26 here: it leaves the bracket, and comes back from far."""
    curve = nl.NurbsCurve(
        2, [0, 0, 0, 1, 1, 1], [(0.935, 0.04), (1.27, -0.387), (2.483, 0.207)], [179, 0.0166, 175]
    )
    path = nl.trace(curve, curve.length(), stepper="exact", period_s=1 / 2.3)
    assert path.evaluations <= 14 * 9
    assert np.abs(path.arc_fluctuation).max() < 1e-14


def test_the_figure_of_eight_is_the_lemniscate():
    curve, a = benchmark_curves()["figure-of-eight"].curve, 25.0
    u = np.linspace(*curve.domain, 1001)
    x, y = curve(u).T
    square = x * x + y * y
    np.testing.assert_allclose(square**2, a**2 * (x * x - y * y), atol=1e-14 * a**4)
    np.testing.assert_allclose(np.abs(curve.curvature(u)), 3.0 * np.sqrt(square) / a**2, atol=1e-14)
    assert curve.length() == pytest.approx(a * gamma(0.25) ** 2 / np.sqrt(2.0 * np.pi), rel=1e-14)
    assert curve.closed


@pytest.mark.parametrize("name", SOUND)
def test_a_step_may_span_several_knots(name):
    turn = np.linspace(0.0, 1.5, 61)
    curve = nl.interpolate_curve(np.column_stack([np.cos(turn), np.sin(turn)]), degree=2)
    path = nl.trace(curve, 1.0, stepper=name, period_s=0.11)
    assert len(path.moved) in (13, 14, 15)
    assert (np.diff(path.u) > 0.0).all()
    assert np.abs(path.arc_fluctuation[1:-1]).max() < 0.05
