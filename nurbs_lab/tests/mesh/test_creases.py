"""Sharp edges of a mesh: which are found, where they end, and what they ask of the faces beside them."""

from itertools import chain, combinations, product

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull, Delaunay

from nurbs_lab.mesh import reconstruct, samples
from nurbs_lab.mesh.core import opposite_of
from nurbs_lab.mesh.solid import quads
from nurbs_lab.mesh.solid._kernels_ring import CORNER, after, before
from nurbs_lab.mesh.solid.features import Surfels, corner_angles, surfels, without_needles
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
        assert (
            surfels(vertices, triangles, 30.0, 0.02, False, np.zeros(len(triangles))).sharp.sum() == 2 * edges
        )


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
        found = surfels(vertices, triangles, 30.0, reach, True, np.zeros(len(triangles)))
        assert found.sharp.sum() == 2 * edges


class Bipyramid:
    """Six triangles, two edges of which are sharp, and what it costs to divide them."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        points = np.array([[1, 0, 0], [-0.5, 0.9, 0], [-0.5, -0.9, 0], [0, 0, 1], [0, 0, -1]])
        self.vertices = points + 0.1 * rng.normal(size=(5, 3))
        self.triangles = np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3], [1, 0, 4], [2, 1, 4], [0, 2, 4]])
        self.opposite, self.tails = opposite_of(self.triangles), self.triangles.ravel()
        self.edge = np.minimum(np.arange(18), self.opposite)
        ends = self.tails, self.tails[after(np.arange(18))]
        apart = [
            (h, k) for h in range(18) for k in range(h) if not {x[h] for x in ends} & {x[k] for x in ends}
        ]
        self.sharp = np.isin(self.edge, self.edge[list(rng.permutation(apart)[0])])
        angles = np.bincount(self.tails, corner_angles(self.vertices, self.triangles).ravel())
        self.fewest = np.where(angles > 230.0, 3, np.where(angles > 140.0, 2, 1))
        self.prices = {}

    def flat(self, sides):
        """Corners, middles and middle of a polygon, the second triangle of a pair turned to the first."""
        points = self.vertices[self.tails[list(sides)]]
        if len(sides) == 4:
            head, apex, tail, far = points
            along = (head - tail) / np.linalg.norm(head - tail)
            up, down = (x - tail - ((x - tail) @ along) * along for x in (apex, far))
            points[3] = far - down - up * np.linalg.norm(down) / np.linalg.norm(up)
        return np.concatenate([points, (points + np.roll(points, -1, axis=0)) / 2, points.mean(axis=0)[None]])

    def price(self, sides, parts):
        at = self.flat(sides)[parts]
        ahead, behind = (np.roll(at, k, axis=1) - at for k in (-1, 1))
        sizes = np.linalg.norm(ahead, axis=2) * np.linalg.norm(behind, axis=2)
        angles = np.degrees(np.arccos(np.clip(np.einsum("pkx,pkx->pk", ahead, behind) / sizes, -1.0, 1.0)))
        return len(parts) * quads._FACE + ((angles / 90.0 - 1.0) ** 2).sum()

    def cost(self, polygons, halved):
        """Of polygons with some edges halved; infinite where they do not fall into quadrilaterals."""
        total, faces, single = 0.0, np.zeros(5), []
        for sides in polygons:
            marks = tuple(int(halved[self.edge[h]] > 0) for h in sides)
            parts = dict(quads.WAYS[len(sides)]).get(marks)
            if parts is None:
                return np.inf
            if (sides, marks) not in self.prices:
                self.prices[sides, marks] = self.price(sides, parts)
            total += self.prices[sides, marks]
            for k, h in enumerate(sides):
                faces[self.tails[h]] += (parts == k).sum()
            single += [self.edge[h] for h, mark in zip(sides, marks, strict=True) if sum(marks) == 1 and mark]
        straight = len(set(single)) < len(single) or self.sharp[single].any()
        return np.inf if straight or (faces < self.fewest).any() else total


@pytest.mark.parametrize("seed", range(4))
def test_triangles_are_joined_and_cut_at_the_least_cost(seed, monkeypatch):
    """Against all pairs of six triangles, and all ways to halve their edges."""
    monkeypatch.setattr(quads, "_MOST_WAYS", 50)  # fewer ways are enough to come near it
    solid, best = Bipyramid(seed), np.inf
    opposite, edges = solid.opposite, np.unique(solid.edge)
    for chosen in chain.from_iterable(combinations(edges[~solid.sharp[edges]], k) for k in range(4)):
        owners = [f for h in chosen for f in (h // 3, opposite[h] // 3)]
        if len(set(owners)) < len(owners):
            continue
        polygons = [(after(h), before(h), after(opposite[h]), before(opposite[h])) for h in chosen]
        polygons += [(3 * f, 3 * f + 1, 3 * f + 2) for f in range(6) if f not in owners]
        for marks in product([False, True], repeat=9):
            halved = dict(zip(edges, marks, strict=True))
            if not any(halved[h] for h in chosen):
                best = min(best, solid.cost(polygons, halved))
    mesh = Surfels(solid.vertices, solid.triangles, opposite, solid.sharp, np.full(5, CORNER), 0.0)
    polygons, halved = [], dict.fromkeys(edges, 0)
    for sides, _, ways in quads.divide(mesh, solid.triangles, opposite, solid.sharp):
        for row, way in zip(sides.tolist(), ways, strict=True):
            polygons.append(tuple(row))
            for h, mark in zip(row, quads.WAYS[len(row)][way][0], strict=True):
                halved[solid.edge[h]] += mark
    assert sorted(f for row in polygons for f in {h // 3 for h in row}) == list(range(6))
    assert set(halved.values()) <= {0, 2}  # neighbours agree
    assert solid.cost(polygons, halved) == pytest.approx(best)


def test_an_edge_without_length_is_joined_too():
    solid = Bipyramid(0)
    solid.vertices[0] = solid.vertices[solid.tails[1 if solid.tails[0] == 0 else 0]]
    mesh = Surfels(solid.vertices, solid.triangles, solid.opposite, solid.sharp, np.full(5, CORNER), 0.0)
    divided = quads.divide(mesh, solid.triangles, solid.opposite, solid.sharp)
    assert sorted({h // 3 for sides, *_ in divided for h in sides.ravel().tolist()}) == list(range(6))


def test_triangles_all_of_whose_edges_are_sharp_are_divided_alone():
    mesh = trimesh.creation.icosahedron()
    made = reconstruct(mesh, tolerance=0.01, faces="patches")
    assert len(made.faces) == 3 * 20
    assert made.within_tolerance
    assert made.volume == pytest.approx(mesh.volume, rel=1e-6)
