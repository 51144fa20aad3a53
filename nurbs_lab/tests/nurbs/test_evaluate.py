"""Points and derivatives against SciPy's polynomial splines, lifted by hand for rational ones."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import BSpline, NdBSpline

import nurbs_lab as nl
from nurbs_lab.tests.nurbs.samples import random_knots, random_surface


@st.composite
def splines(draw, directions):
    """Degrees, knots and a generator for one or two directions."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    degrees = [draw(st.integers(1, 7)) for _ in range(directions)]
    counts = [p + draw(st.integers(1, 8)) for p in degrees]
    return rng, degrees, counts, [random_knots(rng, p, n) for p, n in zip(degrees, counts, strict=True)]


def quotient(lifted, order):
    """First and second derivatives of A / w from those of (A, w), by the quotient rule."""
    a = [x[..., :-1] for x in lifted]
    w = [x[..., -1:] for x in lifted]
    c = [a[0] / w[0]]
    c.append((a[1] - w[1] * c[0]) / w[0])
    c.append((a[2] - 2 * w[1] * c[1] - w[2] * c[0]) / w[0])
    return c[order]


@given(splines(1), st.booleans(), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=60, deadline=None)
def test_curve_equals_scipy(spline, rational, scale):
    rng, (degree,), (count,), (knots,) = spline
    points = rng.normal(size=(count, 3)) * scale
    weights = rng.uniform(0.3, 3.0, count) if rational else np.ones(count)
    curve = nl.NurbsCurve(degree, knots, points, weights)
    u = np.r_[rng.uniform(0, 1, 30), knots[degree : count + 1]]
    u = u[u < 1]
    lifted = BSpline(knots, np.column_stack([points * weights[:, None], weights]), degree)
    values = [lifted(u), *(lifted.derivative(k)(u) if k <= degree else 0 * lifted(u) for k in (1, 2))]
    assert_allclose(curve(u), quotient(values, 0), atol=1e-12 * scale, rtol=0)
    for order in (1, 2):
        expected = quotient(values, order)
        assert_allclose(curve.derivative(u, order), expected, atol=1e-10 * np.abs(expected).max() + 1e-300)


@given(splines(2), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=40, deadline=None)
def test_surface_equals_scipy(spline, scale):
    rng, degrees, counts, knots = spline
    net = rng.normal(size=(*counts, 3)) * scale
    surface = nl.NurbsSurface(degrees, knots, net)
    reference = NdBSpline(tuple(knots), net, degrees)
    u, v = rng.uniform(0, 1, (2, 40))
    at = np.column_stack([u, v])
    assert_allclose(surface(u, v), reference(at), atol=1e-12 * scale, rtol=0)
    for order in [(1, 0), (0, 1), (1, 1), (2, 0), (0, 2)]:
        if order[0] <= degrees[0] and order[1] <= degrees[1]:
            expected = reference(at, nu=order)
            assert_allclose(surface.derivative(u, v, order), expected, atol=1e-10 * np.abs(expected).max())
    assert_allclose(surface.grid(u, v), surface(u[:, None], v), atol=1e-14 * scale, rtol=0)


def test_derivatives_beyond_the_degree_vanish_for_polynomials():
    assert not nl.paper.CURVE.derivative([0.0, 0.3, 1.0], 3).any()


def test_many_points_end_exactly_where_one_point_does():
    curve = nl.NurbsCurve(2, [0, 0, 0, 0.3, 1, 1, 1], [(1, 2), (1.5, 1), (3, 3.1), (7, 2)])
    u = np.linspace(0, 1, 5000)
    assert np.array_equal(curve(u)[[0, -1]], curve.control_points[[0, -1]])
    assert np.array_equal(curve(u)[-1], curve(1.0))


@pytest.mark.parametrize("degrees", [(2, 3), (3, 3), (3, 5), (1, 1)])
@pytest.mark.parametrize("rational", [False, True])
def test_grid_equals_its_points_however_many_and_in_whatever_order(degrees, rational):
    surface = random_surface(4, degrees, rational)
    u = np.array([0.0, 0.3, 1.0])
    even = np.linspace(0, 1, 300)
    for v in (
        even,
        even[::-1],
        np.random.default_rng(1).permutation(even),
        np.repeat(even[::9], 9),
        even[:7],
    ):
        assert_allclose(surface.grid(u, v), surface(u[:, None], v), rtol=0, atol=1e-14)


@pytest.mark.parametrize("degree", [3, 5])
def test_very_many_points_where_the_weight_falls_steeply(degree):
    """There Taylor coefficients of w cancel."""
    weights = np.where(np.arange(degree + 1) > 0, 1e-4, 1e4)
    points = np.random.default_rng(degree).normal(size=(degree + 1, 3))
    curve = nl.NurbsCurve(degree, np.repeat([0, 1], degree + 1), points, weights)
    u = np.linspace(0, 1, 5000)
    rows = BSpline(curve.knots, curve.homogeneous, degree)(u)
    assert_allclose(curve(u), rows[:, :-1] / rows[:, -1:], atol=1e-12)
