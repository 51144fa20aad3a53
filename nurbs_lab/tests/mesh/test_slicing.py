"""Contours against closed forms, an independent count and trimesh."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import nurbs_lab as nl
from nurbs_lab.mesh import samples, slice_mesh
from nurbs_lab.tests.mesh.oracle import count_contours, inner_heights, polygon_area, same_layers


def two_tori():
    ring = trimesh.creation.torus(2.0, 0.5, major_sections=24, minor_sections=16)
    upright = ring.copy()
    upright.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [1, 0, 0]))
    upright.apply_translation([6.0, 0.0, 0.0])
    return trimesh.util.concatenate([ring, upright])


@pytest.mark.parametrize(("subdivisions", "tolerance"), [(3, 0.02), (5, 0.0012)])
def test_areas_of_a_sphere(subdivisions, tolerance):
    sphere = trimesh.creation.icosphere(subdivisions=subdivisions)
    for layer in slice_mesh(sphere, [-0.9, -0.2, 0.0, 0.6]):
        assert layer.area == pytest.approx(np.pi * (1 - layer.height**2), abs=np.pi * tolerance)


def test_areas_of_a_torus_with_its_hole():
    ring = trimesh.creation.torus(2.0, 0.5, major_sections=400, minor_sections=200)
    for layer in slice_mesh(ring, [-0.4, 0.1, 0.3]):
        outline, hole = layer.contours
        assert (outline.is_hole, hole.is_hole, hole.parent) == (False, True, 0)
        assert outline.area > 0 > hole.area
        assert layer.area == pytest.approx(8 * np.pi * np.sqrt(0.25 - layer.height**2), rel=1e-3)


def test_areas_of_a_cone_and_a_cube_are_exact():
    cone = trimesh.creation.cone(radius=1.0, height=2.0, sections=16)
    base = 16 / 2 * np.sin(2 * np.pi / 16)
    for layer in slice_mesh(cone, [0.5, 1.0, 1.9]):
        assert layer.area == pytest.approx(base * (1 - layer.height / 2) ** 2, rel=1e-12)
    assert [layer.area for layer in slice_mesh(trimesh.creation.box(), [-0.3, 0.1])] == [1.0, 1.0]


def test_volume_by_layers_converges_with_order_two():
    mesh = trimesh.creation.icosphere(subdivisions=5)
    counts = np.array([10, 20, 40, 80])
    errors = [
        abs(sum(layer.area for layer in slice_mesh(mesh, inner_heights(mesh, n))) * 2 / n - mesh.volume)
        for n in counts
    ]
    slope = np.polyfit(np.log(1 / counts), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.2)


def test_contours_agree_with_the_segments_of_trimesh():
    mesh = two_tori()
    for layer in slice_mesh(mesh, inner_heights(mesh, 16)):
        segments = trimesh.intersections.mesh_plane(mesh, [0, 0, 1], [0, 0, layer.height])
        assert sum(len(c.points) for c in layer.contours) == len(segments)
        length = np.linalg.norm(np.diff(segments, axis=1), axis=2).sum()
        assert sum(c.length for c in layer.contours) == pytest.approx(length, rel=1e-12)
        assert len(layer.contours) == count_contours(mesh, layer.height)
        for contour in layer.contours:
            assert contour.area == pytest.approx(polygon_area(contour.points), rel=1e-12)


def test_an_unknown_organ_is_named_with_the_known_ones():
    with pytest.raises(ValueError, match=r"'wing' is no organ.*14 spleen"):
        samples.frog_organ("wing")


def test_triangles_carry_their_segments():
    mesh = two_tori()
    for contour in slice_mesh(mesh, 0.2)[0].contours:
        ends = np.roll(contour.points_3d, -1, axis=0)
        for points in (contour.points_3d, ends):
            corners = trimesh.triangles.points_to_barycentric(mesh.triangles[contour.triangles], points)
            assert corners.min() > -1e-9


def test_material_is_on_the_left():
    mesh = two_tori()
    for contour in slice_mesh(mesh, [0.1, 1.0])[0].contours:
        outward = mesh.face_normals[contour.triangles][:, :2]
        step = np.roll(contour.points, -1, axis=0) - contour.points
        assert np.all(step[:, 1] * outward[:, 0] - step[:, 0] * outward[:, 1] > 0)


@pytest.mark.parametrize(("axis", "columns"), [("x", [1, 2]), ("y", [2, 0]), ("z", [0, 1])])
def test_any_axis(axis, columns):
    mesh = samples.nut()
    number = "xyz".index(axis)
    height = mesh.bounds[:, number].mean() + 0.1
    layer = slice_mesh(mesh, [height], axis=axis)[0]
    assert len(layer.contours) == count_contours(mesh, height, number)
    for contour in layer.contours:
        assert np.allclose(contour.points_3d[:, number], height)
        assert np.array_equal(contour.points_3d[:, columns], contour.points)


def test_a_slanted_axis_equals_a_turned_mesh():
    mesh = two_tori()
    axis = np.array([0.3, -0.5, 0.8])
    turned = mesh.copy()
    turned.apply_transform(trimesh.geometry.align_vectors(axis, [0, 0, 1]))
    for one, other in zip(
        slice_mesh(mesh, [0.1, 0.9], axis=axis), slice_mesh(turned, [0.1, 0.9]), strict=True
    ):
        assert one.area == pytest.approx(other.area, rel=1e-9)
        assert np.allclose(one.contours[0].points_3d @ axis / np.linalg.norm(axis), one.height)


def test_heights_in_any_order_and_number():
    mesh = trimesh.creation.icosphere()
    given = [0.5, -0.25, 0.5, 7.0]
    assert [layer.height for layer in slice_mesh(mesh, given)] == given
    assert slice_mesh(mesh, 0.5)[0].area == slice_mesh(mesh, given)[2].area
    assert slice_mesh(mesh, []) == []
    assert slice_mesh(mesh, 7.0)[0].contours == ()


def test_uneven_heights_find_the_same_contours_as_one_at_a_time():
    mesh = two_tori()
    heights = np.concatenate([np.linspace(-2, 2, 9), 0.3 + np.geomspace(1e-9, 1e-2, 30), [-1e6, 1e6]])
    single = [slice_mesh(mesh, h)[0] for h in heights]
    assert same_layers(slice_mesh(mesh, heights), single)


def test_nesting_of_hollow_balls():
    balls = [trimesh.creation.icosphere(subdivisions=3, radius=r) for r in (4.0, 3.0, 2.0, 1.0)]
    balls[1].invert()
    balls[3].invert()
    island = trimesh.creation.icosphere(subdivisions=2, radius=0.5)
    island.apply_translation([10.0, 0.0, 0.0])
    contours = slice_mesh(trimesh.util.concatenate([*balls, island]), 0.01)[0].contours
    assert [c.depth for c in contours] == [0, 1, 2, 3, 0]
    assert [c.parent for c in contours] == [-1, 0, 1, 2, -1]
    assert [c.is_hole for c in contours] == [False, True, False, True, False]


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), shape=st.integers(0, 3))
def test_the_order_of_triangles_and_corners_does_not_matter(seed, shape):
    rng = np.random.default_rng(seed)
    mesh = [two_tori, trimesh.creation.box, samples.ant, trimesh.creation.icosphere][shape]()
    turn = (np.arange(3) + rng.integers(0, 3, (len(mesh.faces), 1))) % 3
    faces = rng.permutation(np.take_along_axis(mesh.faces, turn, axis=1))
    shuffled = trimesh.Trimesh(mesh.vertices, faces, process=False)
    heights = [*inner_heights(mesh, 5), 0.0, rng.choice(mesh.vertices)[2]]
    assert same_layers(slice_mesh(mesh, heights), slice_mesh(shuffled, heights))


@pytest.mark.parametrize("place", [(100, 0, 0), (0, 100, 0), (-70, 30, 0)])
def test_holes_are_found_wherever_the_part_lies(place):
    boxes = [trimesh.creation.box(extents=[size] * 3) for size in (10, 4)]
    part = trimesh.util.concatenate(boxes).apply_translation(place)
    (layer,) = nl.slice_mesh(part, [0.5])
    assert {contour.is_hole: len(contour.points) > 3 for contour in layer.contours} == {
        False: True,
        True: True,
    }
