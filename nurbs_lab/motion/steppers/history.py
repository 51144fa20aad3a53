"""Adams without derivatives and without losing its order: |C'| from backward differences of stored points.

The difference quotient of Eq. (16) is first order, and so is all that is built on it. The points
C(u_j), C(u_{j-1}), ... are stored anyway; the derivative at u_j of the polynomial through five of them is
fourth order, for the same single evaluation of C a step.

A curve is smooth only between knots, so a history never spans one. A step that meets a knot is cut there
and goes on with the Taylor series of u(t) from the knot; the knot, with the derivatives known there once and
for all, then opens the new history as a threefold node (divided differences with repeated nodes).
"""

from math import sqrt

import numpy as np

from nurbs_lab.motion._kernels import GOING, displacement, feed_at, settle
from nurbs_lab.motion.steppers.registry import Stepper, drive, register
from nurbs_lab.nurbs.span_kernels import derivatives, kernel, point, speed, speed_jet

#: A sample that lands behind a knot by less than this part of a period is left out: rounding, divided by the
#: cube of the distance, would be in the differences. More would cost accuracy by the gap that it leaves.
_NEAR = 0.2
_POINTS, _SLOPES = 5, 4


@kernel
def _push(nodes, table, size, node, values):
    """Put a node in front of a row of divided differences ``[z0], [z0, z1], ...``; the oldest falls out.

    ``table[k]`` is the difference over the k + 1 newest nodes, one column for each coordinate.
    """
    for column in range(table.shape[1]):
        new = values[column]
        for k in range(size):
            old = table[k, column]
            table[k, column] = new
            new = (new - old) / (node - nodes[k])
        if size < table.shape[0]:
            table[size, column] = new
    size = min(size + 1, nodes.size)
    for k in range(size - 1, 0, -1):
        nodes[k] = nodes[k - 1]
    nodes[0] = node
    return size


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
def _restart(spans, feed, span, knot, time, piece, nodes, table, times, slopes, counts):
    """Begin again at a knot, a threefold node: C, C' and C''/2 by u, and u' with its derivatives by time."""
    nodes[:3], times[:3] = knot, time
    place = point(spans, span, knot)
    for column in range(3):
        first, second, _ = derivatives(spans, span, knot, column)
        table[0, column], table[1, column], table[2, column] = place[column], first, 0.5 * second
    v, a, j, _ = feed_at(feed, time, piece)
    value, bend, twist = speed_jet(spans, span, knot)
    counts += 1
    one = v / value
    two = (a - bend * one * one) / value
    slopes[0, 0], slopes[1, 0] = one, two
    slopes[2, 0] = 0.5 * (j - twist * one**3 - 3.0 * bend * one * two) / value
    slopes[3, 0] = 0.0


@kernel
def _reached(u, times, slopes, later):
    """u at a later time: the polynomial through the stored slopes, integrated from the newest."""
    s, a, b = later - times[0], times[1] - times[0], times[2] - times[0]
    first = slopes[1, 0] - a * slopes[2, 0] + a * b * slopes[3, 0]
    second = slopes[2, 0] - (a + b) * slopes[3, 0]
    return u + s * (slopes[0, 0] + s * (first / 2.0 + s * (second / 3.0 + s * slopes[3, 0] / 4.0)))


@kernel
def _when(u, times, slopes, target, latest):
    """Time at which the target is reached (bisection)."""
    early, late = times[0], latest
    for _ in range(52):
        middle = 0.5 * (early + late)
        if _reached(u, times, slopes, middle) < target:
            early = middle
        else:
            late = middle
    return late


@kernel
def _history(spans, feed, period, done, until, u, counts, nodes, table, times, slopes, at):
    breaks = spans[0]
    if done == 0:
        _restart(spans, feed, 0, u[0], 0.0, 0, nodes, table, times, slopes, counts)
        at[0], at[1], at[2] = 0, 3, 3
    span, points, speeds = at[0], at[1], at[2]
    piece = 0
    for step in range(done, until):
        t = step * period
        if t - times[0] > _NEAR * period:
            points = _push(nodes, table, points, u[step], point(spans, span, u[step]))
            counts[0] += 1
            v, _, _, piece = feed_at(feed, t, piece)
            speeds = _push(times, slopes, speeds, t, (v / _speed_at_newest(nodes, table, points),))
        following = _reached(nodes[0], times, slopes, t + period)
        while span < breaks.size - 2 and following > breaks[span + 1]:
            meeting = _when(nodes[0], times, slopes, breaks[span + 1], t + period)
            span += 1
            _restart(spans, feed, span, breaks[span], meeting, piece, nodes, table, times, slopes, counts)
            points = speeds = 3
            following = _reached(nodes[0], times, slopes, t + period)
        if following <= u[step]:  # in the last moments of braking: the planned length instead
            following = u[step] + displacement(feed, t, period, piece) / speed(spans, span, u[step])
            counts[1] += 1
        status = settle(u, step, following, breaks[-1])
        if status != GOING:
            return status, step
    at[0], at[1], at[2] = span, points, speeds
    return GOING, until - 1


def _run(job):
    nodes, times = np.empty(_POINTS), np.empty(_SLOPES)
    table, slopes = np.empty((_POINTS, 3)), np.empty((_SLOPES, 1))
    return drive(job, _history, nodes, table, times, slopes, np.zeros(3, dtype=np.int64))


register(
    Stepper(
        "history",
        "Adams of order 4, |C'| by backward differences of the stored points, cut at knots, ours",
        (1, 0, 0, 0),
        _run,
        4,
    )
)
