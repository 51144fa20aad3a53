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
def add_time_of_cell(h, slowness, free, weight, i, place, nodal_model):
    """Add the time of a cell and its rooms to the model, as `_scurve_kernels` adds its own."""
    first, own, cross = nodal_model
    p, q = slowness[i], slowness[i + 1]
    mean = p * q / (p + q)
    short, shorter, needed = h * mean**2, h * mean**3, 2.0 * h * mean
    time, _ = time_of_cell(free, i, needed, place, weight)
    total = mean_x = mean_y = mean_z = mean_w = 0.0  # means times the total
    for again in range(2):  # the time follows: the mean of the conditions, by their steepness, is its own
        for k in range(1 + 2 * free.shape[1]):
            steep = 1.0 / (time - _least(free, i, k, needed, place))
            x, y, z, w = -short * p, -short * q, 0.0, 0.0
            if k > 0:
                row, sign = free[i, (k - 1) // 2], 1.0 if k % 2 else -1.0
                x, y, z, w = sign * row[0], sign * row[1], sign * row[2], sign * row[3]
            if again == 0:
                total, part = total + steep * steep, steep * steep
                mean_x, mean_y = mean_x + part * x, mean_y + part * y
                mean_z, mean_w = mean_z + part * z, mean_w + part * w
                continue
            for at, by_b, by_d in ((i, x, z), (i + 1, y, w)):
                first[at, 0] += weight * steep * by_b
                first[at, 1] += weight * steep * by_d
            x, y = steep * (x - mean_x / total), steep * (y - mean_y / total)
            z, w = steep * (z - mean_z / total), steep * (w - mean_w / total)
            for at, by_b, by_d in ((i, x, z), (i + 1, y, w)):
                own[at, 0] += weight * by_b * by_b
                own[at, 1] += weight * by_b * by_d
                own[at, 2] += weight * by_d * by_d
            for c, product in enumerate((x * y, x * w, z * y, z * w)):
                cross[i, c] += weight * product
    bent = weight / (time - needed)
    own[i, 0] += bent * p * p * (shorter + 0.5 * short * p)
    own[i + 1, 0] += bent * q * q * (shorter + 0.5 * short * q)
    cross[i, 0] += bent * shorter * p * q
