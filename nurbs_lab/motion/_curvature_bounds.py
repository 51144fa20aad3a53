"""Certified bounds of curvature on cells of a curve, from the Bernstein coefficients of its polynomials.

On a cell the homogeneous curve is (A, w) with polynomials in t from 0 to 1. With N = A' w - A w' the
derivatives are C' = N / w² and C' x C'' = (N x N') / w⁴, so that the curvature is |N x N'| w² / |N|³.
Polynomials lie in the convex hull of their Bernstein coefficients: the largest coefficient bounds a factor
from above, and the smallest coefficient of N along one direction bounds |N| from below.
"""

from functools import cache
from math import comb, sqrt

import numpy as np

from nurbs_lab.nurbs.span_kernels import kernel


def curvature_bounds(spans, span, start, stop):
    """An upper bound of the curvature on every cell, from a parameter ``start`` to ``stop`` inside its span.

    It is infinite where the cell turns too much for a bound. Halving a cell brings the bound nearer to the
    largest curvature by the square of the width.
    """
    degree, rational = spans[2].shape[1] - 1, spans[3]
    of_n = 2 * degree - 1 if rational else degree - 1
    matrices = _to_bernstein(degree), _to_bernstein(of_n), _to_bernstein(max(2 * of_n - 2, 0))
    found = np.empty(len(span))
    _bounds(spans, span, start, stop, matrices, found)
    return found


@cache
def _to_bernstein(degree):
    """Matrix from the factors of 1, t, ..., t**degree to Bernstein coefficients."""
    index = range(degree + 1)
    return np.array([[comb(k, j) / comb(degree, j) for j in index] for k in index])


@kernel
def _bounds(spans, span_of, start, stop, matrices, found):
    breaks, scales, coefficients, rational = spans
    degree, (to_w, to_n, to_turning) = coefficients.shape[1] - 1, matrices
    local = np.empty((degree + 1, 4))
    n, turning = np.empty((len(to_n), 3)), np.empty((len(to_turning), 3))
    for cell in range(span_of.size):
        span = span_of[cell]
        low = (start[cell] - breaks[span]) * scales[span] - 1.0
        _expand(coefficients[span], low, (stop[cell] - start[cell]) * scales[span], local)
        n[:] = 0.0
        turning[:] = 0.0
        heaviest = 1.0
        if rational:
            x, y, z = local[0, 0] / local[0, 3], local[0, 1] / local[0, 3], local[0, 2] / local[0, 3]
            for k in range(degree + 1):  # points from the start of the cell
                local[k, 0] -= x * local[k, 3]
                local[k, 1] -= y * local[k, 3]
                local[k, 2] -= z * local[k, 3]
            for i in range(degree + 1):
                for j in range(degree + 1):
                    for c in range(3):
                        if i != j:
                            n[i + j - 1, c] += (i - j) * local[i, c] * local[j, 3]
            heaviest = np.max(to_w @ np.ascontiguousarray(local[:, 3]))
        else:
            for k in range(degree):
                for c in range(3):
                    n[k, c] = (k + 1) * local[k + 1, c]
        for i in range(len(n)):
            for j in range(i + 1, len(n)):
                turning[i + j - 1, 0] += (j - i) * (n[i, 1] * n[j, 2] - n[i, 2] * n[j, 1])
                turning[i + j - 1, 1] += (j - i) * (n[i, 2] * n[j, 0] - n[i, 0] * n[j, 2])
                turning[i + j - 1, 2] += (j - i) * (n[i, 0] * n[j, 1] - n[i, 1] * n[j, 0])
        x = y = z = 0.0  # N at t = 1/2
        for k in range(len(n) - 1, -1, -1):
            x, y, z = 0.5 * x + n[k, 0], 0.5 * y + n[k, 1], 0.5 * z + n[k, 2]
        _to_bezier(to_n, n)
        _to_bezier(to_turning, turning)
        least, most = np.inf, 0.0
        for bx, by, bz in n:
            least = min(least, (bx * x + by * y + bz * z) / sqrt(x * x + y * y + z * z))
        for bx, by, bz in turning:
            most = max(most, sqrt(bx * bx + by * by + bz * bz))
        found[cell] = (most / least) * (heaviest / least) ** 2 if least > 0.0 else np.inf


@kernel
def _expand(coefficients, low, width, local):
    """Factors of 1, t, ... of polynomials in x = low + width t, given from the highest power down."""
    degree = len(local) - 1
    for k in range(degree + 1):
        local[k] = coefficients[degree - k]
    power = 1.0
    for j in range(degree + 1):
        for k in range(degree - 1, j - 1, -1):
            local[k] += low * local[k + 1]
        local[j] *= power
        power *= width


@kernel
def _to_bezier(to_bernstein, rows):
    """Turn factors of 1, t, ... into Bernstein coefficients, in place."""
    for k in range(len(rows) - 1, -1, -1):
        for c in range(3):
            value = 0.0
            for j in range(k + 1):
                value += to_bernstein[k, j] * rows[j, c]
            rows[k, c] = value
