"""The reference: every step is as long as commanded, to rounding."""

import numpy as np

from nurbs_lab.motion._kernels import displacement, settle
from nurbs_lab.motion.steppers.registry import KEPT, Rule, Stepper, register
from nurbs_lab.nurbs.span_kernels import find_span, kernel, parameter_at


@kernel
def _exact(spans, feed, window, u, counts, travelled, panels):
    period, done, until = window
    hints, phase = (0, 0), 0
    for step in range(done, until):
        t = step * period
        phase = find_span(feed[0], t, phase)
        travelled[0] += displacement(feed, t, period, phase)
        following, hints, count = parameter_at(spans, panels, hints, travelled[0])
        counts[1] += count
        if not settle(u, step, max(following, u[step]), panels[0][-1]):
            break
    return step


def _run(job):
    return Rule(_exact, (np.zeros(1), job.track.panels))


register(
    Stepper(
        "exact",
        "arc length inverted to rounding by Newton's method on Gauss-Legendre integrals, the reference",
        (0, 27, 0, 0),
        _run,
        keeps=(*KEPT, "acceleration", "axis_acceleration", "jerk", "axis_jerk"),
    )
)
