"""Triangles of a coarse mesh joined to quadrilaterals, with as few new vertices as possible.

Most triangles are joined in pairs. So many edges are halved that an odd number of halved edges bounds every
triangle left alone, and an even number every pair: each of them then falls into quadrilaterals. Both
choices are integer linear programs.
"""

import numpy as np
from scipy.optimize import LinearConstraint, milp
from scipy.sparse import coo_array, diags_array, eye_array, hstack

from nurbs_lab.mesh.solid._kernels_ring import after, before
from nurbs_lab.mesh.solid.features import components, corner_angles

_LONE = 4.0  # cost of a triangle left alone; a corner that is off by a right angle costs 1
_SEARCH = {"mip_rel_gap": 0.02, "node_limit": 100}  # of the least cost, and branches, where the search ends

# Pieces by the number of sides and by which sides are halved; 0 to 3 are corners, 4 to 7 the middles of the
# sides that follow them, 8 the middle of all. The pieces of other sides are found by rotation.
_PIECES = {
    (4, (0, 0, 0, 0)): ((0, 1, 2, 3),),
    (4, (1, 0, 1, 0)): ((0, 4, 6, 3), (4, 1, 2, 6)),
    (4, (1, 0, 0, 1)): ((0, 4, 8, 7), (4, 1, 2, 8), (8, 2, 3, 7)),
    (4, (1, 1, 1, 1)): ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
    (3, (1, 0, 0)): ((0, 4, 1, 2),),
    (3, (1, 1, 1)): ((0, 4, 8, 6), (4, 1, 5, 8), (8, 5, 2, 6)),
}
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def _sectors(opposite, sharp):
    """Components of corners of faces around a vertex, joined across edges that are not sharp."""
    joined = np.flatnonzero(~sharp)
    across = opposite[joined]
    rows, columns = np.concatenate([joined, after(joined)]), np.concatenate([after(across), across])
    return components(len(opposite), rows, columns)[1]


