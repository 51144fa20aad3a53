"""Points that live on a mesh, taken back from a coarse mesh to the fine one.

Such a point is a triangle and three weights of its corners (its barycentric coordinates).
"""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def containing(px, py, size, turned, u, v):
    """Which triangle of a flat picture holds a place, or nearly so, and its barycentric coordinates there."""
    best, place = -np.inf, 0
    s0, s1, s2 = 0.0, 0.0, 0.0
    for j in range(size):
        if turned:  # (u, v, a) and (v, u, b)
            o, b, c = j, 1 - j, 2 + j
            ox, oy = px[o], py[o]
        else:
            b, c = j, (j + 1) % size
            ox, oy = 0.0, 0.0
        x1, y1, x2, y2 = px[b] - ox, py[b] - oy, px[c] - ox, py[c] - oy
        det = x1 * y2 - y1 * x2
        if not det > 0.0:
            continue
        s, t = ((u - ox) * y2 - (v - oy) * x2) / det, (x1 * (v - oy) - y1 * (u - ox)) / det
        least = min(s, t, 1.0 - s - t)
        if least > best:
            best, place, s0, s1, s2 = least, j, 1.0 - s - t, s, t
    return place, s0, s1, s2


@njit(cache=True, nogil=True)
def trace_back(log, count, triangle, weights):
    """Undo collapses and turned edges, last one first, for points on the coarse mesh, in place.

    ``log`` holds, for every change, its half-edges with the flat picture of its ring, and then their number,
    negative for a turned edge. ``count`` is the number of triangles of the fine mesh.
    """
    first, after = np.full(count, -1), np.empty(len(triangle), np.int64)
    for p in range(len(triangle)):
        after[p] = first[triangle[p]]
        first[triangle[p]] = p
    end = len(log)
    while end > 0:
        turned, size = log[end - 1, 0] < 0.0, int(abs(log[end - 1, 0]))
        start = end - 1 - size
        halves, px, py = (
            log[start : end - 1, 0].astype(np.int64),
            log[start : end - 1, 1],
            log[start : end - 1, 2],
        )
        end = start
        moved = -1
        for j in range(0 if turned else 1, 2 if turned else size - 1):
            f, e = halves[j] // 3, halves[j] % 3
            if turned:  # (a, u, b) and (b, v, a)
                e, a, b, c = 0, 2 + j, j, 3 - j
            else:
                a, b, c = 0, j, j + 1
            p, first[f] = first[f], -1
            while p >= 0:
                w0, w1, w2 = weights[p, e], weights[p, (e + 1) % 3], weights[p, (e + 2) % 3]
                weights[p, 0] = w0 * px[a] + w1 * px[b] + w2 * px[c]
                weights[p, 1] = w0 * py[a] + w1 * py[b] + w2 * py[c]
                following, after[p] = after[p], moved
                moved, p = p, following
        while moved >= 0:
            p, moved = moved, after[moved]
            u, v = weights[p, 0], weights[p, 1]
            place, s0, s1, s2 = containing(px, py, 2 if turned else size, turned, u, v)
            s0, s1, s2 = max(s0, 0.0), max(s1, 0.0), max(s2, 0.0)
            f, e, total = halves[place] // 3, halves[place] % 3, s0 + s1 + s2
            weights[p, e], weights[p, (e + 1) % 3], weights[p, (e + 2) % 3] = (
                s0 / total,
                s1 / total,
                s2 / total,
            )
            after[p] = first[f]
            first[f] = p
    for f in range(count):
        p = first[f]
        while p >= 0:
            triangle[p] = f
            p = after[p]
