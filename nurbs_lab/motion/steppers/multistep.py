"""Three multistep formulas that end at knots: 'history', 'history-arc' and 'adams-arc'.

All integrate the cubic through the last four slopes, as the Adams-Bashforth formula of Eq. (13) does. The
nodes need not be equally spaced, so the cubic is kept in Newton's form, by divided differences.

The slope is exact in 'adams-arc'. In the others it is that of the polynomial through the last five points,
which is of fourth order and needs no evaluation but that of the point. 'history' integrates
``du/dt = v(t) / |C'|``, the others ``du/ds = 1 / |C'|`` over the commanded length, whose right-hand side does
not depend on the speed and so is smooth at a corner of v(t).

A step that crosses a knot is split there, and a new history begins with the Taylor series of the next span at
the knot, because C is smooth only between knots. Every history begins with a Taylor series at the start too.

A curve may be so sharp, or a span so short, that a cubic cannot follow it at the given period. Its last term
is then a large part of the step. Over arc such a step is made by the exact rule, and a new history begins
behind it.
"""

from functools import partial
from math import sqrt

import numpy as np

from nurbs_lab.motion._kernels import displacement, feed_at, settle
from nurbs_lab.motion.steppers.adams import is_held
from nurbs_lab.motion.steppers.registry import KEPT, Rule, Stepper, register
from nurbs_lab.nurbs.span_kernels import find_span, gauss, kernel, parameter_at, point, speed

#: A sample nearer to the newest node than this fraction of the coming step does not become a node: the
#: rounding of its point, divided by the cube of the distance, would spoil the differences.
_NEAR = 0.5
#: The same distance as a fraction of the largest coordinate: a shorter arc consists of rounding errors.
_SHORT = 5e-6
#: A step over arc whose cubic ends with more than this fraction of it is made by the exact rule instead.
_TRUST = 1e-4
_POINTS, _SLOPES = 5, 4


@kernel
def _push_point(nodes, table, size, node, place):
    """Put a point in front of the divided differences of C, one row for each order, and drop the oldest.

    ``table[k]`` is the difference over the k + 1 newest nodes.
    """
    for column in range(3):
        new = place[column]
        for k in range(size):
            old = table[k, column]
            table[k, column] = new
            new = (new - old) / (node - nodes[k])
        if size < _POINTS:
            table[size, column] = new
    for k in range(_POINTS - 1, 0, -1):
        nodes[k] = nodes[k - 1]
    nodes[0] = node
    return min(size + 1, _POINTS)


@kernel
def _push_slope(row, known, since, slope):
    """The cubic of ``_advance`` with a new slope at the distance ``since``, without the oldest slope."""
    b0, b1, b2, _, p1, p2 = row
    first = (slope - b0) / since
    second = (first - b1) / (since - p1) if known > 1 else 0.0
    third = (second - b2) / (since - p2) if known > 2 else 0.0
    return (slope, first, second, third, -since, p1 - since), min(known + 1, _SLOPES)


@kernel
def _speed_at_newest(nodes, table, size):
    """|C'| at the newest node, of the polynomial through all of them."""
    total = 0.0
    for column in range(3):
        slope, factor = 0.0, 1.0
        for k in range(1, size):
            slope += factor * table[k, column]
            factor *= nodes[0] - nodes[k]
        total += slope * slope
    return sqrt(total)


@kernel
def _advance(row, x):
    """Integral of the cubic through the slopes from the newest node over x, and its value there.

    ``row`` holds the divided differences of the slopes, newest first, and the places of the second and
    third node behind the newest.
    """
    b0, b1, b2, b3, p1, p2 = row
    first = b1 - p1 * b2 + p1 * p2 * b3
    second = b2 - (p1 + p2) * b3
    total = x * (b0 + x * (first / 2.0 + x * (second / 3.0 + x * b3 / 4.0)))
    return total, b0 + x * (first + x * (second + x * b3))


@kernel
def _when(row, wanted, low, high):
    """Where between low and high the integral is as wanted (Newton's method, kept inside)."""
    x = high
    for _ in range(30):
        reached, slope = _advance(row, x)
        change = (reached - wanted) / slope
        x = min(max(x - change, low), high)
        if not abs(change) > 1e-15 * high:
            break
    return x


@kernel
def _taylor_of_curve(spans, span, u, table):
    """The Taylor coefficients of C at u, up to the fourth power, into the rows of ``table``, (5, 3)."""
    breaks, scales, coefficients, rational = spans
    x = (u - breaks[span]) * scales[span] - 1.0
    row = np.zeros((5, 4))
    for column in range(4):
        for k in range(coefficients.shape[1]):  # Horner's rule, with all derivatives carried along
            for order in range(4, 0, -1):
                row[order, column] = row[order, column] * x + row[order - 1, column]
            row[0, column] = row[0, column] * x + coefficients[span, k, column]
    for column in range(3):
        factor = 1.0
        for order in range(5):
            value = row[order, column]
            if rational:
                for k in range(1, order + 1):
                    value -= row[k, 3] * row[order - k, column]
                value /= row[0, 3]
                row[order, column] = value
            table[order, column] = value * factor
            factor *= scales[span]


