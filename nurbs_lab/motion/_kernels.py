"""What every stepper shares, on plain arrays: the curve span by span, its arc length, and the feed in time.

A *span table* is the tuple ``(breaks, centres, scales, coefficients, rational)``: on span i the homogeneous
curve is a polynomial in ``x = (u - centres[i]) * scales[i]``, which lies in [-1, 1];
``coefficients[i, k]`` are the (x, y, z, w) factors of ``x**(degree - k)``. Plane curves have z = 0.

A *feed table* is ``(times, terms)``: on piece i the travelled length is
``terms[i] @ (1, tau, tau**2, tau**3)`` with ``tau = t - times[i]``; the last piece has no end.

A *panel table* is ``(nodes, lengths)``: parameters between which eight Gauss points give the arc length
to rounding, and the arc length up to each.
"""

from math import sqrt

import numpy as np
from numba import njit

#: Division by zero gives inf or NaN, as in NumPy: the drivers look at the result instead of at every divisor.
#: Inlined by force: a call counts references to every table it is handed, which costs more than a point does.
kernel = njit(cache=True, nogil=True, error_model="numpy", forceinline=True)

GOING, ARRIVED, BROKEN = 0, 1, 2

GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(8)


@kernel
def find_span(breaks, u, hint):
    """Index of the span that holds u, walking from ``hint``; the last one at the end of the curve."""
    last = breaks.size - 2
    while hint < last and u >= breaks[hint + 1]:
        hint += 1
    while hint > 0 and u < breaks[hint]:
        hint -= 1
    return hint


@kernel
def _polynomial(coefficients, span, column, x):
    """Value and first three derivatives in x of one homogeneous coordinate (Horner)."""
    value = coefficients[span, 0, column]
    first = second = third = 0.0
    for k in range(1, coefficients.shape[1]):
        third = third * x + second
        second = second * x + first
        first = first * x + value
        value = value * x + coefficients[span, k, column]
    return value, first, 2.0 * second, 6.0 * third


@kernel
def point(spans, span, u):
    """C(u) as (x, y, z)."""
    _, centres, scales, coefficients, rational = spans
    x = (u - centres[span]) * scales[span]
    px, py, pz = coefficients[span, 0, 0], coefficients[span, 0, 1], coefficients[span, 0, 2]
    for k in range(1, coefficients.shape[1]):
        px = px * x + coefficients[span, k, 0]
        py = py * x + coefficients[span, k, 1]
        pz = pz * x + coefficients[span, k, 2]
    if rational:
        weight = coefficients[span, 0, 3]
        for k in range(1, coefficients.shape[1]):
            weight = weight * x + coefficients[span, k, 3]
        return px / weight, py / weight, pz / weight
    return px, py, pz


@kernel
def velocity(spans, span, u):
    """C'(u) as (x, y, z)."""
    _, centres, scales, coefficients, rational = spans
    scale = scales[span]
    x = (u - centres[span]) * scale
    px, py, pz = coefficients[span, 0, 0], coefficients[span, 0, 1], coefficients[span, 0, 2]
    weight = coefficients[span, 0, 3]
    dx = dy = dz = slope = 0.0
    for k in range(1, coefficients.shape[1]):
        dx, px = dx * x + px, px * x + coefficients[span, k, 0]
        dy, py = dy * x + py, py * x + coefficients[span, k, 1]
        dz, pz = dz * x + pz, pz * x + coefficients[span, k, 2]
        if rational:
            slope, weight = slope * x + weight, weight * x + coefficients[span, k, 3]
    if rational:
        ratio = slope / weight
        scale /= weight
        dx -= ratio * px
        dy -= ratio * py
        dz -= ratio * pz
    return dx * scale, dy * scale, dz * scale


@kernel
def speed(spans, span, u):
    """|C'(u)|."""
    dx, dy, dz = velocity(spans, span, u)
    return sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def derivatives(spans, span, u, column):
    """First three derivatives in u of one Cartesian coordinate."""
    _, centres, scales, coefficients, rational = spans
    scale = scales[span]
    x = (u - centres[span]) * scale
    p0, p1, p2, p3 = _polynomial(coefficients, span, column, x)
    if rational:
        w0, w1, w2, w3 = _polynomial(coefficients, span, 3, x)
        p0 /= w0
        p1 = (p1 - w1 * p0) / w0
        p2 = (p2 - 2.0 * w1 * p1 - w2 * p0) / w0
        p3 = (p3 - 3.0 * w1 * p2 - 3.0 * w2 * p1 - w3 * p0) / w0
    return p1 * scale, p2 * scale**2, p3 * scale**3


