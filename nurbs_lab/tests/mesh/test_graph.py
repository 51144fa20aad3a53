"""The weighted graph of Eq. (1), edge by edge."""

import numpy as np
import pytest
import pyvista
import trimesh

from nurbs_lab.mesh import mesh_graph, slice_mesh
from nurbs_lab.mesh.core import opposite_of

A, B, C, D = range(4)
TETRAHEDRON = trimesh.Trimesh(
    [[0.0, 0.0, 1.0], [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]],
    # faces 0 BCD, 1 ABD, 2 ACD, 3 ABC as in Fig. 1; in face 1 angle ABD is v0 and angle BAD is v2
    [[B, C, D], [B, D, A], [A, D, C], [A, C, B]],
    process=False,
)


def test_every_edge_of_the_tetrahedron_by_the_definition():
    graph = mesh_graph(TETRAHEDRON)
    corners = [list(face) for face in TETRAHEDRON.faces.tolist()]
    for face, (i, j) in ((f, e) for f in range(4) for e in ((0, 1), (0, 2), (1, 2))):
        edge = i + j - 1
        ends = {corners[face][i], corners[face][j]}
        neighbour = next(g for g in range(4) if g != face and ends <= set(corners[g]))
        weight = sum(corners[neighbour].index(v) for v in ends)  # Eq. (1): the sum of the two angles' numbers
        assert graph.neighbours[face, edge] == neighbour
        assert graph.weights[face, edge] == weight
    assert graph.weights[3, 1] == 2 + 0  # the edge AB, which the paper works out


def test_opposite_half_edges_are_an_involution_and_a_closed_mesh_has_no_loose_edge():
    mesh = trimesh.creation.icosphere(subdivisions=3)
    graph = mesh_graph(mesh)
    assert np.array_equal(graph.opposite[graph.opposite], np.arange(3 * len(mesh.faces)))
    assert graph.closed
    assert len(graph.boundary_edges) == len(graph.non_manifold_edges) == len(graph.against_winding_edges) == 0
    assert {frozenset(pair) for pair in mesh.face_adjacency.tolist()} == {
        frozenset((f, int(g))) for f, row in enumerate(graph.neighbours) for g in row
    }


def test_a_soup_of_triangles_is_welded():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    soup = trimesh.Trimesh(
        mesh.triangles.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3), process=False
    )
    graph = mesh_graph(soup)
    assert len(graph.vertices) == len(mesh.vertices)
    assert np.array_equal(graph.neighbours, mesh_graph(mesh).neighbours)


def test_the_two_signs_of_zero_are_one_place():
    square = trimesh.Trimesh(
        [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [1, -0.0, -0.0], [-0.0, 1, 0]],
        [[0, 1, 2], [4, 3, 5]],
        process=False,
    )
    assert mesh_graph(square).neighbours[0, 2] == 1


def test_non_manifold_edges_are_listed_once():
    side = trimesh.creation.box()
    other = side.copy()
    other.apply_translation([1.0, 1.0, 0.0])  # the two boxes touch along one vertical edge
    graph = mesh_graph(trimesh.util.concatenate([side, other]))
    assert graph.non_manifold_edges.shape == (1, 2)
    assert np.allclose(graph.vertices[graph.non_manifold_edges[0]][:, :2], 0.5)
    assert graph.closed


def test_an_edge_of_four_triangles_needs_no_places():
    """Its half-edges have no single opposite one, and no angle around it is known."""
    opposite = opposite_of(np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]]))
    assert (opposite == -1).all()


def test_a_triangle_wound_against_its_neighbours_is_listed():
    mesh = trimesh.creation.box()
    faces = mesh.faces.copy()
    faces[4] = faces[4][::-1]
    graph = mesh_graph(trimesh.Trimesh(mesh.vertices, faces, process=False))
    assert len(graph.against_winding_edges) == 3


@pytest.mark.parametrize("copies", [1, 3])
def test_repeated_and_zero_area_triangles_are_junk(copies):
    mesh = trimesh.creation.box()
    faces = np.vstack([mesh.faces, *[np.roll(mesh.faces[3:4], 1)] * copies, [[0, 0, 1]]])
    graph = mesh_graph(trimesh.Trimesh(mesh.vertices, faces, process=False))
    assert np.flatnonzero(graph.junk).tolist() == list(range(12, 13 + copies))
    assert graph.closed


def test_the_division_mark_is_where_the_contours_went():
    mesh = trimesh.creation.icosphere(subdivisions=3)
    graph = mesh_graph(mesh)
    layer = slice_mesh(graph, 0.3)[0]
    z = mesh.triangles[:, :, 2]
    assert np.array_equal(graph.division_mark(layer), (z.min(axis=1) < 0.3) & (z.max(axis=1) >= 0.3))


def test_a_graph_is_its_own_graph_and_read_only():
    graph = mesh_graph(TETRAHEDRON)
    assert mesh_graph(graph) is graph
    with pytest.raises(ValueError, match="read-only"):
        graph.opposite[0] = 1


@pytest.mark.parametrize("missing", [0, 1])
def test_a_mesh_of_which_every_triangle_has_a_back_is_its_front(missing):
    box = trimesh.creation.box((3.0, 2.0, 1.0))
    front = box.faces[missing:]
    both = np.stack([front, front[:, ::-1]], axis=1).reshape(-1, 3)  # each beside its back
    graph = mesh_graph(trimesh.Trimesh(box.vertices, both, process=False))
    assert np.array_equal(graph.triangles[~graph.junk], mesh_graph(box).triangles[missing:])
    (layer,) = slice_mesh(graph, [0.1])
    assert layer.area == pytest.approx(6.0 if layer.contours[0].closed else 0.0)
    assert layer.open_ends == 2 * (not layer.contours[0].closed)


def test_a_body_in_the_void_of_another_has_no_backs():
    ball, box = trimesh.creation.icosphere(2), trimesh.creation.box((4.0, 4.0, 4.0))
    graph = mesh_graph(
        trimesh.util.concatenate([box, trimesh.Trimesh(ball.vertices, ball.faces[:, ::-1]), ball])
    )
    assert not graph.junk.any()
    assert slice_mesh(graph, [0.1])[0].area == pytest.approx(16.0)


def test_polygons_of_several_sizes_and_strips_are_a_mesh():
    for surface in (pyvista.Cylinder(resolution=7), pyvista.Cylinder(resolution=7).strip()):
        (layer,) = slice_mesh(surface, 0.1, "x")
        assert layer.area == pytest.approx(7 / 2 * 0.5**2 * np.sin(2 * np.pi / 7), rel=1e-5)
