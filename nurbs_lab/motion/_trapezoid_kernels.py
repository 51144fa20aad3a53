"""Kernels of the trapezoid: fastest speeds under a speed limit that varies along the path.

Two passes over v² as a function of length, the first backwards (braking), the second forwards. Each looks at
every node once, with at most 60 bisections.
"""

import numpy as np

from nurbs_lab.nurbs.span_kernels import kernel


@kernel
def acceleration_range(square, tangent, curvature, acceleration, axis):
    """Accelerations along the path that keep ``|a| <= acceleration`` and every axis, at v² = square."""
    low, high = -acceleration, acceleration
    for i in range(axis.size):
        t, shift = tangent[i], curvature[i] * square
        if abs(t) > 1e-12:
            one, two = (-axis[i] - shift) / t, (axis[i] - shift) / t
            low, high = max(low, min(one, two)), min(high, max(one, two))
    return low, high


@kernel
def _reach(cap, distance, beyond, floor, tangent, curvature, acceleration, axis):
    """Largest v² up to cap from which ``beyond`` is reached within the distance; a convex set: bisect.

    ``floor`` is the least acceleration that the end of the distance allows.
    """
    cap = min(cap, beyond + 2.0 * distance * acceleration)  # else halving a huge cap ends far too high
    low, high = 0.0, cap
    for trial in range(60):
        square = cap if trial == 0 else 0.5 * (low + high)
        least, most = acceleration_range(square, tangent, curvature, acceleration, axis)
        if least <= most + 1e-9 * acceleration and square + 2.0 * distance * max(least, floor) <= beyond:
            low = square
            if trial == 0:
                break
        else:
            high = square
    return low


@kernel
def braking(lengths, caps, tangents, curvatures, acceleration, axes, end):
    """Largest v² from which everything that follows can be kept, from the end backwards.

    ``axes`` holds the limits of all axes at every node. A node more marks where braking starts inside a cell.
    Returns lengths, v² and the node before each.
    """
    n = lengths.size
    at, squares, nodes = np.empty(2 * n), np.empty(2 * n), np.empty(2 * n, dtype=np.int64)
    at[0], squares[0], nodes[0] = lengths[n - 1], min(end, caps[n - 1]), n - 1
    count = 1
    for i in range(n - 2, -1, -1):
        distance = lengths[i + 1] - lengths[i]
        beyond = squares[count - 1]
        floor, most = acceleration_range(
            beyond, tangents[i + 1], curvatures[i + 1], acceleration, axes[i + 1]
        )
        floor = min(floor, most)
        reach = _reach(caps[i], distance, beyond, floor, tangents[i], curvatures[i], acceleration, axes[i])
        least, _ = acceleration_range(reach, tangents[i], curvatures[i], acceleration, axes[i])
        least = max(least, floor)
        gap = caps[i + 1] - beyond
        fall = caps[i + 1] - caps[i]
        if reach == caps[i] and gap > 1e-12 * caps[i + 1]:
            way = gap / (fall / distance - 2.0 * least)
            if 1e-9 * distance < way < (1.0 - 1e-9) * distance:
                at[count], squares[count], nodes[count] = (
                    lengths[i + 1] - way,
                    beyond - 2.0 * least * way,
                    i,
                )
                count += 1
        at[count], squares[count], nodes[count] = lengths[i], reach, i
        count += 1
    return at[:count][::-1].copy(), squares[:count][::-1].copy(), nodes[:count][::-1].copy()


@kernel
def starting(lengths, caps, nodes, tangents, curvatures, acceleration, axes, start):
    """Largest v² up to ``caps`` that can be gained from the start; a node more where gaining ends.

    Where a node inside a cell lies a little above what its axes allow, their least acceleration is taken.
    """
    n = lengths.size
    at, squares, behind = np.empty(2 * n), np.empty(2 * n), np.empty(2 * n, dtype=np.int64)
    at[0], squares[0], behind[0] = lengths[0], min(start, caps[0]), nodes[0]
    count = 1
    for i in range(n - 1):
        distance = lengths[i + 1] - lengths[i]
        square = squares[count - 1]
        node, following = nodes[i], nodes[i + 1]
        least, most = acceleration_range(square, tangents[node], curvatures[node], acceleration, axes[node])
        slope = (caps[i + 1] - caps[i]) / distance
        most = max(least, most)
        ahead = min(max(square + 2.0 * most * distance, 0.0), caps[i + 1])
        _, after = acceleration_range(
            ahead, tangents[following], curvatures[following], acceleration, axes[following]
        )
        most = max(least, min(most, after))
        ahead = square + 2.0 * most * distance
        if ahead > caps[i + 1]:
            way = max(caps[i] - square, 0.0) / (2.0 * most - slope)
            if 1e-9 * distance < way < (1.0 - 1e-9) * distance:
                at[count], squares[count], behind[count] = (
                    lengths[i] + way,
                    caps[i] + slope * way,
                    nodes[i],
                )
                count += 1
            ahead = caps[i + 1]
        at[count], squares[count], behind[count] = lengths[i + 1], max(ahead, 0.0), nodes[i + 1]
        count += 1
    return at[:count], squares[:count], behind[:count]
