"""Edges at which a cutter may touch a part."""

import numpy as np
from numba import njit

VALLEY = 1e-12  # fraction of the largest coordinate: a triangle higher above its neighbour makes a valley


@njit(cache=True, nogil=True)
def contact_edges(order, opposite, kinds, corners, normals):
    """Edges that belong to each triangle, see `Part`.

    Row i of ``corners (m, 9)`` and ``normals (m, 3)`` is that of triangle ``order[i]``; ``opposite`` and
    ``kinds`` are those of the half-edges of a `MeshGraph`.
    """
    place, edges = np.full(len(opposite) // 3, -1), np.zeros(len(order), np.uint8)
    place[order] = np.arange(len(order))
    least = VALLEY * np.abs(corners).max()
    for i in range(len(order)):
        for k in range(3):
            half = 3 * order[i] + k
            other = opposite[half]
            if other >= 0 and kinds[half] == 0:
                if other < half:
                    continue
                j, apex, above = place[other // 3], 3 * ((other + 2) % 3), 0.0
                for d in range(3):
                    above += normals[i, d] * (corners[j, apex + d] - corners[i, d])
                if normals[i, 2] * normals[j, 2] > 0.0 and np.sign(normals[i, 2]) * above > least:
                    continue
            edges[i] |= 1 << k
    return edges
