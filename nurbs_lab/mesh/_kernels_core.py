"""Hot loops that build the weighted graph, on plain arrays.

Half-edge ``3 f + e`` runs from corner e of triangle f to its next corner. Its weight in Eq. (1) of the paper
is the sum of the numbers of its two corners.
"""

from math import atan2, floor, sqrt, tau

import numpy as np
from numba.extending import register_jitable

from nurbs_lab.common.kernels import compiled, inlined
from nurbs_lab.mesh._kernels_distance import cross, dot, less

BOUNDARY, MANY, AGAINST = 1, 2, 3  # kinds of half-edges, see `MeshGraph`; 0 is a regular one
SAME_ANGLE = 1e-9
FEW = 32  # half-edges that are compared each with each; more are sorted first


@register_jitable
def after(h):
    """The next half-edge of the same triangle."""
    return h - h % 3 + (h + 1) % 3


@register_jitable
def before(h):
    """The half-edge before in the same triangle."""
    return h - h % 3 + (h + 2) % 3


@compiled
def weld(points, triangles, junk):
    """Make equal rows of ``points (n, 3)`` one, where -0.0 is 0.0, and renumber the corners, all in place.

    Triangles that repeat a corner are junk. Returns the number of distinct points, in order of appearance.
    """
    n, count, size = len(points), 0, 16
    while size < 2 * n:
        size *= 2
    table, number = np.full(size, -1, np.int32), np.empty(n, np.int32)
    bits = points.view(np.uint64)
    for i in range(n):
        for d in range(3):
            points[i, d] += 0.0
        a, b, c = bits[i, 0], bits[i, 1], bits[i, 2]
        h = a * np.uint64(0x9E3779B97F4A7C15)
        h = ((h ^ (h >> np.uint64(29))) + b) * np.uint64(0xBF58476D1CE4E5B9)
        h = ((h ^ (h >> np.uint64(32))) + c) * np.uint64(0x94D049BB133111EB)
        slot = np.int64((h ^ (h >> np.uint64(31))) & np.uint64(size - 1))
        while table[slot] >= 0:
            j = table[slot]
            if bits[j, 0] == a and bits[j, 1] == b and bits[j, 2] == c:
                break
            slot = (slot + 1) & (size - 1)
        if table[slot] < 0:
            table[slot] = count
            bits[count, 0], bits[count, 1], bits[count, 2] = a, b, c
            count += 1
        number[i] = table[slot]
    for f in range(len(triangles)):
        a, b, c = number[triangles[f, 0]], number[triangles[f, 1]], number[triangles[f, 2]]
        triangles[f, 0], triangles[f, 1], triangles[f, 2] = a, b, c
        junk[f] = a == b or b == c or c == a
    return count


