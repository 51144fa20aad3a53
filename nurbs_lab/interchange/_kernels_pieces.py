"""Longest chords along the points of a curve."""

import numpy as np
from numba import njit

from nurbs_lab.nurbs.span_kernels import kernel


@njit(cache=True, nogil=True)
def longest(points, tolerance):
    """Numbers of the points ``(n, dim)`` at which chords meet, each as long as the tolerance allows.

    A chord is lengthened by twice as many points each time, until it misses the tolerance. Then halving finds
    the longest one that keeps it.
    """
    last = len(points) - 1
    ends, count = np.zeros(last + 1, np.int64), 1
    while ends[count - 1] < last:
        a = ends[count - 1]
        good, step = a + 1, 1
        while good + step <= last and chord_fits(points, a, good + step, tolerance):
            good += step
            step *= 2
        bad = min(good + step, last + 1)
        while bad - good > 1:
            middle = (good + bad) // 2
            if chord_fits(points, a, middle, tolerance):
                good = middle
            else:
                bad = middle
        ends[count] = good
        count += 1
    return ends[:count]


@kernel
def chord_fits(points, a, b, tolerance):
    """Whether the chord from point a to point b is within the tolerance of those between them."""
    dim, square = points.shape[1], 0.0
    for d in range(dim):
        square += (points[b, d] - points[a, d]) ** 2
    for i in range(a + 1, b):
        along = 0.0
        for d in range(dim):
            along += (points[i, d] - points[a, d]) * (points[b, d] - points[a, d])
        along, away = min(max(along / max(square, 1e-300), 0.0), 1.0), 0.0
        for d in range(dim):
            away += (points[i, d] - points[a, d] - along * (points[b, d] - points[a, d])) ** 2
        if away > tolerance * tolerance:
            return False
    return True
