"""Polynomials of degree five along the points of a curve, end to end with the tangents of the curve.

What counts is the distance between polynomial and curve. So the parameters at which the polynomial passes the
points are free, and of the tangents only the directions are given. Both take turns: every point gets the
parameter of the place nearest to it, and the polynomial is fitted to the points by least squares.
"""

import numpy as np
from numba import njit

from nurbs_lab.nurbs.span_kernels import kernel

ROUNDS = 16  # of the fit
PLACES = 20  # steps between the places of a piece that are fitted; many more are checked
CHECKS = 3  # places of a step between two points at which polynomial and curve are compared
ALONG = 0.15  # how much a miss along the curve counts, which is mostly a matter of the parameter
WORSE = 0.5  # part of the weight of a point that grows with what it missed, to make the largest miss smaller
FALL = 1.5  # in each of the rounds left, the largest miss must be able to fall by this factor
RIDGE = 1e-6  # of a square in the normal equations: how firmly the polynomial of the round before is kept
LEAST = 0.02  # of the length of the piece: smallest derivative at an end, divided by five


@kernel
def basis(x):
    """The Bernstein polynomials of degree five."""
    y = 1.0 - x
    return y**5, 5.0 * x * y**4, 10.0 * x**2 * y**3, 10.0 * x**3 * y**2, 5.0 * x**4 * y, x**5


@kernel
def slopes(x):
    """Derivatives of the Bernstein polynomials of degree five."""
    y = 1.0 - x
    a, b, c, d, e = y**4, 4.0 * x * y**3, 6.0 * x**2 * y**2, 4.0 * x**3 * y, x**4
    return -5.0 * a, 5.0 * (a - b), 5.0 * (b - c), 5.0 * (c - d), 5.0 * (d - e), 5.0 * e


@kernel
def missed(control, x, point, miss, along):
    """Squared distance of a point from the polynomial at x, and by how much x should grow to lower it.

    The difference is written to ``miss (dim,)``, the unit tangent of the polynomial to ``along (dim,)``.
    """
    values, changes = basis(x), slopes(x)
    square = speed = forward = 0.0
    for d in range(len(point)):
        miss[d], along[d] = point[d], 0.0
        for k in range(6):
            miss[d] -= values[k] * control[k, d]
            along[d] += changes[k] * control[k, d]
        square += miss[d] * miss[d]
        speed += along[d] * along[d]
        forward += miss[d] * along[d]
    for d in range(len(point)):
        along[d] /= np.sqrt(max(speed, 1e-300))
    return square, forward / max(speed, 1e-300)


@kernel
def place(t, points, tangents, at, out):
    """Write a point of the curve to ``out (dim,)`` and return its length.

    It is on the cubic that has the tangents at both ends of a step; ``at`` is the number of a point and the
    part of the step after it.
    """
    i = min(int(at), len(points) - 2)
    x, y, step = at - i, 1.0 + i - at, t[i + 1] - t[i]
    for d in range(len(out)):
        out[d] = y * y * (1.0 + 2.0 * x) * points[i, d] + x * x * (1.0 + 2.0 * y) * points[i + 1, d]
        out[d] += x * y * step * (y * tangents[i, d] - x * tangents[i + 1, d])
    return t[i] + x * step


@njit(cache=True, nogil=True, error_model="numpy")
def quintic(t, points, tangents, a, b, tolerance):
    """Control points ``(6, dim)`` of a polynomial from point a to point b, and whether it is good enough.

    ``t (n,)`` is the length of the curve up to each of the ``points (n, dim)``, with unit ``tangents``.
    """
    dim, width = points.shape[1], t[b] - t[a]
    control = cubic(t, points, tangents, a, b)
    if b - a == 1:
        return control, True
    places, x = np.empty((PLACES + 1, dim)), np.empty(PLACES + 1)
    for i in range(PLACES + 1):
        x[i] = (place(t, points, tangents, a + (b - a) * i / PLACES, places[i]) - t[a]) / width
    spacing, weights, squares = x[2:] - x[:-2], np.ones(PLACES - 1), np.zeros(PLACES - 1)
    miss, along = np.empty(dim), np.empty(dim)
    for left in range(ROUNDS, -1, -1):
        for i in range(1, PLACES):
            squares[i - 1], _ = missed(control, x[i], places[i], miss, along)
        worst = np.sqrt(squares.max())
        if worst <= tolerance and keeps(t, points, tangents, a, b, control, x, tolerance):
            return control, True
        if left == 0 or (left < ROUNDS and worst > tolerance * FALL**left):
            break
        for i in range(1, PLACES):
            _, more = missed(control, x[i], places[i], miss, along)
            x[i] = min(max(x[i] + more, x[i - 1]), 1.0)
        if left < ROUNDS:
            weights *= 1.0 - WORSE + WORSE * np.sqrt(squares) / max(worst, 1e-300)
            weights /= weights.mean()
        if not fitted(control, places, tangents[a], tangents[b], x, weights * spacing, LEAST * width):
            break
    return control, False


