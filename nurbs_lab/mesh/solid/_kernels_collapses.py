"""The edge collapses that a mesh allows, in the order of their cost."""

import heapq

import numpy as np
from numba import njit

from nurbs_lab.mesh.solid._kernels_ring import FREE, ON_CURVE, cost_of

CHEAPEST = 2.0  # times the least cost: collapses below it are sorted


@njit(cache=True, nogil=True)
def first_costs(mesh, quadrics, weight, stamp, most_cost):
    """All collapses that are cheap enough: cost, half-edge, and the stamps of its ends."""
    found = [(0.0, np.int64(-1), np.int64(0), np.int64(0))]
    found.pop()
    for h in range(3 * len(mesh.triangles)):
        u, v = mesh.triangles[h // 3, h % 3], mesh.triangles[h // 3, (h + 1) % 3]
        if mesh.alive[h // 3] and (mesh.kinds[u] == FREE or (mesh.kinds[u] == ON_CURVE and mesh.sharp[h])):
            cost = cost_of(mesh.vertices, quadrics, weight, u, v)
            if cost < most_cost:
                found.append((cost, np.int64(h), stamp[u], stamp[v]))
    return found


@njit(cache=True, nogil=True)
def cheapest(found, triangles, alive, stamp):
    """A heap of the collapses below a cost, the others, and that cost; those out of date are dropped.

    Most collapses are out of date before they are the cheapest ones. A heap of all of them would sort them in
    vain, and would not fit in the cache.
    """
    heap, count, least = found[:0], 0, np.inf
    for one in found:
        h = one[1]
        u, v = triangles[h // 3, h % 3], triangles[h // 3, (h + 1) % 3]
        if alive[h // 3] and stamp[u] == one[2] and stamp[v] == one[3]:
            found[count] = one
            count += 1
            least = min(least, one[0])
    kept, limit = 0, max(CHEAPEST * least, 1e-300)
    for k in range(count):
        one = found[k]
        if one[0] < limit:
            heap.append(one)
        else:
            found[kept] = one
            kept += 1
    heapq.heapify(heap)
    return heap, found[:kept], limit
