"""A curve span by span as polynomials, and its arc length: kernels that several rooms call.

A *span table* is the tuple ``(breaks, scales, coefficients, rational)``. Between ``breaks[i]`` and
``breaks[i + 1]`` the homogeneous curve is a polynomial in ``x = (u - breaks[i]) * scales[i] - 1``, which runs
from -1 to 1; ``coefficients[i, k]`` are the (x, y, z, w) factors of ``x**(degree - k)``. Curves in fewer than
three dimensions are padded with zeros. `nurbs.spans.span_table` makes it.

A *panel table* is ``(nodes, lengths)``: parameters between which eight Gauss points give the arc length to
rounding, and the arc length from the first node to each.
"""

from math import sqrt

import numpy as np

from nurbs_lab.common.kernels import ZERO, compiled, inlined, kernel
from nurbs_lab.nurbs._kernels import find_knot_span
from nurbs_lab.nurbs._kernels_shape import blossom

GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(8)
_P8 = np.polynomial.Legendre.basis(8)
_LEVEL = _P8.deriv().roots().real  # NumPy 2.5 gives them as complex numbers
_LEVEL -= _P8.deriv()(_LEVEL) / _P8.deriv(2)(_LEVEL)  # a Newton step, for the last digits
LOBATTO_NODES = np.concatenate([[-1.0], _LEVEL, [1.0]])
LOBATTO_WEIGHTS = 1.0 / (36.0 * _P8(LOBATTO_NODES) ** 2)
DEEPEST = 50  # halvings of a span; at a cusp each of them makes the error four times smaller
SLOW = 0.1  # of the largest |C'| of a panel: below it the curve may turn back on itself, and back again
MOST_PANELS = 2000  # of one span
ENOUGH = 1e-8  # of a panel: after a Newton step this short the next one is below rounding
CANCELLING = 100.0  # sum of the powers' coefficients over the largest Bezier coefficient (smallest weight)


@inlined
def bernstein_to_powers(degree):
    """Matrix from Bezier coefficients to factors of x**degree, ..., 1 where t = (1 + x) / 2."""
    matrix = np.zeros((degree + 1, degree + 1))
    binomial = 1.0
    for b in range(degree + 1):
        powers = np.zeros(degree + 1)
        powers[0] = binomial
        for factor in range(degree):
            sign = 0.5 if factor < b else -0.5
            for k in range(factor + 1, 0, -1):
                powers[k] = 0.5 * powers[k] + sign * powers[k - 1]
            powers[0] *= 0.5
        for k in range(degree + 1):
            matrix[k, b] = powers[degree - k]
        binomial *= (degree - b) / (b + 1)
    return matrix


@compiled
def span_polynomials(degree, knots, rows, breaks):
    """Coefficients ``(spans, degree + 1, columns)`` between neighbouring breaks, all knots among them.

    The second result tells which spans are to be halved: their powers cancel so much that digits are lost.
    """
    spans, columns = breaks.size - 1, rows.shape[1]
    coefficients = np.empty((spans, degree + 1, columns))
    poor = np.zeros(spans, dtype=np.bool_)
    to_powers = bernstein_to_powers(degree)
    local, bezier = np.empty((degree + 1, columns)), np.empty((degree + 1, columns))
    arguments = np.empty(degree)
    for i in range(spans):
        span = find_knot_span(degree, knots, breaks[i])
        arguments[:] = breaks[i]
        for k in range(degree + 1):
            if k > 0:
                arguments[degree - k] = breaks[i + 1]
            blossom(span, degree, knots, rows, arguments, local)
            for c in range(columns):
                bezier[k, c] = local[degree, c]
        for c in range(columns):
            size = largest = 0.0
            smallest = np.inf
            for k in range(degree + 1):
                largest, smallest = max(largest, abs(bezier[k, c])), min(smallest, bezier[k, c])
                total = 0.0
                for b in range(degree + 1):
                    total += to_powers[k, b] * bezier[b, c]
                coefficients[i, k, c] = total
                size += abs(total)
            poor[i] |= size > CANCELLING * (largest if c < columns - 1 else smallest)
        poor[i] &= breaks[i] < 0.5 * (breaks[i] + breaks[i + 1]) < breaks[i + 1]
    return coefficients, poor


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
    breaks, scales, coefficients, rational = spans
    x = (u - breaks[span]) * scales[span] - 1.0
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


