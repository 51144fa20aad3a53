"""Values are equal by content, stay frozen when copied, move, join, go round, and meet SciPy and PyVista."""

import contextlib
import copy
import pickle
from dataclasses import fields, is_dataclass

import numpy as np
import pytest
import trimesh
from numpy.testing import assert_allclose, assert_array_equal
from scipy.interpolate import make_interp_spline

import nurbs_lab as nl
from nurbs_lab.machining import prepare_part
from nurbs_lab.nurbs import _kernels, arc, circle, sphere, torus
from nurbs_lab.tests.nurbs.samples import random_curve, random_surface

CURVE, SURFACE = random_curve(1, 3), random_surface(2, (3, 2))
TURN = np.linspace(0.0, 2.0 * np.pi, 13)
LOOP = nl.interpolate_curve(np.column_stack([np.cos(TURN), np.sin(2 * TURN)]), closed=True)


@pytest.mark.parametrize("value", [CURVE, SURFACE, LOOP])
@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
def test_a_copy_is_equal_and_frozen_and_needs_no_compilation(value, again):
    middle = (0.5,) * (1 if isinstance(value, nl.NurbsCurve) else 2)
    here = value(*middle)
    compiled = len(_kernels.curve_points.signatures)
    other = again(value)
    assert other == value
    assert hash(other) == hash(value)
    assert not other.control_points.flags.writeable
    assert not other.homogeneous.flags.writeable
    assert_allclose(other(*middle), here, rtol=0)
    assert len(_kernels.curve_points.signatures) == compiled


def results():
    """A contour, a layer, a feed profile, a tool path, a part, a milled block, a verification and a solid."""
    feed = nl.plan_feed(CURVE, speed=4.0, acceleration=40.0, period_s=0.01)
    block = trimesh.creation.box((8.0, 8.0, 4.0))
    layer = nl.slice_mesh(block, [0.1])[0]
    yield from (layer.contours[0], layer, feed, nl.trace(CURVE, feed), prepare_part(block))
    program = nl.finish(block, nl.Cutter("ball", diameter=4.0), scallop=0.5, tolerance=0.1)
    yield from (nl.simulate(program, resolution=0.5), nl.verify(program, block))
    yield nl.reconstruct(block, tolerance=0.1)


def arrays_of(item):
    if isinstance(item, np.ndarray):
        yield item
    elif is_dataclass(item):
        yield from arrays_of([getattr(item, field.name) for field in fields(item)])
    elif isinstance(item, (list, tuple)):
        for part in item:
            yield from arrays_of(part)


def test_results_too_are_equal_by_content_and_frozen_from_the_start():
    for value, same in zip(results(), results(), strict=True):
        other = pickle.loads(pickle.dumps(value))
        for arrays in zip(*map(arrays_of, (value, same, other)), strict=True):
            assert not any(array.flags.writeable for array in arrays)
            assert_array_equal(arrays[0], arrays[1])
            assert_array_equal(arrays[0], arrays[2])
        if not isinstance(value, nl.machining.Simulation):  # its field of heights is no value
            assert value == same == other
            assert hash(value) == hash(same) == hash(other)


def test_the_stock_of_a_program_is_frozen_and_the_callers_stays_his():
    ball, given = trimesh.creation.icosphere(subdivisions=2, radius=4.0), np.array([[-5.0] * 3, [5.0] * 3])
    cutter, fine = nl.Cutter("ball", diameter=4.0), {"scallop": 0.5, "tolerance": 0.1}
    first = nl.finish(ball, cutter, stock=given, **fine)
    assert_array_equal(first.stock, given)
    programs = [first, nl.finish(ball, cutter, **fine)]
    programs += [nl.finish(ball, nl.Cutter("ball", diameter=2.0), scallop=0.1, tolerance=0.05, after=first)]
    programs += [nl.rough(ball, given, nl.Cutter("flat", diameter=3.0), step_down=2.0, stock_to_leave=0.3)]
    for program in programs:
        assert not any(array.flags.writeable for array in arrays_of(program.stock))
    given[0] = -9.0
    assert first.stock[0, 0] == -5.0


def test_closed_curves_and_surfaces_go_round():
    assert_allclose(LOOP(np.array([-0.25, 1.25, 7.5])), LOOP(np.array([0.75, 0.25, 0.5])), atol=1e-14)
    assert_allclose(LOOP.derivative(1.25), LOOP.derivative(0.25), atol=1e-12)
    total = LOOP.length()
    assert LOOP.length(0.75, 1.25) == pytest.approx(LOOP.length(0.75) + LOOP.length(0, 0.25), rel=1e-13)
    assert LOOP.length(0.25, -0.75) == pytest.approx(-total, rel=1e-13)
    ring = torus(3.0, 1.0)
    assert_allclose(ring(1.25, -0.5), ring(0.25, 0.5), atol=1e-14)


