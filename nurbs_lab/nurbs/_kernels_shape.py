"""Blossoms (polar forms), on which insertion, refinement, splitting, clamping and degree elevation rest.

The control point j of a spline over any finer knot vector T is its polar form at T[j + 1 .. j + p]
(Ramshaw 1989). De Boor's recurrence computes it, one argument for each level.
"""

import numpy as np

from nurbs_lab.common.kernels import compiled
from nurbs_lab.nurbs._kernels import find_knot_span


@compiled
def blossom(span, degree, knots, rows, arguments, local):
    """Polar form of the polynomial piece on a span at ``degree`` arguments, left in ``local[degree]``.

    The largest argument comes first (Oslo order). The fractions then stay near [0, 1], and a control point
    that does not change is copied exactly.
    """
    columns = rows.shape[1]
    for j in range(degree + 1):
        for c in range(columns):
            local[j, c] = rows[span - degree + j, c]
    for level in range(1, degree + 1):
        a = arguments[degree - level]
        for j in range(degree, level - 1, -1):
            low = knots[span - degree + j]
            high = knots[span + 1 + j - level]
            fraction = (a - low) / (high - low)
            for c in range(columns):
                local[j, c] = (1.0 - fraction) * local[j - 1, c] + fraction * local[j, c]


@compiled
def refine(degree, knots, rows, finer):
    """Control rows of the same spline over ``finer`` knots, whose domain lies within the old one."""
    count = finer.size - degree - 1
    out = np.empty((count, rows.shape[1]))
    local = np.empty((degree + 1, rows.shape[1]))
    for j in range(count):
        span = find_knot_span(degree, knots, max(finer[j], knots[degree]))
        blossom(span, degree, knots, rows, finer[j + 1 : j + degree + 1], local)
        for c in range(rows.shape[1]):
            out[j, c] = local[degree, c]
    return out


@compiled
def elevate(degree, knots, rows, raised):
    """Control rows of the same spline one degree higher over ``raised`` knots (each break once more)."""
    count = raised.size - degree - 2
    out = np.zeros((count, rows.shape[1]))
    local = np.empty((degree + 1, rows.shape[1]))
    rest = np.empty(degree)
    for j in range(count):
        arguments = raised[j + 1 : j + degree + 2]
        span = find_knot_span(degree, knots, max(raised[j], knots[degree]))
        for left_out in range(degree + 1):
            for k in range(degree):
                rest[k] = arguments[k if k < left_out else k + 1]
            blossom(span, degree, knots, rows, rest, local)
            for c in range(rows.shape[1]):
                out[j, c] += local[degree, c]
        for c in range(rows.shape[1]):
            out[j, c] /= degree + 1
    return out
