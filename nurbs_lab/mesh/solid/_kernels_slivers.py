"""Details of sharp edges that are smaller than a tolerance, taken off a closed mesh."""

import numpy as np
from numba import njit

from nurbs_lab.mesh.solid._kernels_ring import (
    MOST_NEIGHBOURS,
    after,
    area_vector,
    before,
    distance,
    keeps_side,
    neighbours_if_joinable,
    ring_of,
    turn_edge,
)

MOST_PASSES = 10  # over all triangles
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
def collapse(vertices, triangles, opposite, alive, moved, marks, mark, h):
    """Move the tail of half-edge h to its head, if the mesh stays one surface; whether that was done."""
    halves, ring = np.empty(MOST_NEIGHBOURS, np.int64), np.empty(MOST_NEIGHBOURS, np.int64)
    back = opposite[h]
    u, v = triangles[h // 3, h % 3], triangles[back // 3, back % 3]
    count = ring_of(triangles, opposite, h, halves, ring)
    if count > MOST_NEIGHBOURS or not neighbours_if_joinable(
        triangles, opposite, back, ring, count, marks, mark
    ):
        return False
    for j in range(1, count - 1):
        old = area_vector(vertices, u, ring[j], ring[j + 1])
        if not keeps_side(old, area_vector(vertices, v, ring[j], ring[j + 1])):
            return False
    for c in (h, back):
        a, b = opposite[after(c)], opposite[before(c)]
        opposite[a], opposite[b] = b, a
        alive[c // 3] = False
    for j in range(1, count - 1):
        triangles[halves[j] // 3, halves[j] % 3] = v
    moved[v] = max(moved[v], moved[u] + distance(vertices, u, v))
    return True


@njit(cache=True, nogil=True)
def turn(vertices, triangles, opposite, h):
    """Turn the longest edge h of a sliver, if both new triangles are higher; whether that was done."""
    halves, ring = np.empty(MOST_NEIGHBOURS, np.int64), np.empty(MOST_NEIGHBOURS, np.int64)
    f, g, back = h // 3, opposite[h] // 3, opposite[h]
    u, v = triangles[f, h % 3], triangles[g, back % 3]
    a, b = triangles[f, before(h) % 3], triangles[g, before(back) % 3]
    size = ring_of(triangles, opposite, before(h), halves, ring)
    if size > MOST_NEIGHBOURS:
        return False
    for j in range(size):
        if ring[j] == b:
            return False
    first, second = np.array([a, u, b]), np.array([b, v, a])
    lowest = min(height_and_longest(vertices, triangles[f])[0], height_and_longest(vertices, triangles[g])[0])
    if not min(height_and_longest(vertices, first)[0], height_and_longest(vertices, second)[0]) > (
        BETTER * lowest
    ):
        return False
    old = area_vector(vertices, v, u, b)
    if not (
        keeps_side(old, area_vector(vertices, a, u, b)) and keeps_side(old, area_vector(vertices, b, v, a))
    ):
        return False
    turn_edge(triangles, opposite, h)
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
