"""Distance to triangles against VTK's and against closed forms."""

import numpy as np
import pytest
import pyvista
import trimesh
from scipy.spatial.transform import Rotation

from nurbs_lab.mesh import samples
from nurbs_lab.mesh.distance import triangle_tree


def test_distances_agree_with_vtk():
    mesh = samples.ant()
    rng = np.random.default_rng(4)
    points = rng.uniform(mesh.bounds[0] - 5, mesh.bounds[1] + 5, (2000, 3))
    cloud = pyvista.PolyData(points).compute_implicit_distance(pyvista.wrap(mesh))
    found = triangle_tree(np.asarray(mesh.triangles)).distances(points)
    assert np.allclose(
        found, np.abs(cloud["implicit_distance"]), atol=1e-5
    )  # VTK reckons in single precision


@pytest.mark.parametrize("count", [1, 4, 5, 33])
def test_any_number_of_triangles(count):
    rng = np.random.default_rng(count)
    corners = rng.normal(size=(count, 3, 3))
    points = rng.normal(size=(50, 3)) * 3
    mesh = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3), process=False)
    expected = [
        np.linalg.norm(
            trimesh.triangles.closest_point(mesh.triangles, np.tile(p, (count, 1))) - p, axis=1
        ).min()
        for p in points
    ]
    assert np.allclose(triangle_tree(corners).distances(points), expected, atol=1e-12)


def test_triangles_without_area_are_segments_or_points():
    corners = np.array([[[0.0, 0, 0], [2, 0, 0], [1, 0, 0]], [[9, 9, 9], [9, 9, 9], [9, 9, 9]]])
    assert triangle_tree(corners).distances([[1.5, 3, 4], [9, 9, 8]]) == pytest.approx([5.0, 1.0])


def test_of_equally_near_triangles_the_first_is_named():
    """Points outside a convex edge or corner are as far from all of its triangles, but for rounding."""
    ball = trimesh.creation.icosphere(2, radius=3.0)
    edges, corners = ball.face_adjacency_edges, ball.vertices
    points = 1.4 * np.concatenate([corners[edges].mean(axis=1), corners, ball.triangles_center])
    first = np.concatenate(
        [
            ball.face_adjacency.min(axis=1),
            [min(face for face in faces if face >= 0) for faces in ball.vertex_faces],
            np.arange(len(ball.faces)),
        ]
    )
    for turn in Rotation.random(5, random_state=3):
        for order in (np.arange(len(points)), np.random.default_rng(5).permutation(len(points))):
            named = triangle_tree(turn.apply(corners)[ball.faces]).nearest(turn.apply(points[order]))[1]
            assert np.array_equal(named, first[order])
