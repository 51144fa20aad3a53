"""Approximation: it keeps its tolerance, takes few control points, and says when it cannot."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import BSpline, make_lsq_spline, make_splprep

import nurbs_lab as nl
from nurbs_lab.nurbs._kernels_band import fit_periodic, solve_band
from nurbs_lab.nurbs.knots import spread_knots
from nurbs_lab.tests.nurbs.samples import chord_parameters, trefoil


@given(
    st.integers(1, 7),
    st.booleans(),
    st.floats(1e-6, 1e-1),
    st.sampled_from([1e-6, 1.0, 1e6]),
)
@settings(max_examples=25, deadline=None)
def test_tolerance_is_kept(degree, closed, tolerance, scale):
    points = trefoil(np.linspace(0, 0.9, 500, endpoint=False), scale)
    curve = nl.approximate_curve(points, degree, tolerance=tolerance * scale, closed=closed)
    assert curve.closest_point(points)[1].max() <= tolerance * scale * (1.0 + 1e-9)
    assert len(curve.control_points) <= 500 + closed * degree
    if closed:
        assert curve.closed
        for order in range(degree):
            both = curve.derivative([0.0, 1.0], order)
            assert np.ptp(both, axis=0).max() <= 1e-12 * np.abs(curve.derivatives([0, 0.5], order)).max()
    else:
        assert_allclose(curve([0, 1]), points[[0, -1]], atol=1e-14 * 3 * scale)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_same_knots_give_the_dense_least_squares_of_a_closed_curve(degree):
    rng = np.random.default_rng(degree)
    t, values = np.sort(rng.uniform(0, 1, 40)), rng.normal(size=(40, 2))
    knots = spread_knots(degree, np.append(t, t[0] + 1), 12, True)
    wide = BSpline.design_matrix(t, knots, degree).toarray()
    round_the_seam = wide[:, :12] + np.pad(wide[:, 12:], ((0, 0), (0, 12 - degree)))
    expected = np.linalg.lstsq(round_the_seam, values)[0]
    assert_allclose(fit_periodic(degree, knots, t, values), expected[np.arange(12 + degree) % 12])


def test_smooth_data_need_few_control_points():
    points = trefoil(np.linspace(0, 0.9, 3000))
    counts = [len(nl.approximate_curve(points, 3, tolerance=t).control_points) for t in (1e-2, 1e-4, 1e-6)]
    assert counts == sorted(counts)
    # order 4: a hundredth of the tolerance takes 100**(1/4) = 3.2 times the spans
    assert counts[2] / counts[1] == pytest.approx(100**0.25, rel=0.25)
    straight = np.linspace(0, 1, 50)[:, None] * [1, 2, 3]
    assert len(nl.approximate_curve(straight, 3, tolerance=1e-9).control_points) == 4


def s_bend(count):
    x = np.linspace(-1, 1, count)
    return np.column_stack([x, np.arctan(60 * x) / 5, 0 * x])


def corner(count):
    x = np.linspace(-1, 1, count)
    return np.column_stack([x, np.abs(x), 0 * x])


def spiral(count):
    turn = np.linspace(0, 25, count)
    return np.exp(0.25 * turn)[:, None] / 500 * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])


def fitpack_count(points, tolerance):
    """Fewest control points of SciPy's smoothing spline, its s tuned to the same largest distance."""
    t, low, high, best = chord_parameters(points), 0.0, 4 * len(points) * tolerance**2, len(points)
    for _ in range(20):
        s = 0.5 * (low + high)
        spline = make_splprep(points.T, u=t, s=s)[0]
        curve = nl.NurbsCurve.from_scipy(spline)
        if curve.closest_point(points)[1].max() <= tolerance:
            low, best = s, min(best, len(curve.control_points))
        else:
            high = s
    return best


@pytest.mark.parametrize("shape", [s_bend, corner, spiral])
def test_knots_go_where_the_shape_needs_them(shape):
    points = shape(800)
    curve = nl.approximate_curve(points, 3, tolerance=1e-4)
    count = len(curve.control_points)
    assert curve.closest_point(points)[1].max() <= 1e-4
    assert count < fitpack_count(points, 1e-4)
    t = chord_parameters(points)
    even = make_lsq_spline(t, points, spread_knots(3, t, int(1.4 * count), False), 3)
    assert nl.NurbsCurve.from_scipy(even).closest_point(points)[1].max() > 1e-4


def test_knots_that_the_shape_does_not_need_are_taken_out():
    points = corner(800)  # none of them on the corner: all its knots lie within a few steps
    assert len(nl.approximate_curve(points, tolerance=5e-6).control_points) <= 25
    turn = 2 * np.pi * np.arange(500) / 500
    noise = np.random.default_rng(0).normal(size=(500, 2)) * 1e-3
    ring = np.column_stack([np.cos(turn), np.sin(turn)]) + noise
    ring = nl.approximate_curve(ring, tolerance=3e-3, closed=True)
    assert len(ring.control_points) - 3 < 40


@given(st.integers(0, 10**6), st.integers(1, 9), st.booleans())
@settings(max_examples=25, deadline=None)
def test_any_points_are_approximated(seed, degree, closed):
    """Noise, clusters and corners: crowded knots must leave no control point without data.

    Through very uneven points a curve of high degree has control points so far away that rounding hides the
    distances to it.
    """
    rng = np.random.default_rng(seed)
    walk = rng.normal(size=(int(rng.integers(degree + 1, 120)), 2)) * rng.exponential(1, (1, 2))
    points = np.cumsum(walk * 10.0 ** rng.uniform(-3, 0, (len(walk), 1)), axis=0)
    tolerance = np.ptp(points) * 10 ** rng.uniform(-4, -1)
    curve = nl.approximate_curve(points, degree, tolerance=tolerance, closed=closed)
    far_away = np.abs(curve.control_points).max() > 1e3 * np.ptp(points)
    assert far_away or curve.closest_point(points)[1].max() <= tolerance * (1.0 + 1e-9)


def test_no_step_holds_more_knots_than_interpolation_has_there():
    """All knots wanted in the first three steps of ten, which have room for 4/6 of one each."""
    knots = spread_knots(3, np.linspace(0, 1, 11), 8, False, np.where(np.arange(10) < 3, 1e12, 1.0))
    assert_allclose(knots[4:-4], [0.15, 0.3, 0.3 + 7 / 30, 0.3 + 14 / 30], atol=1e-9)


def test_a_pivot_lost_to_rounding_leaves_its_row_out():
    """Such fits come up in the search for the fewest control points, and are then found to be far off."""
    band, right = np.array([[0, 2.0, 1], [0, 0, 0], [0, 4, 0]]), np.array([[4.0], [1], [1]])
    solve_band(band, 1, right)
    assert right.ravel().tolist() == [2, 0, 0.25]
