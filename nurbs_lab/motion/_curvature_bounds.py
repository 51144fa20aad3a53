"""Certified bounds of curvature on cells of a curve, from the Bernstein coefficients of its polynomials.

On a cell the homogeneous curve is (A, w) with polynomials in t from 0 to 1. With N = A' w - A w' the
derivatives are C' = N / w² and C' x C'' = (N x N') / w⁴, so that the curvature is |N x N'| w² / |N|³.
Polynomials lie in the convex hull of their Bernstein coefficients: the largest coefficient bounds a factor
from above, and the smallest coefficient of N along one direction bounds |N| from below.
"""

from math import comb

import numpy as np


def curvature_bounds(spans, span, start, stop):
    """An upper bound of the curvature on every cell.

    Parameters
    ----------
    spans : tuple
        Span table of the curve; see `nurbs.span_kernels`.
    span : ndarray of int, shape (n,)
    start, stop : ndarray, shape (n,)
        Parameters of both ends of the cell, inside its span.

    Returns
    -------
    ndarray, shape (n,)
        Infinite where the cell turns too much for a bound; halving a cell brings it nearer to the largest
        curvature by the square of its width.
    """
    breaks, scales, coefficients, _ = spans
    low = (start - breaks[span]) * scales[span] - 1.0
    width = (stop - start) * scales[span]
    local = _recentred(coefficients[span][:, ::-1], low, width)
    w = local[:, :, 3]
    position = local[:, :, :3] - (local[:, :1, :3] / w[:, :1, None]) * w[:, :, None]  # from the cell's start
    n = _product(_derivative(position), w[:, :, None]) - _product(position, _derivative(w)[:, :, None])
    turning = _cross(n, _derivative(n))
    middle = np.einsum("nkd,k->nd", n, 0.5 ** np.arange(n.shape[1]))
    direction = middle / np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), 1e-300)
    least = _bernstein(np.einsum("nkd,nd->nk", n, direction)[..., None]).min(axis=1)[:, 0]
    most = np.linalg.norm(_bernstein(turning), axis=2).max(axis=1)
    heaviest = _bernstein(w[..., None]).max(axis=1)[:, 0]
    with np.errstate(all="ignore"):
        return np.where(least > 0.0, (most / least) * (heaviest / least) ** 2, np.inf)


def _recentred(powers, low, width):
    """Coefficients in t of polynomials in x = low + width t, lowest power first."""
    degree = powers.shape[1] - 1
    shifted = np.zeros_like(powers)
    for j in range(degree + 1):
        for k in range(j, degree + 1):
            shifted[:, j] += powers[:, k] * (comb(k, j) * low ** (k - j) * width**j)[:, None]
    return shifted


def _derivative(powers):
    rows = powers[:, 1:] if powers.shape[1] > 1 else np.zeros_like(powers)
    return np.einsum("nk...,k->nk...", rows, np.arange(1.0, rows.shape[1] + 1.0))


def _product(first, second):
    rows = np.zeros((len(first), first.shape[1] + second.shape[1] - 1, first.shape[2]))
    for k in range(second.shape[1]):
        rows[:, k : k + first.shape[1]] += first * second[:, k : k + 1]
    return rows


def _cross(first, second):
    rows = np.zeros((len(first), first.shape[1] + second.shape[1] - 1, 3))
    for k in range(second.shape[1]):
        rows[:, k : k + first.shape[1]] += np.cross(first, second[:, k : k + 1])
    return rows


def _bernstein(powers):
    """Bernstein coefficients of polynomials, ``(n, degree + 1, dim)``."""
    degree = powers.shape[1] - 1
    index = range(degree + 1)
    matrix = np.array([[comb(k, j) / comb(degree, j) for j in index] for k in index])
    return np.einsum("kj,njd->nkd", matrix, powers)
