"""Edges at which a cutter may touch a part, and the order in which passes are cut."""

import numpy as np
from numba import njit

VALLEY = 1e-12  # fraction of the largest coordinate: a triangle higher above its neighbour makes a valley


@njit(cache=True, nogil=True)
def contact_edges(order, opposite, kinds, corners, normals):
    """Edges that belong to each triangle, see `Part`.

    Row i of ``corners (m, 9)`` and ``normals (m, 3)`` is that of triangle ``order[i]``; ``opposite`` and
    ``kinds`` are those of the half-edges of a `MeshGraph`.
    """
    place, edges = np.full(len(opposite) // 3, -1), np.zeros(len(order), np.uint8)
    place[order] = np.arange(len(order))
    least = VALLEY * np.abs(corners).max()
    for i in range(len(order)):
        for k in range(3):
            half = 3 * order[i] + k
            other = opposite[half]
            if other >= 0 and kinds[half] == 0:
                if other < half:
                    continue
                j, apex, above = place[other // 3], 3 * (2 - other % 3), 0.0
                for d in range(3):
                    above += normals[i, d] * (corners[j, apex + d] - corners[i, d])
                if normals[i, 2] * normals[j, 2] > 0.0 and np.sign(normals[i, 2]) * above > least:
                    continue
            edges[i] |= 1 << (0, 2, 1)[k]  # half-edge k joins corners (0, 1), (0, 2) or (1, 2)
    return edges


@njit(cache=True, nogil=True)
def nearest_first(ends, both_ways):
    """Order passes greedily: next comes the pass that begins nearest to the end of the last one.

    ``ends (n, 2, 3)`` are first and last points; passes with ``both_ways`` may be reversed. The pass that
    starts highest comes first. Returned are the numbers of the passes in order, and whether each is reversed.
    """
    n = len(ends)
    order, turned, free = np.empty(n, np.int64), np.zeros(n, np.bool_), np.ones(n, np.bool_)
    order[0] = np.argmax(ends[:, 0, 2])
    for k in range(1, n):
        last = order[k - 1]
        free[last], best = False, np.inf
        x, y, z = ends[last, 0 if turned[k - 1] else 1]
        for i in range(n):
            if not free[i]:
                continue
            for back in range(2 if both_ways[i] else 1):
                gap = (ends[i, back, 0] - x) ** 2 + (ends[i, back, 1] - y) ** 2 + (ends[i, back, 2] - z) ** 2
                if gap < best:
                    best, order[k], turned[k] = gap, i, back == 1
    return order, turned
