"""Cubic least-squares splines along polylines, with knots only where the tolerance needs them."""

import numpy as np
from numba import njit

from nurbs_lab.nurbs._kernels import basis_table
from nurbs_lab.nurbs._kernels_band import fit_open

MIDDLE = 0.1  # weight of the middle of a step, of that of a point
FEWER = 5  # of so many knots one is left out at a time


@njit(cache=True, nogil=True)
def nearest(t, points, nodes):
    """Knots and control points of the cubic spline nearest to a polyline, with knots at its points ``nodes``.

    The middles of the steps have a smaller weight than the points.
    """
    m, dim = 2 * len(t) - 1, points.shape[1]
    knots, sites, values, weights = np.empty(len(nodes) + 6), np.empty(m), np.empty((m, dim)), np.empty(m)
    for i in range(len(knots)):
        knots[i] = t[nodes[min(max(i - 3, 0), len(nodes) - 1)]]
    for i in range(m):
        j = (i + 1) // 2
        weights[i], sites[i] = MIDDLE if i % 2 else 1.0, 0.5 * (t[i // 2] + t[j])
        for d in range(dim):
            values[i, d] = 0.5 * (points[i // 2, d] + points[j, d])
    return knots, fit_open(3, knots, sites, values, weights)


@njit(cache=True, nogil=True)
def off_step(points, i, place):
    """Squared distance of a place from step i of a polyline, infinite if there is no such step."""
    along = square = off = 0.0
    if not 0 <= i < len(points) - 1:
        return np.inf
    for d in range(len(place)):
        step = points[i + 1, d] - points[i, d]
        along += step * (place[d] - points[i, d])
        square += step * step
    along = min(max(along / square, 0.0), 1.0)
    for d in range(len(place)):
        off += (place[d] - points[i, d] - along * (points[i + 1, d] - points[i, d])) ** 2
    return off


@njit(cache=True, nogil=True)
def missed(t, points, nodes, knots, control, tolerance):
    """The point at which each span is farthest from the steps beside it, -1 if within the tolerance."""
    first, table = basis_table(3, knots, t)
    out, place = np.full(len(nodes) - 1, -1), np.empty(points.shape[1])
    for k in range(len(out)):
        worst = tolerance * tolerance
        for i in range(nodes[k], nodes[k + 1] + 1):
            miss = 0.0
            for d in range(len(place)):
                place[d] = 0.0
                for j in range(4):
                    place[d] += table[i, j] * control[first[i] + j, d]
                miss += (place[d] - points[i, d]) ** 2
            if miss > worst:
                miss = min(off_step(points, i - 1, place), off_step(points, i, place))
            if miss > worst:
                worst, out[k] = miss, i
    return out


@njit(cache=True, nogil=True)
def along(t, points, tolerance):
    """Knots and control points of a spline within the tolerance of a polyline at the parameters t.

    A span that is too far away is split in its middle third, at first the whole. Then every fifth knot is
    left out, and those with a span beside them that is too far from the polyline now are put back. This is
    repeated until each knot was left out once.
    """
    kept = np.zeros(len(points), np.bool_)
    kept[0] = kept[-1] = True
    turn = -1
    while True:
        every = np.flatnonzero(kept)
        leave = 0 <= turn < FEWER
        if leave:
            kept[every[1 + turn : -1 : FEWER]] = False
        nodes = np.flatnonzero(kept)
        knots, control = nearest(t, points, nodes)
        wrong, again, left_out = missed(t, points, nodes, knots, control, tolerance), leave, 0
        for k in range(len(wrong)):
            low, high = nodes[k], nodes[k + 1]
            while every[left_out] <= low:
                left_out += 1
            if leave and every[left_out] < high:
                beside = max(wrong[max(k - 1, 0)], wrong[k], wrong[min(k + 1, len(wrong) - 1)])
                kept[every[left_out]] = beside >= 0
            elif not leave and wrong[k] >= 0 and high > low + 1:
                again, third = True, (high - low + 1) // 3
                kept[min(max(wrong[k], low + third), high - third)] = True
        if leave or not again:
            turn += 1
        if turn > FEWER:
            return knots, control
