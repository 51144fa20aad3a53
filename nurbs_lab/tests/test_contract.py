"""The public face as users call it: every name, argument and shape that the README's readers rely on."""

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl


@pytest.fixture(scope="module")
def ball():
    return trimesh.creation.icosphere(subdivisions=3, radius=10.0)


@pytest.fixture(scope="module")
def sheet():
    x, y = np.meshgrid(np.linspace(0, 3, 7), np.linspace(0, 2, 5), indexing="ij")
    return nl.interpolate_surface(np.stack([x, y, np.sin(x) * np.cos(y)], axis=-1), (3, 2))


def test_curve_answers_scalars_arrays_and_lists():
    curve = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0), (1, 2), (2, 0)])
    assert curve(0.5).shape == (2,)
    assert curve([0.0, 0.5]).shape == curve(np.array([0.0, 0.5])).shape == (2, 2)
    assert curve(np.zeros((3, 4))).shape == (3, 4, 2)
    assert curve([]).shape == (0, 2)
    assert curve.derivative(0.5).shape == curve.derivative(0.5, order=2).shape == (2,)
    assert np.allclose(curve.derivative(0.5, 2), (0, -8))
    assert np.shape(curve.curvature([0.1, 0.2])) == (2,)
    assert tuple(curve.domain) == (0, 1)
    assert not curve.closed
    assert curve.length() == pytest.approx(curve.length(0, 0.3) + curve.length(0.3, 1))
    assert curve.length(0, curve.parameter_at(1.0)) == pytest.approx(1.0, abs=1e-12)
    u, distance = curve.closest_point([(1, 1), (0, 0)])
    assert u.shape == distance.shape == (2,)
    assert np.allclose(distance, 0, atol=1e-12)


def test_surface_answers_points_grids_and_derivatives(sheet):
    assert sheet(0.5, 0.5).shape == (3,)
    assert sheet([0.1, 0.2], 0.5).shape == sheet.derivative([0.1, 0.2], 0.5, (1, 1)).shape == (2, 3)
    assert sheet.grid(np.linspace(0, 1, 4), np.linspace(0, 1, 6)).shape == (4, 6, 3)
    assert np.allclose(sheet.grid([0.2], [0.7])[0, 0], sheet(0.2, 0.7))
    assert sheet.derivative(0.2, 0.7, order=(1, 0)).shape == (3,)
    assert np.linalg.norm(sheet.normal(0.2, 0.7)) == pytest.approx(1.0)
    uv, distance = sheet.closest_point(sheet.grid([0.2, 0.4], [0.3]).reshape(-1, 3))
    assert uv.shape == (2, 2)
    assert np.allclose(uv, [(0.2, 0.3), (0.4, 0.3)], atol=1e-8)
    assert np.allclose(distance, 0, atol=1e-9)
    again = nl.NurbsSurface(sheet.degrees, sheet.knots, sheet.control_points, weights=None)
    assert np.allclose(again(0.2, 0.7), sheet(0.2, 0.7))
    assert sheet.to_pyvista().n_points > 0


def test_slices_and_skin(ball):
    layers = nl.slice_mesh(ball, np.linspace(-8, 8, 9))
    assert [layer.height for layer in layers] == list(np.linspace(-8, 8, 9))
    (contour,) = layers[4].contours
    assert contour.points.shape[1] == 2
    assert contour.closed
    assert not contour.is_hole
    assert len(contour.triangles) == len(contour.points)
    surface = nl.skin([layer.contours[0] for layer in layers], degrees=(3, 3), samples=32)
    assert np.linalg.norm(surface(0.3, 0.5)) == pytest.approx(10, rel=0.02)


def test_motion():
    curve = nl.paper.CURVE
    feed = nl.plan_feed(
        curve,
        speed=4,
        acceleration=40,
        jerk=None,
        chord_error=1e-3,
        period_s=1e-3,
        start_speed=0,
        end_speed=0,
    )
    path = nl.trace(curve, feed)
    assert path.stepper == "adams"
    n = len(path.t)
    assert path.u.shape == (n,)
    assert path.points.shape == (n, 2)
    for values in (path.arc_fluctuation, path.chord_fluctuation, path.chord_error):
        assert values.shape == (n - 1,)
    assert np.array_equal(path.points[-1], curve(1.0))
    assert {"taylor1", "taylor2", "rk4", "adams", "paper", "history", "exact", "rtl"} <= set(nl.STEPPERS)