def test_scipy_sees_a_closed_curve_as_periodic():
    spline = LOOP.to_scipy()
    u = np.linspace(-1.0, 2.0, 50)
    assert_allclose(spline(u), LOOP(u), atol=1e-13)
    assert nl.NurbsCurve.from_scipy(spline) == LOOP
    around = make_interp_spline(
        TURN, np.column_stack([np.cos(TURN), np.sin(TURN)])[[*range(12), 0]], bc_type="periodic"
    )
    assert_allclose(nl.NurbsCurve.from_scipy(around)(TURN), around(TURN), atol=1e-14)


@pytest.mark.parametrize("size", [1e-150, 1e-9, 1.0, 1e9, 1e90])
def test_the_twisted_cubic_has_its_known_frame(size):
    """(t, t², t³): the frame, curvature and torsion of the textbooks."""
    points = size * np.array([(0, 0, 0), (1 / 3, 0, 0), (2 / 3, 1 / 3, 0), (1, 1, 1)])
    curve, t = nl.NurbsCurve(3, [0] * 4 + [1] * 4, points), np.linspace(0.0, 1.0, 7)
    first = np.stack([0 * t + 1, 2 * t, 3 * t * t], axis=1)
    speed = np.linalg.norm(first, axis=1)
    across = np.stack([6 * t * t, -6 * t, 0 * t + 2], axis=1)
    side = np.linalg.norm(across, axis=1)
    assert_allclose(curve.tangent(t), first / speed[:, None], atol=1e-14)
    assert_allclose(curve.binormal(t), across / side[:, None], atol=1e-14)
    assert_allclose(curve.normal(t), np.cross(across, first) / (side * speed)[:, None], atol=1e-14)
    assert_allclose(curve.curvature(t) * size, side / speed**3, rtol=1e-13)
    assert_allclose(curve.torsion(t) * size, 12 / side**2, rtol=1e-13)


def test_curvatures_and_areas_of_sphere_and_torus():
    ball, ring = sphere(2.0), torus(3.0, 1.0)
    u, v = np.linspace(0.05, 0.95, 9)[:, None], np.linspace(0.1, 0.9, 7)
    assert_allclose(ball.curvature(u, v).gaussian, 0.25, rtol=1e-11)
    assert_allclose(ball.curvature(u, v).principal, -0.5, rtol=1e-5)  # to the root of rounding
    for v_near in 10.0 ** np.arange(-12, -1):  # a pole: right, or refused
        with contextlib.suppress(ValueError):
            assert_allclose(ball.curvature(u, v_near).gaussian, 0.25, rtol=1e-2)
    points = ring(u, v)
    from_axis = np.hypot(points[..., 0], points[..., 1])
    outwards = (from_axis - 3.0) / from_axis
    assert_allclose(ring.curvature(u, v).gaussian, outwards, atol=1e-11)
    assert_allclose(ring.curvature(u, v).mean, -0.5 * (1 + outwards), atol=1e-11)
    assert ball.area == pytest.approx(16 * np.pi, rel=1e-12)
    assert ring.area == pytest.approx(12 * np.pi**2, rel=1e-12)
    assert ring.scale(1e-6).area == pytest.approx(12 * np.pi**2 * 1e-12, rel=1e-12)


@pytest.mark.parametrize("shape", [CURVE, SURFACE])
def test_moves_are_those_of_matrices(shape):
    points = shape.control_points
    assert_allclose(shape.translate((1, 2, 3)).control_points, points + np.array([1, 2, 3]))
    turned = shape.rotate(np.pi / 2, (0, 0, 2), (1, 0, 0))
    x, y, z = np.moveaxis(points, -1, 0)
    assert_allclose(turned.control_points, np.stack([1 - y, x - 1, z], axis=-1), atol=1e-14)
    assert_allclose(shape.scale((1, 2, -3), (0, 1, 0)).control_points[..., 1], 2 * y - 1)
    matrix = np.array([[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 2, 7], [0, 0, 0, 1.0]])
    assert shape.transform(matrix) == shape.transform(matrix[:3, :3], matrix[:3, 3])


def test_joined_arcs_are_one_circle():
    quarters = [arc(2.0, a, a + np.pi / 2) for a in np.arange(4) * np.pi / 2]
    ring = quarters[0].join(*quarters[1:])
    assert ring.domain == (0.0, 4.0)
    assert ring.closed
    assert ring.length() == pytest.approx(4 * np.pi, rel=1e-14)
    line = nl.NurbsCurve(1, [3, 3, 5, 5], [(2, 0, 0), (2, -1, 0)], [4, 4])
    longer = ring.join(line)
    assert_allclose(longer(np.array([3.7, 5.0])), [ring(3.7), (2, -0.5, 0)], atol=1e-14)


def test_pyvista_gets_curves_and_surfaces():
    line = circle(2.0, (0, 0)).to_pyvista()
    assert line.n_cells == 1
    assert_allclose(np.linalg.norm(line.points, axis=1), 2, rtol=1e-6)
    grid = torus().to_pyvista()
    assert grid.dimensions == (25, 25, 1)
    assert_allclose(np.hypot(np.hypot(*grid.points[:, :2].T) - 2, grid.points[:, 2]), 1, atol=1e-6)
    assert SURFACE.to_pyvista().n_points > SURFACE.control_points[..., 0].size
