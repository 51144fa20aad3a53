"""Cubic least-squares splines along polylines, with knots only where the tolerance needs them."""

import numpy as np
from numba import njit

from nurbs_lab.nurbs.span_kernels import kernel

MIDDLE = 0.1  # weight of the middle of a step, of that of a point
ENDS = 1e8  # weight of both ends, which are on the spline
FEWER = 10  # of so many knots one is left out at a time


@kernel
def surroundings(t, nodes, k):
    """The knots about span k, from two before it to two after it, and the inverse lengths between them."""
    last = len(nodes) - 1
    a, b = t[nodes[max(k - 2, 0)]], t[nodes[max(k - 1, 0)]]
    c, d = t[nodes[k]], t[nodes[k + 1]]
    e, f = t[nodes[min(k + 2, last)]], t[nodes[min(k + 3, last)]]
    wide, wider = (1.0 / (d - c), 1.0 / (d - b), 1.0 / (e - c)), (1.0 / (d - a), 1.0 / (e - b), 1.0 / (f - c))
    return (a, b, c, d, e, f), wide + wider


@kernel
def basis(knots, inverse, at):
    """Values of the four cubic basis functions of a span with these `surroundings`."""
    a, b, c, d, e, f = knots
    here, left = at - c, d - at
    low, high = left * inverse[0] * inverse[1], here * inverse[0] * inverse[2]
    one, three = left * low * inverse[3], here * high * inverse[5]
    two = ((at - b) * low + (e - at) * high) * inverse[4]
    return left * one, (at - a) * one + (e - at) * two, (at - b) * two + (f - at) * three, here * three


@njit(cache=True, nogil=True)
def least_squares(t, points, nodes):
    """Values and derivatives ``(m, 3)`` at its m nodes of the cubic spline nearest to a polyline.

    The middles of the steps have a smaller weight than the points. The normal equations have seven diagonals,
    four of which are kept, and are solved by elimination.
    """
    n, m = len(points), len(nodes)
    rows, right = np.zeros((m + 2, 4)), np.zeros((m + 2, 3))
    k, (knots, inverse) = 0, surroundings(t, nodes, 0)
    for i in range(2 * n - 1):
        j, half = i // 2, i % 2
        if half == 0 and j == nodes[k + 1] and j < n - 1:
            k += 1
            knots, inverse = surroundings(t, nodes, k)
        at = 0.5 * (t[j] + t[j + half])
        weight = MIDDLE if half else ENDS if j == 0 or j == n - 1 else 1.0
        values = basis(knots, inverse, at)
        for a in range(4):
            factor = weight * values[a]
            for b in range(a, 4):
                rows[k + a, b - a] += factor * values[b]
            for d in range(3):
                right[k + a, d] += 0.5 * factor * (points[j, d] + points[j + half, d])
    for i in range(m + 2):
        for a in range(1, min(4, m + 2 - i)):
            factor = rows[i, a] / rows[i, 0]
            for b in range(a, 4):
                rows[i + a, b - a] -= factor * rows[i, b]
            for d in range(3):
                right[i + a, d] -= factor * right[i, d]
    for i in range(m + 1, -1, -1):
        for d in range(3):
            for a in range(1, min(4, m + 2 - i)):
                right[i, d] -= rows[i, a] * right[i + a, d]
            right[i, d] /= rows[i, 0]
    right[0], right[-1] = points[0], points[-1]
    return at_nodes(t, nodes, right)


@njit(cache=True, nogil=True)
def at_nodes(t, nodes, control):
    """Values and derivatives at the knots of the spline with these control points."""
    m = len(nodes)
    values, slopes = np.empty((m, 3)), np.empty((m, 3))
    for j in range(m):
        here, last = t[nodes[j]], m - 1
        first, before = here - t[nodes[max(j - 2, 0)]], here - t[nodes[max(j - 1, 0)]]
        after, final = t[nodes[min(j + 1, last)]] - here, t[nodes[min(j + 2, last)]] - here
        for d in range(3):
            low = (after * control[j, d] + first * control[j + 1, d]) / (first + after)
            high = (final * control[j + 1, d] + before * control[j + 2, d]) / (before + final)
            values[j, d] = (after * low + before * high) / (before + after)
            slopes[j, d] = 3.0 * (high - low) / (before + after)
    return values, slopes


@kernel
def between(t, nodes, values, slopes, k, at, d):
    """Coordinate d of the spline at parameter ``at`` of span k (cubic Hermite form)."""
    width = t[nodes[k + 1]] - t[nodes[k]]
    x = (at - t[nodes[k]]) / width
    p0, p1 = values[k, d], values[k + 1, d]
    step = p1 - p0
    low, high = width * slopes[k, d] - step, step - width * slopes[k + 1, d]
    return p0 + x * step + x * (1.0 - x) * ((1.0 - x) * low + x * high)


@kernel
def off_step(points, i, x, y, z):
    """Squared distance of (x, y, z) from step i of a polyline."""
    x0, y0, z0 = points[i, 0], points[i, 1], points[i, 2]
    dx, dy, dz = points[i + 1, 0] - x0, points[i + 1, 1] - y0, points[i + 1, 2] - z0
    x, y, z = x - x0, y - y0, z - z0
    part = min(max((x * dx + y * dy + z * dz) / (dx * dx + dy * dy + dz * dz), 0.0), 1.0)
    return (x - part * dx) ** 2 + (y - part * dy) ** 2 + (z - part * dz) ** 2


