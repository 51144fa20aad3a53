"""Planes through vertices, edges and faces; open, broken, inside-out and empty meshes; wrong arguments."""

from types import SimpleNamespace

import numpy as np
import pytest
import pyvista
import trimesh

from nurbs_lab.mesh import samples, slice_mesh
from nurbs_lab.tests.mesh.oracle import count_contours


def no_short_segments(contour):
    step = np.diff(contour.points, axis=0, append=contour.points[:1])
    return np.all(np.any(step != 0.0, axis=1))


def wedge():
    """A roof: square base at z = 0, ridge at z = 1."""
    points = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [0, 1, 1], [2, 1, 1]]
    return trimesh.convex.convex_hull(np.array(points, float))


@pytest.mark.parametrize(
    ("mesh", "height", "loops"),
    [
        # A vertex on the plane is above it: the top face gives its outline, and the bottom face nothing.
        (trimesh.creation.box(), 0.5, 1),
        (trimesh.creation.box(), -0.5, 0),
        (wedge(), 0.0, 0),
        (wedge(), 1.0, 0),
        (trimesh.creation.cone(1.0, 2.0), 2.0, 0),
        (trimesh.creation.cone(1.0, 2.0), 0.0, 0),
        (trimesh.creation.icosphere(subdivisions=4), 0.0, 1),
        (trimesh.creation.torus(2.0, 0.5, major_sections=32, minor_sections=16), 0.0, 2),
    ],
)
def test_planes_through_vertices_edges_and_faces(mesh, height, loops):
    layer = slice_mesh(mesh, [height])[0]
    assert len(layer.contours) == loops
    assert layer.open_ends == 0
    assert all(contour.closed and no_short_segments(contour) for contour in layer.contours)


def test_every_vertex_height_of_real_meshes_gives_closed_contours():
    for mesh in (samples.ant(), samples.nut()):
        for layer in slice_mesh(mesh, np.unique(mesh.vertices[:, 2])):
            assert len(layer.contours) + layer.collapsed == count_contours(mesh, layer.height)
            assert all(contour.closed and no_short_segments(contour) for contour in layer.contours)


def test_figure_eight_through_a_saddle():
    ring = trimesh.creation.torus(2.0, 0.5, major_sections=32, minor_sections=16)
    layer = slice_mesh(ring, 1.5, axis="x")[0]  # the plane touches the hole's wall
    assert layer.open_ends == 0
    assert all(contour.closed and no_short_segments(contour) for contour in layer.contours)
    fine = trimesh.creation.torus(2.0, 0.5, major_sections=800, minor_sections=400)
    quarter = np.linspace(
        -0.5, 0.5, 20001
    )  # at distance d from the axis the section is |x| <= sqrt(R^2 - d^2) ...
    width = 2 * (np.sqrt((2 + np.sqrt(0.25 - quarter**2)) ** 2 - 2.25))
    hole = np.maximum((2 - np.sqrt(0.25 - quarter**2)) ** 2 - 2.25, 0.0)
    expected = np.trapezoid(width - 2 * np.sqrt(hole), quarter)
    assert slice_mesh(fine, 1.5, axis="x")[0].area == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("shift", [[0, 0, 1], [1, 0, 0], [1, 1, 0], [1, 0, 1]])
def test_boxes_face_to_face_or_edge_to_edge(shift):
    one = trimesh.creation.box()
    other = one.copy()
    other.apply_translation(shift)
    both = trimesh.util.concatenate([one, other])
    heights = [-0.5, -0.2, 0.0, 0.5, 0.7, 1.0]
    for layer in slice_mesh(both, heights):
        expected = [slice_mesh(box, layer.height)[0].area for box in (one, other)]
        assert [contour.area for contour in layer.contours] == [area for area in expected if area]
        assert layer.open_ends == 0


