"""Kernels of a lower bound of the time with limited jerk: a convex problem with more freedom.

An acceleration changes by no more than its jerk times the time. Here the time of each cell is an unknown of
its own: not less than ``2 h / (v + v')`` with the speeds at its ends, which is a convex function of v² and
v'², but it may be more. The limits of jerk, of the path and of each axis, are then linear, and so the least
time of this problem is what no motion can beat. The method of `_scurve_kernels` finds it, with these times
in place of its own, and without limits of jerk: each cell takes the time that is best for it.

``free[i, k]`` are factors of v² at both ends of cell i and of its slopes at both: the cell takes no less
time than their sum, nor than minus their sum.
"""

from nurbs_lab.common.kernels import inlined, kernel

#: Steps to the time of a cell that is best for it.
_LONGER = 2


@kernel
def _least(free, i, k, needed, ends):
    """The time that a cell takes at least, by the k-th of its conditions."""
    if k == 0:
        return needed
    row = free[i, (k - 1) // 2]
    change = row[0] * ends[0] + row[1] * ends[1] + row[2] * ends[2] + row[3] * ends[3]
    return change if k % 2 else -change


@kernel
def time_of_cell(free, i, needed, ends, weight):
    """The time that is best for a cell, and the product of its rooms."""
    count, least, longer = 1 + 2 * free.shape[1], needed, weight
    for k in range(1, count):
        least = max(least, _least(free, i, k, needed, ends))
    for _ in range(_LONGER):  # least in time and barrier
        slope = curvature = 0.0
        for k in range(count):
            steep = weight / (least + longer - _least(free, i, k, needed, ends))
            slope += steep
            curvature += steep * steep
        longer += weight * (slope * slope - slope) / curvature
    room = 1.0
    for k in range(count):
        room *= least + longer - _least(free, i, k, needed, ends)
    return least + longer, room


@inlined
def add_time_of_cell(grid, free, weight, i, place, padded):
    """Add the time of a cell and its rooms to the model, as `_scurve_kernels` adds its own."""
    widths, joined, slowness = grid
    gradient, hessian = padded
    h, p, q = widths[i + 1], slowness[i], slowness[i + 1]
    mean = p * q / (p + q)
    first, second, needed = h * mean**2, h * mean**3, 2.0 * h * mean
    p0, p1 = h * joined[i], widths[i] * joined[i]
    q1, q2 = widths[i + 2] * joined[i + 1], h * joined[i + 1]
    time, _ = time_of_cell(free, i, needed, place, weight)
    total = middle_x = middle_y = middle_z = 0.0
    for again in range(2):  # the time follows: the mean of the conditions, by their steepness, is its own
        for k in range(1 + 2 * free.shape[1]):
            steep = 1.0 / (time - _least(free, i, k, needed, place))
            if k == 0:
                x, y, z = -first * p * p0, -first * (p * p1 + q * q1), -first * q * q2
            else:
                row, sign = free[i, (k - 1) // 2], 1.0 if k % 2 else -1.0
                left, right = 2.0 * joined[i] * row[2], 2.0 * joined[i + 1] * row[3]
                x, z = sign * (row[0] * p0 - left), sign * (row[1] * q2 + right)
                y = sign * (row[0] * p1 + row[1] * q1 + left - right)
            if again == 0:
                total += steep * steep
                middle_x += steep * steep * x
                middle_y += steep * steep * y
                middle_z += steep * steep * z
                continue
            for c, way in enumerate((x, y, z)):
                gradient[i + c] += weight * steep * way
            x, y, z = steep * (x - middle_x), steep * (y - middle_y), steep * (z - middle_z)
            for c, a, b, e in ((0, x, y, z), (1, y, z, 0.0), (2, z, 0.0, 0.0)):
                hessian[i + c, 0] += weight * a * a
                hessian[i + c, 1] += weight * a * b
                hessian[i + c, 2] += weight * a * e
        middle_x, middle_y, middle_z = middle_x / total, middle_y / total, middle_z / total
    bent = weight / (time - needed)
    pp, pq = bent * p * p * (second + 0.5 * first * p), bent * p * q * second
    qq = bent * q * q * (second + 0.5 * first * q)
    hessian[i, 0] += pp * p0 * p0
    hessian[i, 1] += p0 * (pp * p1 + pq * q1)
    hessian[i, 2] += pq * p0 * q2
    hessian[i + 1, 0] += pp * p1 * p1 + 2.0 * pq * p1 * q1 + qq * q1 * q1
    hessian[i + 1, 1] += q2 * (pq * p1 + qq * q1)
    hessian[i + 2, 0] += qq * q2 * q2
