"""Cubic least-squares splines along polylines, with knots only where the tolerance needs them."""

import numpy as np

from nurbs_lab.common.kernels import ZERO, compiled
from nurbs_lab.nurbs._kernels import basis_functions
from nurbs_lab.nurbs._kernels_band import normal_equations, solve_band

CUBIC = ZERO + 3  # the degree, not a literal
FEWER = 5  # of so many knots one is left out at a time


@compiled
def beside(nodes, changed):
    """The spans in which the spline may change: those with changed steps, and three on each side of them."""
    out = np.zeros(len(nodes) - 1, np.bool_)
    for k in range(len(out)):
        if changed[nodes[k] : nodes[k + 1]].any():
            out[max(k - 3, 0) : k + 4] = True
    return out


@compiled
def held(spans):
    """The control points that act on a span that may not change."""
    out = np.zeros(len(spans) + 3, np.bool_)
    for k in range(len(spans)):
        if not spans[k]:
            out[k : k + 4] = True
    return out


@compiled
def nearest(t, points, nodes, spans, fixed):
    """Knots and control points of the cubic spline nearest to a polyline, with knots at its points ``nodes``.

    The middles of the steps have a tenth of the weight of the points. Control points that act on other spans
    than ``spans`` are ``fixed``.
    """
    last, dim = len(nodes) - 1, points.shape[1]
    knots, count, m = np.empty(last + 7), last + 3, 0
    for i in range(len(knots)):
        knots[i] = t[nodes[min(max(i - 3, 0), last)]]
    sites, values, weights = np.empty(2 * len(t)), np.empty((2 * len(t), dim)), np.empty(2 * len(t))
    for k in range(last):
        if spans[k]:
            for i in range(2 * nodes[k], 2 * nodes[k + 1]):
                j = (i + 1) // 2
                weights[m], sites[m] = 0.1 if i % 2 else 1.0, 0.5 * (t[i // 2] + t[j])
                for d in range(dim):
                    values[m, d] = 0.5 * (points[i // 2, d] + points[j, d])
                m += 1
    rows, right = normal_equations(CUBIC, knots, sites[:m], values[:m], weights[:m], count)
    stay, m = held(spans), 0
    for i in range(count):
        if stay[i] or i == 0 or i == count - 1:
            rows[i] = 0.0
            rows[i, 3] = 1.0
            for d in range(dim):
                right[i, d] = fixed[m, d] if stay[i] else points[0 if i == 0 else -1, d]
            m += stay[i]
    solve_band(rows, CUBIC, right)
    return knots, right


@compiled
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


@compiled
def missed(t, points, nodes, spans, knots, control, tolerance):
    """The point at which each of ``spans`` is farthest from the steps beside it, -1 within the tolerance."""
    out, place, basis = np.full(len(spans), -1), np.empty(points.shape[1]), np.empty(4)
    left, right = np.empty(4), np.empty(4)
    for k in range(len(spans)):
        worst = tolerance * tolerance
        if not spans[k]:
            continue
        for i in range(nodes[k], nodes[k + 1] + 1):
            basis_functions(k + 3, CUBIC, knots, t[i], basis, left, right)
            miss = 0.0
            for d in range(len(place)):
                place[d] = 0.0
                for j in range(4):
                    place[d] += basis[j] * control[k + j, d]
                miss += (place[d] - points[i, d]) ** 2
            if miss > worst:
                miss = min(off_step(points, i - 1, place), off_step(points, i, place))
            if miss > worst:
                worst, out[k] = miss, i
    return out


@compiled
def along(t, points, tolerance, kept, control, changed):
    """Knots, control points and changed steps of a spline within the tolerance of a polyline at parameters t.

    It is the spline with knots at the points ``kept`` and these control points but for the steps ``changed``
    and few beside them. There, a span that is too far away is split in its middle third. Then every fifth
    knot is left out, and those with a span beside them that is too far from the polyline now are put back.
    This is repeated until each knot was left out once.
    """
    old, turn = np.flatnonzero(kept), -1
    while True:
        every = np.flatnonzero(kept)
        for k in range(len(every) - 1):
            changed[every[k] : every[k + 1]] = changed[every[k] : every[k + 1]].any()
        leave = 0 <= turn < FEWER
        if leave:
            for i in every[1 + turn : -1 : FEWER]:
                kept[i] = not (changed[i - 1] and changed[i])
        nodes = np.flatnonzero(kept)
        spans = beside(nodes, changed)
        knots, new = nearest(t, points, nodes, spans, control[held(beside(old, changed))])
        wrong, again, left_out = missed(t, points, nodes, spans, knots, new, tolerance), leave, 0
        for k in range(len(wrong)):
            low, high = nodes[k], nodes[k + 1]
            while every[left_out] <= low:
                left_out += 1
            if leave and every[left_out] < high:
                worst = max(wrong[max(k - 1, 0)], wrong[k], wrong[min(k + 1, len(wrong) - 1)])
                kept[every[left_out]] = worst >= 0
            elif not leave and wrong[k] >= 0 and not changed[low]:
                again, changed[low:high] = True, True
            elif not leave and wrong[k] >= 0 and high > low + 1:
                again, third = True, (high - low + 1) // 3
                kept[min(max(wrong[k], low + third), high - third)] = True
        if leave or not again:
            turn += 1
        if turn > FEWER:
            for k in range(len(spans)):
                changed[nodes[k] : nodes[k + 1]] = spans[k]
            return knots, new, changed
