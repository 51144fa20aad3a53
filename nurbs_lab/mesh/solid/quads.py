"""Triangles of a coarse mesh joined to quadrilaterals, and those divided into as few faces as possible.

Most triangles are joined in pairs. Edges are halved so that an odd number of halved edges bounds every
triangle left alone, and an even number every pair: each of them then falls into quadrilaterals.
"""

import numpy as np
from scipy.optimize import LinearConstraint, milp
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from nurbs_lab.mesh.core import components
from nurbs_lab.mesh.solid._kernels_ring import after, before
from nurbs_lab.mesh.solid.features import corner_angles

_LONE = 4.0  # cost of a triangle left alone; a corner that is off by a right angle costs 1
_TREES = 32  # of polygons, from which the search for halved sides starts
_STRAIGHT = 4.0, 50.0  # cost of a straight angle in that search, at first and then
_IDLE = 60  # turns that make nothing better, after which a round of it ends

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
    most = np.concatenate([np.ones(m), spare])
    owners = np.concatenate([edges // 3, across // 3, m + sector[edges], m + sector[across]])
    places = _table(owners, np.tile(np.arange(len(edges)), 4), (len(most), len(edges)))
    limit, options = LinearConstraint(places, -np.inf, most), {"mip_rel_gap": 0.02, "node_limit": 1}
    found = milp(cost, integrality=np.ones(len(cost)), bounds=(0, 1), constraints=limit, options=options)
    chosen = np.zeros(len(cost), dtype=bool) if found.x is None else found.x > 0.5
    joint = np.full(m, -1)
    joint[edges[chosen] // 3], joint[across[chosen] // 3] = edges[chosen], across[chosen]
    return joint


def _table(rows, columns, shape):
    """A sparse table of ones."""
    return coo_array((np.ones(len(rows)), (rows, columns)), shape=shape).tocsr()


def polygons(triangles, opposite, joint):
    """Half-edges on the sides of the pairs and of the lone triangles, and the first diagonal of each pair."""
    diagonals = joint[(joint >= 0) & (joint < opposite[joint])]
    across = opposite[diagonals]
    sides = [after(diagonals), before(diagonals), after(across), before(across)]
    alone = np.flatnonzero(joint < 0)
    return np.column_stack(sides), 3 * alone[:, None] + np.arange(3), diagonals


def ways_to_cut(triangles, opposite, sharp, pairs, alone):
    """Which of its `WAYS` cuts every pair, and every lone triangle, so that there are few pieces in all.

    A polygon is cut by the set of its halved sides, as bits: an even number for pairs, an odd one for lone
    triangles. The search starts with paths along a tree of polygons, and takes the best of some trees.
    """
    first, count = len(pairs), len(pairs) + len(alone)
    owner, bit, begins = (np.full(len(opposite), k) for k in (-1, 0, 0))
    price, codes = np.zeros((count, 16)), []
    for sides, names in ((pairs, np.arange(first)), (alone, np.arange(first, count))):
        marks, parts = zip(*WAYS[sides.shape[1]], strict=True)
        owner[sides], bit[sides] = names[:, None], 1 << np.arange(sides.shape[1])
        begins[sides] = bit[sides] | np.roll(bit[sides], 1, axis=1)
        codes.append(np.array(marks) @ (1 << np.arange(sides.shape[1])))
        price[names[:, None], codes[-1]] = list(map(len, parts))
    search = _Search(triangles, opposite, sharp, owner, bit, begins, price, alone)
    used = np.flatnonzero(owner >= 0)
    there = owner[opposite[used]]
    across = dict(zip(zip(owner[used].tolist(), there.tolist(), strict=True), used.tolist(), strict=True))
    links, found = _table(owner[used], there, (count, count)), []
    for root in np.linspace(0, count - 1, _TREES if len(alone) else 1).astype(int):
        order, towards = breadth_first_order(links, root)
        halved, odd = np.zeros(count, dtype=np.int64), np.arange(count) >= first
        for k in order[:0:-1]:
            if odd[k]:
                half, odd[towards[k]] = across[k, towards[k]], not odd[towards[k]]
                halved[k] ^= bit[half]
                halved[towards[k]] ^= bit[opposite[half]]
        for straight in _STRAIGHT:
            halved = search.improved(halved, straight)
        found.append((search.cost(halved, straight), len(found), halved))
    halved = min(found)[2]
    return tuple(
        (mine[:, None] == of).argmax(axis=1)
        for mine, of in zip(np.split(halved, [first]), codes, strict=True)
    )


class _Search:
    """Which sides are halved, improved by turns of vertices (Kernighan and Lin 1970).

    A turn halves the edges at a vertex that are not, and no others there: that changes two sides of every
    polygon around it, so the numbers stay even and odd. A lone triangle whose only halved side is sharp, or
    that of another such triangle, would have a straight angle there, which costs extra.
    """

    def __init__(self, triangles, opposite, sharp, owner, bit, begins, price, alone):
        used = np.flatnonzero(owner >= 0)
        tails = triangles.ravel()
        self.turn, self.price, self.wrong = (tails[used], owner[used], begins[used]), price, 0.0 * price
        lone = alone.ravel()
        self.wrong[owner[lone], bit[lone]] = sharp[lone]
        here = lone[~sharp[lone] & (lone < opposite[lone]) & np.isin(opposite[lone], lone)]
        there, none = opposite[here], 0 * here
        self.sides = owner[here], bit[here], owner[there], bit[there]
        ends = (
            (tails[here], begins[here], begins[after(there)]),
            (tails[there], begins[after(here)], begins[there]),
            (tails[before(here)], begins[before(here)], none),
            (tails[before(there)], none, begins[before(there)]),
        )
        beside = [np.concatenate(column) for column in zip(*ends, strict=True)]
        self.beside = [*(np.tile(one, 4) for one in self.sides), *beside]

    def cost(self, halved, straight):
        """Number of pieces, and ``straight`` for every straight angle."""
        p, a, q, b = self.sides
        mine = np.arange(len(halved)), halved
        double = np.count_nonzero((halved[p] == a) & (halved[q] == b))
        return self.price[mine].sum() + straight * (self.wrong[mine].sum() + double)

    def gains(self, halved, straight):
        """What turning each vertex adds to the cost."""
        vertex, polygon, both = self.turn
        p, a, q, b, one, here, there = self.beside
        count, price = vertex.max() + 1, self.price + straight * self.wrong
        change = price[polygon, halved[polygon] ^ both] - price[polygon, halved[polygon]]
        was = (halved[p] == a) & (halved[q] == b)
        will = (halved[p] ^ here == a) & (halved[q] ^ there == b)
        return np.bincount(vertex, change, count) + straight * np.bincount(one, 1.0 * will - was, count)

    def improved(self, halved, straight):
        """The best set on a way of turns, each the best of those left; repeated until none is better."""
        vertex, polygon, both = self.turn
        while True:
            best, total, least, since, now = halved, 0.0, 0.0, 0, halved.copy()
            free = np.bincount(vertex) > 0
            while free.any() and since < _IDLE:
                gains = np.where(free, self.gains(now, straight), np.inf)
                turned = int(gains.argmin())
                around = vertex == turned
                np.bitwise_xor.at(now, polygon[around], both[around])
                free[turned], total, since = False, total + gains[turned], since + 1
                if total < least:
                    best, least, since = now.copy(), total, 0
            if best is halved:
                return halved
            halved = best


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
