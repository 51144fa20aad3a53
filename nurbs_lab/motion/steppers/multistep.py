"""Three multistep formulas that end at knots: 'history', 'history-arc' and 'adams-arc'.

All integrate the cubic through the last four slopes, as the Adams-Bashforth formula of Eq. (13) does. The
nodes need not be equally spaced, so the cubic is kept in Newton's form, by divided differences.

The slope is exact in 'adams-arc'. In the others it is that of the polynomial through the last five points,
which is of fourth order and needs no evaluation but that of the point. 'history' integrates
``du/dt = v(t) / |C'|``, the others ``du/ds = 1 / |C'|`` over the commanded length, whose right-hand side does
not depend on the speed and so is smooth at a corner of v(t).

C is smooth only between knots, and a curve may be so sharp that a cubic cannot follow it at the given
period: its last term is then a large part of the step. A step across a knot, and over arc one whose cubic is
not trusted, is made by the exact rule, and a new history begins behind it: with exact slopes, and by the
classical Runge-Kutta rule until there are four of them, or by the exact rule where |C'| changes much within
the step.

Over arc, the steps of a plan may err by a small part of what its limits leave in a period. The next slope
tells by how much a step erred: with it the formula is that of Adams and Moulton, which corrects what erred by
more. A slope that a sixth point would change by more is not used, and a larger sum of errors is made good.
"""

from functools import partial
from math import sqrt

import numpy as np

from nurbs_lab.common.kernels import ZERO, kernel
from nurbs_lab.motion._kernels import displacement, feed_at, length_at, settle
from nurbs_lab.motion.steppers.exact import exact_step
from nurbs_lab.motion.steppers.one_step import classical, three_speeds
from nurbs_lab.motion.steppers.registry import KEPT, Stepper, register, steps_of
from nurbs_lab.nurbs.span_kernels import find_span, point, speed

#: A sample nearer to the newest node than this fraction of the coming step does not become a node: the
#: rounding of its point, divided by the cube of the distance, would spoil the differences.
_NEAR = 0.5
#: The same distance as a fraction of the largest coordinate: a shorter arc consists of rounding errors.
_SHORT = 5e-7
#: A step over arc whose cubic ends with more than this fraction of it is made by the exact rule instead; a
#: step by Runge-Kutta is, if the slope changes by more than the square root of this in half of it.
_TRUST = 1e-4
#: What a step over arc may err by, as a part of what the limits of a plan leave in a period: a jerk holds
#: errors of three steps, once, twice and once.
_ROOM = 2.5e-4
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
        if size <= _POINTS:
            table[size, column] = new
    for k in range(_POINTS, 0, -1):
        nodes[k] = nodes[k - 1]
    nodes[0] = node
    return min(size + 1, _POINTS + 1)


@kernel
def _push_slope(row, known, since, slope):
    """The cubic of ``_advance`` with a new slope at the distance ``since``, without the oldest slope."""
    b0, b1, b2, _, p1, p2 = row
    first = (slope - b0) / since if known > 0 else 0.0
    second = (first - b1) / (since - p1) if known > 1 else 0.0
    third = (second - b2) / (since - p2) if known > 2 else 0.0
    return (slope, first, second, third, -since, p1 - since), min(known + 1, _SLOPES)


@kernel
def _advance(row, x):
    """Integral of the cubic through the slopes from the newest node over x.

    ``row`` holds the divided differences of the slopes, newest first, and the places of the second and
    third node behind the newest.
    """
    b0, b1, b2, b3, p1, p2 = row
    first = b1 - p1 * b2 + p1 * p2 * b3
    second = b2 - (p1 + p2) * b3
    return x * (b0 + x * (first / 2.0 + x * (second / 3.0 + x * b3 / 4.0)))


@kernel
def _slope(spans, span, u, counts, past):
    """1 / |C'| at a new node: exact, or of the polynomial through the five newest points, if there are five.

    The third result is by what part a sixth point would change it.
    """
    nodes, table, size = past
    if nodes.size:
        counts[0] += 1
        size = _push_point(nodes, table, size, u, point(spans, span, u))
    if size < _POINTS:
        counts[1] += 1
        return 1.0 / speed(spans, span, u), size, 0.0
    total = change = 0.0
    for column in range(3):
        slope, factor = 0.0, 1.0
        for k in range(1, _POINTS):
            slope += factor * table[k, column]
            factor *= nodes[0] - nodes[k]
        total += slope * slope
        change += (factor * table[_POINTS, column]) ** 2 if size > _POINTS else 0.0
    return 1.0 / sqrt(total), size, sqrt(change / total)


