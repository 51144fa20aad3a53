"""Surfaces from meshes: tubes, tolerance, orders, and the report of what was reached."""

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.mesh import reconstruct, samples
from nurbs_lab.tests.mesh import shapes


@pytest.fixture(scope="module")
def eye():
    return reconstruct(samples.frog_organ("eye_white"), layers=20, tolerance=0.5)


def kinds(result):
    return sorted(junction.kind for junction in result.junctions)


def test_the_contract():
    result = nl.reconstruct(trimesh.creation.icosphere(subdivisions=4, radius=10), layers=12, tolerance=0.05)
    assert len(result.layers) >= 12
    assert all(isinstance(surface, nl.NurbsSurface) for surface in result.surfaces)
    deviation = result.deviation()
    assert deviation.max <= result.tolerance
    assert result.within_tolerance


@pytest.mark.parametrize("tolerance", [1.0, 0.5, 0.25])
def test_the_tolerance_is_kept_on_the_frogs_eye(tolerance):
    mesh = samples.frog_organ("eye_white")
    result = reconstruct(mesh, layers=20, tolerance=tolerance)
    deviation = result.deviation()
    assert deviation.max <= tolerance
    assert deviation.junctions.max <= tolerance
    assert max(tube.fit_error for tube in result.tubes) <= 0.4 * tolerance
    assert deviation.vertices.shape == (len(mesh.vertices),)


def test_the_figures_of_the_deviation_hang_together(eye):
    deviation = eye.deviation()
    values = np.concatenate([deviation.mesh_to_surface.values, deviation.surface_to_mesh.values])
    assert deviation.max == values.max() == deviation.percentile(100)
    assert deviation.samples == len(values)
    assert 0 < deviation.mean < deviation.rms < deviation.percentile(95) < deviation.max
    diagonal = np.linalg.norm(np.ptp(eye.mesh.vertices, axis=0))
    assert deviation.relative == pytest.approx(deviation.max / diagonal)
    assert max(part.max() for part in deviation.tubes) == pytest.approx(deviation.max)
    assert np.array_equal(
        deviation.vertices[~deviation.vertex_at_junction],
        deviation.mesh_to_surface.values[: np.count_nonzero(~deviation.vertex_at_junction)],
    )


def test_the_deviation_agrees_with_a_dense_tessellation(eye):
    """Independent: nearest point of a fine tessellation by VTK, for vertices away from junctions."""
    import pyvista

    blocks = []
    for surface in eye.surfaces:
        (u0, u1), (v0, v1) = surface.domain
        grid = surface.grid(np.linspace(u0, u1, 600), np.linspace(v0, v1, 300))
        blocks.append(pyvista.StructuredGrid(*grid.transpose(2, 0, 1)).extract_surface(algorithm=None))
    fine = pyvista.merge(blocks).extract_surface(algorithm=None).triangulate()
    deviation = eye.deviation()
    chosen = np.flatnonzero(~deviation.vertex_at_junction)[::5]
    _, nearest = fine.find_closest_cell(eye.mesh.vertices[chosen], return_closest_point=True)
    distance = np.linalg.norm(nearest - eye.mesh.vertices[chosen], axis=1)
    assert np.all(deviation.vertices[chosen] >= distance - 0.02)  # never reported too small
    assert np.quantile(deviation.vertices[chosen] - distance, 0.99) < 0.02


def test_every_section_lies_on_its_surface(eye):
    for tube in eye.tubes:
        u = np.linspace(0.0, 1.0, 50)
        for curve, v, contour in zip(tube.curves, tube.parameters, tube.contours, strict=True):
            assert np.allclose(tube.surface(u, v), curve(u), atol=1e-9)
            assert np.allclose(curve(u)[:, 2], contour.height, atol=1e-9)


def test_seams_do_not_twist():
    mesh = trimesh.creation.box((6.0, 4.0, 1.0))
    mesh = mesh.subdivide().subdivide().subdivide()
    turn = mesh.vertices[:, 2] * 0.2  # a slight twist of the body itself
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = mesh.vertices.T
    mesh.vertices = np.column_stack([c * x - s * y, s * x + c * y, z])
    (tube,) = reconstruct(mesh, layers=6, tolerance=0.1, adaptive=False).tubes
    seam = tube.surface(np.zeros(50), np.linspace(0.0, 1.0, 50))
    assert np.linalg.norm(np.ptp(seam, axis=0)[:2]) < 0.8  # of a circumference of 20


@pytest.mark.parametrize(
    ("shape", "tubes", "least_order"),
    [(shapes.ball, 1, 2.0), (shapes.ring, 2, 2.0), (shapes.pillar, 1, None)],
)
def test_smooth_shapes_come_back_with_the_expected_order(shape, tubes, least_order):
    """Even planes: order 2 near a round end, where the meridian between them is sqrt(spacing) long."""
    mesh = shape()
    counts = np.array([5, 7, 10])
    results = [reconstruct(mesh, layers=int(n), tolerance=2e-3, adaptive=False) for n in counts]
    errors = [result.deviation().max for result in results]
    assert all(len(result.tubes) == tubes for result in results)
    if least_order is None:  # straight walls: nothing but the fit of the contours is left
        assert max(errors) <= 2e-3
    else:
        assert np.polyfit(np.log(1 / counts), np.log(errors), 1)[0] > least_order
    flat_ends = [result.deviation().junctions.max for result in results]
    assert np.polyfit(np.log(1 / counts), np.log(flat_ends), 1)[0] == pytest.approx(1.0, abs=0.02)


