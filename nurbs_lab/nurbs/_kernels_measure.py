"""Arc length and its inverse: Gauss-Legendre quadrature, halved until both halves agree with the whole."""

import numpy as np
from numba import njit

from nurbs_lab.nurbs._kernels import curve_derivatives_at

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
AGREES = 1e-14  # of the whole length
DEEPEST = 50


@njit(cache=True, nogil=True)
def speed(degree, knots, homogeneous, u, frame):
    """|C'(u)|; ``frame (2, dim)`` is scratch."""
    curve_derivatives_at(degree, knots, homogeneous, u, frame)
    return np.sqrt((frame[1] ** 2).sum())


@njit(cache=True, nogil=True)
def agreement(homogeneous, total):
    """How near two quadratures must come: a part of the whole length, and the rounding of the points."""
    return AGREES * total + 1e-16 * np.abs(homogeneous[:, :-1]).max() / homogeneous[:, -1].max()


@njit(cache=True, nogil=True)
def panel(degree, knots, homogeneous, a, b, frame):
    """One Gauss-Legendre panel of |C'| over [a, b], inside one span."""
    total = 0.0
    for k in range(NODES.size):
        u = 0.5 * (a + b) + 0.5 * (b - a) * NODES[k]
        total += WEIGHTS[k] * speed(degree, knots, homogeneous, u, frame)
    return 0.5 * (b - a) * total


@njit(cache=True, nogil=True)
def piece_length(degree, knots, homogeneous, a, b, tolerance, frame):
    """Arc length over [a, b] inside one span, to an absolute tolerance."""
    starts = np.empty(DEEPEST + 2)
    ends = np.empty(DEEPEST + 2)
    wholes = np.empty(DEEPEST + 2)
    depths = np.empty(DEEPEST + 2, dtype=np.int64)
    starts[0], ends[0], depths[0] = a, b, 0
    wholes[0] = panel(degree, knots, homogeneous, a, b, frame)
    waiting = 1
    total = 0.0
    while waiting > 0:
        waiting -= 1
        start, end, whole, depth = starts[waiting], ends[waiting], wholes[waiting], depths[waiting]
        middle = 0.5 * (start + end)
        left = panel(degree, knots, homogeneous, start, middle, frame)
        right = panel(degree, knots, homogeneous, middle, end, frame)
        if abs(left + right - whole) <= tolerance or depth >= DEEPEST:
            total += left + right
            continue
        starts[waiting], ends[waiting], wholes[waiting] = start, middle, left
        starts[waiting + 1], ends[waiting + 1], wholes[waiting + 1] = middle, end, right
        depths[waiting] = depth + 1
        depths[waiting + 1] = depth + 1
        waiting += 2
    return total


@njit(cache=True, nogil=True)
def break_lengths(degree, knots, homogeneous, breaks):
    """Arc length from the first break to each of the breaks, no knot lying between two of them."""
    frame = np.empty((2, homogeneous.shape[1] - 1))
    rough = 0.0
    for k in range(breaks.size - 1):
        rough += panel(degree, knots, homogeneous, breaks[k], breaks[k + 1], frame)
    tolerance = agreement(homogeneous, rough)
    out = np.zeros(breaks.size)
    for k in range(breaks.size - 1):
        part = piece_length(degree, knots, homogeneous, breaks[k], breaks[k + 1], tolerance, frame)
        out[k + 1] = out[k] + part
    return out


@njit(cache=True, nogil=True)
def parameters_at(degree, knots, homogeneous, breaks, lengths, wanted):
    """Parameter of each wanted arc length: Newton inside a bracket, the integral carried along."""
    frame = np.empty((2, homogeneous.shape[1] - 1))
    out = np.empty(wanted.size)
    tolerance = agreement(homogeneous, lengths[-1])
    for k in range(wanted.size):
        i = min(max(np.searchsorted(lengths, wanted[k], side="right") - 1, 0), breaks.size - 2)
        low, high = breaks[i], breaks[i + 1]
        missing = wanted[k] - lengths[i]
        here = lengths[i + 1] - lengths[i]
        u = low
        target = low + (high - low) * (missing / here if here > 0.0 else 0.0)
        for _ in range(80):
            target = min(max(target, low), high)
            forward = target >= u
            a, b = (u, target) if forward else (target, u)
            moved = piece_length(degree, knots, homogeneous, a, b, tolerance, frame) if b > a else 0.0
            missing -= moved if forward else -moved
            u = target
            if missing > 0.0:
                low = u
            else:
                high = u
            rate = speed(degree, knots, homogeneous, u, frame)
            if abs(missing) <= 2e-16 * lengths[-1] or high - low <= 4e-16 * max(abs(low), abs(high)):
                break
            target = u + missing / rate if rate > 0.0 else 0.5 * (low + high)
            if not low < target < high:
                target = 0.5 * (low + high)
            if target == u:
                break
        out[k] = u
    return out
