"""The triangles around a vertex of a mesh: their order, their flat picture, the cost of a collapse."""

from collections import namedtuple

import numpy as np
from numba.extending import register_jitable

from nurbs_lab.common.kernels import compiled, inlined
from nurbs_lab.mesh._kernels_core import after, before
from nurbs_lab.mesh._kernels_distance import cross, dot, less

MOST_NEIGHBOURS = 400
FREE, ON_CURVE, CORNER = 0, 1, 2
# A mesh while it is coarsened. Of the vertices: places, kinds, a half-edge that leaves each. Of the
# triangles: corners, and which are left. Of the half-edges: the opposite one, whether they are sharp, the
# half-edge of the whole mesh with which their sharp curve begins, and its length.
Coarse = namedtuple("Coarse", "vertices kinds out triangles alive opposite sharp begin length")
LEAST_COSINE = 0.2  # between the normals of a triangle before and after a change
SPREAD = 5e-3  # of the squared length of an edge, in the cost of its collapse
TRACE = 1e-4  # by which numbers part equal sizes: rotation and rounding change sizes by less


@register_jitable
def untied(number):
    """A factor near 1 that differs from number to number, so that equal sizes have an order of their own."""
    return 1.0 + TRACE * (0.5 + 0.5 * np.sin(number))


@compiled
def ring_of(triangles, opposite, start, halves, ring):
    """Half-edges that leave a vertex, counter-clockwise from ``start``, and their heads; their number."""
    h = start
    count = 0
    while True:
        if count == MOST_NEIGHBOURS:
            return MOST_NEIGHBOURS + 1
        halves[count] = h
        ring[count] = triangles[h // 3, (h + 1) % 3]
        count += 1
        h = opposite[before(h)]
        if h == start:
            return count


@compiled
def distance(vertices, a, b):
    """Distance of two vertices."""
    step = less(vertices[a], vertices[b])
    return np.sqrt(dot(step, step))


@compiled
def area_vector(vertices, a, b, c):
    """Twice the area of a triangle, along its normal."""
    return cross(less(vertices[b], vertices[a]), less(vertices[c], vertices[a]))


@inlined
def keeps_side(old, new):
    """Whether two area vectors point about the same way."""
    return dot(old, new) > LEAST_COSINE * np.sqrt(dot(old, old) * dot(new, new))


@inlined
def neighbours_if_joinable(triangles, opposite, start, ring, count, marks, mark):
    """Number of neighbours of the tail of ``start``; 0 if collapsing a vertex into it leaves no surface.

    ``ring`` holds the ``count`` neighbours of the other vertex. The two must have two neighbours in common.
    """
    halves, mine = np.empty(MOST_NEIGHBOURS, np.int64), np.empty(MOST_NEIGHBOURS, np.int64)
    size = ring_of(triangles, opposite, start, halves, mine)
    if size > MOST_NEIGHBOURS:
        return 0
    for j in range(size):
        marks[mine[j]] = mark
    common = 0
    for j in range(count):
        common += marks[ring[j]] == mark
    return 0 if common != 2 or (count == 3 and size == 3) else size


@inlined
def quadrics_of(vertices, triangles):
    """Area-weighted quadrics of the vertices: ten coefficients, and the weight in the last column."""
    quadrics = np.zeros((len(vertices), 11))
    for f in range(len(triangles)):
        a, b, c = triangles[f]
        vector = area_vector(vertices, a, b, c)
        area = np.sqrt(dot(vector, vector))
        if area == 0.0:
            continue
        x, y, z = vector[0] / area, vector[1] / area, vector[2] / area
        d = -dot((x, y, z), vertices[a])
        terms = (x * x, x * y, x * z, x * d, y * y, y * z, y * d, z * z, z * d, d * d, 1.0)
        for v in (a, b, c):
            for k in range(10):
                quadrics[v, k] += area * terms[k]
            quadrics[v, 10] += area
    return quadrics


@inlined
def cost_of(vertices, quadrics, weight, u, v):
    """Mean squared distance of v to the planes collapsed into u and v, and a trace of the length."""
    x, y, z = vertices[v]
    total = 0.0
    for q in (quadrics[u], quadrics[v]):
        total += (
            q[0] * x * x + q[4] * y * y + q[7] * z * z
            + 2.0 * (q[1] * x * y + q[2] * x * z + q[5] * y * z + q[3] * x + q[6] * y + q[8] * z)
            + q[9]
        )  # fmt: skip
    length = distance(vertices, u, v)
    error = max(total, 0.0) / (quadrics[u, 10] + quadrics[v, 10] + 1e-300)
    return max(weight[u], weight[v]) * (error + SPREAD * length * length)


@inlined
def flatten(vertices, ring, count, other, x, y):
    """Ring around a vertex in the plane, the first neighbour on the positive x axis.

    ``other`` is the place in the ring where a sharp curve leaves that enters at place 0, or 0 if there is
    none: both sides of the curve are then flattened to half a turn.
    """
    u = ring[count]
    angles = np.empty(count)
    for j in range(count):
        a, b = ring[j], ring[(j + 1) % count]
        first, second, across = distance(vertices, u, a), distance(vertices, u, b), distance(vertices, a, b)
        cosine = (first * first + second * second - across * across) / (2.0 * first * second + 1e-300)
        angles[j] = np.arccos(min(1.0, max(-1.0, cosine))) + 1e-6
    stop = other if other > 0 else count
    low, turn = 0, 0.0
    while low < count:
        power = (np.pi if other > 0 else 2.0 * np.pi) / angles[low:stop].sum()
        for j in range(low, stop):
            radius = distance(vertices, u, ring[j]) ** min(power, 2.0)
            x[j], y[j] = radius * np.cos(turn), radius * np.sin(turn)
            turn += power * angles[j]
        low, stop = stop, count
    if other > 0:
        y[other] = 0.0


@inlined
def least_sine(x1, y1, x2, y2):
    """Sine of the smallest angle of a triangle with one corner at the origin; negative if turned over."""
    product = x1 * y2 - y1 * x2
    a, b, c = np.hypot(x1, y1), np.hypot(x2, y2), np.hypot(x2 - x1, y2 - y1)
    return product / (max(a * b, b * c, a * c) + 1e-300)


@inlined
def sector_size(opposite, sharp, start):
    """Triangles around the tail of half-edge ``start`` that no sharp edge parts from its triangle."""
    count = 1
    h = start
    while True:
        h = opposite[before(h)]
        if h == start:
            return count
        if sharp[h]:
            break
        count += 1
    h = start
    while not sharp[h]:
        h = after(opposite[h])
        count += 1
    return count


@compiled
def leaves_enough(mesh, h):
    """Whether the apex of the triangle of half-edge h may lose this triangle.

    A smooth vertex keeps four triangles, and one on a sharp curve keeps two on each side: with fewer, a
    patch would have a straight angle for a corner.
    """
    apex = before(h)
    kind = mesh.kinds[mesh.triangles[apex // 3, apex % 3]]
    if kind == CORNER:
        return True
    return sector_size(mesh.opposite, mesh.sharp, apex) > (4 if kind == FREE else 2)
