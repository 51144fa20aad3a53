"""The reference: every step is as long as commanded, to rounding."""

import numpy as np

from nurbs_lab.motion._kernels import displacement, settle
from nurbs_lab.motion.steppers.registry import KEPT, Rule, Stepper, register
from nurbs_lab.nurbs.span_kernels import arc, find_span, kernel, speed


@kernel
def advance_by(spans, panels, hints, start, length, counts):
    """Parameter at an arc length beyond start, by Newton or bisection, and the error of that length.

    ``hints`` are the span and the panel that hold start.
    """
    breaks, (span, panel) = spans[0], hints
    low, high = start, breaks[-1]
    guess = min(start + length / speed(spans, span, start), high)
    excess = before = np.inf
    for _ in range(120):
        excess = arc(spans, panels, start, guess, span, panel) - length
        counts[1] += 9
        if excess > 0.0:
            high = guess
        elif guess == breaks[-1]:
            break
        else:
            low = guess
        change = excess / speed(spans, find_span(breaks, guess, span), guess)
        if abs(change) <= 1.2e-16 * abs(guess):
            break
        guess -= change
        stuck = abs(excess) > max(0.5 * before, 1e-9 * length)  # Newton oscillates over a kink of s(u)
        if stuck or not low <= guess <= high:
            guess = 0.5 * (low + high)
        before = abs(excess)
    return guess, excess


@kernel
def _exact(spans, feed, window, u, counts, carried, panels):
    breaks, (period, done, until) = spans[0], window
    span = panel = phase = 0
    for step in range(done, until):
        t = step * period
        span = find_span(breaks, u[step], span)
        panel = find_span(panels[0], u[step], panel)
        phase = find_span(feed[0], t, phase)
        wanted = max(displacement(feed, t, period, phase) - carried[0], 0.0)
        following, carried[0] = advance_by(spans, panels, (span, panel), u[step], wanted, counts)
        if not settle(u, step, following, breaks[-1]):
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
