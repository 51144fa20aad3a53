"""A closed mesh with what a layout asks of it: sharp edges and corners, and roughness taken off."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import splu

from nurbs_lab.mesh.core import (
    components,
    enclosed_volume,
    face_normals,
    opposite_of,
    tails_and_heads,
    unit,
    vertex_normals,
)  # fmt: skip
from nurbs_lab.mesh.distance import triangle_tree
from nurbs_lab.mesh.solid import _kernels_flips, _kernels_ring

_MOST_VOLUME = 1e-3  # change by slivers that are taken off
_FLAT_EDGE = 1e-12  # 1 - cosine of the angle across an edge within a plane
_MOVED = 0.15  # of the reach: the farthest that a vertex is moved to make the mesh smooth
_LEAST_CHORD = 0.94  # of the length of a sharp curve: about 70° of a circle
_JAGGED = 4.0  # reaches: length of sharp edges for every corner of them, below which they are noise
_COTANGENTS = 0.02, 3.0  # of the angles of triangles, the least and the largest that count
_PINNED = 1e6  # weight of vertices that are not moved


@dataclass(frozen=True, eq=False)
class Surfels:
    """The mesh that is fitted: plain arrays, closed, every edge with two triangles.

    Attributes
    ----------
    vertices, triangles : (n, 3), (m, 3) arrays
    opposite : (3 m,) array
        The half-edge on the other side; half-edge 3 f + e runs from corner e of triangle f to the next.
    sharp : (3 m,) array of bool
        Half-edges on sharp edges.
    kinds : (n,) array
        Free, on a sharp curve, or a corner of sharp curves.
    least_chord : float
        Least chord of an edge of a layout, over the length of the sharp curve that it stands for: beside half
        a hole, patches would overlap themselves. 0 on a rough mesh, whose sharp curves may wind.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    opposite: np.ndarray
    sharp: np.ndarray
    kinds: np.ndarray
    least_chord: float


def surfels(vertices, triangles, sharp_angle, reach, rough, region):
    """Arrays of a closed mesh, its sharp curves found, and the rest made smooth.

    An edge is sharp if the mesh turns across it by more than ``sharp_angle`` degrees beyond what is expected,
    and so do the normals at half of ``reach`` from it. Chains of sharp edges that end freely are noise, and
    so are connected ones with corners too near to one another on a ``rough`` mesh, of which what is rough
    within ``reach`` is smoothed. Borders of the ``region`` of every triangle are sharp anyway.
    """
    opposite = opposite_of(triangles)
    sharp = _turning(vertices, triangles, opposite, sharp_angle, reach)
    _drop_short(vertices, triangles, opposite, sharp, sharp_angle, _JAGGED * reach * rough)
    sharp |= np.repeat(region, 3) != region[opposite // 3]
    kinds = _kinds(vertices, triangles, sharp, sharp_angle)
    if rough:
        vertices = _faired(vertices, triangles, kinds == _kernels_ring.FREE, reach)
    return Surfels(vertices, triangles, opposite, sharp, kinds, 0.0 if rough else _LEAST_CHORD)


def _faired(vertices, triangles, free, reach):
    """Vertices with details shorter than ``reach`` taken off; only the free ones move.

    A step of implicit mean curvature flow smooths the mesh (Desbrun, Meyer, Schröder and Barr 1999). What it
    takes off is smoothed too and put back, which keeps the curvature of longer details; an offset of the
    free vertices keeps the volume. Corners of triangles that would turn over stay where they are.
    """
    angles = np.radians(corner_angles(vertices, triangles))
    weight = np.clip(1.0 / np.tan(np.maximum(angles, 1e-3)), *_COTANGENTS).ravel() / 2
    ends = np.roll(triangles, -1, axis=1).ravel(), np.roll(triangles, -2, axis=1).ravel()
    links = coo_array((weight, ends), shape=(len(vertices), len(vertices)))
    links = (links + links.T).tocsr()
    areas = vertex_normals(vertices, triangles)[1]
    areas = np.where(free, areas, _PINNED * areas.max())[:, None]
    flow = factorized(diags_array(areas[:, 0] + reach**2 * links.sum(axis=1)) - reach**2 * links)
    smooth = flow(areas * vertices)
    moves = (smooth - vertices + flow(areas * (vertices - smooth))) * free[:, None]
    sizes = np.linalg.norm(moves, axis=1, keepdims=True)
    moves *= _MOVED * reach / np.maximum(sizes, _MOVED * reach)
    before = face_normals(vertices, triangles)
    while True:
        fair = vertices + moves
        over = np.einsum("ij,ij->i", face_normals(fair, triangles), before) <= 0.0
        over &= moves[triangles].any(axis=(1, 2))
        if not over.any():
            break
        moves[triangles[over]] = 0.0
    normals, areas = vertex_normals(fair, triangles)
    lost = enclosed_volume(vertices, triangles) - enclosed_volume(fair, triangles)
    offset = lost / max(areas[free].sum(), 1e-300)
    return fair + offset * free[:, None] * normals


def factorized(matrix):
    """A function that solves a sparse symmetric positive definite system."""
    options = {"SymmetricMode": True}
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options).solve


