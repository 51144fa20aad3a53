"""Details of sharp edges that are smaller than a tolerance, taken off a closed mesh."""

import numpy as np
from numba import njit

from nurbs_lab.mesh._kernels_ring import MOST_NEIGHBOURS, area_vector, distance, ring_of

MOST_PASSES = 10  # over all triangles
LEAST_COSINE = 0.2  # between the normals of a triangle before and after
BETTER = 1.05  # factor of the smallest height, from which an edge is turned


@njit(cache=True, nogil=True)
def height_and_longest(vertices, triangle):
    """Height of a triangle over its longest edge, and the corner where that edge starts."""
    x, y, z = area_vector(vertices, triangle[0], triangle[1], triangle[2])
    longest, where = 0.0, 0
    for e in range(3):
        length = distance(vertices, triangle[e], triangle[(e + 1) % 3])
        if length > longest:
            longest, where = length, e
    return np.sqrt(x * x + y * y + z * z) / max(longest, 1e-300), where


@njit(cache=True, nogil=True)
def keeps_side(vertices, old, new):
    """Whether a triangle faces about the same way after a change."""
    p, q = area_vector(vertices, old[0], old[1], old[2]), area_vector(vertices, new[0], new[1], new[2])
    along = p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
    sizes = (p[0] ** 2 + p[1] ** 2 + p[2] ** 2) * (q[0] ** 2 + q[1] ** 2 + q[2] ** 2)
    return along > LEAST_COSINE * np.sqrt(sizes)


@njit(cache=True, nogil=True)
def collapse(vertices, triangles, opposite, alive, moved, marks, mark, h):
    """Move the tail of half-edge h to its head, if the mesh stays one surface; whether that was done."""
    halves, ring = np.empty(MOST_NEIGHBOURS + 1, np.int64), np.empty(MOST_NEIGHBOURS + 1, np.int64)
    back = opposite[h]
    v = triangles[back // 3, back % 3]
    u = triangles[h // 3, h % 3]
    size = ring_of(triangles, opposite, back, halves, ring)
    if size > MOST_NEIGHBOURS:
        return False
    for j in range(size):
        marks[ring[j]] = mark
    count = ring_of(triangles, opposite, h, halves, ring)
    if count > MOST_NEIGHBOURS:
        return False
    common = 0
    for j in range(count):
        common += marks[ring[j]] == mark
    if common != 2 or (count == 3 and size == 3):
        return False
    old, new = np.empty(3, np.int64), np.empty(3, np.int64)
    for j in range(1, count - 1):
        old[0], old[1], old[2] = u, ring[j], ring[j + 1]
        new[0], new[1], new[2] = v, ring[j], ring[j + 1]
        if not keeps_side(vertices, old, new):
            return False
    for c in (h, back):
        a, b = opposite[c - c % 3 + (c + 1) % 3], opposite[c - c % 3 + (c + 2) % 3]
        opposite[a], opposite[b] = b, a
        alive[c // 3] = False
    for j in range(1, count - 1):
        triangles[halves[j] // 3, halves[j] % 3] = v
    moved[v] = max(moved[v], moved[u] + distance(vertices, u, v))
    return True


@njit(cache=True, nogil=True)
def turn(vertices, triangles, opposite, h):
    """Turn the longest edge h of a sliver, if both new triangles are higher; whether that was done."""
    halves, ring = np.empty(MOST_NEIGHBOURS + 1, np.int64), np.empty(MOST_NEIGHBOURS + 1, np.int64)
    across = opposite[h]
    f, g, e, d = h // 3, across // 3, h % 3, across % 3
    u, v, a, b = (
        triangles[f, e],
        triangles[f, (e + 1) % 3],
        triangles[f, (e + 2) % 3],
        triangles[g, (d + 2) % 3],
    )
    size = ring_of(triangles, opposite, 3 * f + (e + 2) % 3, halves, ring)
    if size > MOST_NEIGHBOURS:
        return False
    for j in range(size):
        if ring[j] == b:
            return False
    old = triangles[g].copy()
    first, second = np.array([a, u, b]), np.array([b, v, a])
    before = min(height_and_longest(vertices, triangles[f])[0], height_and_longest(vertices, old)[0])
    after = min(height_and_longest(vertices, first)[0], height_and_longest(vertices, second)[0])
    if not after > BETTER * before:
        return False
    if not (keeps_side(vertices, old, first) and keeps_side(vertices, old, second)):
        return False
    va, au = opposite[3 * f + (e + 1) % 3], opposite[3 * f + (e + 2) % 3]
    ub, bv = opposite[3 * g + (d + 1) % 3], opposite[3 * g + (d + 2) % 3]
    triangles[f], triangles[g] = first, second
    for mine, other in ((3 * f, au), (3 * f + 1, ub), (3 * g, bv), (3 * g + 1, va)):
        opposite[mine], opposite[other] = other, mine
    opposite[3 * f + 2], opposite[3 * g + 2] = 3 * g + 2, 3 * f + 2
    return True


@njit(cache=True, nogil=True)
def drop_slivers(vertices, triangles, opposite, degree, limit):
    """Collapse edges shorter than ``limit``, and turn the longest edges of triangles flatter than that.

    Only between vertices with sharp edges, ``degree`` of them; no vertex is moved farther than ``limit``.
    ``triangles`` and ``opposite`` change in place. Returns which triangles are left.
    """
    alive = np.ones(len(triangles), np.bool_)
    moved, marks = np.zeros(len(vertices)), np.full(len(vertices), -1, np.int64)
    mark = 0
    for _ in range(MOST_PASSES):
        changed = False
        for h in range(3 * len(triangles)):
            f, e = h // 3, h % 3
            u, v = triangles[f, e], triangles[f, (e + 1) % 3]
            if not alive[f] or degree[u] == 0 or degree[v] < degree[u]:
                continue
            if distance(vertices, u, v) + max(moved[u], moved[v]) < limit:
                mark += 1
                changed |= collapse(vertices, triangles, opposite, alive, moved, marks, mark, h)
        for f in range(len(triangles)):
            if not alive[f] or degree[triangles[f]].min() == 0:
                continue
            height, e = height_and_longest(vertices, triangles[f])
            if height < limit:
                changed |= turn(vertices, triangles, opposite, 3 * f + e)
        if not changed:
            break
    return alive