def test_a_smooth_wall_comes_back_with_order_four():
    """Cubic interpolation across; even counts, so that the waist lies in the middle of a slab each time."""
    counts = np.array([8, 10, 12])
    results = [reconstruct(shapes.vase(), layers=int(n), tolerance=6e-3, adaptive=False) for n in counts]
    errors = [result.deviation().max for result in results]
    assert np.polyfit(np.log(1 / counts), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.4)


def test_a_hole_is_a_tube_of_its_own():
    result = reconstruct(shapes.ring(), layers=10, tolerance=0.02, adaptive=False)
    assert sorted(tube.is_hole for tube in result.tubes) == [False, True]
    assert kinds(result) == ["cap", "cap"]
    assert [len(j.above or j.below) for j in result.junctions] == [2, 2]  # flat rings


def test_branches_start_new_tubes():
    result = reconstruct(shapes.trousers(), layers=24, tolerance=0.1, adaptive=False)
    assert len(result.tubes) == 3
    assert kinds(result) == ["branch", "cap", "cap", "cap"]
    (branch,) = (j for j in result.junctions if j.kind == "branch")
    assert (len(branch.below), len(branch.above)) == (2, 1)


def test_several_bodies():
    one = trimesh.creation.icosphere(subdivisions=3)
    other = one.copy()
    other.apply_translation([5.0, 0.0, 0.5])
    tiny = trimesh.creation.icosphere(subdivisions=1, radius=0.01)
    tiny.apply_translation([10.0, 0.0, 0.03])
    result = reconstruct(
        trimesh.util.concatenate([one, other, tiny]), layers=10, tolerance=0.01, adaptive=False
    )
    assert len(result.tubes) == 2
    assert kinds(result) == ["cap"] * 4 + ["missed"]
    assert result.deviation().junctions.max > 4.0  # the missed body is not hidden


def test_a_thin_ledge_becomes_a_step():
    step = np.array([[0, 0], [3, 0], [3, 2], [1, 2.001], [1, 4], [0, 4]])
    mesh = shapes.lathe(step[:, 0].astype(float), step[:, 1].astype(float), 90)
    result = reconstruct(mesh, layers=10, tolerance=0.05)
    assert "step" in kinds(result)
    assert result.deviation().max <= 0.05
    assert result.deviation().junctions.max <= 0.06


def test_an_open_mesh_gives_open_surfaces():
    wall = shapes.pillar()
    half = trimesh.Trimesh(wall.vertices, wall.faces[wall.triangles_center[:, 0] > 0.01], process=False)
    result = reconstruct(half, layers=8, tolerance=0.02, adaptive=False)
    (tube,) = result.tubes
    assert tube.closed is False
    assert result.deviation().max <= 0.02


def test_another_axis_gives_the_same_surface_turned():
    mesh = samples.nut()
    turned = trimesh.Trimesh(mesh.vertices[:, [1, 2, 0]], mesh.faces, process=False)
    along_x = reconstruct(mesh, layers=9, tolerance=1.0, axis="x", adaptive=False)
    along_z = reconstruct(turned, layers=9, tolerance=1.0, adaptive=False)
    assert along_x.deviation().max == pytest.approx(along_z.deviation().max, rel=1e-9)
    for one, other in zip(along_x.surfaces, along_z.surfaces, strict=True):
        assert np.allclose(one.control_points[..., [1, 2, 0]], other.control_points)


def test_layer_height_and_wrong_arguments():
    ball = trimesh.creation.icosphere()
    assert len(reconstruct(ball, layer_height=0.1, tolerance=0.1, adaptive=False).layers) == 20
    with pytest.raises(TypeError, match="either layers"):
        reconstruct(ball, tolerance=0.1)
    with pytest.raises(TypeError, match="either layers"):
        reconstruct(ball, layers=5, layer_height=0.1, tolerance=0.1)
    with pytest.raises(ValueError, match="layers is 0"):
        reconstruct(ball, layers=0, tolerance=0.1)
    with pytest.raises(ValueError, match="more layers"):
        reconstruct(ball, layers=1, tolerance=0.1)
    with pytest.raises(ValueError, match="tolerance must be positive"):
        reconstruct(ball, layers=5, tolerance=-1)
    with pytest.raises(ValueError, match="layer_height must be positive"):
        reconstruct(ball, layer_height=0, tolerance=1)
    above = ball.copy()
    above.apply_translation([3.0, 0.0, 2.0])
    with pytest.raises(ValueError, match="more layers"):
        reconstruct(trimesh.util.concatenate([ball, above]), layers=2, tolerance=0.1, adaptive=False)
