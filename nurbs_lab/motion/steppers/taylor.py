"""Taylor series of u(t), the rule most controllers use (paper's reference 12)."""

from functools import partial

from nurbs_lab.motion._kernels import GOING, displacement, feed_at, settle
from nurbs_lab.motion.steppers.registry import Stepper, drive, register
from nurbs_lab.nurbs.span_kernels import find_span, kernel, speed, speed_jet


@kernel
def series(spans, span, u, v, a, j, order, time):
    """Advance of u over ``time``: |C'| u' = v, differentiated once and twice for u'' and u'''."""
    if order == 1:
        return time * v / speed(spans, span, u)
    value, first, second = speed_jet(spans, span, u)
    du = v / value
    ddu = (a - first * du * du) / value
    dddu = (j - second * du**3 - 3.0 * first * du * ddu) / value if order == 3 else 0.0
    return time * (du + time * (0.5 * ddu + time * dddu / 6.0))


@kernel
def _taylor(spans, feed, period, done, until, u, counts, order):
    breaks = spans[0]
    end = breaks[-1]
    span = piece = 0
    for step in range(done, until):
        t = step * period
        v, a, j, piece = feed_at(feed, t, piece)
        span = find_span(breaks, u[step], span)
        advance = series(spans, span, u[step], v, a, j, order, period)
        for k in range(1, order + 1):
            counts[k] += 1
        if not advance > 0.0:  # at rest, and in the last moments of braking: the planned length instead
            advance = displacement(feed, t, period, piece) / speed(spans, span, u[step])
        status = settle(u, step, u[step] + advance, end)
        if status != GOING:
            return status, step
    return GOING, until - 1


def _run(job, *, order):
    return drive(job, _taylor, order)


for _order in (1, 2, 3):
    register(
        Stepper(
            name=f"taylor{_order}",
            summary=f"Taylor series of u(t) up to t**{_order}, the derivatives of the feed included",
            evaluations=(0, 1, int(_order > 1), int(_order > 2)),
            run=partial(_run, order=_order),
            order=_order,
        )
    )