@compiled
def points(spans, ends, u, out):
    """C(u) for very many u into ``out (len(u), dim)``; ``ends (2, dim)`` are exact, where powers are rounded.

    A guide table of four cells a span tells which few spans may hold a parameter.
    """
    breaks = spans[0]
    low, high, cells = breaks[0], breaks[-1], 4 * (breaks.size - 1)
    per_cell = cells / (high - low)
    guide = np.searchsorted((breaks[1:-1] - low) * per_cell, np.arange(cells + 2))
    for k in range(u.size):
        if u[k] in (low, high):
            out[k] = ends[int(u[k] == high)]
            continue
        cell = min(int((u[k] - low) * per_cell), cells)
        span, top = guide[cell], guide[cell + 1]
        while top > span:
            middle = (span + top + 1) // 2
            if u[k] < breaks[middle]:
                top = middle - 1
            else:
                span = middle
        place = point(spans, span, u[k])
        for d in range(out.shape[1]):
            out[k, d] = place[d]


@kernel
def _local_speed(coefficients, rational, span, x):
    """|dC/dx|."""
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
        ratio, scale = slope / weight, 1.0 / weight
        dx, dy, dz = (dx - ratio * px) * scale, (dy - ratio * py) * scale, (dz - ratio * pz) * scale
    return sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def speed(spans, span, u):
    """|C'(u)|."""
    scale = spans[1][span]
    return scale * _local_speed(spans[2], spans[3], span, (u - spans[0][span]) * scale - 1.0)


@kernel
def derivatives(spans, span, u, column):
    """First three derivatives in u of one Cartesian coordinate."""
    breaks, scales, coefficients, rational = spans
    scale = scales[span]
    x = (u - breaks[span]) * scale - 1.0
    p0, p1, p2, p3 = _polynomial(coefficients, span, column, x)
    if rational:
        w0, w1, w2, w3 = _polynomial(coefficients, span, ZERO + 3, x)
        p0 /= w0
        p1 = (p1 - w1 * p0) / w0
        p2 = (p2 - 2.0 * w1 * p1 - w2 * p0) / w0
        p3 = (p3 - 3.0 * w1 * p2 - 3.0 * w2 * p1 - w3 * p0) / w0
    return p1 * scale, p2 * scale**2, p3 * scale**3


@inlined
def speed_jet(spans, span, u):
    """|C'| and its first two derivatives in u."""
    x1, x2, x3 = derivatives(spans, span, u, ZERO)
    y1, y2, y3 = derivatives(spans, span, u, ZERO + 1)
    z1, z2, z3 = derivatives(spans, span, u, ZERO + 2)
    value = sqrt(x1 * x1 + y1 * y1 + z1 * z1)
    first = (x1 * x2 + y1 * y2 + z1 * z2) / value
    second = (x2 * x2 + y2 * y2 + z2 * z2 + x1 * x3 + y1 * y3 + z1 * z3 - first * first) / value
    return value, first, second


@kernel
def _quadrature(spans, span, start, stop, nodes, weights):
    """Arc length between two parameters of one span, by a rule on [-1, 1], and the least and largest |C'|."""
    breaks, scales, coefficients, rational = spans
    half = 0.5 * (stop - start) * scales[span]
    middle = (start - breaks[span]) * scales[span] - 1.0 + half
    total, least, largest = 0.0, np.inf, 0.0
    for k in range(nodes.size):
        found = _local_speed(coefficients, rational, span, middle + half * nodes[k])
        total, least, largest = total + weights[k] * found, min(least, found), max(largest, found)
    return half * total, least, largest