def _turning(vertices, triangles, opposite, angle, reach=0.0):
    """Half-edges across which the mesh turns by more than ``angle`` degrees beyond what is expected there.

    It does so at once and between the normals at half of ``reach``. The turning that a smooth surface would
    have is expected: each of the two triangles turns in the same way towards its other neighbours, over their
    distance across the edge. So neither noise nor the large triangles of a coarse round mesh are sharp.
    Nothing is expected of a polyhedron, all of whose other edges are flat.
    """
    normals, most = unit(face_normals(vertices, triangles)), np.cos(np.radians(angle))
    cosine = np.einsum("ij,ij->i", np.repeat(normals, 3, axis=0), normals[opposite // 3])
    sharp = cosine < most
    sharp |= sharp[opposite]
    polyhedron = bool((sharp | (cosine > 1.0 - _FLAT_EDGE)).all())
    halves = np.flatnonzero(sharp & (np.arange(len(sharp)) < opposite))
    both = halves, opposite[halves]
    here, there = (_normals_beside(vertices, triangles, normals, some, reach) for some in both)
    lost = np.einsum("ij,ij->i", here, there) >= most
    tails, heads = tails_and_heads(triangles)
    along = unit(vertices[heads[halves]] - vertices[tails[halves]])
    here, there = (normals[some // 3] for some in both)
    turning = np.arctan2(
        np.einsum("ij,ij->i", np.cross(here, there), along), np.einsum("ij,ij->i", here, there)
    )
    expected = sum(
        _turning_nearby(vertices, triangles, opposite, normals, some, sign * along, np.sign(turning))
        for some, sign in zip(both, (1.0, -1.0), strict=True)
    )
    expected = np.minimum(expected, np.radians(angle)) * (not polyhedron)
    lost |= np.abs(turning) - expected < np.radians(angle)
    sharp[halves[lost]] = sharp[opposite[halves[lost]]] = False
    return sharp


def _normals_beside(vertices, triangles, normals, halves, reach):
    """Normals of the mesh beside half-edges, in their triangles or beyond, half of ``reach`` away."""
    own = normals[halves // 3]
    if not reach or not len(halves):
        return own
    tails, heads = (vertices[ends[halves]] for ends in tails_and_heads(triangles))
    inward = np.cross(own, unit(heads - tails))
    _, near = triangle_tree(vertices[triangles]).nearest((tails + heads + reach * inward) / 2, own)
    return normals[near]


def _turning_nearby(vertices, triangles, opposite, normals, halves, along, sign):
    """How far a triangle turns across an edge, as it does towards its two other neighbours; at least 0.

    ``along`` are the directions of the half-edges, and ``sign`` tells whether the edges are convex.
    """
    centres, own = vertices[triangles].mean(axis=1), halves // 3
    inward = np.cross(normals[own], along)
    turned, spread = np.zeros(len(halves)), np.zeros(len(halves))
    for step in 1, 2:
        other = opposite[3 * own + (halves + step) % 3] // 3
        far = np.maximum(np.einsum("ij,ij->i", centres[other] - centres[own], inward), 0.0)
        cosine = np.einsum("ij,ij->i", normals[other], normals[own])
        turned += far * np.arctan2(np.einsum("ij,ij->i", normals[other], inward), cosine)
        spread += far**2
    near = np.einsum("ij,ij->i", centres[own] - vertices[triangles.ravel()[halves]], inward)
    return np.maximum(sign * turned / np.maximum(spread, 1e-300), 0.0) * near


def without_slivers(vertices, triangles, sharp_angle, limit):
    """A closed mesh without edges shorter than ``limit`` between vertices on sharp edges: these become one.

    None is moved farther than that. The mesh stays as it is if it would not be closed, or if its volume would
    change by more than a thousandth: a sheet is no detail.
    """
    sharp = _turning(vertices, triangles, opposite_of(triangles), sharp_angle)
    degree = np.bincount(triangles.ravel()[sharp], minlength=len(vertices))
    kept, lost = tails_and_heads(triangles)
    short = np.linalg.norm(vertices[kept] - vertices[lost], axis=1) < limit
    short = np.flatnonzero(short & (degree[lost] > 0) & (degree[kept] >= degree[lost]))
    into, free = np.arange(len(vertices)), np.ones(len(vertices), dtype=bool)
    for h in short[np.argsort(-degree[kept[short]], kind="stable")]:
        if into[kept[h]] == kept[h] and free[lost[h]]:
            into[lost[h]] = kept[h]
            free[kept[h]] = free[lost[h]] = False
    left = into[triangles]
    left = left[(left != np.roll(left, 1, axis=1)).all(axis=1)]
    change = enclosed_volume(vertices, left) / enclosed_volume(vertices, triangles) - 1.0
    if (opposite_of(left) < 0).any() or abs(change) > _MOST_VOLUME:
        return vertices, triangles
    used, corners = np.unique(left, return_inverse=True)
    return vertices[used], corners.reshape(-1, 3)


def _sharp_edges(triangles, sharp):
    ends = np.column_stack(tails_and_heads(triangles))
    return ends, np.flatnonzero(sharp & (ends[:, 0] < ends[:, 1]))


def _drop_short(vertices, triangles, opposite, sharp, sharp_angle, apart):
    """Forget chains of sharp edges with a free end, and connected ones shorter than ``apart`` a corner."""
    ends, chosen = _sharp_edges(triangles, sharp)
    while len(chosen):
        free = np.bincount(ends[chosen].ravel(), minlength=len(vertices)) == 1
        lost = free[ends[chosen]].any(axis=1)
        if not lost.any():
            break
        sharp[chosen[lost]] = sharp[opposite[chosen[lost]]] = False
        chosen = chosen[~lost]
    a, b = ends[chosen].T
    length = np.linalg.norm(vertices[a] - vertices[b], axis=1)
    part = components(len(vertices), a, b)[1]
    corners = _kinds(vertices, triangles, sharp, sharp_angle) == _kernels_ring.CORNER
    least = apart * np.bincount(part, corners)
    lost = chosen[(np.bincount(part[a], length, len(least)) < least)[part[a]]]
    sharp[lost] = sharp[opposite[lost]] = False


def _kinds(vertices, triangles, sharp, sharp_angle):
    ends, chosen = _sharp_edges(triangles, sharp)
    a, b = ends[chosen].T
    degree = np.bincount(np.concatenate([a, b]), minlength=len(vertices))
    kinds = np.where(degree == 0, _kernels_ring.FREE, _kernels_ring.CORNER)
    direction = unit(vertices[b] - vertices[a])
    total = np.zeros_like(vertices)
    np.add.at(total, a, direction)
    np.add.at(total, b, -direction)
    straight = np.linalg.norm(total, axis=1) < 2 * np.sin(np.radians(sharp_angle) / 2)
    kinds[(degree == 2) & straight] = _kernels_ring.ON_CURVE
    return kinds


def refine(vertices, triangles, longest, most):
    """Halve the longest edges of triangles until none exceeds ``longest``; the shape stays the same.

    No round starts with more than ``most`` triangles. Two rounds halve the longest edge at least, so there
    are about 2 log2(longest edge / ``longest``) of them.
    """
    while True:
        tails, heads = tails_and_heads(triangles)
        key = np.minimum(tails, heads) * np.int64(len(vertices)) + np.maximum(tails, heads)
        _, first, edge = np.unique(key, return_index=True, return_inverse=True)
        edge = edge.reshape(-1, 3)
        size = np.linalg.norm(vertices[tails] - vertices[heads], axis=1).reshape(-1, 3)
        size *= _kernels_ring.untied(edge)
        rows = np.flatnonzero(size.max(axis=1) > longest)
        if not len(rows) or len(triangles) > most:
            return vertices, triangles
        halved = np.zeros(len(first) + 1, dtype=bool)  # the last one stands for edges that are new
        halved[edge[rows, size[rows].argmax(axis=1)]] = True
        middle = np.where(halved, len(vertices) + np.cumsum(halved) - 1, -1)
        chosen = first[halved[:-1]]
        vertices = np.concatenate([vertices, (vertices[tails[chosen]] + vertices[heads[chosen]]) / 2])
        while len(split := np.flatnonzero(halved[edge].any(axis=1))):
            k = halved[edge[split]].argmax(axis=1)
            a, b, c = (triangles[split, (k + j) % 3] for j in range(3))
            m, to_c, to_a = middle[edge[split, k]], edge[split, (k + 1) % 3], edge[split, (k + 2) % 3]
            new = np.full(len(split), len(first))
            triangles, edge = triangles.copy(), edge.copy()
            triangles[split], edge[split] = np.column_stack([a, m, c]), np.column_stack([new, new, to_a])
            triangles = np.concatenate([triangles, np.column_stack([m, b, c])])
            edge = np.concatenate([edge, np.column_stack([new, to_c, new])])


def without_needles(vertices, triangles, sharp_angle, limit):
    """Triangles made fat: edges that are not sharp are turned, none farther away than ``limit``."""
    triangles, most = triangles.copy(), np.cos(np.radians(sharp_angle))
    _kernels_flips.flip(vertices, triangles, opposite_of(triangles), limit, most)
    return triangles


def corner_angles(vertices, triangles):
    p = vertices[triangles]
    ahead, behind = unit(np.roll(p, -1, axis=1) - p), unit(np.roll(p, 1, axis=1) - p)
    return np.degrees(np.arccos(np.clip(np.einsum("ijk,ijk->ij", ahead, behind), -1.0, 1.0)))
