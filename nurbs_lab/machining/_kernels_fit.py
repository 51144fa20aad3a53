"""Cubic splines through as few of many points as keep a tolerance at the others."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def tangents(t, points, nodes):
    """Derivatives ``(m, 3)`` at the nodes of the cubic spline through them, of parabolas at the ends."""
    m = len(nodes)
    out = np.empty((m, 3))
    if m == 2:
        for d in range(3):
            out[0, d] = (points[nodes[1], d] - points[nodes[0], d]) / (t[nodes[1]] - t[nodes[0]])
            out[1, d] = out[0, d]
        return out
    over = np.empty(m)
    for d in range(3):
        for end in (0, 1):
            i, j, k = (0, 1, 2) if end == 0 else (m - 1, m - 2, m - 3)
            one, two = t[nodes[j]] - t[nodes[i]], t[nodes[k]] - t[nodes[j]]
            first = (points[nodes[j], d] - points[nodes[i], d]) / one
            second = (points[nodes[k], d] - points[nodes[j], d]) / two
            out[i, d] = first - one * (second - first) / (one + two)
        over[0] = 0.0
        for i in range(1, m - 1):  # forward elimination of a system of three diagonals
            before, after = t[nodes[i]] - t[nodes[i - 1]], t[nodes[i + 1]] - t[nodes[i]]
            first = (points[nodes[i], d] - points[nodes[i - 1], d]) / before
            second = (points[nodes[i + 1], d] - points[nodes[i], d]) / after
            right = 3.0 * (after * first + before * second)
            pivot = 2.0 * (before + after) - after * over[i - 1]
            over[i] = before / pivot
            out[i, d] = (right - after * out[i - 1, d]) / pivot
        for i in range(m - 2, 0, -1):
            out[i, d] -= over[i] * out[i + 1, d]
    return out


@njit(cache=True, nogil=True, inline="always")
def between(t, points, nodes, slopes, k, at, d):
    """Coordinate d of the spline at parameter ``at`` of piece k (cubic Hermite form)."""
    width = t[nodes[k + 1]] - t[nodes[k]]
    x = (at - t[nodes[k]]) / width
    p0, p1 = points[nodes[k], d], points[nodes[k + 1], d]
    step = p1 - p0
    low, high = width * slopes[k, d] - step, step - width * slopes[k + 1, d]
    return p0 + x * step + x * (1.0 - x) * ((1.0 - x) * low + x * high)


@njit(cache=True, nogil=True)
def fit(t, points, tolerance):
    """Numbers of the points that the spline goes through, and its derivatives there.

    A piece that misses a point by more than the tolerance gets the point that it misses most.
    """
    n = len(points)
    taken = np.zeros(n, np.bool_)
    taken[0] = taken[n - 1] = True
    while True:
        nodes = np.flatnonzero(taken)
        slopes = tangents(t, points, nodes)
        good = True
        for k in range(len(nodes) - 1):
            worst, at = tolerance * tolerance, -1
            for i in range(nodes[k] + 1, nodes[k + 1]):
                miss = 0.0
                for d in range(3):
                    miss += (between(t, points, nodes, slopes, k, t[i], d) - points[i, d]) ** 2
                if miss > worst:
                    worst, at = miss, i
            if at >= 0:
                taken[at] = True
                good = False
        if good:
            return nodes, slopes


@njit(cache=True, nogil=True)
def samples(t, points, nodes, slopes, counts):
    """Points of the spline: ``counts[i]`` in the middles of as many equal parts of step i."""
    out = np.empty((counts.sum(), 3))
    k, row = 0, 0
    for i in range(len(counts)):
        while nodes[k + 1] <= i:
            k += 1
        for j in range(counts[i]):
            at = t[i] + (j + 0.5) * (t[i + 1] - t[i]) / counts[i]
            for d in range(3):
                out[row, d] = between(t, points, nodes, slopes, k, at, d)
            row += 1
    return out
