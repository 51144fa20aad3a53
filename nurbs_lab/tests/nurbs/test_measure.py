"""Lengths, curvatures and boxes against closed forms and brute force."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

import nurbs_lab as nl
from nurbs_lab.nurbs import arc, circle, cylinder, sphere, torus
from nurbs_lab.tests.nurbs.samples import random_curve, random_surface

U = np.linspace(0, 1, 401)


@pytest.mark.parametrize("radius", [1e-6, 1.0, 2.5e6])
def test_circle_is_exact(radius):
    ring = circle(radius, (1 * radius, 2 * radius, 0), normal=(1, 1, 1))
    points = (ring(U) - [radius, 2 * radius, 0]) / radius
    assert_allclose(np.linalg.norm(points, axis=1), 1, atol=1e-14)
    assert_allclose(points @ [1, 1, 1], 0, atol=1e-14)
    assert ring.length() == pytest.approx(2 * np.pi * radius, rel=1e-13)
    assert_allclose(ring.curvature(U) * radius, 1, rtol=1e-12)
    assert ring.closed
    assert_allclose(np.linalg.norm(circle(3, (0, 0))(U), axis=1), 3, rtol=1e-14)


@pytest.mark.parametrize("turn", [0.1, 1.5, 2.0, 4.0, 6.2])
def test_arc_has_its_length_and_ends(turn):
    part = arc(2.0, 0.3, 0.3 + turn)
    assert part.length() == pytest.approx(2 * turn, rel=1e-13)
    assert_allclose(
        part([0, 1]), 2 * np.array([[np.cos(a), np.sin(a), 0] for a in (0.3, 0.3 + turn)]), atol=1e-14
    )


@given(st.integers(0, 10**6), st.integers(1, 6))
@settings(max_examples=25, deadline=None)
def test_length_equals_quadrature_and_is_inverted(seed, degree):
    curve = random_curve(seed, degree)
    breaks = np.unique(curve.knots)
    expected = sum(
        quad(lambda u: np.linalg.norm(curve.derivative(u)), a, b, limit=200, epsabs=1e-13, epsrel=1e-13)[0]
        for a, b in pairwise(breaks)
    )
    total = curve.length()
    assert total == pytest.approx(expected, rel=1e-11)
    assert curve.length(0.7, 0.2) == pytest.approx(-curve.length(0.2, 0.7), rel=1e-14)
    wanted = np.linspace(0, total, 9)
    found = curve.parameter_at(wanted)
    assert found[0] == 0
    assert found[-1] == 1
    assert_allclose([curve.length(0, u) for u in found], wanted, atol=2e-13 * total)


@pytest.mark.parametrize("weight", [1e3, 1e-3])
def test_parameters_on_a_line_that_is_run_through_ever_faster_or_slower(weight):
    """x = w u / (1 - u + w u): Newton's method alone would leave the span."""
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (1, 0)], [1, weight])
    lengths = np.linspace(0.0, 1.0, 21)
    expected = lengths / (weight - (weight - 1) * lengths)
    assert_allclose(line.parameter_at(lengths), expected, rtol=1e-11)
    assert line.length() == pytest.approx(1.0, rel=1e-14)


@pytest.mark.parametrize("turn", [1e-2, 1e-3, 1e-4, 3e-6, 1e-8])
def test_length_of_a_curve_that_reverses_near_an_end(turn):
    """x = (u - turn)² goes there and back: no Gauss point of the whole span lies before the turn."""
    there = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(turn**2, 0), (turn**2 - turn, 0), ((1 - turn) ** 2, 0)])
    for curve in (there, there.reverse()):
        assert curve.length() == pytest.approx(turn**2 + (1 - turn) ** 2, rel=1e-12)


def test_length_with_knots_close_together_and_weights_far_apart():
    """Straight legs whatever the weights; the middle of a panel must not be rounded as a parameter."""
    points = np.array([(0, 0), (1, 0), (1, 1e5), (7, 1e5)])
    curve = nl.NurbsCurve(1, [0, 0, 0.2658, 0.2658 + 1e-8, 10, 10], points, [1, 1e-2, 1e3, 1])
    assert curve.length() == pytest.approx(np.abs(np.diff(points, axis=0)).sum(), rel=1e-13)


