"""A predictor-corrector that measures the chord of the step it makes.

u is predicted by the cubic through the last four parameters over the commanded length. Then u is interpolated
as a function of the chord through the trial points (inverse interpolation) and taken at the commanded length.
It needs no derivative, but where |C'| jumps so much that the last trial is still far off: there the step is
as long as commanded by the arc.
"""

import numpy as np

from nurbs_lab.common.kernels import ZERO, inlined, kernel
from nurbs_lab.motion._kernels import displacement, settle
from nurbs_lab.motion.steppers.adams import distance, push
from nurbs_lab.motion.steppers.exact import exact_step
from nurbs_lab.motion.steppers.registry import Option, Stepper, register, steps_of
from nurbs_lab.nurbs.span_kernels import find_span, point, speed

#: Further trials in each of the first four steps, which have too few earlier parameters to predict from.
_EXTRA = 2
#: A step whose last trial misses the commanded length, or the step's end, by more than this part of it is
#: made by the exact rule.
_FAR = 0.5


@kernel
def neville(nodes, values, size, x, work):
    """Value at x of the polynomial through (nodes[k], values[k]), k < size."""
    for k in range(size):
        work[k] = values[k]
    for width in range(1, size):
        for k in range(size - width):
            work[k] += (x - nodes[k]) * (work[k + 1] - work[k]) / (nodes[k + width] - nodes[k])
    return work[0]


@inlined
def _predict(spans, span, u, step, length, lengths, rows):
    """Extrapolated parameter after ``length``; ``lengths`` holds the three lengths before, latest first."""
    nodes, values, work = rows
    known = min(step + 1, 4)
    nodes[0], values[0] = 0.0, u[step]
    for k in range(1, known):
        nodes[k] = nodes[k - 1] - lengths[k - 1]
        values[k] = u[step - k]
    following = neville(nodes, values, known, length, work)
    if not following > u[step]:  # the first step, and a prediction that turns back
        following = u[step] + length / speed(spans, span, u[step])
    return min(following, spans[0][-1])


@kernel
def _chord(spans, feed, period, u, counts, trials, noise, panels):
    breaks, lengths = spans[0], np.zeros(3)
    end, most = breaks[-1], trials + _EXTRA
    rows = np.empty(4), np.empty(4), np.empty(max(4, most + 1))
    chords, tried = np.empty(most + 1), np.empty(most + 1)
    span = phase = panel = ZERO
    for step in range(u.size - 1):
        t = step * period
        span = find_span(breaks, u[step], span)
        phase = find_span(feed[0], t, phase)
        length = displacement(feed, t, period, phase)
        if length == 0.0 and settle(u, step, u[step], end):  # held
            continue
        following = _predict(spans, span, u, step, length, lengths, rows)
        here = point(spans, span, u[step])
        counts[0] += 1
        chords[0] = chord = 0.0
        tried[0] = u[step]
        for trial in range(1, (most if step < 4 else trials) + 1):
            following = last = min(following, end)
            chord = distance(point(spans, find_span(breaks, following, span), following), here)
            counts[0] += 1
            ends = following == end and chord < length  # no chord from here is longer
            if abs(chord - length) <= noise or chord == chords[trial - 1] or ends:
                break
            chords[trial], tried[trial] = chord, following
            following = neville(chords, tried, trial + 1, length, rows[2])
            if not following > u[step]:  # no polynomial fits the chords: in proportion to the last
                following = u[step] + (tried[trial] - u[step]) * length / chord
        far = abs(chord - length) > max(_FAR * length, noise) and not ends
        if far or abs(following - last) > _FAR * (following - u[step]):
            following, panel, count, _ = exact_step(spans, panels, (panel, span), u[step], length)
            counts[1] += count
        push(lengths, length)
        if not settle(u, step, following, end):
            break
    return step


def _run_chord(job, *, trials=2):
    rounding = 4.0 * np.spacing(np.abs(job.curve.control_points).max())  # a chord's, not corrected further
    return steps_of(job, _chord, trials, rounding, job.track.panels)


register(
    Stepper(
        "chord-corrected",
        "cubic prediction, then u by inverse interpolation over the chords to ``trials`` points (2), ours",
        (3, 0, 0, 0),
        _run_chord,
        options=(Option("trials", int, 2, (1, 20), "points tried in a step"),),
    )
)