def pair(mesh, triangles, opposite, sharp):
    """The half-edge across which every triangle is joined to its partner; -1 for those left alone.

    The squared deviations of all corners from right angles are least together, by integer linear programming.
    Every vertex keeps enough faces: three, or two on each side of a sharp curve.
    """
    m, half = len(triangles), np.arange(len(opposite))
    angles = corner_angles(mesh.vertices, triangles).ravel()
    sector = _sectors(opposite, sharp)
    around = np.bincount(sector, weights=angles)
    kinds = np.empty(len(around), dtype=np.int64)
    kinds[sector] = mesh.kinds[triangles.ravel()]
    at_corner = np.where(around > 230.0, 3, np.where(around > 140.0, 2, 1))
    spare = np.maximum(np.bincount(sector) - np.choose(kinds, [3, 2, at_corner]), 0)
    angles *= (np.choose(kinds, [360.0, 180.0, around]) / np.maximum(around, 1.0))[sector]  # as if smooth
    edges = np.flatnonzero(~sharp & (half < opposite))
    across = opposite[edges]
    ends = angles[edges] + angles[after(across)], angles[after(edges)] + angles[across]
    corners = np.stack([*ends, angles[before(edges)], angles[before(across)]])
    cost = ((corners / 90.0 - 1.0) ** 2).sum(axis=0) - 2.0 * _LONE
    most = np.concatenate([np.ones(m), np.maximum(spare, 0)])
    owners = np.concatenate([edges // 3, across // 3, m + sector[edges], m + sector[across]])
    limit = LinearConstraint(_table(owners, 4, (len(most), len(edges))), -np.inf, most)
    chosen = _solve(cost, 1, [limit], otherwise=False)
    joint = np.full(m, -1)
    joint[edges[chosen] // 3], joint[across[chosen] // 3] = edges[chosen], across[chosen]
    return joint


def _table(rows, times, shape):
    """A sparse table of ones at ``rows``; the columns are all of them, so many times."""
    return coo_array((np.ones(len(rows)), (rows, np.tile(np.arange(shape[1]), times))), shape=shape).tocsr()


def _solve(cost, most, limits, otherwise):
    """Which whole numbers from 0 to ``most`` of least cost are not 0; ``otherwise`` if the search fails."""
    found = milp(cost, integrality=np.ones(len(cost)), bounds=(0, most), constraints=limits, options=_SEARCH)
    return np.full(len(cost), otherwise) if found.x is None else found.x > 0.5


def polygons(triangles, opposite, joint):
    """Half-edges on the sides of the pairs and of the lone triangles, and the first diagonal of each pair."""
    diagonals = joint[(joint >= 0) & (joint < opposite[joint])]
    across = opposite[diagonals]
    sides = [after(diagonals), before(diagonals), after(across), before(across)]
    alone = np.flatnonzero(joint < 0)
    return np.column_stack(sides), 3 * alone[:, None] + np.arange(3), diagonals


def halved_edges(opposite, sharp, pairs, alone):
    """Half-edges that are halved so that an odd number bounds every lone triangle, an even one every pair.

    They are as few as possible. A lone triangle whose only halved edge is sharp, or that of another such
    triangle, would have a straight angle there: all its edges are halved instead.
    """
    owner, lone = np.full(len(opposite), -1), np.repeat([0.0, 1.0], [len(pairs), len(alone)])
    for sides, first in ((pairs, 0), (alone, len(pairs))):
        owner[sides] = first + np.arange(len(sides))[:, None]
    edges = np.flatnonzero((owner >= 0) & (np.arange(len(opposite)) < opposite))
    owners = owner[edges], owner[opposite[edges]]
    around = _table(np.concatenate(owners), 2, (len(lone), len(edges)))
    lone_sides = lone[owners[0]] + lone[owners[1]]
    wanted = np.where(sharp[edges], lone_sides, lone_sides // 2)  # of them, with all edges halved
    odd = LinearConstraint(hstack([around, -2 * eye_array(len(lone))]), lone, lone)
    straight = LinearConstraint(hstack([diags_array(wanted), -around.T * lone]), -np.inf, 0)
    cost, most = np.repeat([1.0, 0.0], around.T.shape), np.concatenate([np.ones(len(edges)), 2 - lone])
    halved = np.zeros(len(opposite), dtype=bool)
    chosen = _solve(cost, most, [odd, straight], otherwise=True)[: len(edges)]
    halved[edges] = halved[opposite[edges]] = chosen
    return halved


def middles(points, halved):
    """The mean of the corners of polygons, or of two where the halved sides meet in one of them.

    That is the middle of a diagonal, where all pieces of a convex polygon are convex.
    """
    weight = (halved == np.roll(halved, 1, axis=1))[..., None]
    return (weight * points).sum(axis=1) / np.maximum(weight.sum(axis=1), 1)


def pieces(vertices, triangles, opposite, sharp, curves, halved, sides, diagonals):
    """Quadrilaterals of polygons of one kind, with some edges halved.

    Returns, for each, its corners, their places in the square of the polygon, the diagonal of the polygon,
    which of its sides are sharp, and the points along them.
    """
    size = sides.shape[1]
    number, half_count = len(vertices), len(triangles.ravel())
    corners = triangles.ravel()[sides]
    middles = number + np.minimum(sides, opposite[sides])
    hubs = number + half_count + diagonals
    square = SQUARE[:size]
    flat = np.concatenate([square, (square + np.roll(square, -1, axis=0)) / 2, square.mean(axis=0)[None]])
    nodes = np.column_stack([corners, middles, hubs])
    samples = (curves.shape[1] + 1) // 2
    out = []
    marks = halved[sides]
    done = np.zeros(len(sides), dtype=bool)
    for (corner_count, pattern), parts in _PIECES.items():
        for turn in range(size if corner_count == size else 0):
            chosen = ~done & (marks == np.roll(pattern, turn)).all(axis=1)
            done |= chosen
            for part in parts:
                local = [
                    2 * size if k == 8 else (k + turn) % size if k < 4 else size + (k - 4 + turn) % size
                    for k in part
                ]
                edge_sharp = np.zeros((chosen.sum(), 4), dtype=bool)
                along = np.zeros((len(edge_sharp), 4, samples, 3))
                for k in range(4):
                    a, b = local[k], local[(k + 1) % 4]
                    if a < size and b == (a + 1) % size:
                        side, points = a, slice(None, None, 2)
                    elif a < size and b == size + a:
                        side, points = a, slice(None, samples)
                    elif size <= a < 2 * size and b == (a - size + 1) % size:
                        side, points = a - size, slice(samples - 1, None)
                    else:
                        continue
                    edge_sharp[:, k] = sharp[sides[chosen, side]]
                    along[:, k] = curves[sides[chosen, side], points]
                where = np.tile(flat[local], (len(along), 1, 1))
                out.append((nodes[chosen][:, local], where, diagonals[chosen], edge_sharp, along))
    return [np.concatenate(one) for one in zip(*out, strict=True)]
