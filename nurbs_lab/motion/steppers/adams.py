"""Adams formulas on u' = v(t) / |C'(u)| with the exact |C'| (paper Eq. 11-15), started by Runge-Kutta."""

from functools import partial

import numpy as np

from nurbs_lab.motion._kernels import GOING, feed_at, settle
from nurbs_lab.motion.steppers.registry import Stepper, drive, register
from nurbs_lab.motion.steppers.runge_kutta import advance4, slope
from nurbs_lab.nurbs.span_kernels import find_span, kernel

#: Weights of the slopes at t_j, t_{j-1}, ... for orders 1 to 5; the fourth is Eq. (13).
BASHFORTH = {
    1: (1.0,),
    2: (3 / 2, -1 / 2),
    3: (23 / 12, -16 / 12, 5 / 12),
    4: (55 / 24, -59 / 24, 37 / 24, -9 / 24),
    5: (1901 / 720, -2774 / 720, 2616 / 720, -1274 / 720, 251 / 720),
}
#: Fourth-order Adams-Moulton: weights of the slopes at t_{j+1}, t_j, t_{j-1}, t_{j-2}.
MOULTON = (9 / 24, 19 / 24, -5 / 24, 1 / 24)


@kernel
def _adams(spans, feed, period, done, until, u, counts, slopes, weights, correct):
    breaks = spans[0]
    order = weights.size
    span = piece = 0
    for step in range(done, until):
        t = step * period
        span = find_span(breaks, u[step], span)
        v, _, _, piece = feed_at(feed, t, piece)
        for k in range(order - 1, 0, -1):
            slopes[k] = slopes[k - 1]
        slopes[0] = slope(spans, span, u[step], v)
        counts[1] += 1
        advance = 0.0
        if step >= order - 1:
            for k in range(order):
                advance += period * weights[k] * slopes[k]
            if correct:
                v, _, _, _ = feed_at(feed, t + period, piece)
                ahead = slope(spans, span, u[step] + advance, v)
                counts[1] += 1
                advance = MOULTON[0] * ahead
                for k in range(3):
                    advance += MOULTON[k + 1] * slopes[k]
                advance *= period
        if not advance > 0.0:  # at the start, at rest, and in the last moments of braking
            advance = advance4(spans, feed, span, piece, u[step], t, period, counts)
        status = settle(u, step, u[step] + advance, breaks[-1])
        if status != GOING:
            return status, step
    return GOING, until - 1


def _run(job, *, order, correct=False):
    return drive(job, _adams, np.zeros(order), np.array(BASHFORTH[order]), correct)


for _order in BASHFORTH:
    register(
        Stepper(
            name="adams" if _order == 4 else f"adams{_order}",
            summary=f"Adams-Bashforth of order {_order}, exact |C'|" + (" (Eq. 15)" if _order == 4 else ""),
            evaluations=(0, 1, 0, 0),
            run=partial(_run, order=_order),
            order=_order,
        )
    )
register(
    Stepper(
        name="abm4",
        summary="Adams-Bashforth prediction, one Adams-Moulton correction, order 4 (Eq. 11, 12), exact |C'|",
        evaluations=(0, 2, 0, 0),
        run=partial(_run, order=4, correct=True),
        order=4,
    )
)
