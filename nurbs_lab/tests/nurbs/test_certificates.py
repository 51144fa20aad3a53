"""Answers carry certificates at all scales: weights 1e8 apart, sizes from 1e-9 to 1e9, far away."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import nurbs_lab as nl
from nurbs_lab.tests.robust.certificates import wrong
from nurbs_lab.tests.robust.hostile import spline

WHOLE = {"u0": None, "u1": None}


@given(st.integers(0, 10**6))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_lengths_lie_between_chords_and_polygon(seed):
    curve = spline(np.random.default_rng(seed), 1)
    gaps = np.diff(np.unique(curve.knots)) / np.ptp(curve.domain)
    assume(gaps.min() > 1e-4)  # parameters in double precision resolve every span
    total = curve.length()
    assert wrong(curve.length, WHOLE, total) == ""


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_distances_are_those_of_the_points_found(seed):
    rng = np.random.default_rng(seed)
    for shape in (spline(rng, 1), spline(rng, 2)):
        vectors = [shape.knots] if isinstance(shape, nl.NurbsCurve) else shape.knots
        counts = [np.unique(k, return_counts=True)[1] for k in vectors]
        assume(all(count[1:-1].max(initial=0) < count[0] - 1 for count in counts))  # the shape has no gaps
        points = shape.control_points.reshape(-1, shape.dim)[:5] + rng.normal(size=shape.dim)
        assert wrong(shape.closest_point, {"points": points}, shape.closest_point(points)) == ""


@pytest.mark.parametrize("stretch", [1e-9, 1e-3, 1.0, 1e3, 1e9])
@pytest.mark.parametrize("size", [1e-100, 1e-9, 1.0, 1e9, 1e90])
def test_normals_are_unit_vectors_whatever_the_sizes_and_ranges(stretch, size):
    ball = nl.nurbs.sphere(size)
    knots = (ball.knots[0] * stretch, ball.knots[1])
    long = nl.NurbsSurface(ball.degrees, knots, ball.control_points, ball.weights)
    u, v = np.linspace(0.0, stretch, 9)[:, None], np.linspace(0.0, 1.0, 9)
    normals = long.normal(u, v)
    assert wrong(long.normal, {}, normals) == ""
    np.testing.assert_allclose(normals, long(u, v) / size, atol=1e-9)
