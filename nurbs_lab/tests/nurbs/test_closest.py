"""Closest points against closed forms and dense samples."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial import cKDTree

import nurbs_lab as nl
from nurbs_lab.nurbs import sphere, torus
from nurbs_lab.tests.nurbs.samples import random_curve, random_surface

U = np.linspace(0, 1, 401)


@given(st.integers(0, 10**6), st.integers(1, 6), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=25, deadline=None)
def test_closest_point_of_a_curve(seed, degree, scale):
    curve = random_curve(seed, degree, scale=scale)
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(40, 3)) * 2 * scale
    u, distance = curve.closest_point(points)
    assert_allclose(np.linalg.norm(curve(u) - points, axis=1), distance, rtol=1e-12, atol=1e-15 * scale)
    sampled = cKDTree(curve(np.linspace(0, 1, 4001))).query(points)[0]
    assert (distance <= sampled + 1e-12 * scale).all()
    slope = ((curve(u) - points) * curve.derivative(u)).sum(axis=1)
    size = np.linalg.norm(curve.derivative(u), axis=1) * distance
    inner = (u > 0) & (u < 1) & ~np.isin(u, curve.knots)
    assert (np.abs(slope) <= 1e-7 * size)[inner].all()
    assert_allclose(curve.closest_point(curve(U))[1], 0, atol=1e-9 * scale)


@given(st.integers(0, 10**6), st.tuples(st.integers(1, 4), st.integers(1, 4)))
@settings(max_examples=15, deadline=None)
def test_closest_point_of_a_surface(seed, degrees):
    surface = random_surface(seed, degrees)
    points = np.random.default_rng(seed).normal(size=(40, 3)) * 2
    uv, distance = surface.closest_point(points)
    assert_allclose(np.linalg.norm(surface(*uv.T) - points, axis=1), distance, rtol=1e-12, atol=1e-14)
    w = np.linspace(0, 1, 201)
    sampled = cKDTree(surface.grid(w, w).reshape(-1, 3)).query(points)[0]
    assert (distance <= sampled + 1e-12).all()


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_closest_points_have_closed_forms(scale):
    points = np.random.default_rng(2).normal(size=(300, 3)) * 3 * scale
    x, y, z = points.T
    ball = sphere(2 * scale)
    assert_allclose(
        ball.closest_point(points)[1], np.abs(np.linalg.norm(points, axis=1) - 2 * scale), atol=1e-9 * scale
    )
    ring = torus(3 * scale, scale)
    expected = np.abs(np.hypot(np.hypot(x, y) - 3 * scale, z) - scale)
    assert_allclose(ring.closest_point(points)[1], expected, atol=1e-9 * scale)
    uv, distance = ring.closest_point([[9 * scale, 0, 0], [0, 9 * scale, 0]])
    assert uv.shape == (2, 2)
    assert_allclose(distance, 5 * scale, rtol=1e-12)


@pytest.mark.parametrize("off", [0.0, 1e-12, 1e-9, 1e-6, 1e-3])
def test_all_points_may_be_nearly_as_near(off):
    """Centres, axes and poles: thousands of valleys within rounding of each other."""
    aside = np.array([off, off / 2, off / 3])
    assert_allclose(sphere(2).closest_point(aside)[1], 2 - np.linalg.norm(aside), rtol=1e-12)
    above = aside + np.array([0, 0, 3])
    assert_allclose(sphere(2).closest_point(above)[1], np.linalg.norm(above) - 2, rtol=1e-12)
    assert_allclose(torus(3, 1).closest_point([off, 0, 0.3])[1], np.hypot(3 - off, 0.3) - 1, rtol=1e-12)
    assert_allclose(torus(3, 1).closest_point([3 + off, 0, 0])[1], 1 - off, rtol=1e-12)


@pytest.mark.parametrize("seed", [165, 199, 428])
def test_narrow_bent_valleys_are_followed_to_their_ends(seed):
    """Weights of 1e-3 to 1e3 make the distance to a corner a valley that no single parameter follows."""
    rng = np.random.default_rng(seed)
    degree = 3 + seed % 3
    knots = [0, 0, 1e-3, 1, 1], [0] * (degree + 1) + [0.3, 0.7] + [1] * (degree + 1)
    weights = 10 ** rng.uniform(-3, 3, (3, degree + 3))
    surface = nl.NurbsSurface((1, degree), knots, rng.normal(size=(3, degree + 3, 3)), weights)
    edges = surface(np.linspace(0, 1, 9)[:, None], [0.0, 1.0])
    assert surface.closest_point(edges)[1].max() < 1e-9