@kernel
def gauss(spans, span, start, stop):
    """Arc length between two parameters of one span, by eight Gauss points."""
    return _quadrature(spans, span, start, stop, GAUSS_NODES, GAUSS_WEIGHTS)[0]


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
def panel_table(spans, tolerance, low, high):
    """Panels from ``low`` to ``high``: every span is halved until one panel and its two halves agree.

    The whole has nine Gauss-Lobatto points, both ends among them, so that a kink of |C'| next to an end is
    seen; the halves have Gauss points. They must agree to ``tolerance`` of the whole length, and |C'| must
    nowhere be small, since the curve may turn back on itself between two points, and back again. A panel is
    also done after 50 halvings, where no parameter lies inside it, and where its span has 2000 panels.
    """
    breaks = spans[0]
    scale = 0.0
    for span in range(breaks.size - 1):
        start, stop = max(breaks[span], low), min(breaks[span + 1], high)
        if start < stop:
            scale += gauss(spans, span, start, stop)
    nodes = [low]
    lengths = [0.0]
    pending = [(low, low, 0)]
    for span in range(breaks.size - 1):
        start, stop = max(breaks[span], low), min(breaks[span + 1], high)
        if start >= stop:
            continue
        pending.clear()
        pending.append((start, stop, 0))
        most = len(nodes) + MOST_PANELS
        while pending:
            start, stop, depth = pending.pop()
            middle = 0.5 * (start + stop)
            whole, least, largest = _quadrature(spans, span, start, stop, LOBATTO_NODES, LOBATTO_WEIGHTS)
            halves = gauss(spans, span, start, middle) + gauss(spans, span, middle, stop)
            last = depth == DEEPEST or not start < middle < stop or len(nodes) + len(pending) >= most
            if last or (abs(whole - halves) <= tolerance * scale and least >= SLOW * largest):
                nodes.append(stop)
                lengths.append(lengths[-1] + halves)
            else:
                pending.append((middle, stop, depth + 1))
                pending.append((start, middle, depth + 1))
    return np.array(nodes), np.array(lengths)


@kernel
def moved_lengths(spans, panels, u, out):
    """Arc length of every step between neighbours of the increasing parameters u."""
    span = panel = ZERO
    for k in range(u.size - 1):
        span = find_span(spans[0], u[k], span)
        panel = find_span(panels[0], u[k], panel)
        out[k] = arc(spans, panels, u[k], u[k + 1], span, panel)


@kernel
def parameter_at(spans, panels, hints, length):
    """Parameter at an arc length, by Newton's method, and by bisection where it leaves a panel.

    It begins on the cubic of the parameter over the length that has the slopes 1 / |C'| at both ends of the
    panel. At most 60 steps are made. ``hints`` are a panel and a span near it; those that hold it are
    returned, and the number of evaluations of |C'|.
    """
    breaks, (nodes, totals) = spans[0], panels
    panel = find_span(totals, length, hints[0])
    begin, end, part = nodes[panel], nodes[panel + 1], totals[panel + 1] - totals[panel]
    span = find_span(breaks, begin, hints[1])
    if length >= totals[-1]:
        return nodes[-1], (panel, span), 0
    low, high, width, wanted = begin, end, end - begin, length - totals[panel]
    x = wanted / part
    first, last = part / (width * speed(spans, span, low)), part / (width * speed(spans, span, high))
    guess = low + width * x * (first + x * (3.0 - 2.0 * first - last + x * (first + last - 2.0)))
    if not low <= guess <= high:  # at a cusp a slope is infinite
        guess = low + x * width if part > 0.0 else low
    count = 2
    for _ in range(60):
        excess = gauss(spans, span, begin, guess) - wanted
        if excess > 0.0:
            high = guess
        else:
            low = guess
        following = guess - excess / speed(spans, span, guess)
        count += 9
        inside = low <= following <= high
        if not inside:
            following = 0.5 * (low + high)
        moved = abs(following - guess)
        guess = following
        if moved <= 1e-16 * abs(guess) or (inside and moved <= ENOUGH * width):
            break
    return guess, (panel, span), count


@kernel
def invert(spans, panels, lengths, u):
    """Parameters at increasing arc lengths."""
    hints = (ZERO, ZERO)
    for k in range(lengths.size):
        u[k], hints, _ = parameter_at(spans, panels, hints, lengths[k])
