"""Runge-Kutta predictor, one quadratic corrector: Erwinski, Wawrzak & Paprocki, IEEE TII 18 (2022).

The predictor is Heun's rule with the speed of the period in both slopes (their Eq. 1 and 2). The corrector
asks ``|C(u) + C'(u) d - C(u_j)| = length`` of the change d, a quadratic (Eq. 5-8), with the chord to the
predicted point replaced by the arc by Simpson's rule. Its solution (Eq. 9) is printed with a^2 - 4ab under
the root; b^2 - 4ac is meant. First derivatives only.
"""

from math import sqrt

from nurbs_lab.motion._kernels import GOING, displacement, settle
from nurbs_lab.motion.steppers.registry import Rule, Stepper, register
from nurbs_lab.nurbs.span_kernels import find_span, kernel, point, speed, velocity


@kernel
def _rk2_pc(spans, feed, period, offset, done, until, u, counts):
    breaks = spans[0]
    end = breaks[-1]
    span = phase = 0
    for step in range(done, until):
        t = (offset + step) * period
        span = find_span(breaks, u[step], span)
        phase = find_span(feed[0], t, phase)
        length = displacement(feed, t, period, phase)
        first = speed(spans, span, u[step])
        ahead = min(u[step] + length / first, end)
        second = speed(spans, find_span(breaks, ahead, span), ahead)
        trial = min(u[step] + 0.5 * length * (1.0 / first + 1.0 / second), end)
        middle = 0.5 * (u[step] + trial)
        between = speed(spans, find_span(breaks, middle, span), middle)
        there = find_span(breaks, trial, span)
        dx, dy, dz = velocity(spans, there, trial)
        last_speed = sqrt(dx * dx + dy * dy + dz * dz)
        arc = (trial - u[step]) / 6.0 * (first + 4.0 * between + last_speed)
        here = point(spans, span, u[step])
        reached = point(spans, there, trial)
        counts[0] += 2
        counts[1] += 4
        a = last_speed * last_speed
        b = 2.0 * ((reached[0] - here[0]) * dx + (reached[1] - here[1]) * dy + (reached[2] - here[2]) * dz)
        c = arc * arc - length * length
        # the root next to zero, written without cancellation
        following = trial - 2.0 * c / (b + sqrt(max(b * b - 4.0 * a * c, 0.0)))
        if not following > u[step]:  # Simpson's arc is wrong over a jump of |C'|: keep the prediction
            following = trial
        status = settle(u, step, following, end)
        if status != GOING:
            return status, step
    return GOING, until - 1


def _run(job):
    return Rule(_rk2_pc)


register(
    Stepper(
        "rk2-pc",
        "Heun predictor, one quadratic corrector on Simpson's arc (Erwinski 2022)",
        (2, 4, 0, 0),
        _run,
    )
)
