"""Points that live on a mesh, taken back from a coarse mesh to the fine one.

Such a point is a triangle and three weights of its corners (its barycentric coordinates).
"""

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined


@inlined
def containing(px, py, u, v):
    """Which triangle from the origin to a side of a flat ring holds (u, v), or nearly so, and the weights."""
    best, place = -np.inf, 0
    s0, s1, s2 = 0.0, 0.0, 0.0
    for j in range(len(px)):
        k = (j + 1) % len(px)
        det = px[j] * py[k] - py[j] * px[k]
        if not det > 0.0:
            continue
        s, t = (u * py[k] - v * px[k]) / det, (px[j] * v - py[j] * u) / det
        least = min(s, t, 1.0 - s - t)
        if least > best:
            best, place, s0, s1, s2 = least, j, 1.0 - s - t, s, t
    return place, max(s0, 0.0), max(s1, 0.0), max(s2, 0.0)


@compiled
def trace_back(log, count, triangle, weights):
    """Undo collapses, last one first, for points on the coarse mesh, in place.

    ``log`` holds, for every collapse, its half-edges with the flat picture of its ring, and then their
    number. ``count`` is the number of triangles of the fine mesh.
    """
    first, after = np.full(count, -1), np.empty(len(triangle), np.int64)
    for p in range(len(triangle)):
        after[p] = first[triangle[p]]
        first[triangle[p]] = p
    end = len(log)
    while end > 0:
        size = int(log[end - 1, 0])
        start = end - 1 - size
        halves, px, py = (
            log[start : end - 1, 0].astype(np.int64),
            log[start : end - 1, 1],
            log[start : end - 1, 2],
        )
        end = start
        moved = -1
        for j in range(1, size - 1):
            f, e = halves[j] // 3, halves[j] % 3
            p, first[f] = first[f], -1
            while p >= 0:
                a, b, c = weights[p, e], weights[p, (e + 1) % 3], weights[p, (e + 2) % 3]
                weights[p, 0] = a * px[0] + b * px[j] + c * px[j + 1]
                weights[p, 1] = a * py[0] + b * py[j] + c * py[j + 1]
                following, after[p] = after[p], moved
                moved, p = p, following
        while moved >= 0:
            p, moved = moved, after[moved]
            place, a, b, c = containing(px, py, weights[p, 0], weights[p, 1])
            f, e, total = halves[place] // 3, halves[place] % 3, a + b + c
            weights[p, e], weights[p, (e + 1) % 3], weights[p, (e + 2) % 3] = a / total, b / total, c / total
            after[p] = first[f]
            first[f] = p
    for f in range(count):
        p = first[f]
        while p >= 0:
            triangle[p] = f
            p = after[p]