@kernel
def _multistep(spans, feed, period, u, counts, past, how):
    breaks, (nodes, table), (over_arc, panels, short, room) = spans[0], past, how
    span = points = known = phase = panel = ZERO
    base, since, row = 0.0, 0.0, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    ahead, blurred, length, by_cubic = 0.0, 0.0, 0.0, False
    for step in range(u.size - 1):
        t = step * period
        v, _, _, phase = feed_at(feed, t, phase)
        gone, before, length = length_at(feed, t, phase), length, displacement(feed, t, period, phase)
        if length == 0.0 and settle(u, step, u[step], breaks[-1]):
            known = known if over_arc else ZERO  # slopes of zero hold no information about the curve
            continue
        span, way = find_span(breaks, u[step], span), length if over_arc else period
        if known == 0 or since > max(_NEAR * way, short):
            slope, points, blurred = _slope(spans, span, u[step], counts, (nodes, table, points))
            row, known = _push_slope(row, known, since, slope if over_arc else v * slope)
            missed = (u[step] - base + _advance(row, -since)) / slope if by_cubic else 0.0
            base, since, ahead = u[step], 0.0, ahead + missed
            if abs(missed) > 10.0 * room:  # of which the formula leaves a tenth
                u[step], panel, count, reached = exact_step(spans, panels, (panel, span), u[step - 1], before)
                counts[1], since, ahead = counts[1] + count, (u[step] - base) / slope, reached - gone
            elif abs(missed) > room:
                u[step] = min(max(u[step] - missed * slope, u[step - 1]), breaks[-1])
                since, ahead = -missed, ahead - missed
        excess = ahead - min(max(ahead, -room), room)  # an eighth is made good now, but no more than a room
        back = min(max(0.125 * excess, -room), room)
        way, ahead = way - back, ahead - back
        since += way
        by_cubic = known == _SLOPES
        if by_cubic:
            following = base + _advance(row, since)
            trusted = not over_arc or abs(row[3]) * since**3 < _TRUST * row[0]
        else:
            speeds = (1.0, 1.0, 1.0) if over_arc else three_speeds(feed, t, period, phase)
            advance, doubt = classical(spans, span, u[step], speeds, way, counts)
            following, trusted = u[step] + advance, doubt * doubt < _TRUST
        inside = following < breaks[span + 1] or span == breaks.size - 2
        cut = not (trusted and inside and following > u[step])
        if cut or (by_cubic and blurred * since > room):
            way, by_cubic = length - back, False
            following, panel, count, reached = exact_step(spans, panels, (panel, span), u[step], way)
            counts[1], ahead = counts[1] + count, reached - gone - length
        if cut:
            known = points = ZERO
        if not settle(u, step, following, breaks[-1]):
            break
    return step


def _run(job, *, exact, over_arc):
    short = _SHORT * np.abs(job.curve.control_points).max() if over_arc and not exact else 0.0
    room, limits = np.inf, job.feed.limits
    if over_arc and limits is not None:
        powers = {"acceleration": 2, "axis_acceleration": 2, "jerk": 3, "axis_jerk": 3}
        given = [(getattr(limits, name), power) for name, power in powers.items()]
        room = _ROOM * min(np.min(one) * job.period_s**power for one, power in given if one is not None)
    past = np.empty(0 if exact else _POINTS + 1), np.zeros((_POINTS + 1, 3))
    return steps_of(job, _multistep, past, (over_arc, job.track.panels, short, room))


_ROWS = (
    ("history", "|C'| from stored points, over time, cut at knots, ours", (1, 0, 0, 0), False, False),
    ("history-arc", "|C'| from stored points, over arc, cut at knots, ours", (1, 0, 0, 0), False, True),
    ("adams-arc", "exact |C'|, over arc, cut at knots", (0, 1, 0, 0), True, True),
)
for _name, _summary, _evaluations, _exact, _over_arc in _ROWS:
    _call = partial(_run, exact=_exact, over_arc=_over_arc)
    _summary = f"Adams of order 4, {_summary}"
    register(Stepper(_name, _summary, _evaluations, _call, 4, keeps=KEPT if _over_arc else ()))
