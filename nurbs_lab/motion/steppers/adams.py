"""The Adams formulas as they are printed, with equal periods and across knots (paper Eq. 11 to 20).

The slope u' = v(t) / |C'(u)| is either exact or, by Eq. (16), v(t) times a difference quotient. The first
four steps are by Runge-Kutta: Eq. (19) with the exact |C'|, or one of four readings of Eq. (20).

Eq. (20) is damaged in the copy of the paper that this project has: the quotient of K4 is lost altogether,
and the denominators of K2 and K3 have plus signs. With h for what is added to u (T/2 K1 and T/2 K2; T K3 for
K4 in every reading, by analogy with Eq. 19) the readings of the quotient that stands for |C'(u_j + h)| are

- mended:  ``|C(u_j + h) - C(u_{j-1} + h)| / |u_j - u_{j-1}|``, both ends moved;
- newer:   ``|C(u_j + h) - C(u_{j-1})| / |u_j - u_{j-1} + h|``, the printed denominator, the newer end moved;
- plus:    ``|C(u_j) - C(u_{j-1} + h)| / |u_j - u_{j-1} + h|``, the signs as printed, which do not match;
- minus:   ``|C(u_j) - C(u_{j-1} + h)| / |u_j - u_{j-1} - h|``, the signs that would; K4 is then 0/0 where
  |C'| is constant, as on a line: T K3 is just u_j - u_{j-1}.

There is no u_{-1}: at u_0 the exact end derivative |C'(u_0)| stands in for every quotient, and after a hold
the last quotient before it does. In the last moments of braking the formula may ask for a step back; then the
planned length over |C'| is taken instead.
"""

from functools import partial
from math import sqrt

import numpy as np

from nurbs_lab.common.kernels import ZERO, inlined, kernel
from nurbs_lab.motion._kernels import displacement, feed_at, settle
from nurbs_lab.motion.steppers.one_step import classical, slope, three_speeds
from nurbs_lab.motion.steppers.registry import Stepper, register, steps_of
from nurbs_lab.nurbs.span_kernels import find_span, point, speed

#: Weights of the slopes at t_j, t_{j-1}, t_{j-2} and t_{j-3} (Eq. 13).
BASHFORTH = (55 / 24, -59 / 24, 37 / 24, -9 / 24)
#: Fourth-order Adams-Moulton: weights of the slopes at t_{j+1}, t_j, t_{j-1}, t_{j-2} (Eq. 12).
MOULTON = (9 / 24, 19 / 24, -5 / 24, 1 / 24)
#: How the steps before Adams are made, and of which slopes: all exact, or quotients after an exact start or
#: after one of the readings.
SLOPES, EXACT, MENDED, NEWER, PLUS, MINUS = range(6)


@kernel
def distance(a, b):
    """|a - b| of two points."""
    dx, dy, dz = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def push(row, value):
    """Put a value in front of a row, whose last one is dropped."""
    for k in range(row.size - 1, 0, -1):
        row[k] = row[k - 1]
    row[0] = value


@kernel
def _point_at(spans, span, u, counts):
    """C(u); beyond the end the last span's polynomial goes on, so that no quotient degenerates there."""
    counts[0] += 1
    return point(spans, find_span(spans[0], u, span), u)


@kernel
def _quotient(spans, span, pair, h, reading, counts):
    """The quotient that stands for |C'(u + h)|; ``pair`` is u, the parameter before, and C at both."""
    u, before, here, there = pair
    width = u - before
    if reading == MENDED:
        moved = _point_at(spans, span, u + h, counts), _point_at(spans, span, before + h, counts)
        return distance(moved[0], moved[1]) / width
    if reading == NEWER:
        return distance(_point_at(spans, span, u + h, counts), there) / (width + h)
    width = width + h if reading == PLUS else abs(width - h)
    return distance(here, _point_at(spans, span, before + h, counts)) / width


