"""Insertion, elevation, splitting and the rest leave every point where it was."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import BSpline, NdBSpline, make_interp_spline

import nurbs_lab as nl
from nurbs_lab.tests.nurbs.samples import random_curve, random_surface

U = np.linspace(0, 1, 201)
seeds, scales = st.integers(0, 10**6), st.sampled_from([1e-6, 1.0, 1e6])


@given(seeds, st.integers(1, 7), st.booleans(), scales)
@settings(max_examples=40, deadline=None)
def test_curve_keeps_its_shape(seed, degree, rational, scale):
    curve = random_curve(seed, degree, rational, scale)
    points = curve(U)
    changed = [
        curve.insert_knot(0.41, degree),
        curve.refine([0.2, 0.41, 0.77]),
        curve.elevate_degree(),
        curve.elevate_degree(2),
        curve.clamped(),
    ]
    for other in changed:
        assert_allclose(other(U), points, atol=1e-13 * 5 * scale, rtol=0)
    assert_allclose(curve.reverse()(1 - U), points, atol=1e-12 * scale, rtol=0)
    left, right = curve.split(0.41)
    assert left.domain == (0, 0.41)
    assert right.domain == (0.41, 1)
    assert_allclose(left(U[U <= 0.41]), points[U <= 0.41], atol=1e-13 * 5 * scale, rtol=0)
    assert_allclose(right(U[U > 0.41]), points[U > 0.41], atol=1e-13 * 5 * scale, rtol=0)
    for piece in curve.beziers():
        at = np.linspace(*piece.domain, 7)
        assert len(piece.control_points) == degree + 1
        assert_allclose(piece(at), curve(at), atol=1e-13 * 5 * scale, rtol=0)


@pytest.mark.parametrize("degree", range(1, 8))
def test_removal_undoes_insertion_and_refuses_to_change_the_shape(degree):
    curve = random_curve(degree, degree)
    back = curve.insert_knot(0.37).remove_knot(0.37, 1e-9)
    assert_allclose(back.knots, curve.knots, rtol=0)
    assert_allclose(back(U), curve(U), atol=1e-10)
    corner = nl.NurbsCurve(1, [0, 0, 0.5, 1, 1], [(0, 0), (1, 1), (2, 0)])
    with pytest.raises(ValueError, match="could move points by 1"):
        corner.remove_knot(0.5, 0.9)
    assert_allclose(corner.remove_knot(0.5, 1.0)(0.5), (1, 0), atol=1e-15)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_closed_fits_can_be_changed_too(degree):
    turn = 2 * np.pi * np.arange(20) / 20
    ring = np.column_stack([np.cos(turn), np.sin(turn), np.sin(3 * turn)])
    curve = nl.interpolate_curve(ring, degree, closed=True)
    for other in (curve.insert_knot(0.01), curve.elevate_degree(), curve.clamped()):
        assert other.domain == curve.domain
        assert_allclose(other(U), curve(U), atol=1e-13)
    assert_allclose(curve.clamped().control_points[[0, -1]], ring[[0, 0]], atol=1e-13)
    assert_allclose(curve.reverse()(1 - U), curve(U), atol=1e-13)


def test_knots_at_the_ends_of_an_unclamped_domain():
    """By hand: the last two points of the quadratic over the knots 0 ... 6 become the means of three."""
    curve = nl.NurbsCurve(2, np.arange(7.0), [(1, 0), (2, 1), (3, 0), (4, 2)])
    last, first = curve.insert_knot(4.0), curve.insert_knot(2.0)
    assert_allclose(last.control_points, [(1, 0), (2, 1), (3, 0), (3.5, 1), (4, 2)])
    assert_allclose(first.control_points, [(1, 0), (1.5, 0.5), (2, 1), (3, 0), (4, 2)])
    for other in (first, last):
        assert other.domain == (2.0, 4.0)
        assert_allclose(other(2 + 2 * U), curve(2 + 2 * U), atol=1e-15)


@given(seeds, st.tuples(st.integers(1, 5), st.integers(1, 5)), st.booleans(), scales)
@settings(max_examples=20, deadline=None)
def test_surface_keeps_its_shape_in_each_direction(seed, degrees, rational, scale):
    surface = random_surface(seed, degrees, rational, scale)
    w = np.linspace(0, 1, 23)
    points = surface.grid(w, w)
    atol = 1e-13 * 5 * scale
    for direction in "uv":
        inserted = surface.insert_knot(0.41, direction=direction)
        for other in (
            inserted,
            surface.refine([0.2, 0.7], direction=direction),
            surface.elevate_degree(direction=direction),
        ):
            assert_allclose(other.grid(w, w), points, atol=atol, rtol=0)
        restored = inserted.remove_knot(0.41, 1e-9 * scale, direction=direction)
        assert restored.control_points.shape == surface.control_points.shape
        turned = surface.reverse(direction=direction).grid(w, w)
        assert_allclose(turned[::-1] if direction == "u" else turned[:, ::-1], points, atol=10 * atol, rtol=0)
        left, right = surface.split(0.41, direction=direction)
        for part in (left, right):
            at = [np.linspace(*span, 9) for span in part.domain]
            assert_allclose(part.grid(*at), surface.grid(*at), atol=atol, rtol=0)
    assert_allclose(surface.iso_curve(u=0.3)(w), surface(0.3, w), atol=atol, rtol=0)
    assert_allclose(surface.iso_curve(v=1.0)(w), surface(w, 1.0), atol=atol, rtol=0)


def test_affine_maps_commute_with_evaluation():
    matrix, offset = np.array([[1, 2, 0], [0, 1, -1], [3, 0, 1.0]]), np.array([5, 6, 7.0])
    curve, surface = random_curve(3, 3), random_surface(4, (2, 3))
    assert_allclose(curve.transform(matrix, offset)(U), curve(U) @ matrix.T + offset, atol=1e-13)
    moved = surface.transform(matrix, offset)
    assert_allclose(moved(U, 0.3), surface(U, 0.3) @ matrix.T + offset, atol=1e-13)
    assert curve.transform(np.eye(3)[:2]).dim == 2


def test_conversion_to_and_from_scipy():
    curve = random_curve(5, 4, rational=False)
    spline = curve.to_scipy()
    assert isinstance(spline, BSpline)
    assert_allclose(spline(U), curve(U), atol=1e-14)
    assert_allclose(nl.NurbsCurve.from_scipy(spline)(U), curve(U), rtol=0)
    t = np.linspace(0, 1, 12)
    ring = make_interp_spline(
        t, np.column_stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)]), bc_type=None
    )
    assert_allclose(nl.NurbsCurve.from_scipy(ring)(U), ring(U), atol=1e-14)
    surface = random_surface(6, (2, 4), rational=False)
    spline = surface.to_scipy()
    assert isinstance(spline, NdBSpline)
    assert_allclose(nl.NurbsSurface.from_scipy(spline)(U, 0.3), surface(U, 0.3), rtol=0)
