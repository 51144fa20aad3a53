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
    halves = 0.5 ** np.arange(len(to_n))
    for cell in range(span_of.size):
        span = span_of[cell]
        low = (start[cell] - breaks[span]) * scales[span] - 1.0
        _expand(coefficients[span], low, (stop[cell] - start[cell]) * scales[span], local)
        n[:] = 0.0
        turning[:] = 0.0
        heaviest = 1.0
        if rational:
            for c in range(3):  # points from the start of the cell
                first = local[0, c] / local[0, 3]
                for k in range(degree + 1):
                    local[k, c] -= first * local[k, 3]
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
                for c in range(3):
                    d, e = (c + 1) % 3, (c + 2) % 3
                    turning[i + j - 1, c] += (j - i) * (n[i, d] * n[j, e] - n[i, e] * n[j, d])
        middle = halves[: len(n)] @ n  # N at t = 1/2
        most = 0.0
        for bx, by, bz in to_turning @ turning:
            most = max(most, bx * bx + by * by + bz * bz)
        least = np.min(to_n @ (n @ middle)) / sqrt(np.sum(middle**2))
        found[cell] = (sqrt(most) / least) * (heaviest / least) ** 2 if least > 0.0 else np.inf


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
