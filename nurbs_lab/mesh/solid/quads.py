"""Triangles of a coarse mesh joined to quadrilaterals, and those divided into as few good faces as possible.

Most triangles are joined in pairs. Edges are halved so that an odd number of halved edges bounds every
triangle left alone, and an even number every pair: each of them then falls into quadrilaterals. One integer
linear program chooses pairs and halved edges together: what a lone triangle costs depends on what its
neighbours can do with a halved edge.
"""

import numpy as np
from scipy.optimize import LinearConstraint, linprog, milp
from scipy.sparse import coo_array

from nurbs_lab.mesh._kernels_core import after, before
from nurbs_lab.mesh.core import fans
from nurbs_lab.mesh.solid.features import corner_angles

_FACE = 2.0  # cost of a face; a corner that is off by a right angle costs 1
_MOST_WAYS = 1500  # to choose from; a quarter more, and so on, where these do not do

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


def divide(mesh, triangles, opposite, sharp):
    """Which triangles are joined in pairs, and in which of its `WAYS` every pair and lone triangle is cut.

    Of pairs, and of lone triangles, returns the half-edges on their sides, a half-edge to number them by (of
    pairs, the diagonal), and the ways. Faces and the squared deviations of their angles from right ones cost
    least together.
    """
    half = np.arange(len(opposite))
    angles = corner_angles(mesh.vertices, triangles).ravel()
    sector = fans(opposite, ~sharp)[1]
    around = np.bincount(sector, weights=angles)
    kinds = np.empty(len(around), dtype=np.int64)
    kinds[sector] = mesh.kinds[triangles.ravel()]
    at_corner = np.where(around > 230.0, 3, np.where(around > 140.0, 2, 1))
    fewest = np.minimum(np.bincount(sector), np.choose(kinds, [3, 2, at_corner]))
    smooth = (np.choose(kinds, [360.0, 180.0, around]) / np.maximum(around, 1.0))[sector]
    diagonals = np.flatnonzero(~sharp & (half < opposite))
    across, alone = opposite[diagonals], half.reshape(-1, 3)
    pairs = np.column_stack([after(diagonals), before(diagonals), after(across), before(across)])
    ends = mesh.vertices[triangles]
    length = np.linalg.norm(np.roll(ends, -1, axis=1) - ends, axis=-1).ravel()
    apex = _apexes(length)
    base, zero = length[diagonals], np.zeros(len(diagonals))
    flat = np.column_stack([base, apex[diagonals], zero, base - apex[across]])
    single = np.column_stack([0.0 * half[::3], length[::3], apex[::3]])
    price = np.concatenate([*_prices(flat, smooth[pairs]), *_prices(single, smooth[alone])])
    owners = [(diagonals // 3, across // 3), (half[::3] // 3,)]
    chosen = _least(price, (pairs, alone), owners, opposite, sharp, sector, fewest)
    out = []
    for sides, parents, one in zip((pairs, alone), (diagonals, alone[:, 2]), chosen, strict=True):
        rows = np.flatnonzero(one.any(axis=0))
        out.append((sides[rows], parents[rows], one[:, rows].argmax(axis=0)))
    return out


def _apexes(length):
    """The third corners of triangles whose half-edges run from 0 along the real axis."""
    half = np.arange(len(length))
    ahead, behind = length[after(half)], length[before(half)]
    real = (length**2 + behind**2 - ahead**2) / np.maximum(2.0 * length, 1e-300)
    return real + 1j * np.sqrt(np.maximum(behind**2 - real**2, 0.0))


def _prices(corners, smooth):
    """What the pieces of flat polygons cost, for each of the `WAYS`.

    The angles at the corners of the polygons are multiplied by ``smooth``.
    """
    size = corners.shape[1]
    places = np.column_stack([corners, (corners + np.roll(corners, -1, axis=1)) / 2, corners.mean(axis=1)])
    factors = np.column_stack([smooth, np.ones((len(corners), size + 1))])
    for _, parts in WAYS[size]:
        at = places[:, parts]
        ahead, behind = np.roll(at, -1, axis=2) - at, np.roll(at, 1, axis=2) - at
        angles = np.angle(behind * ahead.conj()) % (2 * np.pi) * factors[:, parts]
        yield len(parts) * _FACE + ((angles / (np.pi / 2) - 1.0) ** 2).sum(axis=(1, 2))


def _least(price, polygons, owners, opposite, sharp, sector, fewest):
    """The cheapest ways to cut polygons, by integer linear programming: for each kind ``(ways, polygons)``.

    Every triangle is in one polygon. Neighbours agree about their edge. A lone triangle whose only halved
    side is sharp, or that of another such triangle, would have a straight angle there: none is cut so. Every
    vertex keeps enough faces: three, or two on each side of a sharp curve. To leave all triangles alone and
    halve all sides is always possible.

    First fractions of ways are allowed. Of many ways, only those of the least reduced costs are tried then.
    """
    count, half = len(opposite), np.arange(len(opposite))
    edge, sign = np.minimum(half, opposite), np.where(half < opposite, 1.0, -1.0)
    straight = count + count // 3  # the first condition that is no equation
    limits = np.concatenate([np.zeros(count), np.ones(count // 3), ~sharp, -fewest])
    rows, columns, values, begin = [], [], [], 0
    for sides, owner in zip(polygons, owners, strict=True):
        for marks, parts in WAYS[sides.shape[1]]:
            halved = sides[:, np.flatnonzero(marks)].T
            entries = [(edge[h], sign[h]) for h in halved] + [(count + triangle, 1.0) for triangle in owner]
            if len(halved) == 1:
                entries.append((straight + edge[halved[0]], 1.0))
            for k, side in enumerate(sides.T):
                entries.append((straight + count + sector[side], -float((parts == k).sum())))
            for row, value in entries:
                rows.append(row)
                columns.append(begin + np.arange(len(row)))
                values.append(np.broadcast_to(value, row.shape))
            begin += len(sides)
    places = np.concatenate(rows), np.concatenate(columns)
    table = coo_array((np.concatenate(values), places), shape=(len(limits), begin)).tocsr()
    equal, below = (table[:straight], limits[:straight]), (table[straight:], limits[straight:])
    part = linprog(price, below[0], below[1], equal[0], equal[1], bounds=(0, 1))
    least = np.concatenate([limits[:straight], np.full(len(limits) - straight, -np.inf)])
    options = {"mip_rel_gap": 0.02, "node_limit": 1}
    order, most = np.argsort(part.lower.marginals, kind="stable"), _MOST_WAYS
    while True:
        some = np.sort(order[:most])
        conditions = LinearConstraint(table[:, some], least, limits)
        found = milp(price[some], integrality=1, bounds=(0, 1), constraints=conditions, options=options)
        if found.x is not None or most >= begin:
            break
        most += most // 4
    alone = np.arange(begin) >= begin - count // 3  # all of them, and all their sides halved
    chosen = alone if found.x is None else np.isin(np.arange(begin), some[found.x > 0.5])
    parts = np.split(chosen, [len(polygons[0]) * len(WAYS[4])])
    return [one.reshape(len(WAYS[n]), -1) for n, one in zip((4, 3), parts, strict=True)]


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
