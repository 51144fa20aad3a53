"""Longest chords, and longest polynomials of degree five, along the points of a curve."""

import numpy as np
from numba import njit

from nurbs_lab.nurbs.span_kernels import kernel

CHECKS = 4  # places of a step between two points at which a polynomial is compared with the curve
RIDGE = 1e-9  # of a square in the normal equations: with few points a polynomial is nearly a cubic


@njit(cache=True, nogil=True)
def longest(t, points, tangents, tolerance):
    """Numbers of the points ``(n, dim)`` at which pieces meet, each as long as the tolerance allows.

    The pieces are polynomials with the unit ``tangents (n, dim)`` at the parameters ``t (n,)``, or chords if
    there are no tangents. A piece is lengthened by twice as many points each time, until it misses the
    tolerance. Then halving finds the longest one that keeps it.
    """
    last = len(points) - 1
    ends, count = np.zeros(last + 1, np.int64), 1
    while ends[count - 1] < last:
        a = ends[count - 1]
        good, step = a + 1, 1
        while good + step <= last and fits(t, points, tangents, a, good + step, tolerance):
            good += step
            step *= 2
        bad = min(good + step, last + 1)
        while bad - good > 1:
            middle = (good + bad) // 2
            if fits(t, points, tangents, a, middle, tolerance):
                good = middle
            else:
                bad = middle
        ends[count] = good
        count += 1
    return ends[:count]


@njit(cache=True, nogil=True)
def fits(t, points, tangents, a, b, tolerance):
    """Whether the piece from point a to point b is within the tolerance of those between them."""
    if len(tangents):
        return quintic_fits(t, points, tangents, a, b, tolerance)
    return chord_fits(points, a, b, tolerance)


@kernel
def chord_fits(points, a, b, tolerance):
    """`fits` for a chord."""
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


@njit(cache=True, nogil=True)
def quintic_fits(t, points, tangents, a, b, tolerance):
    """`fits` for a polynomial.

    Each step between two points is compared at ``CHECKS`` places with the cubic that has the tangents there.
    """
    control = quintic(t, points, tangents, a, b)
    for j in range(CHECKS * a + 1, CHECKS * b):
        i, x, square = j // CHECKS, (j % CHECKS) / CHECKS, 0.0
        e, y, step = min(i + 1, b), 1.0 - x, t[min(i + 1, b)] - t[i]
        values = basis((t[i] + x * step - t[a]) / (t[b] - t[a]))
        for d in range(points.shape[1]):
            miss = y * y * (1.0 + 2.0 * x) * points[i, d] + x * x * (1.0 + 2.0 * y) * points[e, d]
            miss += x * y * step * (y * tangents[i, d] - x * tangents[e, d])
            for k in range(6):
                miss -= values[k] * control[k, d]
            square += miss * miss
        if square > tolerance * tolerance:
            return False
    return True


@njit(cache=True, nogil=True)
def quintics(t, points, tangents, ends):
    """Control points ``(m - 1, 6, dim)`` of the polynomials that meet at the points ``ends (m,)``."""
    out = np.empty((len(ends) - 1, 6, points.shape[1]))
    for i in range(len(out)):
        out[i] = quintic(t, points, tangents, ends[i], ends[i + 1])
    return out


@njit(cache=True, nogil=True)
def quintic(t, points, tangents, a, b):
    """Control points ``(6, dim)`` of the polynomial from point a to point b, nearest to those between them.

    It has the unit tangents of both ends. Its inner control points are those of the cubic with these ends,
    moved by least squares.
    """
    width, dim = t[b] - t[a], points.shape[1]
    control, one, two, three = np.empty((6, dim)), 0.0, 0.0, 0.0
    right = np.zeros((2, dim))
    for d in range(dim):
        first, last = width * tangents[a, d] / 5.0, width * tangents[b, d] / 5.0
        p, q = points[a, d], points[b, d]
        control[0, d], control[1, d], control[4, d], control[5, d] = p, p + first, q - last, q
        control[2, d] = 0.7 * p + 0.3 * q + first - last / 2.0
        control[3, d] = 0.3 * p + 0.7 * q + first / 2.0 - last
    for i in range(a + 1, b):
        values, weight = basis((t[i] - t[a]) / width), (t[i + 1] - t[i - 1]) / width
        one += weight * values[2] ** 2
        two += weight * values[2] * values[3]
        three += weight * values[3] ** 2
        for d in range(dim):
            miss = points[i, d]
            for k in range(6):
                miss -= values[k] * control[k, d]
            right[0, d] += weight * values[2] * miss
            right[1, d] += weight * values[3] * miss
    one, three = one + RIDGE, three + RIDGE
    scale = 1.0 / (one * three - two * two)
    for d in range(dim):
        control[2, d] += scale * (three * right[0, d] - two * right[1, d])
        control[3, d] += scale * (one * right[1, d] - two * right[0, d])
    return control


@kernel
def basis(x):
    """The Bernstein polynomials of degree five."""
    y = 1.0 - x
    return y**5, 5.0 * x * y**4, 10.0 * x**2 * y**3, 10.0 * x**3 * y**2, 5.0 * x**4 * y, x**5