@njit(cache=True, nogil=True)
def missed(t, points, nodes, values, slopes, tolerance):
    """The point at which each span is farthest from the polyline, -1 where it is within the tolerance."""
    out, last = np.full(len(nodes) - 1, -1), len(points) - 1
    for k in range(len(out)):
        worst = tolerance * tolerance
        for i in range(nodes[k], nodes[k + 1] + 1):
            x = between(t, nodes, values, slopes, k, t[i], 0)
            y = between(t, nodes, values, slopes, k, t[i], 1)
            z = between(t, nodes, values, slopes, k, t[i], 2)
            miss = (x - points[i, 0]) ** 2 + (y - points[i, 1]) ** 2 + (z - points[i, 2]) ** 2
            if miss > worst:
                miss = off_step(points, max(i - 1, 0), x, y, z)
                miss = min(miss, off_step(points, min(i, last - 1), x, y, z))
            if miss > worst:
                worst, out[k] = miss, i
    return out


@njit(cache=True, nogil=True)
def fit(t, points, tolerance, taken, times):
    """Numbers of the points at which the spline has knots, and its values and derivatives there.

    The spline with knots at the points ``taken (n,)`` is tried first, with as many more as it needs. Then
    every tenth knot is left out, and those with a span beside them that is too far from the polyline now are
    put back. This is repeated until each knot was left out so many ``times``.
    """
    taken[0] = taken[-1] = True
    split(t, points, tolerance, taken)
    for turn in range(times * FEWER):
        left_out = np.flatnonzero(taken)[1 + turn % FEWER : -1 : FEWER]
        taken[left_out] = False
        nodes = np.flatnonzero(taken)
        wrong = missed(t, points, nodes, *least_squares(t, points, nodes), tolerance)
        for i in left_out:
            span = np.searchsorted(nodes, i) - 1
            taken[i] = wrong[max(span - 1, 0) : span + 2].max() >= 0
    return split(t, points, tolerance, taken)


@njit(cache=True, nogil=True)
def split(t, points, tolerance, taken):
    """The spline of `fit`, with further knots: a span that is too far away is split in its middle third."""
    while True:
        nodes = np.flatnonzero(taken)
        values, slopes = least_squares(t, points, nodes)
        wrong = missed(t, points, nodes, values, slopes, tolerance)
        spans = np.flatnonzero((wrong >= 0) & (np.diff(nodes) > 1))
        if not len(spans):
            return nodes, values, slopes
        low, high = nodes[spans], nodes[spans + 1]
        third = (high - low + 1) // 3
        taken[np.minimum(np.maximum(wrong[spans], low + third), high - third)] = True


@njit(cache=True, nogil=True)
def samples(t, nodes, values, slopes, counts):
    """Points of the spline: step i is cut into ``counts[i]`` equal parts, and their midpoints are taken."""
    out = np.empty((counts.sum(), 3))
    k, row = 0, 0
    for i in range(len(counts)):
        while nodes[k + 1] <= i:
            k += 1
        for j in range(counts[i]):
            at = t[i] + (j + 0.5) * (t[i + 1] - t[i]) / counts[i]
            for d in range(3):
                out[row, d] = between(t, nodes, values, slopes, k, at, d)
            row += 1
    return out


@kernel
def curvature(t, nodes, values, slopes, k, i):
    """Larger curvature of span k at the two ends of step i; the parameter is nearly the arc length."""
    largest, width = 0.0, t[nodes[k + 1]] - t[nodes[k]]
    for end in range(2):
        x, square = (t[i + end] - t[nodes[k]]) / width, 0.0
        for d in range(3):
            step = (values[k + 1, d] - values[k, d]) / width
            low, high = slopes[k, d] - step, step - slopes[k + 1, d]
            square += (2.0 * ((3.0 * x - 2.0) * low + (1.0 - 3.0 * x) * high) / width) ** 2
        largest = max(largest, square)
    return np.sqrt(largest)


@njit(cache=True, nogil=True)
def b_spline(t, values, slopes):
    """Knots and control points of the spline with these values and derivatives at the parameters ``t``.

    Every control point is a value of the blossom of one span.
    """
    m = len(t)
    knots, control = np.empty(m + 6), np.empty((m + 2, 3))
    knots[:3], knots[3:-3], knots[-3:] = t[0], t, t[-1]
    for i in range(m + 2):
        k = min(max(i - 2, 0), m - 2)
        width = t[k + 1] - t[k]
        a, b, c = knots[i + 1] - t[k], knots[i + 2] - t[k], knots[i + 3] - t[k]
        for d in range(3):
            step = (values[k + 1, d] - values[k, d]) / width
            low, high = slopes[k, d] - step, step - slopes[k + 1, d]
            # p0 + x step + x (w - x) ((w - x) low + x high) / w**2, as powers of x
            square, cube = (high - 2.0 * low) / width, (low - high) / width**2
            linear = values[k, d] + slopes[k, d] * (a + b + c) / 3.0
            control[i, d] = linear + square * (a * b + b * c + c * a) / 3.0 + cube * a * b * c
    control[0], control[-1] = values[0], values[-1]
    return knots, control
