"""The paper's own scheme: |C'| replaced by the difference quotient of Eq. (16).

Eq. (20) as printed divides |C(u_j) - C(u_{j-1} + h)| by |u_j - u_{j-1} - h|. Its K4 is then 0/0 at steady
speed, since h = T K3 is just u_j - u_{j-1}. The mended form shifts both ends of the quotient by h.
At u_0 there is no earlier point: the exact end derivative |C'(u_0)| stands in for every quotient.
"""

from functools import partial
from math import sqrt

import numpy as np

from nurbs_lab.motion._kernels import GOING, displacement, feed_at, settle
from nurbs_lab.motion.steppers.adams import BASHFORTH
from nurbs_lab.motion.steppers.registry import Stepper, drive, register
from nurbs_lab.motion.steppers.runge_kutta import advance4
from nurbs_lab.nurbs.span_kernels import find_span, kernel, point, speed

#: How the steps before Adams are made.
_EXACT, _MENDED, _PRINTED = 0, 1, 2
_W0, _W1, _W2, _W3 = BASHFORTH[4]


@kernel
def distance(a, b):
    """|a - b| of two points."""
    dx, dy, dz = a[0] - b[0], a[1] - b[1], a[2] - b[2]
    return sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def point_at(spans, span, u, counts):
    """C(u); beyond the end the last span's polynomial goes on, so that no quotient degenerates there."""
    counts[0] += 1
    return point(spans, find_span(spans[0], u, span), u)


@kernel
def _shifted(spans, span, u, before, here, h, form, counts):
    """The quotient that stands for |C'(u + h)|."""
    back = point_at(spans, span, before + h, counts)
    width = u - before
    if form == _PRINTED:
        width = abs(width - h)
    else:
        here = point_at(spans, span, u + h, counts)
    return distance(here, back) / width


@kernel
def _quotient(spans, feed, period, done, until, u, counts, memory, form, started):
    """Runge-Kutta for the first ``started`` steps, Eq. (20), then Adams, Eq. (17)."""
    breaks = spans[0]
    span = piece = 0
    f0, f1, f2, f3 = memory[0], memory[1], memory[2], 0.0
    here = before = (memory[3], memory[4], memory[5])
    for step in range(done, until):
        t = step * period
        span = find_span(breaks, u[step], span)
        v, _, _, piece = feed_at(feed, t, piece)
        before, here = here, point_at(spans, span, u[step], counts)
        f1, f2, f3 = f0, f1, f2
        if step == 0:
            start = speed(spans, span, u[0])
            counts[1] += 1
            quotient = start
        else:
            quotient = distance(here, before) / (u[step] - u[step - 1])
        f0 = v / quotient
        if step >= started:
            advance = period * (_W0 * f0 + _W1 * f1 + _W2 * f2 + _W3 * f3)
        elif form == _EXACT:
            advance = advance4(spans, feed, span, piece, u[step], t, period, counts)
        else:
            half, _, _, _ = feed_at(feed, t + 0.5 * period, piece)
            whole, _, _, _ = feed_at(feed, t + period, piece)
            k1 = f0
            if step == 0:
                k2 = k3 = half / start
                k4 = whole / start
            else:
                back = u[step - 1]
                k2 = half / _shifted(spans, span, u[step], back, here, 0.5 * period * k1, form, counts)
                k3 = half / _shifted(spans, span, u[step], back, here, 0.5 * period * k2, form, counts)
                k4 = whole / _shifted(spans, span, u[step], back, here, period * k3, form, counts)
            advance = period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        if advance <= 0.0:  # Adams in the last moments of braking: the planned length instead
            advance = displacement(feed, t, period, piece) / quotient
        status = settle(u, step, u[step] + advance, breaks[-1])
        if status != GOING:
            return status, step
    memory[0], memory[1], memory[2] = f0, f1, f2
    memory[3], memory[4], memory[5] = here
    return GOING, until - 1


def _run(job, *, form, started=None):
    return drive(job, _quotient, np.zeros(6), form, job.last_step if started is None else started)


_MEND = "both ends of the quotient shifted"
for _name, _summary, _evaluations, _run_it in (
    (
        "adams-quotient",
        "Adams with quotients (Eq. 17), exact start",
        1,
        partial(_run, form=_EXACT, started=4),
    ),
    ("rk4-quotient", f"Runge-Kutta with quotients (Eq. 20), {_MEND}", 7, partial(_run, form=_MENDED)),
    ("rk4-printed", "Runge-Kutta with quotients, Eq. (20) as printed", 4, partial(_run, form=_PRINTED)),
    (
        "paper",
        f"the paper's scheme: Eq. (20), {_MEND}, four times, then Eq. (17)",
        1,
        partial(_run, form=_MENDED, started=4),
    ),
):
    register(Stepper(_name, _summary, (_evaluations, 0, 0, 0), _run_it, None if "printed" in _name else 1))
