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
FEW = 32  # half-edges that are compared each with each; more are sorted first


@njit(cache=True, nogil=True)
def hash_points(points, hashes):
    """A hash of 64 bits of every row of ``points (n, 3)``, where -0.0 becomes 0.0: they are one place."""
    bits = points.view(np.uint64)
    for i in range(len(points)):
        for d in range(3):
            points[i, d] += 0.0
        h = bits[i, 0] * np.uint64(0x9E3779B97F4A7C15)
        h = ((h ^ (h >> np.uint64(29))) + bits[i, 1]) * np.uint64(0xBF58476D1CE4E5B9)
        h = ((h ^ (h >> np.uint64(32))) + bits[i, 2]) * np.uint64(0x94D049BB133111EB)
        hashes[i] = h ^ (h >> np.uint64(31))


@njit(cache=True, nogil=True)
def match_points(points, hashes, part, parts, earliest):
    """For the rows of ``points (n, 3)`` whose hash belongs to one part: the earliest row equal to each.

    Equal rows belong to one part, so every part can have a thread of its own.
    """
    n = len(points)
    size = 16
    while size * parts < 3 * n:
        size *= 2
    bits = points.view(np.uint64)
    mine, count = np.empty(n, np.int32), 0
    for i in range(n):  # without a branch, which no processor could predict
        mine[count] = i
        count += np.int64((hashes[i] >> np.uint64(32)) * np.uint64(parts) >> np.uint64(32)) == part
    table = np.full(size, -1, np.int32)
    for i in mine[:count]:
        a, b, c = bits[i, 0], bits[i, 1], bits[i, 2]
        slot = np.int64(hashes[i] & np.uint64(size - 1))
        while table[slot] >= 0:
            j = table[slot]
            if bits[j, 0] == a and bits[j, 1] == b and bits[j, 2] == c:
                break
            slot = (slot + 1) & (size - 1)
        if table[slot] < 0:
            table[slot] = i
        earliest[i] = table[slot]


@njit(cache=True, nogil=True)
def number_points(points, earliest):
    """The distinct rows in the order in which they come first, and the number of every row; in place."""
    count = 0
    for i in range(len(points)):
        if earliest[i] == i:
            if count < i:
                points[count] = points[i]
            earliest[i] = count
            count += 1
        else:
            earliest[i] = earliest[earliest[i]]
    return points[:count], earliest


@njit(cache=True, nogil=True)
def weld(triangles, index, junk):
    """Give the corners of triangles their new numbers, in place; triangles that repeat one are junk."""
    for f in range(len(triangles)):
        a, b, c = index[triangles[f, 0]], index[triangles[f, 1]], index[triangles[f, 2]]
        triangles[f, 0], triangles[f, 1], triangles[f, 2] = a, b, c
        junk[f] = a == b or b == c or c == a


@njit(cache=True, nogil=True)
def pair_fan(fan, triangles, vertices, low, high, opposite):
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
        if opposite[half] >= 0:
            continue
        if not closes[order[i % k]]:
            if i < k:
                opened[depth] = half
                depth += 1
        elif depth > 0:
            depth -= 1
            opposite[half] = opened[depth]
            opposite[opened[depth]] = half


@njit(cache=True, nogil=True)
def count_edges(triangles, junk, counts, opposite, kinds):
    """Count the half-edges that have each vertex as their lower one; as yet they are opposite to none."""
    counts[:] = 0
    for f in range(len(triangles)):
        opposite[f] = -1
        kinds[f] = 0
        if not junk[f]:
            for e in range(3):
                counts[min(triangles[f, TAIL[e]], triangles[f, HEAD[e]])] += 1


@njit(cache=True, nogil=True)
def places_from_counts(counts):
    """Turn the counts of every part and vertex into the first place of each, in place; the sum of all."""
    place = 0
    for v in range(counts.shape[1]):
        for part in range(len(counts)):
            count, counts[part, v] = counts[part, v], place
            place += count
    return place


@njit(cache=True, nogil=True)
def place_edges(triangles, junk, first, places, edges):
    """Half-edges of triangles numbered from ``first`` on, side by side by their lower vertex.

    ``places`` holds the next place of each vertex. A half-edge is stored with ``2 * higher vertex +
    direction``; the direction is 1 if it runs from the higher vertex to the lower.
    """
    for f in range(len(triangles)):
        if not junk[f]:
            for e in range(3):
                a, b = triangles[f, TAIL[e]], triangles[f, HEAD[e]]
                low = min(a, b)
                place = places[low]
                places[low] = place + 1
                edges[place, 0] = 3 * (first + f) + e
                edges[place, 1] = 2 * a + 1 if a > b else 2 * b


@njit(cache=True, nogil=True)
def link_edges(triangles, vertices, offsets, edges, first, last, opposite, kinds):
    """Link the half-edges whose lower vertex is in ``first .. last - 1``; how many are irregular.

    Those of vertex v are ``edges[offsets[v] : offsets[v + 1]]``; they change their order. Ranges of vertices
    share no half-edge, so each can have a thread of its own.
    """
    irregular = 0
    for v in range(first, last):
        i, stop = offsets[v], offsets[v + 1]
        if stop - i > FEW:
            edges[i:stop] = edges[i:stop][np.argsort(edges[i:stop, 1], kind="mergesort")]
        while i < stop:
            one, key = edges[i, 0], edges[i, 1]
            end = stop
            if stop - i > FEW:  # they are sorted
                end = i + np.searchsorted(edges[i:stop, 1], key | 1, side="right")
            count, other = 0, i
            for j in range(i, end):  # without a branch, which no processor could predict
                same = edges[j, 1] >> 1 == key >> 1
                count += same
                other = j if same else other
            if count == 1:
                kinds[one] = 1
            elif count == 2:
                two = edges[other, 0]
                opposite[one], opposite[two] = two, one
                if key == edges[other, 1]:
                    kinds[one], kinds[two] = 3, 3
                    irregular += 2
                edges[other, 0], edges[other, 1] = edges[i + 1, 0], edges[i + 1, 1]
            else:
                irregular += count
                link_fan(edges[i:end], key >> 1, triangles, vertices, v, opposite, kinds)
            i += count
    return irregular


@njit(cache=True, nogil=True)
def link_fan(edges, high, triangles, vertices, low, opposite, kinds):
    """Pair the half-edges of one non-manifold edge, which are moved to the front."""
    count = 0
    for j in range(len(edges)):
        if edges[j, 1] >> 1 == high:
            half, key = edges[j, 0], edges[j, 1]
            edges[j, 0], edges[j, 1] = edges[count, 0], edges[count, 1]
            edges[count, 0], edges[count, 1] = half, key
            count += 1
    fan = np.sort(edges[:count, 0])
    for half in fan:
        kinds[half] = 2
    pair_fan(fan, triangles, vertices, low, high, opposite)