@kernel
def _restart(spans, span, u, moment, over_arc, past):
    """Begin a history at u: the Taylor series of C by u, and of u by arc or by time.

    ``moment`` is the feed, the time, and the phase that holds it.
    """
    nodes, table = past
    nodes[:] = u
    _taylor_of_curve(spans, span, u, table)
    q0 = q1 = q2 = q3 = 0.0  # of |C'|²
    for column in range(3):
        d0, d1 = table[1, column], 2.0 * table[2, column]
        d2, d3 = 3.0 * table[3, column], 4.0 * table[4, column]
        q0 += d0 * d0
        q1 += 2.0 * d0 * d1
        q2 += 2.0 * d0 * d2 + d1 * d1
        q3 += 2.0 * (d0 * d3 + d1 * d2)
    a1 = sqrt(q0)  # of the arc: a1 u + a2 u² + ...
    a2 = q1 / (4.0 * a1)
    a3 = (q2 - 4.0 * a2 * a2) / (6.0 * a1)
    a4 = (q3 - 12.0 * a2 * a3) / (8.0 * a1)
    # of u by arc: that series reversed
    b1 = 1.0 / a1
    b2 = -a2 * b1**3
    b3 = (2.0 * a2 * a2 - a1 * a3) * b1**5
    b4 = (5.0 * a1 * a2 * a3 - a1 * a1 * a4 - 5.0 * a2**3) * b1**7
    if not over_arc:  # the arc by time put in
        v, a, j, _ = feed_at(*moment)
        s2, s3 = 0.5 * a, j / 6.0
        b4 = b4 * v**4 + 3.0 * b3 * v * v * s2 + b2 * (2.0 * v * s3 + s2 * s2)
        b3 = b3 * v**3 + 2.0 * b2 * v * s2 + b1 * s3
        b2 = b2 * v * v + b1 * s2
        b1 *= v
    return b1, 2.0 * b2, 3.0 * b3, 4.0 * b4, 0.0, 0.0


@kernel
def _trusted(row, x):
    """Whether the last term of the cubic is a small part of the step."""
    return abs(row[3]) * x * x * x < _TRUST * row[0]


@kernel
def _measured_slope(spans, span, u, counts, past):
    """1 / |C'| by arc at a new node: exact, or by the points of the past, which are then not empty."""
    nodes, table, size = past
    if not nodes.size:
        counts[1] += 1
        return 1.0 / speed(spans, span, u), size
    counts[0] += 1
    size = _push_point(nodes, table, size, u, point(spans, span, u))
    return 1.0 / _speed_at_newest(nodes, table, size), size


@kernel
def _multistep(spans, feed, period, u, counts, past, how):
    breaks, (nodes, table), (over_arc, panels, short) = spans[0], past, how
    span = points = known = phase = panel = 0
    anew, base, since, row = True, 0.0, 0.0, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for step in range(u.size - 1):
        t = step * period
        v, _, _, phase = feed_at(feed, t, phase)
        length = displacement(feed, t, period, phase) if over_arc else period
        if is_held(feed, v, t, period, phase) and settle(u, step, u[step], breaks[-1]):
            anew = not over_arc  # slopes of zero hold no information about the curve
            continue
        if since > max(_NEAR * length, short):
            base = u[step]
            span = find_span(breaks, base, span)
            slope, points = _measured_slope(spans, span, base, counts, (nodes, table, points))
            row, known = _push_slope(row, known, since, slope if over_arc else v * slope)
            since = 0.0
        if anew:
            base, since = u[step], 0.0
            span = find_span(breaks, base, span)
        low, high = since, since + length
        following = base + _advance(row, high)[0]
        trusted = _trusted(row, high) or not over_arc
        while anew or (trusted and span < breaks.size - 2 and following > breaks[span + 1]):
            if not anew:
                span += 1
                high -= _when(row, breaks[span] - base, low, high)
                base = breaks[span]
            low, anew = 0.0, False
            moment = t + period * (1.0 - high / length)
            row = _restart(spans, span, base, (feed, moment, phase), over_arc, (nodes, table))
            counts += 1
            points, known = _POINTS, _SLOPES
            following = base + _advance(row, high)[0]
            trusted = _trusted(row, high) or not over_arc
        since = high
        if not trusted:
            span = find_span(breaks, u[step], span)
            panel = find_span(panels[0], u[step], panel)
            gone = panels[1][panel] + gauss(spans, span, panels[0][panel], u[step])
            following, _, count = parameter_at(spans, panels, (panel, span), gone + length)
            counts[1] += count
            anew = True
        if not following > u[step]:  # in the last moments of braking: the planned length instead
            following = u[step] + displacement(feed, t, period, phase) / speed(spans, span, u[step])
            counts[1] += 1
        if not settle(u, step, following, breaks[-1]):
            break
    return step


def _run(job, *, exact, over_arc):
    homogeneous = job.curve.homogeneous
    short = 0.0
    if over_arc and not exact:
        short = _SHORT * np.abs(homogeneous[:, :-1]).max() / homogeneous[:, -1].min()
    past = np.empty(0 if exact else _POINTS), np.zeros((_POINTS, 3))
    return Rule(_multistep, (past, (over_arc, job.track.panels, short)))


_ROWS = (
    ("history", "|C'| from stored points, over time, cut at knots, ours", (1, 0, 0, 0), False, False),
    ("history-arc", "|C'| from stored points, over arc, cut at knots, ours", (1, 0, 0, 0), False, True),
    ("adams-arc", "exact |C'|, over arc, cut at knots", (0, 1, 0, 0), True, True),
)
for _name, _summary, _evaluations, _exact, _over_arc in _ROWS:
    _call = partial(_run, exact=_exact, over_arc=_over_arc)
    _keeps = KEPT if _over_arc else ()  # the accelerations to 1 % on sharp curves, elsewhere all
    register(Stepper(_name, f"Adams of order 4, {_summary}", _evaluations, _call, 4, keeps=_keeps))
