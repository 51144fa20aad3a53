"""Lengths, curvatures and boxes against closed forms and brute force."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import BPoly

import nurbs_lab as nl
from nurbs_lab.nurbs import circle, cylinder, sphere, torus
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


def test_length_with_knots_close_together_and_weights_far_apart():
    """Straight legs whatever the weights; the middle of a panel must not be rounded as a parameter."""
    points = np.array([(0, 0), (1, 0), (1, 1e5), (7, 1e5)])
    curve = nl.NurbsCurve(1, [0, 0, 0.2658, 0.2658 + 1e-8, 10, 10], points, [1, 1e-2, 1e3, 1])
    assert curve.length() == pytest.approx(np.abs(np.diff(points, axis=0)).sum(), rel=1e-13)


def test_length_through_a_cusp():
    cusp = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), (1, 1), (0, 1), (1, 0)])
    assert cusp.length() == pytest.approx(2 * np.sqrt(2) - 1, rel=1e-13)
    with pytest.raises(ValueError, match="curvature has no value at u"):
        cusp.curvature(0.5)


def test_length_of_curves_that_turn_back_on_themselves():
    """Cubics on a line, x' = (u - a) (u - b): their length is the sum of the ways between the turns."""
    places = np.random.default_rng(3).uniform(0.0, 1.0, (200, 2))
    places[:20, 0] = 10.0 ** -np.arange(1.0, 11.0).repeat(2)  # next to an end
    for a, b in places:
        turns = np.array([0.0, min(a, b), max(a, b), 1.0])
        way = np.diff(turns**3 / 3 - (a + b) * turns**2 / 2 + a * b * turns)
        x = np.cumsum([0.0, a * b, (2 * a * b - a - b) / 2, (1 - a) * (1 - b)]) / 3
        back = nl.NurbsCurve(3, [0] * 4 + [1] * 4, np.outer(x, (2, 3, 6)) / 7)
        assert back.length() == pytest.approx(np.abs(way).sum(), rel=1e-12)


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


def test_boxes_of_control_points_hold_the_shapes():
    for shape, points in (
        (circle(2, (1, 1)), circle(2, (1, 1))(U)),
        (random_curve(8, 4), random_curve(8, 4)(np.linspace(0, 1, 20001))),
        (random_surface(9, (3, 2)), random_surface(9, (3, 2)).grid(U, U).reshape(-1, 3)),
    ):
        box = shape.control_points.reshape(-1, shape.dim)
        assert (box.min(axis=0) <= points.min(axis=0)).all()
        assert (points.max(axis=0) <= box.max(axis=0)).all()


@pytest.mark.parametrize("tolerance", [0.3, 0.03, 0.003])
def test_triangles_lie_within_the_tolerance_and_no_closer_than_needed(tolerance):
    """Measured on a torus, where the distance of a point to the surface is known."""
    points, triangles = torus(3, 1).tessellate(tolerance)
    shares = np.random.default_rng(1).dirichlet((1, 1, 1), 40)
    inside = (shares @ points[triangles]).reshape(-1, 3)
    off = np.abs(np.hypot(np.hypot(*inside[:, :2].T) - 3, inside[:, 2]) - 1)
    assert tolerance / 8 < off.max() < tolerance


@pytest.mark.parametrize("across", [1, 3])
@pytest.mark.parametrize("heights", [(10, -10), (10, -10, 10, -10), (3, -7, 0, 7, -3), (9, 1, -1, -9)])
def test_triangles_follow_an_s_through_the_middles(heights, across):
    """Against Bernstein polynomials: the middle of an S lies on its chord, and so do those of waves."""
    z = np.r_[0, heights, 0.0]
    degree = len(z) - 1
    net = np.zeros((degree + 1, across + 1, 3))
    net[..., 0] = np.linspace(0, 30, degree + 1)[:, None]
    net[..., 1] = np.linspace(0, 20, across + 1)
    net[..., 2] = z[:, None]
    knots = [np.repeat([0, 1], p + 1) for p in (degree, across)]
    points, _ = nl.NurbsSurface((degree, across), knots, net).tessellate(0.05)
    sides = points[points[:, 1] == 0]
    exact = BPoly(z[:, None], [0, 30])(x := np.linspace(0, 30, 1001))
    assert np.abs(np.interp(x, *sides[:, [0, 2]].T) - exact).max() <= 0.05