@inlined
def _quotient_step(spans, span, pair, value, speeds, period, reading, counts):
    """Eq. (20); ``value`` is the quotient at u. Without a point before, the end derivative is used thrice."""
    v0, v1, v2 = speeds
    k1 = v0 / value
    if pair[0] == pair[1]:
        k2 = k3 = v1 / value
        k4 = v2 / value
    else:
        k2 = v1 / _quotient(spans, span, pair, 0.5 * period * k1, reading, counts)
        k3 = v1 / _quotient(spans, span, pair, 0.5 * period * k2, reading, counts)
        k4 = v2 / _quotient(spans, span, pair, period * k3, reading, counts)
    return period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@kernel
def _adams(spans, feed, period, u, counts, reading, started, correct):
    """Eq. (19) or (20) for the first ``started`` steps, then Eq. (15) or (17), corrected once if wanted."""
    breaks, slopes = spans[0], np.zeros(4)
    here, value = (0.0, 0.0, 0.0), 0.0
    span = phase = ZERO
    for step in range(u.size - 1):
        t = step * period
        span = find_span(breaks, u[step], span)
        v, _, _, phase = feed_at(feed, t, phase)
        last = u[max(step - 1, 0)]
        if reading == SLOPES or step == 0:
            value = speed(spans, span, u[step])
            counts[1] += 1
        before = here
        if reading != SLOPES:
            here = _point_at(spans, span, u[step], counts)
            if u[step] > last:
                value = distance(here, before) / (u[step] - last)
        push(slopes, v / value)
        advance, held = 0.0, v == 0.0 and displacement(feed, t, period, phase) == 0.0
        if step >= started and not held:
            for k in range(4):
                advance += period * BASHFORTH[k] * slopes[k]
            if correct:
                v, _, _, _ = feed_at(feed, t + period, phase)
                advance = MOULTON[0] * slope(spans, span, u[step] + advance, v)
                counts[1] += 1
                for k in range(3):
                    advance += MOULTON[k + 1] * slopes[k]
                advance *= period
        elif not held:
            speeds = three_speeds(feed, t, period, phase)
            if reading <= EXACT:
                advance, _ = classical(spans, span, u[step], speeds, period, counts)
            else:
                pair = (u[step], last, here, before)
                advance = _quotient_step(spans, span, pair, value, speeds, period, reading, counts)
        if advance <= 0.0:  # Adams in the last moments of braking: the planned length instead
            advance = displacement(feed, t, period, phase) / value
        if not settle(u, step, u[step] + advance, breaks[-1]):
            break
    return step


def _run(job, *, reading, started, correct):
    return steps_of(job, _adams, reading, job.last_step if started is None else started, correct)


_CORRECTED = "Adams-Bashforth, one Adams-Moulton correction (Eq. 11, 12), order 4, exact |C'|"
_ROWS = (
    ("adams", "Adams-Bashforth of order 4, exact |C'| (Eq. 15)", (0, 1), SLOPES, 4, 4),
    ("abm4", _CORRECTED, (0, 2), SLOPES, 4, 4),
    ("adams-quotient", "Adams with quotients (Eq. 17), exact start", (1, 0), EXACT, 4, 1),
    ("paper", "the paper's scheme: Eq. (20), mended, four times, then Eq. (17)", (1, 0), MENDED, 4, 1),
    ("rk4-quotient", "Eq. (20) mended: both ends of the quotient moved", (7, 0), MENDED, None, 1),
    ("rk4-newer", "Eq. (20) with the newer end moved, as the denominator is printed", (4, 0), NEWER, None, 1),
    ("rk4-plus", "Eq. (20) to the letter, with plus signs: unstable", (4, 0), PLUS, None, None),
    ("rk4-minus", "Eq. (20) with minus signs, K4 by analogy: 0/0 on a line", (4, 0), MINUS, None, None),
)
for _name, _summary, _evaluations, _reading, _started, _order in _ROWS:
    _call = partial(_run, reading=_reading, started=_started, correct=_evaluations[1] == 2)
    register(Stepper(_name, _summary, (*_evaluations, 0, 0), _call, _order))
