"""Coarsening of a closed mesh by edge collapses.

Half-edge ``3 f + e`` runs from corner e of triangle f to its next corner. Vertex u is collapsed into its
neighbour v: the ring of triangles around u is flattened by the power map z^a, which makes the angles at u add
up to a full turn, and the hole is filled by triangles that start at v and are not turned over there (MAPS:
Lee, Sweldens, Schröder, Cowsar and Dobkin 1998). The order of the collapses follows the quadric error
(Garland and Heckbert 1997). Every sharp half-edge knows with which half-edge of the mesh it begins.
"""

import heapq

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined
from nurbs_lab.mesh._kernels_core import after, before
from nurbs_lab.mesh.solid._kernels_ring import (
    FREE,
    MOST_NEIGHBOURS,
    ON_CURVE,
    area_vector,
    cost_of,
    distance,
    flatten,
    keeps_side,
    least_sine,
    leaves_enough,
    neighbours_if_joinable,
    quadrics_of,
    ring_of,
    untied,
)

LEAST_SINE = 0.1  # of an angle of a flattened triangle


@compiled
def allowed(mesh, ring, count, marks, mark, picture, other, least):
    """Whether the ring can be filled from its first neighbour: one surface still, and nothing turned over."""
    u, v = ring[count], ring[0]
    size = neighbours_if_joinable(mesh.triangles, mesh.opposite, mesh.out[v], ring, count, marks, mark)
    if size == 0 or (count + size - 4 > 12 and count > 4):
        return False
    if other > 0 and (other == 1 or other == count - 1):
        return False
    x, y = picture
    flatten(mesh.vertices, ring, count, other, x, y)
    for j in range(count):
        k = (j + 1) % count
        least = min(least, 0.99 * least_sine(x[j], y[j], x[k], y[k]))
    for j in range(1, count - 1):
        if not least_sine(x[j] - x[0], y[j] - y[0], x[j + 1] - x[0], y[j + 1] - y[0]) > max(least, 1e-6):
            return False
        old = area_vector(mesh.vertices, u, ring[j], ring[j + 1])
        if not keeps_side(old, area_vector(mesh.vertices, v, ring[j], ring[j + 1])):
            return False
    return True


@inlined
def remember(log, end, halves, picture, count):
    """Append a collapse to the log, which may become longer: half-edges and their flat picture; its end."""
    if end + count + 1 > len(log):
        longer = np.empty((2 * len(log) + count + 1, 3))
        for j in range(end):
            for k in range(3):
                longer[j, k] = log[j, k]
        log = longer
    for j in range(count):
        log[end + j, 0], log[end + j, 1], log[end + j, 2] = halves[j], picture[0, j], picture[1, j]
    log[end + count, 0] = count
    return log, end + count + 1


@inlined
def way_on(mesh, halves, ring, count, least_chord):
    """Where the sharp curve leaves a ring that enters it at place 0, 0 if none does, and its length.

    -1 if the chord of the curve would be shorter than ``least_chord`` times its length.
    """
    if mesh.kinds[ring[count]] != ON_CURVE:
        return 0, 0.0
    other = 0
    for j in range(1, count):
        if mesh.sharp[halves[j]]:
            other = j
    merged = mesh.length[halves[0]] + mesh.length[halves[other]]
    return (-1 if distance(mesh.vertices, ring[0], ring[other]) < least_chord * merged else other), merged


