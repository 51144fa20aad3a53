"""Triangles of a coarse mesh joined to quadrilaterals, and those divided into as few faces as possible.

Most triangles are joined in pairs. Edges are halved so that an odd number of halved edges bounds every
triangle left alone, and an even number every pair: each of them then falls into quadrilaterals.
"""

import numpy as np
from scipy.optimize import LinearConstraint, milp
from scipy.sparse import coo_array

from nurbs_lab.mesh.core import components
from nurbs_lab.mesh.solid._kernels_ring import after, before
from nurbs_lab.mesh.solid.features import corner_angles

_LONE = 4.0  # cost of a triangle left alone; a corner that is off by a right angle costs 1

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


def _ways(size):
    """All ways to halve sides of a polygon, and the pieces of each."""
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
    if not len(edges):  # as on a tetrahedron
        return np.full(m, -1)
    across = opposite[edges]
    ends = angles[edges] + angles[after(across)], angles[after(edges)] + angles[across]
    corners = np.stack([*ends, angles[before(edges)], angles[before(across)]])
    cost = ((corners / 90.0 - 1.0) ** 2).sum(axis=0) - 2.0 * _LONE
    owners = edges // 3, across // 3, m + sector[edges], m + sector[across]
    most = np.concatenate([np.ones(m), spare])
    chosen = _least(cost, [[(owner, 1.0) for owner in owners]], -np.inf, most)
    chosen = np.zeros(len(cost), dtype=bool) if chosen is None else chosen
    joint = np.full(m, -1)
    joint[edges[chosen] // 3], joint[across[chosen] // 3] = edges[chosen], across[chosen]
    return joint


def polygons(triangles, opposite, joint):
    """Half-edges on the sides of the pairs and of the lone triangles, and the first diagonal of each pair."""
    diagonals = joint[(joint >= 0) & (joint < opposite[joint])]
    across = opposite[diagonals]
    sides = [after(diagonals), before(diagonals), after(across), before(across)]
    alone = np.flatnonzero(joint < 0)
    return np.column_stack(sides), 3 * alone[:, None] + np.arange(3), diagonals


def ways_to_cut(opposite, sharp, pairs, alone):
    """Which of its `WAYS` cuts every pair, and every lone triangle, so that there are fewest pieces in all.

    Each polygon is cut in one way, and neighbours agree about their edge. A lone triangle whose only halved
    side is sharp, or that of another such triangle, would have a straight angle there: none is cut so. To
    halve all sides is always possible.
    """
    half, count = np.arange(len(opposite)), len(opposite)
    edge, sign = np.minimum(half, opposite), np.where(half < opposite, 1.0, -1.0)
    entries, price, whole, first = [], [], [], 0
    for sides in (pairs, alone):
        names = 2 * count + first + np.arange(len(sides))
        for marks, parts in WAYS[sides.shape[1]]:
            halved = sides[:, np.flatnonzero(marks)].T
            entries.append([(names, 1.0), *((edge[h], sign[h]) for h in halved)])
            if len(halved) == 1:
                entries[-1].append((count + edge[halved[0]], 1.0))
            price.append(np.full(len(sides), len(parts)))
            whole.append(np.full(len(sides), all(marks)))
        first += len(sides)
    limits = np.concatenate([0 * half, ~sharp, np.ones(first)])
    least = np.where(np.arange(len(limits)) < 2 * count, 0, 1)
    chosen = _least(np.concatenate(price), entries, least, limits)
    chosen = np.concatenate(whole) if chosen is None else chosen
    parts = np.split(chosen, [len(pairs) * len(WAYS[4])])
    return tuple(part.reshape(len(WAYS[n]), -1).argmax(axis=0) for n, part in zip((4, 3), parts, strict=True))


def _least(price, entries, least, most):
    """The cheapest choice under linear conditions, by integer linear programming; None if none was found.

    ``entries`` are, for every block of choices, their rows and values in the conditions.
    """
    rows, columns, values, begin = [], [], [], 0
    for block in entries:
        for row, value in block:
            rows.append(row)
            columns.append(begin + np.arange(len(row)))
            values.append(np.broadcast_to(value, row.shape))
        begin += len(block[0][0])
    places = np.concatenate(rows), np.concatenate(columns)
    table = coo_array((np.concatenate(values), places), shape=(len(most), len(price))).tocsr()
    limits, options = LinearConstraint(table, least, most), {"mip_rel_gap": 0.02, "node_limit": 1}
    found = milp(price, integrality=np.ones(len(price)), bounds=(0, 1), constraints=limits, options=options)
    return None if found.x is None else found.x > 0.5


def pieces(nodes, sharp, curves, diagonals, ways):
    """Quadrilaterals of polygons of one kind, cut in their `WAYS`.

    ``nodes`` are the numbers of the corners of the polygons, of the middles of their sides, and of their own
    middles. Returns, for each piece, its corners, their places in the square of the polygon, the diagonal of
    the polygon, which of its sides are sharp, and the points along them.
    """
    size, samples = sharp.shape[1], (curves.shape[2] + 1) // 2
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])[:size]
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
