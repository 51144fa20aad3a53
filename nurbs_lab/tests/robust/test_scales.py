"""From micrometres taken as metres to kilometres: lengths times a power of two change no bit of a result."""

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls import BALL, CURVE, GRID, KNOTS, LIMITS, LINE, SURFACE, WEIGHTS

SCALES = [2.0**-20, 2.0**20]


@pytest.fixture(params=SCALES, ids=["1e-6", "1e+6"])
def scale(request):
    return request.param


def scaled_curve(scale):
    return nl.NurbsCurve(3, KNOTS, scale * LINE, WEIGHTS)


def scaled_ball(scale):
    return trimesh.Trimesh(scale * BALL.vertices, BALL.faces, process=False)


def test_curves(scale):
    curve = scaled_curve(scale)
    u = np.linspace(0, 1, 50)
    np.testing.assert_array_equal(curve(u), scale * CURVE(u))
    np.testing.assert_array_equal(curve.curvature(u), CURVE.curvature(u) / scale)
    assert curve.length() == scale * CURVE.length()
    assert curve.closed == CURVE.closed
    assert curve.parameter_at(scale * 2.0) == CURVE.parameter_at(2.0)
    away = LINE + np.array([0.5, -0.25, 1.0])
    u, distance = curve.closest_point(scale * away)
    np.testing.assert_allclose((u, distance / scale), CURVE.closest_point(away), rtol=1e-12)


@pytest.mark.parametrize("closed", [False, True])
def test_fits(scale, closed):
    there_and_back = np.concatenate([LINE, LINE[::-1] + np.array([0, 5, 0])])
    for one, other in (
        [nl.interpolate_curve(k * LINE, closed=closed) for k in (1, scale)],
        [nl.approximate_curve(k * there_and_back, closed=closed, tolerance=0.25 * k) for k in (1, scale)],
    ):
        np.testing.assert_array_equal(other.knots, one.knots)
        np.testing.assert_array_equal(other.control_points, scale * one.control_points)


def test_surfaces(scale):
    np.testing.assert_array_equal(
        nl.interpolate_surface(scale * GRID).control_points, scale * SURFACE.control_points
    )
    sections = [LINE, LINE + 1, LINE + 3, LINE + 4]
    skin, larger = nl.skin(sections), nl.skin([scale * section for section in sections])
    np.testing.assert_array_equal(larger.control_points, scale * skin.control_points)


def test_slices(scale):
    heights = np.array([-1.5, 0.0, 2.0])
    for layer, larger in zip(
        nl.slice_mesh(BALL, heights), nl.slice_mesh(scaled_ball(scale), scale * heights), strict=True
    ):
        (contour,), (other,) = layer.contours, larger.contours
        np.testing.assert_array_equal(other.points, scale * contour.points)
        np.testing.assert_array_equal(other.triangles, contour.triangles)
        assert other.area == scale**2 * contour.area


def test_reconstruction(scale):
    one = nl.reconstruct(BALL, tolerance=0.5, faces="patches")
    other = nl.reconstruct(scaled_ball(scale), tolerance=0.5 * scale, faces="patches")
    for a, b in zip(one.surfaces, other.surfaces, strict=True):
        np.testing.assert_array_equal(b.control_points, scale * a.control_points)
    exact = nl.reconstruct(scaled_ball(scale), tolerance=0.5 * scale)
    assert exact.within_tolerance
    assert exact.volume == pytest.approx(scale**3 * one.volume, rel=0.05)


@pytest.mark.parametrize("jerk", [None, 4000.0])
def test_feeds_and_paths(scale, jerk):
    feeds = [
        nl.plan_feed(
            scaled_curve(k),
            speed=4.0 * k,
            acceleration=40.0 * k,
            jerk=jerk and jerk * k,
            chord_error=1e-3 * k,
            centripetal_acceleration=30.0 * k,
            axis_speed=3.0 * k,
            period_s=LIMITS["period_s"],
        )
        for k in (1.0, scale)
    ]
    assert feeds[1].duration == pytest.approx(feeds[0].duration, rel=1e-9)
    one, other = (nl.trace(scaled_curve(k), feed) for k, feed in zip((1.0, scale), feeds, strict=True))
    np.testing.assert_allclose(other.u, one.u, rtol=0, atol=1e-9)
