"""Triangles of a coarse mesh joined to quadrilaterals, with as few new vertices as possible.

Most triangles are joined in pairs. Those left alone are linked, two by two, by short paths over the others;
the edges that a path crosses are halved, so that an odd number of halved edges bounds every lone triangle and
an even number every pair. Each of them then falls into quadrilaterals.
"""

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from nurbs_lab.mesh.solid import _kernels_matching
from nurbs_lab.mesh.solid._kernels_ring import FREE, after, before
from nurbs_lab.mesh.solid.features import components, corner_angles

_CORNERS = (80.0, 120.0)  # degrees from a right angle, of a corner of two joined triangles; in turn
_HELD = 1.6  # factor of that angle at vertices that cannot move freely
_ATTEMPTS = 8
_ACROSS_SHARP = 6.0  # length of a step over a sharp edge; of others it is 1

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

    The matching is as large as good shapes allow; pairs that would leave too few faces around a vertex are
    parted again, and it is completed without them.
    """
    m = len(triangles)
    angles = corner_angles(mesh.vertices, triangles).ravel()
    half = np.arange(3 * m)
    sector = _sectors(opposite, sharp)
    around = np.bincount(sector, weights=angles)
    kinds = np.empty(len(around), dtype=np.int64)
    kinds[sector] = mesh.kinds[triangles.ravel()]
    at_corner = np.where(around > 230.0, 3, np.where(around > 140.0, 2, 1))
    smooth = np.zeros(len(around), dtype=bool)
    smooth[sector] = ~np.isin(triangles.ravel(), triangles.ravel()[sharp])
    at_corner = np.where(smooth, 3, at_corner)
    spare = np.bincount(sector) - np.choose(kinds, [3, 2, at_corner])
    behind, across = before(half), opposite
    scale = np.choose(kinds, [360.0, 180.0, around]) / np.maximum(around, 1.0)  # angles as on a smooth mesh
    evened = angles * scale[sector]

    def at_corners(x):
        return np.stack([x + x[after(across)], x[after(half)] + x[across], x[behind], x[behind[across]]])

    corners = triangles.ravel()[np.stack([half, after(half), behind, behind[across]])]
    held = np.where(mesh.kinds[corners] == FREE, 1.0, _HELD)
    worst = (np.abs(at_corners(evened) - 90.0) * held).max(axis=0)
    mate, usable = np.full(m, -1, dtype=np.int64), ~sharp
    for limit in np.repeat(_CORNERS, _ATTEMPTS):
        edges = np.flatnonzero(usable & (worst < limit))
        first = np.searchsorted(edges // 3, np.arange(m + 1))
        _kernels_matching.complete_matching(first, opposite[edges] // 3, mate)
        joint = _diagonals(opposite, mate)
        broken = _crowded(joint, opposite, sector, spare)
        usable[broken] = usable[opposite[broken]] = False
        mate[broken // 3] = mate[opposite[broken] // 3] = -1
        joint[broken // 3] = joint[opposite[broken] // 3] = -1
    return joint


def _diagonals(opposite, mate):
    """The half-edge across which every triangle meets its mate; -1 without one."""
    met = (opposite.reshape(-1, 3) // 3 == mate[:, None]) & (mate[:, None] >= 0)
    return np.where(met.any(axis=1), 3 * np.arange(len(mate)) + met.argmax(axis=1), -1)


def _crowded(joint, opposite, sector, spare):
    """Diagonals of a matching that leave too few faces around one of their ends."""
    spare, broken = spare.copy(), []
    chosen = joint[(joint >= 0) & (joint < opposite[joint])]
    ends = np.column_stack([sector[chosen], sector[after(chosen)]])
    np.subtract.at(spare, ends, 1)
    for h, (tail, head) in zip(chosen.tolist(), ends.tolist(), strict=True):
        if min(spare[tail], spare[head]) < 0:
            broken.append(h)
            spare[tail] += 1
            spare[head] += 1
    return np.array(broken, dtype=np.int64)


def polygons(triangles, opposite, joint):
    """Half-edges on the sides of the pairs and of the lone triangles, and the first diagonal of each pair."""
    diagonals = joint[(joint >= 0) & (joint < opposite[joint])]
    across = opposite[diagonals]
    sides = [after(diagonals), before(diagonals), after(across), before(across)]
    alone = np.flatnonzero(joint < 0)
    return np.column_stack(sides), 3 * alone[:, None] + np.arange(3), diagonals


def halved_edges(opposite, sharp, pairs, alone):
    """Half-edges that are halved so that an odd number bounds every lone triangle, an even one every pair.

    A lone triangle whose only halved edge is sharp, or that of another such triangle, would have a straight
    angle there; all its edges are halved instead. Where that does not come to an end,
    every edge is halved.
    """
    count = len(pairs) + len(alone)
    owner = np.empty(len(opposite), dtype=np.int64)
    owner[pairs] = np.arange(len(pairs))[:, None]
    owner[alone] = np.arange(len(pairs), count)[:, None]
    sides = np.concatenate([pairs.ravel(), alone.ravel()])
    lone = np.arange(count) >= len(pairs)
    full, halved = np.zeros(count, dtype=bool), np.zeros(len(opposite), dtype=bool)
    for _ in range(_ATTEMPTS):
        marks = np.bincount(owner[sides], halved[sides], count)
        open_sides = sides[~(full[owner[sides]] | full[owner[opposite[sides]]])]
        crossed = _links(count, owner, opposite, sharp, open_sides, np.flatnonzero((marks % 2 == 1) != lone))
        if crossed is None:
            break
        for half in crossed:
            halved[half] = halved[opposite[half]] = not halved[half]
        single = lone & (np.bincount(owner[sides], halved[sides], count) == 1)
        poor = single[owner[sides]] & halved[sides]
        poor &= sharp[sides] | (single[owner[opposite[sides]]] & (sides < opposite[sides]))
        if not poor.any():
            return halved
        full[owner[sides[poor]]] = True
        around = sides[full[owner[sides]]]
        halved[around] = halved[opposite[around]] = True
    return np.ones(len(opposite), dtype=bool)


def _links(count, owner, opposite, sharp, sides, left):
    """Half-edges that short paths cross which link the polygons ``left`` two by two; None if none can."""
    a, b = owner[sides], owner[opposite[sides]]
    length = np.where(sharp[sides], _ACROSS_SHARP, 1.0)
    order = np.lexsort((sides, length, b, a))
    order = order[np.r_[True, (np.diff(a[order]) != 0) | (np.diff(b[order]) != 0)]]  # the shortest of two
    sides, a, b, length = sides[order], a[order], b[order], length[order]
    graph = coo_matrix((length, (a, b)), shape=(count, count)).tocsr()
    key, crossed = a * count + b, []
    while len(left):
        start, left = left[0], left[1:]
        far, before = dijkstra(graph, indices=start, return_predecessors=True)
        if not np.isfinite(far[left]).any():
            return None
        end = left[np.argmin(far[left])]
        left = left[left != end]
        while end != start:
            crossed.append(sides[np.searchsorted(key, int(before[end]) * count + end)])
            end = before[end]
    return crossed


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
