"""Coarsening of a closed mesh by edge collapses.

Half-edge ``3 f + e`` runs from corner e of triangle f to its next corner. Vertex u is collapsed into its
neighbour v: the ring of triangles around u is flattened by the power map z^a, which makes the angles at u add
up to a full turn, and the hole is filled by triangles that start at v and are not turned over there (MAPS:
Lee, Sweldens, Schröder, Cowsar and Dobkin 1998). The order of the collapses follows the quadric error
(Garland and Heckbert 1997). Every sharp half-edge knows with which half-edge of the mesh it begins.
"""

import heapq

import numpy as np
from numba import njit

from nurbs_lab.mesh.solid._kernels_collapses import cheapest, first_costs
from nurbs_lab.mesh.solid._kernels_ring import (
    CORNER,
    FREE,
    LEAST_COSINE,
    MOST_NEIGHBOURS,
    ON_CURVE,
    after,
    area_vector,
    before,
    cost_of,
    distance,
    flatten,
    keeps_side,
    least_sine,
    leaves_enough,
    neighbours_if_joinable,
    quadrics_of,
    ring_of,
    sector_size,
    turn_edge,
    unfold,
)

MOST_ROUNDS = 8  # of collapses, with edges turned after each
LEAST_SINE = 0.1  # of an angle of a flattened triangle
LEAST_COSINE_ACROSS = -0.1  # between the normals of the mesh at the ends of an edge
LEAST_OPENING = 0.1  # sine of the angle between an edge and a sharp curve at their common end


@njit(cache=True, nogil=True)
def prune(count, tails, heads, length, shortest):
    """Which edges of a graph are left when chains with a free end shorter than ``shortest`` are taken off.

    Every round but the last takes an edge off, so there are at most as many rounds as edges.
    """
    m = len(tails)
    kept = np.ones(m, np.bool_)
    degree = np.zeros(count, np.int64)
    first = np.zeros(count + 1, np.int64)
    for e in range(m):
        first[tails[e] + 1] += 1
        first[heads[e] + 1] += 1
    degree[:] = first[1:]
    first = np.cumsum(first)
    fill = first[:-1].copy()
    edges = np.empty(2 * m, np.int64)
    for e in range(m):
        for v in (tails[e], heads[e]):
            edges[fill[v]] = e
            fill[v] += 1
    chain = np.empty(m, np.int64)
    changed = True
    while changed:
        changed = False
        for end in range(count):
            if degree[end] != 1:
                continue
            v, size, total = end, 0, 0.0
            while True:
                for k in range(first[v], first[v + 1]):
                    e = edges[k]
                    if kept[e] and (size == 0 or e != chain[size - 1]):
                        break
                chain[size] = e
                size += 1
                total += length[e]
                v = heads[e] if tails[e] == v else tails[e]
                if degree[v] != 2:
                    break
            if total < shortest:
                for k in range(size):
                    kept[chain[k]] = False
                    degree[tails[chain[k]]] -= 1
                    degree[heads[chain[k]]] -= 1
                changed = True
    return kept


@njit(cache=True, nogil=True)
def opposed(normals, kinds, a, b):
    """Whether two free vertices face too different ways to be the ends of an edge."""
    cosine = normals[a, 0] * normals[b, 0] + normals[a, 1] * normals[b, 1] + normals[a, 2] * normals[b, 2]
    return kinds[a] == FREE and kinds[b] == FREE and cosine < LEAST_COSINE_ACROSS


