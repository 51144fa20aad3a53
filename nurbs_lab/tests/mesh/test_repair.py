"""What is mended, what is named and what is refused before a mesh becomes solids; volumes are exact."""

import re
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista
import trimesh

from nurbs_lab.mesh import mesh_graph, repair_mesh, slice_mesh
from nurbs_lab.mesh.repair import closed_surfaces

BOX, BALL = trimesh.creation.box(), trimesh.creation.icosphere(subdivisions=3)
WIDE = trimesh.creation.box((4, 4, 4))
KERNEL = BALL.copy().apply_scale(0.5)
HOLLOW = trimesh.Trimesh(BALL.vertices, BALL.faces[:, ::-1])


def moved(mesh, *step):
    return mesh.copy().apply_translation(step)


def both(*meshes):
    return trimesh.util.concatenate(meshes)


def mirrored(mesh):
    """As a tool writes it that does not turn the triangles."""
    return trimesh.Trimesh(mesh.vertices * [-1, 1, 1], mesh.faces, process=False)


def mesh_of(vertices, faces):
    return SimpleNamespace(vertices=np.asarray(vertices), faces=np.asarray(faces))


def divided_edge(*fractions):
    """A box with an edge of one triangle, not of its neighbour, divided."""
    a, b, c = BOX.faces[0]
    line = [a, *range(8, 8 + len(fractions)), b]
    ends = BOX.vertices[[a, b]]
    vertices = np.vstack([BOX.vertices, *((1 - t) * ends[0] + t * ends[1] for t in fractions)])
    return mesh_of(vertices, np.vstack([BOX.faces[1:], [(p, q, c) for p, q in pairwise(line)]]))


def loose(mesh, gap):
    """Every triangle with vertices of its own."""
    points = mesh.triangles.reshape(-1, 3)
    points = points + np.random.default_rng(0).uniform(-gap, gap, points.shape)
    return mesh_of(points, np.arange(len(points)).reshape(-1, 3))


def turned(mesh, every):
    faces = mesh.faces.copy()
    faces[::every] = faces[::every, ::-1]
    return mesh_of(mesh.vertices, faces)


def without(mesh, *faces):
    return mesh_of(mesh.vertices, np.delete(mesh.faces, faces, axis=0))


def pinched():
    """Two slabs of four cubes, and between them two cubes that touch along the whole of an edge."""
    cubes = pyvista.ImageData(dimensions=(3, 3, 4)).extract_cells(np.delete(np.arange(12), [5, 6]))
    skin = cubes.extract_surface(algorithm=None).triangulate()
    return mesh_of(skin.points, skin.regular_faces)


@pytest.mark.parametrize(
    ("mesh", "solids", "volume", "said"),
    [
        (both(BOX, moved(BOX, 1, 0, 0)), 2, 2.0, []),
        (both(BOX, moved(BOX, 1, 0.25, 0.125)), 2, 2.0, []),
        (both(BOX, moved(BOX, 1, 1, 0)), 2, 2.0, []),
        (both(BOX, moved(BOX, 1, 1, 1)), 2, 2.0, []),
        (both(BOX, moved(BOX, 0.5, 0.5, 0.5)), 2, 2.0, ["not mended: bodies overlap"]),
        (both(BOX, moved(BOX, 0.5, 0, 0)), 2, 2.0, ["not mended: bodies overlap"]),
        (both(WIDE, HOLLOW), 1, 64 - BALL.volume, []),
        (both(both(WIDE, HOLLOW), KERNEL), 2, 64 - BALL.volume + KERNEL.volume, []),
        (both(WIDE, BALL), 2, 64 + BALL.volume, ["not mended: the body around .* lies inside another"]),
        (without(BOX, 3), 1, 1.0, ["1 pinhole filled"]),
        (without(BALL, 7, 300), 1, BALL.volume, ["2 pinholes filled"]),
        *((without(BOX, *two), 1, 1.0, ["1 pinhole filled"]) for two in BOX.face_adjacency),
        (loose(BALL, 1e-12), 1, BALL.volume, ["doubled vertices welded"]),
        (loose(BALL, 1e-5), 1, BALL.volume, ["doubled vertices welded"]),
        (mesh_of(BALL.vertices, BALL.faces[:, ::-1]), 1, BALL.volume, ["1 surface turned"]),
        (mirrored(both(WIDE, HOLLOW, KERNEL)), 2, 64 - BALL.volume + KERNEL.volume, ["3 surfaces turned"]),
        (both(mirrored(BOX), moved(BOX, 0.5, 0.5, 0.5)), 2, 2.0, ["1 surface turned", "bodies overlap"]),
        (mesh_of(BOX.vertices, BOX.faces[[*range(12), 3, 4]]), 1, 1.0, ["2 triangles left out"]),
        (turned(BALL, 3), 1, BALL.volume, ["427 flipped triangles turned"]),
        (mesh_of(BOX.vertices, np.vstack([BOX.faces, BOX.faces[:2, ::-1]])), 1, 1.0, ["2 stray triangles"]),
        (without(both(BOX, moved(BOX, 1, 0, 0)), 12, 14), 1, 2.0, ["2 stray triangles"]),
        (divided_edge(0.5), 1, 1.0, ["1 T-junction closed"]),
        (divided_edge(0.1, 0.7), 1, 1.0, ["2 T-junctions closed"]),
        (pinched(), 1, 10.0, []),
    ],
)  # fmt: skip
def test_small_defects_are_mended_and_large_ones_named(mesh, solids, volume, said):
    surfaces, repairs = closed_surfaces(mesh_graph(mesh))
    assert len({one.body for one in surfaces}) == solids
    assert sum(one.volume for one in surfaces) == pytest.approx(volume, rel=1e-4)
    assert len(repairs) == len(said)
    for repair, word in zip(repairs, said, strict=True):
        assert re.search(word, repair)
    for one in surfaces:
        assert trimesh.Trimesh(one.vertices, one.triangles, process=False).is_watertight