@inlined
def collapse(mesh, halves, count, other, merged):
    """Move the tail of half-edge ``halves[0]`` to its head; the ring around it is ``halves``."""
    h, back = halves[0], mesh.opposite[halves[0]]
    v = mesh.triangles[h // 3, (h + 1) % 3]
    if other > 0:
        mesh.begin[halves[other]] = mesh.begin[back]
        mesh.length[halves[other]] = mesh.length[mesh.opposite[halves[other]]] = merged
    for c, d in ((after(h), before(h)), (after(back), before(back))):
        a, b = mesh.opposite[c], mesh.opposite[d]
        if mesh.sharp[a]:
            mesh.begin[b], mesh.length[b] = mesh.begin[c], mesh.length[a]
        else:
            mesh.begin[a], mesh.length[a] = mesh.begin[d], mesh.length[b]
        mesh.opposite[a], mesh.opposite[b] = b, a
        mesh.sharp[a] = mesh.sharp[b] = mesh.sharp[a] or mesh.sharp[b]
        mesh.out[mesh.triangles[a // 3, a % 3]] = a
        mesh.out[mesh.triangles[b // 3, b % 3]] = b
    mesh.alive[h // 3] = mesh.alive[back // 3] = False
    for j in range(1, count - 1):
        mesh.triangles[halves[j] // 3, halves[j] % 3] = v
    mesh.out[v] = halves[1]


@compiled
def offer(mesh, quadrics, weight, stamp, h, most_cost, heap):
    """Add the collapse of the tail of a half-edge to the heap if it is possible at all and cheap enough."""
    u, v = mesh.triangles[h // 3, h % 3], mesh.triangles[h // 3, (h + 1) % 3]
    if mesh.kinds[u] == FREE or (mesh.kinds[u] == ON_CURVE and mesh.sharp[h]):
        cost = cost_of(mesh.vertices, quadrics, weight, u, v)
        if cost < most_cost:
            heapq.heappush(heap, (cost * untied(h), np.int64(h), stamp[u], stamp[v]))


@compiled
def coarsen(mesh, weight, most_cost, least_chord):
    """Collapse vertices for as long as the cost stays below ``most_cost``, a squared length.

    The chord of an edge is at least ``least_chord`` times the length of the sharp curve that it stands for.
    ``mesh`` is a `Coarse` and changes in place. Returns the log of collapses
    for `_kernels_feet.trace_back`. A collapse takes a vertex off, so there are fewer collapses than vertices.
    """
    weight, stamp = weight.copy(), np.zeros(len(mesh.vertices), np.int64)
    quadrics = quadrics_of(mesh.vertices, mesh.triangles)
    halves, ring = np.empty(MOST_NEIGHBOURS + 1, np.int64), np.empty(MOST_NEIGHBOURS + 1, np.int64)
    picture = np.empty((2, MOST_NEIGHBOURS))
    marks = np.full(len(mesh.vertices), -1, np.int64)
    left, step = len(mesh.triangles), 0
    log, end = np.empty((4 * left, 3)), 0
    last, least = -1, LEAST_SINE
    heap = [(0.0, np.int64(-1), np.int64(0), np.int64(0))]
    heap.pop()
    while True:
        if len(heap) == 0:  # what was not allowed may be so now
            if left == last and least < LEAST_SINE:
                return log[:end]
            least = LEAST_SINE / 2 if left == last else least  # where nothing else is left
            last = left
            for h in range(3 * len(mesh.triangles)):
                if mesh.alive[h // 3]:
                    offer(mesh, quadrics, weight, stamp, h, most_cost, heap)
            continue
        _, h, stamp_u, stamp_v = heapq.heappop(heap)
        u, v = mesh.triangles[h // 3, h % 3], mesh.triangles[h // 3, (h + 1) % 3]
        if not mesh.alive[h // 3] or stamp[u] != stamp_u or stamp[v] != stamp_v or left <= 4:
            continue
        count = ring_of(mesh.triangles, mesh.opposite, h, halves, ring)
        if count > MOST_NEIGHBOURS:
            continue
        ring[count] = u
        other, merged = way_on(mesh, halves, ring, count, least_chord)
        if other < 0 or not leaves_enough(mesh, h) or not leaves_enough(mesh, mesh.opposite[h]):
            continue
        step += 1
        if not allowed(mesh, ring, count, marks, step, picture, other, least):
            continue
        log, end = remember(log, end, halves, picture, count)
        collapse(mesh, halves, count, other, merged)
        left -= 2
        for k in range(quadrics.shape[1]):
            quadrics[v, k] += quadrics[u, k]
        weight[v] = max(weight[u], weight[v])
        stamp[v] = step  # never a value it had before
        size = ring_of(mesh.triangles, mesh.opposite, mesh.out[v], halves, ring)
        for j in range(size if size <= MOST_NEIGHBOURS else 0):
            offer(mesh, quadrics, weight, stamp, halves[j], most_cost, heap)
            offer(mesh, quadrics, weight, stamp, mesh.opposite[halves[j]], most_cost, heap)