@njit(cache=True, nogil=True)
def inward_of(vertices, triangles, sharp):
    """Unit vectors across the sharp half-edges of a mesh, within their triangles; zeros of the others."""
    inward = np.zeros((len(sharp), 3))
    for h in np.flatnonzero(sharp):
        a, b, c = triangles[h // 3, h % 3], triangles[h // 3, (h + 1) % 3], triangles[h // 3, (h + 2) % 3]
        along, across = vertices[b] - vertices[a], vertices[c] - vertices[a]
        across -= (along * across).sum() / ((along * along).sum() + 1e-300) * along
        inward[h] = across / (np.sqrt((across * across).sum()) + 1e-300)
    return inward


@njit(cache=True, nogil=True)
def leaves_curve(vertices, curves, begin, end, tail, head, apex):
    """Whether two sides of a triangle leave the sharp curve that its third one stands for, on the right side.

    ``begin`` and ``end`` are the half-edges of the mesh with which the curve begins at its tail, and at its
    head on the other side.
    """
    inward, opposite = curves
    for v, across in ((tail, inward[begin]), (head, inward[opposite[end]])):
        away = vertices[apex] - vertices[v]
        if (away * across).sum() < LEAST_OPENING * np.sqrt((away * away).sum()):
            return False
    return True


@njit(cache=True, nogil=True)
def leaves_side(vertices, curves, opposite, sharp, begin, side, tail, head, apex):
    """Whether two sides of a triangle leave its third one, half-edge ``side``; True if that is not sharp."""
    return not sharp[side] or leaves_curve(
        vertices, curves, begin[side], begin[opposite[side]], tail, head, apex
    )


@njit(cache=True, nogil=True)
def beside_curves(vertices, curves, opposite, sharp, begin, halves, ring, count, other):
    """Whether all triangles that fill a ring from its first neighbour leave the sharp curves along them."""
    v, back = ring[0], opposite[halves[0]]
    for j in range(1, count - 1):
        side = after(halves[j])
        if not leaves_side(vertices, curves, opposite, sharp, begin, side, ring[j], ring[j + 1], v):
            return False
    first, last = after(halves[0]), before(back)
    if not leaves_side(vertices, curves, opposite, sharp, begin, first, v, ring[1], ring[2]):
        return False
    if not leaves_side(vertices, curves, opposite, sharp, begin, last, ring[count - 1], v, ring[count - 2]):
        return False
    if other == 0:
        return True
    w = ring[other]
    from_v, from_w = begin[back], begin[opposite[halves[other]]]  # the curve through u
    return leaves_curve(vertices, curves, from_v, from_w, v, w, ring[other + 1]) and leaves_curve(
        vertices, curves, from_w, from_v, w, v, ring[other - 1]
    )


@njit(cache=True, nogil=True)
def allowed(vertices, normals, kinds, triangles, opposite, out, ring, count, marks, mark, x, y, other):
    """Whether the ring can be filled from its first neighbour: one surface still, and nothing turned over."""
    u, v = ring[count], ring[0]
    size = neighbours_if_joinable(triangles, opposite, out[v], ring, count, marks, mark)
    if size == 0 or (count + size - 4 > 12 and count > 4):
        return False
    if other > 0 and (other == 1 or other == count - 1):
        return False
    flatten(vertices, ring, count, other, x, y)
    least = LEAST_SINE
    for j in range(count):
        k = (j + 1) % count
        least = min(least, 0.99 * least_sine(x[j], y[j], x[k], y[k]))
    for j in range(1, count - 1):
        if not least_sine(x[j] - x[0], y[j] - y[0], x[j + 1] - x[0], y[j + 1] - y[0]) > max(least, 1e-6):
            return False
        old = area_vector(vertices, u, ring[j], ring[j + 1])
        if not keeps_side(old, area_vector(vertices, v, ring[j], ring[j + 1])):
            return False
        if j > 1 and opposed(normals, kinds, v, ring[j]):
            return False
    return True


@njit(cache=True, nogil=True)
def remember(log, end, halves, x, y, count, mark):
    """Append a change to the log, half-edges and their flat picture; the log, larger if need be, its end."""
    if end + count + 1 > len(log):
        longer = np.empty((2 * len(log) + count + 1, 3))
        longer[:end] = log[:end]
        log = longer
    for j in range(count):
        log[end + j, 0], log[end + j, 1], log[end + j, 2] = halves[j], x[j], y[j]
    log[end + count, 0] = mark
    return log, end + count + 1


@njit(cache=True, nogil=True)
def flip_edges(
    vertices, normals, curves, triangles, opposite, alive, sharp, begin, length, kinds, out, log, end,
):  # fmt: skip
    """Turn edges inside their two triangles where that widens the smallest angle; their number, the log."""
    turned = 0
    x, y = np.empty(4), np.empty(4)
    halves, ring = np.empty(MOST_NEIGHBOURS + 1, np.int64), np.empty(MOST_NEIGHBOURS + 1, np.int64)
    for h in range(3 * len(triangles)):
        across = opposite[h]
        if not alive[h // 3] or across < h or sharp[h]:
            continue
        f, g = h // 3, across // 3
        u, v = triangles[f, h % 3], triangles[g, across % 3]
        a, b = triangles[f, before(h) % 3], triangles[g, before(across) % 3]
        unfold(vertices, u, v, a, b, x, y)
        now = min(least_sine(x[1], y[1], x[2], y[2]), least_sine(x[3], y[3], x[1], y[1]))
        then = min(
            least_sine(x[3] - x[2], y[3] - y[2], x[1] - x[2], y[1] - y[2]),
            least_sine(x[0] - x[2], y[0] - y[2], x[3] - x[2], y[3] - y[2]),
        )
        if not then > 1.05 * max(now, 1e-3) or opposed(normals, kinds, a, b):
            continue
        first, second = area_vector(vertices, u, v, a), area_vector(vertices, v, u, b)
        third, fourth = area_vector(vertices, u, b, a), area_vector(vertices, v, a, b)
        along, sizes = 0.0, 0.0
        for k in range(3):
            along += (first[k] + second[k]) * (third[k] + fourth[k])
            sizes += (first[k] + second[k]) ** 2
        inner = third[0] * fourth[0] + third[1] * fourth[1] + third[2] * fourth[2]
        if along <= LEAST_COSINE * sizes or inner <= 0.0:
            continue
        enough = True
        for w, start in ((u, h), (v, across)):
            if kinds[w] != CORNER:
                enough &= sector_size(opposite, sharp, start) > (4 if kinds[w] == FREE else 2)
        if not enough:
            continue
        leaves = True
        for side, apex in ((before(h), b), (after(across), a), (before(across), a), (after(h), b)):
            tail, head = triangles[side // 3, side % 3], triangles[side // 3, after(side) % 3]
            leaves &= leaves_side(vertices, curves, opposite, sharp, begin, side, tail, head, apex)
        if not leaves:
            continue
        size = ring_of(triangles, opposite, out[a], halves, ring)
        joined = size > 14
        for j in range(size):
            joined |= ring[j] == b
        if joined or ring_of(triangles, opposite, out[b], halves, ring) > 14:
            continue
        halves[0], halves[1], halves[2], halves[3] = h, across, -1, -1
        log, end = remember(log, end, halves, x, y, 4, -4)
        old = turn_edge(triangles, opposite, h)
        new = np.array([3 * f, 3 * f + 1, 3 * g, 3 * g + 1])
        sharp[new], begin[new], length[new] = sharp[old], begin[old], length[old]
        sharp[3 * f + 2] = sharp[3 * g + 2] = False
        out[a], out[u], out[b], out[v] = 3 * f, 3 * f + 1, 3 * g, 3 * g + 1
        turned += 1
    return turned, log, end


@njit(cache=True, nogil=True)
def coarsen(vertices, normals, triangles, opposite, sharp, kinds, weight, most_cost, least_chord):
    """Collapse vertices for as long as the cost stays below ``most_cost``, in mm squared.

    The chord of an edge is at least ``least_chord`` times the length of the sharp curve that it stands for.
    ``triangles``, ``opposite`` and ``sharp`` (of half-edges) are changed in place. Returns which triangles
    are left, for every half-edge the half-edge of the mesh with which its sharp curve begins, and the log of
    changes for `_kernels_feet.trace_back`. A collapse takes a vertex off, so there are fewer collapses than
    vertices.
    """
    n, m = len(vertices), len(triangles)
    alive = np.ones(m, np.bool_)
    weight = weight.copy()
    stamp = np.zeros(n, np.int64)
    out = np.empty(n, np.int64)
    begin, length = np.arange(3 * m), np.empty(3 * m)
    for f in range(m):
        for e in range(3):
            out[triangles[f, e]] = 3 * f + e
            length[3 * f + e] = distance(vertices, triangles[f, e], triangles[f, (e + 1) % 3])
    curves = inward_of(vertices, triangles, sharp), opposite.copy()
    quadrics = quadrics_of(vertices, triangles)
    halves, ring = np.empty(MOST_NEIGHBOURS + 1, np.int64), np.empty(MOST_NEIGHBOURS + 1, np.int64)
    x, y = np.empty(MOST_NEIGHBOURS), np.empty(MOST_NEIGHBOURS)
    marks = np.full(n, -1, np.int64)
    left = m
    step = 0
    log, end = np.empty((4 * m, 3)), 0
    rounds, last, turned = 0, -1, 0
    heap = [(0.0, np.int64(-1), np.int64(0), np.int64(0))]
    heap.pop()
    found, limit = heap[:0], 0.0
    while True:
        if len(heap) == 0:
            heap, found, limit = cheapest(found, triangles, alive, stamp)
        if len(heap) == 0:  # turn edges; what was not allowed may be so then
            if last >= 0:
                turned, log, end = flip_edges(
                    vertices, normals, curves, triangles, opposite, alive, sharp, begin, length, kinds, out,
                    log, end,
                )  # fmt: skip
            rounds += 1
            if (left == last and turned == 0) or rounds > MOST_ROUNDS:
                break
            last = left
            found = first_costs(vertices, quadrics, weight, triangles, alive, sharp, kinds, stamp, most_cost)
            heap, found, limit = cheapest(found, triangles, alive, stamp)
            if len(heap) == 0:
                continue
        cost, h, stamp_u, stamp_v = heapq.heappop(heap)
        if not alive[h // 3]:
            continue
        u, v = triangles[h // 3, h % 3], triangles[h // 3, (h + 1) % 3]
        if stamp[u] != stamp_u or stamp[v] != stamp_v or left <= 4:
            continue
        count = ring_of(triangles, opposite, h, halves, ring)
        if count > MOST_NEIGHBOURS:
            continue
        ring[count] = u
        other = 0
        if kinds[u] == ON_CURVE:
            for j in range(1, count):
                if sharp[halves[j]]:
                    other = j
            merged = length[h] + length[halves[other]]
            if distance(vertices, v, ring[other]) < least_chord * merged:
                continue
        if not leaves_enough(triangles, opposite, sharp, kinds, h):
            continue
        if not leaves_enough(triangles, opposite, sharp, kinds, opposite[h]):
            continue
        step += 1
        if not allowed(
            vertices, normals, kinds, triangles, opposite, out, ring, count, marks, step, x, y, other
        ):
            continue
        if not beside_curves(vertices, curves, opposite, sharp, begin, halves, ring, count, other):
            continue
        log, end = remember(log, end, halves, x, y, count, count)
        back = opposite[h]
        if other > 0:
            begin[halves[other]] = begin[back]
            length[halves[other]] = length[opposite[halves[other]]] = merged
        for c, d in ((after(h), before(h)), (after(back), before(back))):
            a, b = opposite[c], opposite[d]
            if sharp[a]:
                begin[b], length[b] = begin[c], length[a]
            else:
                begin[a], length[a] = begin[d], length[b]
            opposite[a], opposite[b] = b, a
            sharp[a] = sharp[b] = sharp[a] or sharp[b]
            out[triangles[a // 3, a % 3]] = a
            out[triangles[b // 3, b % 3]] = b
        alive[h // 3] = alive[back // 3] = False
        left -= 2
        for j in range(1, count - 1):
            triangles[halves[j] // 3, halves[j] % 3] = v
        out[v] = halves[1]
        quadrics[v] += quadrics[u]
        weight[v] = max(weight[u], weight[v])
        stamp[v] = step  # never a value it had before
        size = ring_of(triangles, opposite, out[v], halves, ring)
        if size > MOST_NEIGHBOURS:
            continue
        for j in range(size):
            w = ring[j]
            for a, b, g in ((v, w, halves[j]), (w, v, opposite[halves[j]])):
                if kinds[a] == FREE or (kinds[a] == ON_CURVE and sharp[g]):
                    cost = cost_of(vertices, quadrics, weight, a, b)
                    if cost < min(most_cost, limit):
                        heapq.heappush(heap, (cost, np.int64(g), stamp[a], stamp[b]))
                    elif cost < most_cost:
                        found.append((cost, np.int64(g), stamp[a], stamp[b]))
    return alive, begin, log[:end]
