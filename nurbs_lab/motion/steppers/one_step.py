"""One-step rules: the Taylor series of u(t), and Runge-Kutta for u' = v(t) / |C'(u)|."""

from functools import partial

from nurbs_lab.common.kernels import ZERO, inlined, kernel
from nurbs_lab.motion._kernels import displacement, feed_at, settle
from nurbs_lab.motion.steppers.registry import Stepper, register, steps_of
from nurbs_lab.nurbs.span_kernels import find_span, speed, speed_jet

TAYLOR, RUNGE_KUTTA = range(2)


@kernel
def slope(spans, span, u, v):
    """v / |C'(u)|, with u kept on the curve."""
    breaks = spans[0]
    u = min(u, breaks[-1])
    return v / speed(spans, find_span(breaks, u, span), u)


@inlined
def _series(spans, feed, span, u, t, period, phase, order):
    """Advance of u in a period: |C'| u' = v, differentiated once and twice for the higher derivatives."""
    v, a, j, phase = feed_at(feed, t, phase)
    later = feed_at(feed, t + period, phase)[1]  # in the branch that uses it, it would slow all orders down
    if order == 1:
        return period * v / speed(spans, span, u)
    value, first, second = speed_jet(spans, span, u)
    du = v / value
    ddu = (a - first * du * du) / value
    dddu = 0.0
    if order == 3:
        most = abs(later - a) / period
        j = min(max(j, -most), most)  # a jerk may end long before the period
        dddu = (j - second * du**3 - 3.0 * first * du * ddu) / value
    return period * (du + period * (0.5 * ddu + period * dddu / 6.0))


@kernel
def three_speeds(feed, t, period, phase):
    """The commanded speeds at the begin, the middle and the end of a period."""
    v0, _, _, phase = feed_at(feed, t, phase)
    v1, _, _, phase = feed_at(feed, t + 0.5 * period, phase)
    return v0, v1, feed_at(feed, t + period, phase)[0]


@kernel
def classical(spans, span, u, speeds, period, counts):
    """Advance of u by one step of the classical Runge-Kutta rule of fourth order (Eq. 19).

    The second result is the part by which 1 / |C'| changes in the first half of the step.
    """
    v0, v1, v2 = speeds
    here = slope(spans, span, u, 1.0)
    k1 = v0 * here
    ahead = slope(spans, span, u + 0.5 * period * k1, 1.0)
    k2 = v1 * ahead
    k3 = slope(spans, span, u + 0.5 * period * k2, v1)
    k4 = slope(spans, span, u + period * k3, v2)
    counts[1] += 4
    return period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), abs(ahead - here) / here


@kernel
def _one_step(spans, feed, period, u, counts, family, order):
    breaks = spans[0]
    span = phase = ZERO
    for step in range(u.size - 1):
        t = step * period
        span = find_span(breaks, u[step], span)
        phase = find_span(feed[0], t, phase)
        if family == RUNGE_KUTTA:
            v0, v1, v2 = three_speeds(feed, t, period, phase)
            if order == 4:
                advance, _ = classical(spans, span, u[step], (v0, v1, v2), period, counts)
            else:  # the midpoint rule
                half = 0.5 * period * slope(spans, span, u[step], v0)
                advance = period * slope(spans, span, u[step] + half, v1)
                counts[1] += 2
        else:
            advance = _series(spans, feed, span, u[step], t, period, phase, order)
            if not advance > 0.0:  # at rest, and in the last moments of braking: the planned length instead
                advance = displacement(feed, t, period, phase) / speed(spans, span, u[step])
        if not settle(u, step, u[step] + advance, breaks[-1]):
            break
    if family == TAYLOR:
        counts[1 : order + 1] += step + 1
    return step


def _run(job, *, family, order):
    return steps_of(job, _one_step, family, order)


_ROWS = (
    ("taylor1", "Taylor series of u(t) up to t", (0, 1, 0, 0), TAYLOR, 1),
    ("taylor2", "Taylor series of u(t) up to t², the slope of the feed included", (0, 1, 1, 0), TAYLOR, 2),
    ("taylor3", "Taylor series of u(t) up to t³, the jerk of the feed included", (0, 1, 1, 1), TAYLOR, 3),
    ("rk2", "Runge-Kutta of order 2, the midpoint rule", (0, 2, 0, 0), RUNGE_KUTTA, 2),
    ("rk4", "Runge-Kutta of order 4 (Eq. 19), exact |C'|", (0, 4, 0, 0), RUNGE_KUTTA, 4),
)
for _name, _summary, _evaluations, _family, _order in _ROWS:
    register(Stepper(_name, _summary, _evaluations, partial(_run, family=_family, order=_order), _order))
