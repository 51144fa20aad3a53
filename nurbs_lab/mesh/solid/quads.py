"""Triangles of a coarse mesh joined to quadrilaterals, and those divided into as few faces as possible.

Most triangles are joined in pairs. Edges are halved so that an odd number of halved edges bounds every
triangle left alone, and an even number every pair: each of them then falls into quadrilaterals. Both
choices are integer linear programs.
"""

import numpy as np
from scipy.optimize import LinearConstraint, milp
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.csgraph import dijkstra

from nurbs_lab.mesh.core import components
from nurbs_lab.mesh.solid._kernels_ring import after, before
from nurbs_lab.mesh.solid.features import corner_angles

_LONE = 4.0  # cost of a triangle left alone; a corner that is off by a right angle costs 1
_SEARCH = {"mip_rel_gap": 0.02, "node_limit": 1}  # of the least cost, and nodes of the tree, where it ends

# Pieces of polygons by which of their sides are halved: first the corners 0, 1, ... of the polygon, then the
# middles of the sides that follow them, and last the middle of all. Other sides follow by rotation.
_PIECES = {
    (0, 0, 0, 0): ((0, 1, 2, 3),),
    (1, 0, 1, 0): ((0, 4, 6, 3), (4, 1, 2, 6)),
    (1, 0, 0, 1): ((0, 4, 8, 7), (4, 1, 2, 8), (8, 2, 3, 7)),
    (1, 1, 1, 1): ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
    (1, 0, 0): ((0, 3, 1, 2),),
    (1, 1, 1): ((0, 3, 6, 5), (3, 1, 4, 6), (6, 4, 2, 5)),
}
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def _ways(size):
    """All ways to halve sides of a polygon, and the pieces of each; the last way halves all of them."""
    out = {}
    for marks, parts in _PIECES.items():
        for turn in range(size if len(marks) == size else 0):
            k = np.array(parts)
            turned = np.where(k < 2 * size, k // size * size + (k + turn) % size, k)
            out.setdefault(tuple(np.roll(marks, turn).tolist()), turned)
    return list(out.items())


WAYS = {size: _ways(size) for size in (3, 4)}


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
    places = _table(owners, np.tile(np.arange(len(edges)), 4), (len(most), len(edges)))
    chosen = _solve(cost, [LinearConstraint(places, -np.inf, most)])
    joint = np.full(m, -1)
    joint[edges[chosen] // 3], joint[across[chosen] // 3] = edges[chosen], across[chosen]
    return joint


def _table(rows, columns, shape):
    """A sparse table of ones."""
    return coo_array((np.ones(len(rows)), (rows, columns)), shape=shape).tocsr()


def _solve(cost, limits):
    """Which of the variables, 0 or 1, are 1 where the cost is least; none if the search fails."""
    found = milp(cost, integrality=np.ones(len(cost)), bounds=(0, 1), constraints=limits, options=_SEARCH)
    return np.zeros(len(cost), dtype=bool) if found.x is None else found.x > 0.5


def polygons(triangles, opposite, joint):
    """Half-edges on the sides of the pairs and of the lone triangles, and the first diagonal of each pair."""
    diagonals = joint[(joint >= 0) & (joint < opposite[joint])]
    across = opposite[diagonals]
    sides = [after(diagonals), before(diagonals), after(across), before(across)]
    alone = np.flatnonzero(joint < 0)
    return np.column_stack(sides), 3 * alone[:, None] + np.arange(3), diagonals


def ways_to_cut(opposite, sharp, pairs, alone):
    """Which of its `WAYS` cuts every pair, and every lone triangle, so that there are fewest pieces in all.

    A lone triangle whose only halved edge is sharp, or that of another such triangle, would have a straight
    angle there: that is ruled out. All edges are halved if the search fails.
    """
    count, owner = len(pairs) + len(alone), np.full(len(opposite), -1)
    rows, columns, owners, ways, marked, cost = [], [], [], [], [], []
    for sides, names in ((pairs, np.arange(len(pairs))), (alone, np.arange(len(pairs), count))):
        owner[sides] = names[:, None]
        for way, (marks, parts) in enumerate(WAYS[sides.shape[1]]):
            halved = sides[:, np.array(marks, dtype=bool)]
            rows.append(halved.ravel())
            columns.append(np.repeat(sum(map(len, owners)) + np.arange(len(sides)), halved.shape[1]))
            owners.append(names)
            for values, value in ((ways, way), (marked, sum(marks)), (cost, len(parts) - 1)):
                values.append(np.full(len(sides), value))
    rows, columns, owners, ways, marked, cost = map(
        np.concatenate, (rows, columns, owners, ways, marked, cost)
    )
    halving = _table(rows, columns, (len(opposite), len(cost)))
    straight = halving @ diags_array((marked == 1).astype(float))
    limits = [
        LinearConstraint(_table(owners, np.arange(len(cost)), (count, len(cost))), 1, 1),
        LinearConstraint(halving - halving[opposite], 0, 0),
        LinearConstraint(straight + straight[opposite], -np.inf, 1.0 - sharp),
        *_borders(halving, owner, opposite, len(pairs), count),
    ]
    chosen = _solve(cost, limits)
    chosen = chosen if chosen.any() else marked > 2
    out = np.empty(count, dtype=np.int64)
    out[owners[chosen]] = ways[chosen]
    return out[: len(pairs)], out[len(pairs) :]


def _borders(halving, owner, opposite, first, count):
    """Around a lone triangle and its neighbours up to the next lone one, an edge at least is halved.

    For whole numbers that follows from the other conditions; with it, the search is shorter.
    """
    used = np.flatnonzero(owner >= 0)
    here, there = owner[used], owner[opposite[used]]
    steps = dijkstra(_table(here, there, (count, count)), indices=np.arange(first, count), unweighted=True)
    for radius in range(count):
        near = steps <= radius
        near = near[near[:, first:].sum(axis=1) == 1]
        if not len(near):
            return
        yield LinearConstraint(csr_array(near[:, here] & ~near[:, there]) @ halving[used], 1, np.inf)


def pieces(nodes, sharp, curves, diagonals, ways):
    """Quadrilaterals of polygons of one kind, cut in their `WAYS`.

    ``nodes`` are the numbers of the corners of the polygons, of the middles of their sides, and of their own
    middles. Returns, for each piece, its corners, their places in the square of the polygon, the diagonal of
    the polygon, which of its sides are sharp, and the points along them.
    """
    size, samples = sharp.shape[1], (curves.shape[2] + 1) // 2
    square = SQUARE[:size]
    flat = np.concatenate([square, (square + np.roll(square, -1, axis=0)) / 2, square.mean(axis=0)[None]])
    at = np.concatenate([np.arange(size), np.arange(size) + 0.5, [np.nan]])  # sides from the first corner
    out = []
    for way, (_, parts) in enumerate(WAYS[size]):
        chosen = np.flatnonzero(ways == way)
        for part in parts:
            marks = np.zeros((len(chosen), 4), dtype=bool)
            along = np.zeros((len(chosen), 4, samples, 3))
            for k, (begin, end) in enumerate(zip(at[part], at[np.roll(part, -1)], strict=True)):
                step = (end - begin) % size
                if step <= 1.0:  # not inside the polygon
                    side, start = int(begin), int(begin % 1.0 * 2 * (samples - 1))
                    marks[:, k] = sharp[chosen, side]
                    along[:, k] = curves[chosen, side, start :: int(2 * step)][:, :samples]
            where = np.tile(flat[part], (len(chosen), 1, 1))
            out.append((nodes[chosen][:, part], where, diagonals[chosen], marks, along))
    return [np.concatenate(one) for one in zip(*out, strict=True)]