def test_where_double_precision_cannot_do_it_the_knots_are_named():
    """Most of the length lies between two knots that only a few thousand parameters separate."""
    curve = nl.NurbsCurve(1, [0, 0, 1, 1 + 1e-12, 2, 2], [(0, 0), (1, 0), (9, 0), (10, 0)])
    assert curve.length() == pytest.approx(10.0, rel=1e-14)
    with pytest.raises(ValueError, match=r"has no parameter in double precision: the knots near u = 1"):
        curve.parameter_at(np.linspace(1.5, 8.5, 50))


def test_length_through_a_cusp():
    cusp = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), (1, 1), (0, 1), (1, 0)])
    assert cusp.length() == pytest.approx(2 * np.sqrt(2) - 1, rel=1e-13)
    with pytest.raises(ValueError, match="curvature has no value at u"):
        cusp.curvature(0.5)


def test_surfaces_of_revolution_are_exact_and_have_normals():
    u, v = U[:, None], U[None]
    ball, ring, tube = sphere(2.0), torus(3, 1), cylinder(1.5, 4)
    assert_allclose(np.linalg.norm(ball.grid(U, U), axis=-1), 2, atol=1e-14)
    points = ring.grid(U, U)
    assert_allclose(np.hypot(np.hypot(points[..., 0], points[..., 1]) - 3, points[..., 2]), 1, atol=1e-14)
    assert_allclose(np.hypot(*np.moveaxis(tube.grid(U, U)[..., :2], -1, 0)), 1.5, atol=1e-14)
    assert ball.closed == (True, False)
    assert ring.closed == (True, True)
    assert_allclose(ball.normal(u, v), ball(u, v) / 2, atol=1e-9)  # the poles included
    assert_allclose(np.linalg.norm(ring.normal(u, v), axis=-1), 1, rtol=1e-14)


def test_boxes_hold_the_points_tightly():
    low, high = circle(2, (1, 1)).bounding_box()
    assert_allclose([low, high], [[-1, -1], [3, 3]], atol=1e-12)
    curve, surface = random_curve(8, 4), random_surface(9, (3, 2))
    low, high = curve.bounding_box()
    dense = curve(np.linspace(0, 1, 20001))
    assert_allclose([low, high], [dense.min(axis=0), dense.max(axis=0)], atol=1e-5)
    low, high = surface.bounding_box()
    points = surface.grid(U, U).reshape(-1, 3)
    assert (low <= points.min(axis=0)).all()
    assert (points.max(axis=0) <= high).all()


@pytest.mark.parametrize("tolerance", [0.3, 0.03, 0.003])
def test_triangles_lie_within_the_tolerance_and_no_closer_than_needed(tolerance):
    """Measured on a torus, where the distance of a point to the surface is known."""
    points, triangles = torus(3, 1).tessellate(tolerance)
    shares = np.random.default_rng(1).dirichlet((1, 1, 1), 40)
    inside = (shares @ points[triangles]).reshape(-1, 3)
    off = np.abs(np.hypot(np.hypot(*inside[:, :2].T) - 3, inside[:, 2]) - 1)
    assert tolerance / 8 < off.max() < tolerance


def test_a_rational_curve_of_one_point_has_no_length():
    """All it has to agree to is rounding."""
    point = nl.NurbsCurve(1, [100, 100, 100.1, 100.1], [(0.416, -0.371, 0.538)] * 2, [2.83, 0.056])
    assert point.length() == pytest.approx(0.0, abs=1e-13)
    assert 100.0 <= point.parameter_at(0.0) <= 100.1


def test_boxes_hold_sharp_peaks():
    for seed in (35, 63, 71):
        rng = np.random.default_rng(seed)
        weights = 10 ** rng.uniform(-4.4, 4.4, 6)
        curve = nl.NurbsCurve(5, np.repeat([0, 1], 6), rng.normal(size=(6, 2)), weights)
        low, high = curve.bounding_box()
        near_zero = np.geomspace(1e-9, 0.5, 5000)
        points = curve(np.concatenate([[0], near_zero, 1 - near_zero, [1]]))
        assert (low - 1e-12 <= points.min(axis=0)).all()
        assert (points.max(axis=0) <= high + 1e-12).all()
        assert_allclose([low, high], [points.min(axis=0), points.max(axis=0)], atol=0.02)