def test_open_meshes_give_open_contours_from_end_to_end():
    tube = trimesh.creation.cylinder(1.0, 2.0, sections=32)
    wall = trimesh.Trimesh(tube.vertices, tube.faces[np.abs(tube.face_normals[:, 2]) < 0.5], process=False)
    assert [c.closed for c in slice_mesh(wall, 0.1)[0].contours] == [True]
    half = trimesh.Trimesh(wall.vertices, wall.faces[wall.triangles_center[:, 0] > 0], process=False)
    with pytest.warns(UserWarning, match="contours of 1 of 2 layers are open.* close it with .*repair_mesh"):
        layer = slice_mesh(half, (0.1, 9.0))[0]
    assert [c.closed for c in layer.contours] == [False]
    assert layer.open_ends == 2
    contour = layer.contours[0]
    assert len(contour.points) == len(contour.triangles) + 1
    assert contour.length == pytest.approx(np.pi, rel=0.1)
    assert contour.points[-1, 1] > contour.points[0, 1]  # counter-clockwise: the material is on the left


def test_an_inside_out_mesh_gives_the_same_contours():
    mesh = trimesh.creation.torus(2.0, 0.5)
    inverted = mesh.copy()
    inverted.invert()
    right, turned = slice_mesh(mesh, 0.1)[0], slice_mesh(inverted, 0.1)[0]
    assert len(right.contours) == 2
    for one, other in zip(right.contours, turned.contours, strict=True):
        assert np.array_equal(one.points, other.points)
        assert np.array_equal(one.triangles, other.triangles)


def test_junk_triangles_do_no_harm():
    box = trimesh.creation.box()
    upright = box.faces[np.ptp(box.triangles[:, :, 2], axis=1) > 0][0]
    edge = upright[np.argsort(box.vertices[upright, 2])[[0, 2]]]
    faces = np.vstack([box.faces, upright, [[edge[0], edge[1], edge[1]]]])
    layer = slice_mesh(trimesh.Trimesh(box.vertices, faces, process=False), 0.25)[0]
    assert [(c.closed, c.area) for c in layer.contours] == [(True, 1.0)]


def test_a_fin_on_a_box_is_cut_as_an_open_contour():
    box = trimesh.creation.box()
    a, b = np.flatnonzero((box.vertices[:, 0] > 0) & (box.vertices[:, 1] > 0))
    vertices = np.vstack([box.vertices, [[2.0, 2.0, 0.0]]])
    mesh = trimesh.Trimesh(vertices, np.vstack([box.faces, [[a, b, len(vertices) - 1]]]), process=False)
    layer = slice_mesh(mesh, 0.25)[0]
    assert sum(len(c.triangles) for c in layer.contours) == 9
    assert layer.open_ends == 2 * sum(not c.closed for c in layer.contours) == 2


def test_a_body_inside_a_body_is_a_hole_or_nothing_by_the_rule_asked_for():
    outer, inner = trimesh.creation.box((4.0, 4.0, 4.0)), trimesh.creation.box((2.0, 2.0, 2.0))
    island = trimesh.creation.box((1.0, 1.0, 1.0))
    void = trimesh.creation.box((3.0, 3.0, 3.0))
    void.invert()
    overlapping = trimesh.util.concatenate([outer, inner])
    hollow = trimesh.util.concatenate([outer, void, island])

    def areas(mesh, fill):
        (layer,) = slice_mesh(mesh, 0.1, fill=fill)
        return [(c.area, c.depth, c.parent, c.is_hole) for c in layer.contours]

    assert areas(overlapping, "even-odd") == [(16.0, 0, -1, False), (-4.0, 1, 0, True)]
    assert areas(overlapping, "nonzero") == [(16.0, 0, -1, False)]
    nested = [(16.0, 0, -1, False), (-9.0, 1, 0, True), (1.0, 2, 1, False)]
    assert areas(hollow, "even-odd") == areas(hollow, "nonzero") == nested