@compiled
def pair_fan(fan, triangles, vertices, body, low, high, opposite):
    """Pair the half-edges of a non-manifold edge so that a pair encloses material; an odd one stays alone.

    Seen along the edge, a triangle whose half-edge runs low -> high has its material clockwise of it, the
    others counter-clockwise. So going round, the second kind opens a wedge of material and the first kind
    closes it. Two of one body are a pair where there are two, so that bodies that touch stay apart.
    """
    k = len(fan)
    closes, turns = np.empty(k, np.bool_), np.empty(k)
    axis = less(vertices[high], vertices[low])
    size = max(sqrt(dot(axis, axis)), 1e-300)  # nothing is paired where no place is known
    for i in range(k):
        f, e = fan[i] // 3, fan[i] % 3
        closes[i] = triangles[f, e] == low
        out = less(vertices[triangles[f, (e + 2) % 3]], vertices[low])
        if i == 0:  # the two directions across the edge from which angles are measured
            along, normal = dot(out, axis) / size / size, cross(axis, out)
            first = less(out, (along * axis[0], along * axis[1], along * axis[2]))
            second = (normal[0] / size, normal[1] / size, normal[2] / size)
        turn = atan2(dot(out, second), dot(out, first)) % tau
        turn = turn if turn < tau - SAME_ANGLE else 0.0
        turns[i] = 2.0 * floor(turn / SAME_ANGLE + 0.5)
        if closes[i]:  # before one opens, and in the other order, so that the last opened closes first
            turns[i] -= 1.0 + i / (2.0 * k)
    order = np.argsort(turns, kind="mergesort")
    opened = np.empty(2 * k, np.int64)
    for others_too in range(2):
        depth = 0
        for i in range(2 * k):
            half = fan[order[i % k]]
            if opposite[half] >= 0:
                continue
            if not closes[order[i % k]]:
                if i < k:
                    opened[depth] = half
                    depth += 1
                continue
            at = depth - 1
            while at >= 0 and not others_too and body[opened[at] // 3] != body[half // 3]:
                at -= 1
            if at >= 0:
                opposite[half], opposite[opened[at]] = opened[at], half
                depth -= 1
                for j in range(at, depth):
                    opened[j] = opened[j + 1]


@inlined
def edges_by_vertex(triangles, junk, count):
    """Half-edges side by side by their lower vertex, and where those of each of ``count`` vertices begin.

    A half-edge is stored with ``2 * higher vertex + direction``; the direction is 1 if it runs from the
    higher vertex to the lower.
    """
    offsets = np.zeros(count + 1, np.int32)
    for f in range(len(triangles)):
        if not junk[f]:
            for e in range(3):
                offsets[min(triangles[f, e], triangles[f, (e + 1) % 3]) + 1] += 1
    for v in range(len(offsets) - 1):
        offsets[v + 1] += offsets[v]
    place = offsets[:-1].copy()
    edges = np.empty((offsets[-1], 2), np.int32)
    for f in range(len(triangles)):
        if not junk[f]:
            for e in range(3):
                a, b = triangles[f, e], triangles[f, (e + 1) % 3]
                low = min(a, b)
                edges[place[low], 0] = 3 * f + e
                edges[place[low], 1] = 2 * a + 1 if a > b else 2 * b
                place[low] += 1
    return edges, offsets


@compiled
def link(triangles, vertices, body, junk, opposite, kinds):
    """The opposite and the kind of every half-edge, as in `MeshGraph`; how many are irregular."""
    opposite[:] = -1
    kinds[:] = 0
    irregular = 0
    edges, offsets = edges_by_vertex(triangles, junk, len(vertices))
    for v in range(len(offsets) - 1):
        i, stop = offsets[v], offsets[v + 1]
        if stop - i > FEW:
            order, unsorted = np.argsort(1.0 * edges[i:stop, 1], kind="mergesort"), edges[i:stop].copy()
            for k in range(stop - i):
                edges[i + k, 0], edges[i + k, 1] = unsorted[order[k], 0], unsorted[order[k], 1]
        while i < stop:
            one, key = edges[i, 0], edges[i, 1]
            end = stop
            if stop - i > FEW:  # they are sorted
                end = i + 1
                while end < stop and edges[end, 1] >> 1 == key >> 1:
                    end += 1
            count, other = 0, i
            for j in range(i, end):  # without a branch, which no processor could predict
                same = edges[j, 1] >> 1 == key >> 1
                count += same
                other = j if same else other
            if count == 1:
                kinds[one] = BOUNDARY
            elif count == 2:
                two = edges[other, 0]
                opposite[one], opposite[two] = two, one
                if key == edges[other, 1]:
                    kinds[one], kinds[two] = AGAINST, AGAINST
                    irregular += 2
                edges[other, 0], edges[other, 1] = edges[i + 1, 0], edges[i + 1, 1]
            else:
                irregular += count
                link_fan(edges[i:end], key >> 1, triangles, vertices, body, v, opposite, kinds)
            i += count
    return irregular


@compiled
def link_fan(edges, high, triangles, vertices, body, low, opposite, kinds):
    """Pair the half-edges of one non-manifold edge, which are moved to the front."""
    count = 0
    for j in range(len(edges)):
        if edges[j, 1] >> 1 == high:
            half, key = edges[j, 0], edges[j, 1]
            edges[j, 0], edges[j, 1] = edges[count, 0], edges[count, 1]
            edges[count, 0], edges[count, 1] = half, key
            count += 1
    fan, order = np.empty(count, np.int32), np.argsort(1.0 * edges[:count, 0], kind="mergesort")
    for k in range(count):
        fan[k] = edges[order[k], 0]
        kinds[fan[k]] = MANY
    pair_fan(fan, triangles, vertices, body, low, high, opposite)


@compiled
def rims(opposite):
    """The open half-edges of a mesh of one winding, and the open one that follows each around its hole."""
    halves = np.flatnonzero(opposite < 0)
    around = np.empty_like(halves)
    for i in range(len(halves)):
        half = after(halves[i])
        while opposite[half] >= 0:
            half = after(opposite[half])
        around[i] = half
    return halves, around
