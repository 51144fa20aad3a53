"""Sharp edges of a mesh: which are found, where they end, and what they ask of the faces beside them."""

from itertools import product

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull, Delaunay

from nurbs_lab.mesh import reconstruct, samples
from nurbs_lab.mesh.core import opposite_of
from nurbs_lab.mesh.solid import quads
from nurbs_lab.mesh.solid.features import surfels, without_needles
from nurbs_lab.tests.mesh import shapes


def test_no_edge_is_a_long_arc_of_a_hole():
    """An arc of more than about 70° would be one edge of a patch that overlaps itself beside the hole."""
    plate = trimesh.creation.annulus(3.0, 50.0, 12.0, sections=48)
    (shell,) = reconstruct(plate, tolerance=0.5, faces="patches").shells
    curves = shell.patches.layout.curves[shell.sharp]
    lengths = np.linalg.norm(np.diff(curves, axis=1), axis=2).sum(axis=1)
    assert (np.linalg.norm(curves[:, -1] - curves[:, 0], axis=1) > 0.93 * lengths).all()


def test_a_coarse_round_mesh_is_not_sharp_but_edges_of_prisms_are():
    coarse = trimesh.creation.icosphere(1)
    coarse.apply_scale([3.0, 1.0, 1.0])
    prism = trimesh.creation.annulus(1.0, 2.0, 1.5, sections=96)
    chamfered = trimesh.creation.cylinder(1.0, 2.0, sections=8)
    for mesh, edges in ((coarse, 0), (prism, 4 * 96), (chamfered, 3 * 8)):
        vertices, triangles = np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)
        assert np.degrees(mesh.face_adjacency_angles).max() > 44.0
        assert surfels(vertices, triangles, 30.0, 0.02).sharp.sum() == 2 * edges


def test_slivers_make_no_sharp_edges():
    made = reconstruct(samples.frog_organ("eye_white", blur_mm=2.0), tolerance=0.5)
    turns = np.degrees(made.mesh.face_adjacency_angles)
    assert (turns > 60.0).any()
    assert not made.shells[0].sharp.any()
    assert made.within_tolerance
    assert made.seam_angle < 1e-4
    assert len(made.surfaces) < 60


def test_needles_in_a_plane_become_the_triangles_of_delaunay():
    random = np.random.default_rng(4)
    turns = 2 * np.pi * np.arange(20) / 20
    flat = np.concatenate(
        [np.column_stack([np.cos(turns), np.sin(turns)]), random.uniform(-0.6, 0.6, (80, 2))]
    )
    apex, rim = len(flat), ConvexHull(flat).vertices
    needles = Delaunay(flat * [30.0, 1.0]).simplices
    ways = np.linalg.det(np.diff(flat[needles], axis=1))
    needles = np.where(ways[:, None] > 0.0, needles, needles[:, ::-1])
    sides = np.column_stack([np.roll(rim, -1), rim, np.full(len(rim), apex)])
    vertices = np.vstack([np.column_stack([flat, np.zeros(apex)]), [0.0, 0.0, -1.0]])
    made = without_needles(vertices, np.concatenate([needles, sides]), 30.0, 1e-9)
    assert (opposite_of(made) >= 0).all()
    wanted = np.concatenate([Delaunay(flat).simplices, sides])
    assert {*map(frozenset, made.tolist())} == {*map(frozenset, wanted.tolist())}


def test_short_jagged_creases_of_a_smooth_part_are_noise():
    random = np.random.default_rng(5)
    centres, radii = random.uniform(-12.0, 12.0, (7, 3)), random.uniform(4.0, 7.0, 7)

    def field(points):
        """Balls joined by blends that are narrow where two of them hardly touch."""
        gaps = np.linalg.norm(points[:, None] - centres, axis=2) - radii
        return -1.5 * np.log(np.exp(-gaps / 1.5).sum(axis=1))

    balls = max(shapes.contour(field, [-25.0] * 3, [25.0] * 3, 80).split(), key=lambda part: len(part.faces))
    for mesh, edges in ((balls, 0), (shapes.pillar(), 2 * 360)):
        vertices, triangles = np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64)
        reach = 2.0 * 0.005 * np.ptp(vertices, axis=0).max()
        found = surfels(vertices, triangles, 30.0, reach, rough=True)
        assert found.sharp.sum() == 2 * edges


@pytest.mark.parametrize("seed", range(4))
def test_lone_triangles_fall_into_as_few_pieces_as_can_be(seed):
    """Against all ways to halve the edges of an octahedron, two triangles of which are a pair."""
    triangles = np.array(
        [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    )
    opposite, halves = opposite_of(triangles), np.arange(24)
    edges = np.flatnonzero(halves < opposite)
    joint = np.full(8, -1)
    joint[0], joint[1] = (h := next(h for h in range(3) if opposite[h] // 3 == 1)), opposite[h]
    sharp = np.zeros(24, dtype=bool)
    chosen = np.random.default_rng(seed).choice(edges[edges != min(h, opposite[h])], 3, replace=False)
    sharp[chosen] = sharp[opposite[chosen]] = True
    pairs, alone, _ = quads.polygons(triangles, opposite, joint)
    least = np.inf
    for marks in product([False, True], repeat=12):
        halved = np.zeros(24, dtype=bool)
        halved[edges] = halved[opposite[edges]] = marks
        single = alone[halved[alone].sum(axis=1) == 1]
        straight = np.isin(halves, single) & halved
        even, odd = halved[pairs].sum(axis=1), halved[alone].sum(axis=1)
        valid = not halved[h] and not (even % 2).any() and (odd % 2).all()
        if valid and not (straight & (sharp | straight[opposite])).any():
            facing = halved[pairs][:, 0] == halved[pairs][:, 2]
            cut = np.where(even == 2, np.where(facing, 2, 3), np.where(even == 0, 1, 4))
            least = min(least, cut.sum() + odd.sum())
    ways = quads.ways_to_cut(opposite, sharp, pairs, alone)
    assert (
        sum(len(quads.WAYS[n][way][1]) for n, some in zip((4, 3), ways, strict=True) for way in some) == least
    )


def test_triangles_all_of_whose_edges_are_sharp_are_divided_alone():
    mesh = trimesh.creation.icosahedron()
    made = reconstruct(mesh, tolerance=0.01, faces="patches")
    assert len(made.faces) == 3 * 20
    assert made.within_tolerance
    assert made.volume == pytest.approx(mesh.volume, rel=1e-6)
