"""Hot loops that build the weighted graph, on plain arrays.

An edge of a triangle is numbered by Eq. (1) of the paper less one: 0 joins corners 0 and 1, 1 joins corners
0 and 2, 2 joins corners 1 and 2. A half-edge is ``3 * triangle + edge``; in the winding of its triangle it
runs 0 -> 1, 2 -> 0 and 1 -> 2.
"""

import numpy as np
from numba import njit

TAIL = np.array([0, 2, 1])
HEAD = np.array([1, 0, 2])
FULL_TURN = 2.0 * np.pi
SAME_ANGLE = 1e-9


@njit(cache=True, nogil=True)
def weld(points):
    """Number the distinct rows of ``points (n, 3)``: ``(index of every row, first row of every number)``."""
    n = len(points)
    size = 16
    while size < 2 * n:
        size *= 2
    bits = points.view(np.uint64)
    table = np.full(size, -1, np.int32)
    index = np.empty(n, np.int32)
    first = np.empty(n, np.int32)
    count = 0
    for i in range(n):
        a, b, c = bits[i, 0], bits[i, 1], bits[i, 2]
        h = a * np.uint64(0x9E3779B97F4A7C15)
        h = ((h ^ (h >> np.uint64(29))) + b) * np.uint64(0xBF58476D1CE4E5B9)
        h = ((h ^ (h >> np.uint64(32))) + c) * np.uint64(0x94D049BB133111EB)
        slot = np.int64((h ^ (h >> np.uint64(31))) & np.uint64(size - 1))
        while table[slot] >= 0:
            j = first[table[slot]]
            if bits[j, 0] == a and bits[j, 1] == b and bits[j, 2] == c:
                break
            slot = (slot + 1) & (size - 1)
        if table[slot] < 0:
            table[slot] = count
            first[count] = i
            count += 1
        index[i] = table[slot]
    return index, first[:count].copy()


@njit(cache=True, nogil=True)
def sort_edges(triangles, skip, vertex_count):
    """Half-edges ordered by (lower, higher) vertex: two counting sorts, linear time."""
    order = np.empty(3 * len(triangles), np.int32)
    passes = np.empty_like(order)
    ends = np.zeros((2, vertex_count + 1), np.int32)
    for f in range(len(triangles)):
        if not skip[f]:
            for e in range(3):
                a, b = triangles[f, TAIL[e]], triangles[f, HEAD[e]]
                ends[0, max(a, b) + 1] += 1
                ends[1, min(a, b) + 1] += 1
    for v in range(vertex_count):
        ends[0, v + 1] += ends[0, v]
        ends[1, v + 1] += ends[1, v]
    used = ends[0, vertex_count]
    for f in range(len(triangles)):
        if not skip[f]:
            for e in range(3):
                v = max(triangles[f, TAIL[e]], triangles[f, HEAD[e]])
                passes[ends[0, v]] = 3 * f + e
                ends[0, v] += 1
    for i in range(used):
        half = passes[i]
        f, e = half // 3, half % 3
        v = min(triangles[f, TAIL[e]], triangles[f, HEAD[e]])
        order[ends[1, v]] = half
        ends[1, v] += 1
    return order[:used]


@njit(cache=True, nogil=True)
def pair_fan(fan, triangles, vertices, low, high, twins):
    """Pair the half-edges of a non-manifold edge so that a pair encloses material; an odd one stays alone.

    Seen along the edge, a triangle whose half-edge runs low -> high has its material clockwise of it, the
    others counter-clockwise. So going round, the second kind opens a wedge of material and the first kind
    closes it.
    """
    k = len(fan)
    axis = vertices[high] - vertices[low]
    axis /= np.sqrt(np.dot(axis, axis))
    angle = np.empty(k)
    closes = np.empty(k, np.bool_)
    zero = np.empty(3)
    for i in range(k):
        f, e = fan[i] // 3, fan[i] % 3
        closes[i] = triangles[f, TAIL[e]] == low
        across = vertices[triangles[f, 2 - e]] - vertices[low]
        across = across - np.dot(across, axis) * axis
        if i == 0:
            zero = across
        turn = np.arctan2(np.dot(axis, np.cross(zero, across)), np.dot(zero, across)) % FULL_TURN
        angle[i] = 0.0 if turn > FULL_TURN - SAME_ANGLE else turn
    order = np.argsort(angle, kind="mergesort")
    for i in range(1, k):
        j = i
        while j > 0 and closes[order[j]] and not closes[order[j - 1]]:
            if angle[order[j]] - angle[order[j - 1]] > SAME_ANGLE:
                break
            order[j], order[j - 1] = order[j - 1], order[j]
            j -= 1
    opened = np.empty(2 * k, np.int64)
    depth = 0
    for i in range(2 * k):
        half = fan[order[i % k]]
        if twins[half] >= 0:
            continue
        if not closes[order[i % k]]:
            if i < k:
                opened[depth] = half
                depth += 1
        elif depth > 0:
            depth -= 1
            twins[half] = opened[depth]
            twins[opened[depth]] = half


@njit(cache=True, nogil=True)
def link_edges(order, triangles, vertices):
    """Twin of every half-edge (-1: none) and its kind as in `MeshGraph.kinds`."""
    twins = np.full(3 * len(triangles), -1, np.int32)
    kind = np.zeros(3 * len(triangles), np.uint8)
    start = 0
    while start < len(order):
        f, e = order[start] // 3, order[start] % 3
        a, b = triangles[f, TAIL[e]], triangles[f, HEAD[e]]
        stop = start + 1
        while stop < len(order):
            g, d = order[stop] // 3, order[stop] % 3
            c, o = triangles[g, TAIL[d]], triangles[g, HEAD[d]]
            if min(a, b) != min(c, o) or max(a, b) != max(c, o):
                break
            stop += 1
        if stop == start + 1:
            kind[order[start]] = 1
        elif stop == start + 2:
            twins[order[start]] = order[start + 1]
            twins[order[start + 1]] = order[start]
            g, d = order[start + 1] // 3, order[start + 1] % 3
            if triangles[g, TAIL[d]] == a:
                kind[order[start]] = 3
                kind[order[start + 1]] = 3
        else:
            for i in range(start, stop):
                kind[order[i]] = 2
            pair_fan(order[start:stop], triangles, vertices, min(a, b), max(a, b), twins)
        start = stop
    return twins, kind
