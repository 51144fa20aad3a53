"""One-step rules: Taylor series of u(t), and Runge-Kutta for u' = v(t) / |C'(u)|."""

from functools import partial

from nurbs_lab.motion._kernels import GOING, displacement, feed_at, settle
from nurbs_lab.motion.steppers.registry import Rule, Stepper, register
from nurbs_lab.nurbs.span_kernels import find_span, kernel, speed, speed_jet


@kernel
def slope(spans, span, u, v):
    """v / |C'(u)|, with u kept on the curve."""
    breaks = spans[0]
    u = min(u, breaks[-1])
    return v / speed(spans, find_span(breaks, u, span), u)


@kernel
def _series(spans, span, u, v, a, j, order, time):
    """Advance of u over ``time``: |C'| u' = v, differentiated once and twice for u'' and u'''."""
    if order == 1:
        return time * v / speed(spans, span, u)
    value, first, second = speed_jet(spans, span, u)
    du = v / value
    ddu = (a - first * du * du) / value
    dddu = (j - second * du**3 - 3.0 * first * du * ddu) / value if order == 3 else 0.0
    return time * (du + time * (0.5 * ddu + time * dddu / 6.0))


@kernel
def advance2(spans, feed, span, phase, u, t, period, counts):
    """One midpoint step."""
    v0, _, _, phase = feed_at(feed, t, phase)
    v1, _, _, _ = feed_at(feed, t + 0.5 * period, phase)
    counts[1] += 2
    return period * slope(spans, span, u + 0.5 * period * slope(spans, span, u, v0), v1)


@kernel
def advance4(spans, feed, span, phase, u, t, period, counts):
    """One classical fourth-order step (Eq. 19)."""
    v0, _, _, phase = feed_at(feed, t, phase)
    v1, _, _, _ = feed_at(feed, t + 0.5 * period, phase)
    v2, _, _, _ = feed_at(feed, t + period, phase)
    k1 = slope(spans, span, u, v0)
    k2 = slope(spans, span, u + 0.5 * period * k1, v1)
    k3 = slope(spans, span, u + 0.5 * period * k2, v1)
    k4 = slope(spans, span, u + period * k3, v2)
    counts[1] += 4
    return period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@kernel
def _taylor(spans, feed, period, offset, done, until, u, counts, order):
    breaks = spans[0]
    span = phase = 0
    for step in range(done, until):
        t = (offset + step) * period
        v, a, j, phase = feed_at(feed, t, phase)
        span = find_span(breaks, u[step], span)
        advance = _series(spans, span, u[step], v, a, j, order, period)
        for k in range(1, order + 1):
            counts[k] += 1
        if not advance > 0.0:  # at rest, and in the last moments of braking: the planned length instead
            advance = displacement(feed, t, period, phase) / speed(spans, span, u[step])
        status = settle(u, step, u[step] + advance, breaks[-1])
        if status != GOING:
            return status, step
    return GOING, until - 1


@kernel
def _runge_kutta(spans, feed, period, offset, done, until, u, counts, order):
    breaks = spans[0]
    span = phase = 0
    for step in range(done, until):
        t = (offset + step) * period
        span = find_span(breaks, u[step], span)
        phase = find_span(feed[0], t, phase)
        if order == 4:
            advance = advance4(spans, feed, span, phase, u[step], t, period, counts)
        else:
            advance = advance2(spans, feed, span, phase, u[step], t, period, counts)
        status = settle(u, step, u[step] + advance, breaks[-1])
        if status != GOING:
            return status, step
    return GOING, until - 1


def _run(job, *, rule, order):
    return Rule(rule, (order,))


_ROWS = (
    ("taylor1", "Taylor series of u(t) up to t", (0, 1, 0, 0), _taylor, 1),
    ("taylor2", "Taylor series of u(t) up to t², the slope of the feed included", (0, 1, 1, 0), _taylor, 2),
    ("taylor3", "Taylor series of u(t) up to t³, the jerk of the feed included", (0, 1, 1, 1), _taylor, 3),
    ("rk2", "Runge-Kutta of order 2, the midpoint rule", (0, 2, 0, 0), _runge_kutta, 2),
    ("rk4", "Runge-Kutta of order 4 (Eq. 19), exact |C'|", (0, 4, 0, 0), _runge_kutta, 4),
)
for _name, _summary, _evaluations, _rule, _order in _ROWS:
    register(Stepper(_name, _summary, _evaluations, partial(_run, rule=_rule, order=_order), _order))