@njit(cache=True, nogil=True)
def cubic(t, points, tangents, a, b):
    """Control points ``(6, dim)`` of the cubic from point a to point b with the unit tangents there."""
    control, fifth = np.empty((6, points.shape[1])), (t[b] - t[a]) / 5.0
    for d in range(points.shape[1]):
        p, q, first, last = points[a, d], points[b, d], fifth * tangents[a, d], fifth * tangents[b, d]
        control[0, d], control[1, d], control[2, d] = p, p + first, 0.7 * p + 0.3 * q + first - 0.5 * last
        control[3, d], control[4, d], control[5, d] = 0.3 * p + 0.7 * q + 0.5 * first - last, q - last, q
    return control


@njit(cache=True, nogil=True, error_model="numpy")
def fitted(control, places, first, last, x, weights, least):
    """Move the inner control points by weighted least squares; whether the curve still leaves forwards.

    The unknowns are the distances of the second and of the last but one control point from the ends, along
    the tangents, and the coordinates of the two in between.
    """
    dim = places.shape[1]
    size = 2 + 2 * dim
    square, right, now = np.zeros((size, size)), np.zeros(size), np.zeros(size)
    rows, miss, along = np.zeros((dim, size)), np.empty(dim), np.empty(dim)
    for i in range(1, PLACES):
        values = basis(x[i])
        missed(control, x[i], places[i], miss, along)
        across = 0.0
        for d in range(dim):
            rows[d] = 0.0
            rows[d, 0], rows[d, 1] = values[1] * first[d], -values[4] * last[d]
            rows[d, 2 + d], rows[d, 2 + dim + d] = values[2], values[3]
            miss[d] = places[i, d] - (values[0] + values[1]) * control[0, d]
            miss[d] -= (values[4] + values[5]) * control[5, d]
            across += along[d] * miss[d]
        for d in range(dim):
            miss[d] -= (1.0 - ALONG) * across * along[d]
        for j in range(size):
            across = 0.0
            for d in range(dim):
                across += along[d] * rows[d, j]
            for d in range(dim):
                rows[d, j] -= (1.0 - ALONG) * across * along[d]
        for j in range(size):
            for d in range(dim):
                factor = weights[i - 1] * rows[d, j]
                right[j] += factor * miss[d]
                for k in range(j, size):
                    square[j, k] += factor * rows[d, k]
    for d in range(dim):
        now[0] += (control[1, d] - control[0, d]) * first[d]
        now[1] += (control[5, d] - control[4, d]) * last[d]
        now[2 + d], now[2 + dim + d] = control[2, d], control[3, d]
    for j in range(size):
        square[j, j] += RIDGE
        right[j] += RIDGE * now[j]
    for j in range(size):
        for k in range(j + 1, size):
            factor = square[j, k] / square[j, j]
            for m in range(k, size):
                square[k, m] -= factor * square[j, m]
            right[k] -= factor * right[j]
    for j in range(size - 1, -1, -1):
        for k in range(j + 1, size):
            right[j] -= square[j, k] * right[k]
        right[j] /= square[j, j]
    for d in range(dim):
        control[1, d] = control[0, d] + right[0] * first[d]
        control[4, d] = control[5, d] - right[1] * last[d]
        control[2, d], control[3, d] = right[2 + d], right[2 + dim + d]
    return right[0] > least and right[1] > least


@njit(cache=True, nogil=True, error_model="numpy")
def keeps(t, points, tangents, a, b, control, x, tolerance):
    """Whether polynomial and curve are within the tolerance of one another.

    Each step between two points is compared at ``CHECKS`` places, whose parameters on the polynomial never
    fall, and half-way between those, so that the polynomial has no loop there.
    """
    dim, before = points.shape[1], 0.0
    here, between, miss, along = np.empty(dim), np.empty(dim), np.empty(dim), np.empty(dim)
    for j in range(1, CHECKS * (b - a) + 1):
        place(t, points, tangents, a + j / CHECKS, here)
        place(t, points, tangents, a + (j - 0.5) / CHECKS, between)
        part = PLACES * j / (CHECKS * (b - a))
        k = min(int(part), PLACES - 1)
        at = x[k] + (part - k) * (x[k + 1] - x[k])
        _, more = missed(control, at, here, miss, along)
        at = min(max(at + more, before), 1.0) if j < CHECKS * (b - a) else 1.0
        for where, target in ((at, here), (0.5 * (before + at), between)):
            square, _ = missed(control, where, target, miss, along)
            if square > tolerance * tolerance:
                return False
        before = at
    return True


@njit(cache=True, nogil=True)
def quintics(t, points, tangents, ends, tolerance):
    """Control points ``(m - 1, 6, dim)`` of the polynomials that meet at the points ``ends (m,)``."""
    out = np.empty((len(ends) - 1, 6, points.shape[1]))
    for i in range(len(out)):
        out[i], _ = quintic(t, points, tangents, ends[i], ends[i + 1], tolerance)
    return out
