"""What every stepper shares, on plain arrays: the feed in time, and how a step ends.

The curve comes as a span table, its arc length as a panel table; see `nurbs.span_kernels`.

A *feed table* is ``(times, terms)``: on phase i the travelled length is
``terms[i] @ (1, tau, tau**2, tau**3)`` with ``tau = t - times[i]``; the last phase has no end.
"""

import numpy as np

from nurbs_lab.nurbs.span_kernels import find_span, kernel, speed


@kernel
def feed_at(feed, t, hint):
    """Speed, acceleration and jerk at time t, and the phase that holds t."""
    times, terms = feed
    hint = find_span(times, t, hint)
    tau = t - times[hint]
    velocity_ = terms[hint, 1] + tau * (2.0 * terms[hint, 2] + tau * 3.0 * terms[hint, 3])
    return velocity_, 2.0 * terms[hint, 2] + 6.0 * tau * terms[hint, 3], 6.0 * terms[hint, 3], hint


@kernel
def displacement(feed, t, duration, hint):
    """Length commanded between t and t + duration, without the cancellation of s(t + duration) - s(t)."""
    times = feed[0]
    total = 0.0
    hint = find_span(times, t, hint)
    while duration > 0.0:
        v, a, j, hint = feed_at(feed, t, hint)
        left = times[hint + 1] - t
        if left >= duration * (1.0 - 1e-12) or hint == times.size - 2:
            left = duration
        total += left * (v + left * (0.5 * a + left * j / 6.0))
        duration -= left
        t = times[hint + 1]
    return total


@kernel
def settle(u, step, following, end):
    """Store the next parameter, which is NaN if the rule broke down; whether the path goes on after it."""
    going = following < end and step + 2 < u.size
    u[step + 1] = following if going else end
    if not (np.isfinite(following) and following >= u[step]):
        u[step + 1] = np.nan
        going = False
    return going


@kernel
def speeds(spans, span_of, u, out):
    """|C'| at every u, in the named span."""
    for k in range(u.size):
        out[k] = speed(spans, span_of[k], u[k])