def box_between(low, high):
    return trimesh.creation.box(bounds=[low, high])


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize(
    ("low", "high"),
    [((0, 0), (2, 2)), ((0, 0), (2, 4)), ((1, 0), (3, 4)), ((0, 1), (2, 3)), ((2, 2), (4, 4))],
)
def test_bodies_that_share_walls_and_edges_are_cut_apart(low, high, first):
    bodies = [box_between((0, 0, 0), (4, 4, 4)), box_between((*low, 0), (*high, 4))]
    both = trimesh.util.concatenate([bodies[first], bodies[1 - first]])
    inner = np.prod(np.subtract(high, low))
    for fill, area in ("even-odd", 16 - inner), ("nonzero", 16):
        (layer,) = slice_mesh(both, 2.01, fill=fill)
        assert (layer.area, layer.open_ends) == (pytest.approx(area), 0)


@pytest.mark.parametrize("fill", ["even-odd", "nonzero"])
def test_contours_that_cross_are_kept_whole_unless_next_to_nothing_is_outside(fill):
    box, bore = box_between((0, 0, 0), (30, 20, 10)), box_between((2, 2, 0), (4, 4, 10))
    bore.invert()
    for shift in ((10, 5), (-10, 5), (10, 0), (0, 5), (30, 20)):
        moved = box.copy().apply_translation((*shift, 0))
        (layer,) = slice_mesh(trimesh.util.concatenate([box, bore, moved]), 5.0, fill=fill)
        assert (layer.area, [contour.depth for contour in layer.contours]) == (1196.0, [0, 0, 1])
    plate, hole, pin = box_between((-9, -9, 0), (9, 9, 9)), *(trimesh.creation.cylinder(5, 18) for _ in "ab")
    hole.invert()
    pin.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 32, (0, 0, 1)))  # half a facet
    (layer,) = slice_mesh(trimesh.util.concatenate([plate, pin, hole]), 5.0, fill=fill)
    assert layer.area == pytest.approx(18 * 18)


def test_equal_contours_of_two_bodies_count_as_one_inside_the_other():
    box = box_between((0, 0, 0), (4, 4, 4))
    mirrored = trimesh.Trimesh(box.vertices * [-1, 1, 1] + [4, 0, 0], box.faces[:, ::-1], process=False)
    pair = trimesh.util.concatenate([box, mirrored])  # its diagonals run the other way
    assert [slice_mesh(pair, 2.01, fill=fill)[0].area for fill in ("even-odd", "nonzero")] == [0.0, 16.0]


def test_a_pyvista_surface_and_a_file_are_meshes_too(tmp_path):
    mesh = trimesh.creation.icosphere()
    area = slice_mesh(mesh, 0.2)[0].area
    assert slice_mesh(pyvista.wrap(mesh), 0.2)[0].area == pytest.approx(area, rel=1e-6)
    for suffix in (".stl", ".ply", ".obj", ".off"):
        mesh.export(tmp_path / f"ball{suffix}")
        layer = slice_mesh(str(tmp_path / f"ball{suffix}"), 0.2)[0]
        assert [c.closed for c in layer.contours] == [True]
        assert layer.area == pytest.approx(area, rel=1e-5)
    pyvista.wrap(mesh).save(tmp_path / "ball.vtp")  # its reader ends the process on a damaged file
    with pytest.raises(ValueError, match=r"ball.vtp.* cannot be read: '.vtp' is none of .*; read it with"):
        slice_mesh(tmp_path / "ball.vtp", 0.2)


BALL = trimesh.creation.icosphere(subdivisions=1)
LOST = BALL.vertices.copy()
LOST[3, 1] = np.nan


@pytest.mark.parametrize(
    ("mesh", "heights", "options", "kind", "said"),
    [
        (trimesh.Trimesh(LOST, BALL.faces, process=False), 0.0, {}, ValueError, r"vertices\[3, 1\] is nan"),
        (SimpleNamespace(vertices=BALL.vertices, faces=[(0, 1, 99)]), 0.0, {}, ValueError, "but 42 vertices"),
        ("nowhere.stl", 0.0, {}, FileNotFoundError, "nowhere"),
        (BALL, [0.0, np.nan], {}, ValueError, r"heights\[1\] is nan"),
        (BALL, 0.0, {"axis": "w"}, ValueError, "axis is 'w'"),
    ],
)
def test_wrong_arguments_are_named(mesh, heights, options, kind, said):
    with pytest.raises(kind, match=said):
        slice_mesh(mesh, heights, **options)