@kernel
def speed_jet(spans, span, u):
    """|C'| and its first two derivatives in u."""
    x1, x2, x3 = derivatives(spans, span, u, 0)
    y1, y2, y3 = derivatives(spans, span, u, 1)
    z1, z2, z3 = derivatives(spans, span, u, 2)
    value = sqrt(x1 * x1 + y1 * y1 + z1 * z1)
    first = (x1 * x2 + y1 * y2 + z1 * z2) / value
    second = (x2 * x2 + y2 * y2 + z2 * z2 + x1 * x3 + y1 * y3 + z1 * z3 - first * first) / value
    return value, first, second


@kernel
def gauss(spans, span, start, stop):
    """Arc length of a piece that holds no knot inside."""
    half = 0.5 * (stop - start)
    middle = 0.5 * (stop + start)
    total = 0.0
    for k in range(8):
        total += GAUSS_WEIGHTS[k] * speed(spans, span, middle + half * GAUSS_NODES[k])
    return half * total


@kernel
def arc(spans, panels, start, stop, span, panel):
    """Arc length from start to stop; ``span`` and ``panel`` hold start."""
    nodes = panels[0]
    breaks = spans[0]
    total = 0.0
    while start < stop:
        span = find_span(breaks, start, span)
        panel = find_span(nodes, start, panel)
        end = nodes[panel + 1] if panel < nodes.size - 2 else stop
        end = min(end, stop)
        total += gauss(spans, span, start, end)
        start = end
    return total


@kernel
def panel_table(spans, tolerance):
    """Halve every span until eight Gauss points and twice eight agree to ``tolerance`` of the length."""
    breaks = spans[0]
    scale = 0.0
    for span in range(breaks.size - 1):
        scale += gauss(spans, span, breaks[span], breaks[span + 1])
    nodes = [breaks[0]]
    lengths = [0.0]
    pending = [(breaks[0], breaks[0])]
    for span in range(breaks.size - 1):
        pending.clear()
        pending.append((breaks[span], breaks[span + 1]))
        while pending:
            start, stop = pending.pop()
            middle = 0.5 * (start + stop)
            whole = gauss(spans, span, start, stop)
            halves = gauss(spans, span, start, middle) + gauss(spans, span, middle, stop)
            small = stop - start < 1e-12 * (breaks[-1] - breaks[0])
            if abs(whole - halves) <= tolerance * scale or small:
                nodes.append(stop)
                lengths.append(lengths[-1] + halves)
            else:
                pending.append((middle, stop))
                pending.append((start, middle))
    return np.array(nodes), np.array(lengths)


@kernel
def feed_at(feed, t, hint):
    """Speed, acceleration and jerk at time t, and the piece that holds t."""
    times, terms = feed
    hint = find_span(times, t, hint)
    tau = t - times[hint]
    velocity_ = terms[hint, 1] + tau * (2.0 * terms[hint, 2] + tau * 3.0 * terms[hint, 3])
    return velocity_, 2.0 * terms[hint, 2] + 6.0 * tau * terms[hint, 3], 6.0 * terms[hint, 3], hint


@kernel
def displacement(feed, t, duration, hint):
    """Length commanded between t and t + duration, without the cancellation of s(t + duration) - s(t)."""
    times = feed[0]
    total = 0.0
    hint = find_span(times, t, hint)
    while duration > 0.0:
        v, a, j, hint = feed_at(feed, t, hint)
        left = times[hint + 1] - t
        if left >= duration * (1.0 - 1e-12) or hint == times.size - 2:
            left = duration
        total += left * (v + left * (0.5 * a + left * j / 6.0))
        duration -= left
        t = times[hint + 1]
    return total


@kernel
def settle(u, step, following, end):
    """Store the next parameter; tell whether the path goes on, has arrived, or broke down."""
    if not (np.isfinite(following) and following >= u[step]):
        return BROKEN
    if following >= end or step + 2 == u.size:
        u[step + 1] = end
        return ARRIVED
    u[step + 1] = following
    return GOING


@kernel
def slowest(spans):
    """Parameter and value of the smallest |C'|: 32 samples a span, the lowest narrowed by golden section."""
    breaks = spans[0]
    best, best_u = np.inf, breaks[0]
    for span in range(breaks.size - 1):
        width = (breaks[span + 1] - breaks[span]) / 32
        low, at = np.inf, 0
        for k in range(33):
            value = speed(spans, span, breaks[span] + k * width)
            if value < low:
                low, at = value, k
        start = breaks[span] + max(at - 1, 0) * width
        stop = breaks[span] + min(at + 1, 32) * width
        for _ in range(60):
            third = 0.381966011250105 * (stop - start)
            if speed(spans, span, start + third) < speed(spans, span, stop - third):
                stop -= third
            else:
                start += third
        u = 0.5 * (start + stop)
        for candidate in (u, breaks[span], breaks[span + 1]):
            value = speed(spans, span, candidate)
            if value < best:
                best, best_u = value, candidate
    return best_u, best
