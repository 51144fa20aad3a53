"""Runge-Kutta on u' = v(t) / |C'(u)|, with the exact |C'| and v sampled inside the period (paper Eq. 19)."""

from functools import partial

from nurbs_lab.motion._kernels import GOING, feed_at, settle
from nurbs_lab.motion.steppers.registry import Stepper, drive, register
from nurbs_lab.nurbs.span_kernels import find_span, kernel, speed


@kernel
def slope(spans, span, u, v):
    """v / |C'(u)|, with u kept on the curve."""
    breaks = spans[0]
    u = min(u, breaks[-1])
    return v / speed(spans, find_span(breaks, u, span), u)


@kernel
def advance4(spans, feed, span, piece, u, t, period, counts):
    """One classical fourth-order step."""
    v0, _, _, piece = feed_at(feed, t, piece)
    v1, _, _, _ = feed_at(feed, t + 0.5 * period, piece)
    v2, _, _, _ = feed_at(feed, t + period, piece)
    k1 = slope(spans, span, u, v0)
    k2 = slope(spans, span, u + 0.5 * period * k1, v1)
    k3 = slope(spans, span, u + 0.5 * period * k2, v1)
    k4 = slope(spans, span, u + period * k3, v2)
    counts[1] += 4
    return period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@kernel
def advance2(spans, feed, span, piece, u, t, period, counts):
    """One midpoint step."""
    v0, _, _, piece = feed_at(feed, t, piece)
    v1, _, _, _ = feed_at(feed, t + 0.5 * period, piece)
    counts[1] += 2
    return period * slope(spans, span, u + 0.5 * period * slope(spans, span, u, v0), v1)


@kernel
def _runge_kutta(spans, feed, period, done, until, u, counts, order):
    breaks = spans[0]
    span = piece = 0
    for step in range(done, until):
        t = step * period
        span = find_span(breaks, u[step], span)
        piece = find_span(feed[0], t, piece)
        if order == 4:
            advance = advance4(spans, feed, span, piece, u[step], t, period, counts)
        else:
            advance = advance2(spans, feed, span, piece, u[step], t, period, counts)
        status = settle(u, step, u[step] + advance, breaks[-1])
        if status != GOING:
            return status, step
    return GOING, until - 1


def _run(job, *, order):
    return drive(job, _runge_kutta, order)


register(Stepper("rk2", "Runge-Kutta of order 2, the midpoint rule", (0, 2, 0, 0), partial(_run, order=2), 2))
register(
    Stepper("rk4", "Runge-Kutta of order 4 (Eq. 19), exact |C'|", (0, 4, 0, 0), partial(_run, order=4), 4)
)
