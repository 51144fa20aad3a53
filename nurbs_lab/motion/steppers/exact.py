"""The reference: every step is as long as commanded, to rounding."""

from nurbs_lab.common.kernels import ZERO, kernel
from nurbs_lab.motion._kernels import length_at, settle
from nurbs_lab.motion.steppers.registry import KEPT, Stepper, register, steps_of
from nurbs_lab.nurbs.span_kernels import find_span, gauss, parameter_at


@kernel
def exact_step(spans, panels, hints, u, length):
    """Parameter a length beyond u; ``hints`` are a panel near u and the span that holds it.

    The panel that holds u, the number of evaluations of C' and the length from the start are returned too.
    """
    panel = find_span(panels[0], u, hints[0])
    reached = panels[1][panel] + gauss(spans, hints[1], panels[0][panel], u) + length
    following, _, count = parameter_at(spans, panels, (panel, hints[1]), reached)
    return max(following, u), panel, count, reached


@kernel
def _exact(spans, feed, period, u, counts, panels):
    hints, phase = (ZERO, ZERO), ZERO
    for step in range(u.size - 1):
        phase = find_span(feed[0], (step + 1) * period, phase)
        wanted = length_at(feed, (step + 1) * period, phase)
        following, hints, count = parameter_at(spans, panels, hints, wanted)
        counts[1] += count
        if not settle(u, step, max(following, u[step]), panels[0][-1]):
            break
    return step


def _run(job):
    return steps_of(job, _exact, job.track.panels)


register(
    Stepper(
        "exact",
        "arc length inverted to rounding by Newton's method on Gauss-Legendre integrals, the reference",
        (0, 23, 0, 0),
        _run,
        keeps=KEPT,
    )
)