def tube_along(middles, radius, sides=16):
    """A closed tube around a closed plane curve."""
    along = np.roll(middles, -1, axis=0) - np.roll(middles, 1, axis=0)
    across = np.cross(along / np.linalg.norm(along, axis=1)[:, None], (0, 0, 1.0))
    turn = 2 * np.pi * np.arange(sides) / sides
    rings = np.cos(turn)[:, None] * across[:, None] + np.sin(turn)[:, None] * np.array((0, 0, 1.0))
    i, j = np.divmod(np.arange(len(middles) * sides), sides)
    corner = [((i + a) % len(middles)) * sides + (j + b) % sides for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    faces = np.vstack([np.column_stack([corner[k] for k in (0, *ends)]) for ends in ((1, 2), (2, 3))])
    return mesh_of((middles[:, None] + radius * rings).reshape(-1, 3), faces)


def test_a_surface_that_crosses_itself_is_named_and_one_that_comes_near_is_not():
    turn = 2 * np.pi * np.arange(120) / 120
    for lift, said in ((0.0, 1), (0.8, 0)):
        eight = np.column_stack([5 * np.sin(turn), 3 * np.sin(2 * turn), lift * np.cos(turn)])
        repairs = closed_surfaces(mesh_graph(tube_along(eight, 0.7)))[1]
        assert sum("crosses itself" in repair for repair in repairs) == len(repairs) == said


@pytest.mark.parametrize(
    ("mesh", "said"),
    [
        (without(BOX, 3, 7), r"6 edges have .* only, as around a hole or a sheet, around \(.*\) mm"),
        (without(BALL, *range(0, 400, 2)), "edges have one triangle only"),
        (mesh_of([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), "encloses no volume"),
        (mesh_of(np.eye(3)[[0, 1, 2, 0]] * 1e-95, [(0, 1, 2)]), "nothing to reconstruct"),
        (
            mesh_of(
                [(np.cos(t) * (1 + s * np.cos(t / 2)), np.sin(t) * (1 + s * np.cos(t / 2)), s * np.sin(t / 2))
                 for t in 2 * np.pi * np.arange(9) / 9 for s in (-0.2, 0.2)],
                [face for i in range(0, 16, 2) for face in ((i, i + 1, i + 2), (i + 1, i + 3, i + 2))]
                + [(16, 17, 1), (17, 0, 1)],
            ),
            "wound against each other, as on a one-sided strip",
        ),
    ],
)  # fmt: skip
def test_what_is_too_large_to_mend_is_refused_by_its_kind_and_place(mesh, said):
    with pytest.raises(ValueError, match=said):
        closed_surfaces(mesh_graph(mesh))


def test_slices_of_a_repaired_mesh_are_whole():
    torn = divided_edge(0.5)
    mesh = repair_mesh(both(trimesh.Trimesh(torn.vertices, torn.faces, process=False), moved(BALL, 5, 0, 0)))
    assert mesh.metadata["repairs"] == ("1 T-junction closed",)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(1.0 + BALL.volume)
    (layer,) = slice_mesh(mesh, [0.1])
    assert layer.area == pytest.approx(1.0 + slice_mesh(BALL, [0.1])[0].area)
