"""Edges of a closed mesh turned to the other diagonal until its triangles are nearly those of Delaunay.

Half-edges are numbered as in `_kernels_layout`.
"""

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined
from nurbs_lab.mesh._kernels_core import after, before
from nurbs_lab.mesh._kernels_distance import dot, less
from nurbs_lab.mesh.solid._kernels_ring import (
    MOST_NEIGHBOURS,
    TRACE,
    area_vector,
    keeps_side,
    ring_of,
)


@inlined
def fatter(v, a, b, c, d, limit, cosine):
    """Whether triangles (a, c, b) and (c, a, d) are fatter with the edge b d, and much the same surface.

    The angles at b and d are more than half a turn together, the triangles turn by less than an angle of this
    ``cosine`` and do not turn over, and the edges a c and b d are at most ``limit`` apart.
    """
    here, there = area_vector(v, a, c, b), area_vector(v, c, a, d)
    sine_b, sine_d = np.sqrt(dot(here, here)), np.sqrt(dot(there, there))
    cosine_b, cosine_d = dot(less(v[a], v[b]), less(v[c], v[b])), dot(less(v[a], v[d]), less(v[c], v[d]))
    sizes = np.sqrt((sine_b**2 + cosine_b**2) * (sine_d**2 + cosine_d**2))
    if not sine_b * cosine_d + sine_d * cosine_b < -TRACE * sizes:
        return False
    total = here[0] + there[0], here[1] + there[1], here[2] + there[2]
    return (
        dot(here, there) >= cosine * sine_b * sine_d
        and keeps_side(total, area_vector(v, a, d, b))
        and keeps_side(total, area_vector(v, d, c, b))
        and abs(dot(here, less(v[d], v[a]))) <= limit * np.sqrt(dot(total, total))
    )


@compiled
def joinable(triangles, opposite, h, d, halves, ring):
    """Whether both ends of half-edge h have more than three neighbours, and its apex is not joined to d."""
    for start in (h, opposite[h]):
        if ring_of(triangles, opposite, start, halves, ring) <= 3:
            return False
    size = ring_of(triangles, opposite, before(h), halves, ring)
    for j in range(min(size, MOST_NEIGHBOURS)):
        if ring[j] == d:
            return False
    return size <= MOST_NEIGHBOURS


@compiled
def flip(vertices, triangles, opposite, limit, cosine):
    """Turn edges in place where that makes triangles `fatter`.

    In a plane that comes to an end (Lawson 1977); elsewhere after twenty looks at every edge at most.
    """
    m = 3 * len(triangles)
    halves, ring = np.empty(MOST_NEIGHBOURS + 1, np.int64), np.empty(MOST_NEIGHBOURS + 1, np.int64)
    queue, waits = np.arange(m), np.ones(m, np.bool_)
    begin, left = 0, m
    while left > 0 and begin < 20 * m:
        h = queue[begin % m]
        begin, left, waits[h] = begin + 1, left - 1, False
        o, p, q = opposite[h], before(h), before(opposite[h])
        a, c = triangles[h // 3, h % 3], triangles[o // 3, o % 3]
        b, d = triangles[p // 3, p % 3], triangles[q // 3, q % 3]
        if not fatter(vertices, a, b, c, d, limit, cosine):
            continue
        if not joinable(triangles, opposite, h, d, halves, ring):
            continue
        triangles[h // 3, h % 3], triangles[o // 3, o % 3] = d, b
        beside_p, beside_q = opposite[p], opposite[q]
        opposite[h], opposite[beside_q], opposite[o], opposite[beside_p] = beside_q, h, beside_p, o
        opposite[p], opposite[q] = q, p
        for k in (h, after(h), o, after(o)):
            if not waits[k]:
                queue[(begin + left) % m] = k
                left, waits[k] = left + 1, True
