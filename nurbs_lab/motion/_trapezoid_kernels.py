"""Kernel of the trapezoid: fastest speeds under a speed limit that varies along the path.

It is one pass over v² as a function of length, backwards from the end, which looks at every node once. What
can be gained from the start is found by the same pass along the reversed path.

A *cone* is (A, κ): the acceleration along the path and the one across it, κ v², keep a² + (κ v²)² <= A².
"""

from math import sqrt

import numpy as np

from nurbs_lab.common.kernels import inlined, kernel


@kernel
def acceleration_range(square, tangent, curvature, cone, axis):
    """Accelerations along the path that keep the cone and every axis, at v² = square."""
    high = sqrt(max(cone[0] ** 2 - (cone[1] * square) ** 2, 0.0))
    low = -high
    for i in range(axis.size):
        t, shift = tangent[i], curvature[i] * square
        if abs(t) > 1e-12:
            one, two = (-axis[i] - shift) / t, (axis[i] - shift) / t
            low, high = max(low, min(one, two)), min(high, max(one, two))
    return low, high


@inlined
def _reach(cap, distance, beyond, floor, tangent, curvature, cone, axis):
    """Largest v² up to cap from which ``beyond`` is reached within the distance.

    ``floor`` is the least acceleration that the end of the distance allows. Every limit of an axis is linear
    in v², and the cone is a quadratic equation.
    """
    acceleration, kappa = cone
    best = min(cap, beyond - 2.0 * distance * max(floor, -acceleration))
    if kappa > 0.0 and best > beyond:
        double = 2.0 * distance
        factor = 1.0 + (double * kappa) ** 2
        room = double**2 * (acceleration**2 * factor - (kappa * beyond) ** 2)
        best = min(best, max((beyond + sqrt(max(room, 0.0))) / factor, min(cap, beyond)))
    for i in range(axis.size):
        t, n = abs(tangent[i]), curvature[i] * np.sign(tangent[i])
        if t > 1e-12:
            rate = t - 2.0 * distance * n  # of v² that is left when this axis brakes as hard as it may
            if rate > 0.0:
                best = min(best, (beyond * t + 2.0 * distance * axis[i]) / rate)
            if abs(n) * acceleration > kappa * axis[i]:  # some acceleration must suit this axis and the cone
                both = n * n + (t * kappa) ** 2
                most = sqrt(max(acceleration**2 * both - (kappa * axis[i]) ** 2, 0.0))
                best = min(best, (abs(n) * axis[i] + t * most) / both)
            for k in range(i):  # and each axis before it
                cross = abs(curvature[i] * tangent[k] - curvature[k] * tangent[i])
                if cross > 0.0 and abs(tangent[k]) > 1e-12:
                    best = min(best, (axis[i] * abs(tangent[k]) + axis[k] * t) / cross)
    return max(best, 0.0)


@kernel
def braking(lengths, caps, tangents, curvatures, axes, cones, end):
    """Largest v² from which everything that follows can be kept, from the end backwards.

    ``axes`` holds the limits of all axes at every node, ``cones`` its cone. A node more marks where braking
    starts inside a cell. Returns lengths, v² and the node before each.
    """
    n = lengths.size
    at, squares, nodes = np.empty(2 * n), np.empty(2 * n), np.empty(2 * n, dtype=np.int64)
    at[0], squares[0], nodes[0] = lengths[n - 1], min(end, caps[n - 1]), n - 1
    count = 1
    for i in range(n - 2, -1, -1):
        distance, beyond = lengths[i + 1] - lengths[i], squares[count - 1]
        here, there = (tangents[i], curvatures[i]), (tangents[i + 1], curvatures[i + 1])
        floor, most = acceleration_range(beyond, there[0], there[1], cones[i + 1], axes[i + 1])
        floor = min(floor, most)
        reach = _reach(caps[i], distance, beyond, floor, here[0], here[1], cones[i], axes[i])
        least, _ = acceleration_range(reach, here[0], here[1], cones[i], axes[i])
        least = max(least, floor)
        gap, fall = caps[i + 1] - beyond, caps[i + 1] - caps[i]
        if reach == caps[i] and gap > 1e-12 * caps[i + 1]:
            way = gap / (fall / distance - 2.0 * least)
            if 1e-9 * distance < way < (1.0 - 1e-9) * distance:
                at[count], nodes[count] = lengths[i + 1] - way, i
                squares[count] = beyond - 2.0 * least * way
                count += 1
        at[count], squares[count], nodes[count] = lengths[i], reach, i
        count += 1
    return at[:count][::-1].copy(), squares[:count][::-1].copy(), nodes[:count][::-1].copy()
