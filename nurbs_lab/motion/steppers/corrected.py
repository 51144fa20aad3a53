"""Predictor-correctors that measure the step they make, by chord or by arc.

Both predict u by the cubic through the last four parameters over the commanded length.

'chord-corrected' evaluates the chord to a trial point. It interpolates u as a function of the chord through
the trial points (inverse interpolation) and takes its value at the commanded length. It needs no derivative.

'arc-corrected' measures the arc to the predicted point by Gauss-Legendre quadrature of |C'|, separately on
each side of a knot, and corrects u by the inverse Taylor series of the arc.
"""

import numpy as np

from nurbs_lab.motion._kernels import displacement, settle
from nurbs_lab.motion.steppers.adams import distance, push
from nurbs_lab.motion.steppers.registry import Option, Rule, Stepper, register
from nurbs_lab.nurbs.span_kernels import find_span, kernel, point, speed

#: Further trials in each of the first four steps, which have too few earlier parameters to predict from.
_EXTRA = 2
#: A chord is not corrected further once its error is below this fraction of the largest coordinate.
_ROUNDING = 2.0**-50


@kernel
def neville(nodes, values, size, x, work):
    """Value at x of the polynomial through (nodes[k], values[k]), k < size."""
    for k in range(size):
        work[k] = values[k]
    for width in range(1, size):
        for k in range(size - width):
            work[k] += (x - nodes[k]) * (work[k + 1] - work[k]) / (nodes[k + width] - nodes[k])
    return work[0]


@kernel
def _predict(spans, span, u, step, length, lengths, nodes, values, work):
    """Extrapolated parameter after ``length``; ``lengths`` holds the three lengths before, latest first."""
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
def _chord(spans, feed, period, offset, done, until, u, counts, lengths, trials, noise):
    breaks = spans[0]
    end = breaks[-1]
    most = trials + _EXTRA
    nodes, values, work = np.empty(4), np.empty(4), np.empty(max(4, most + 1))
    chords, tried = np.empty(most + 1), np.empty(most + 1)
    span = phase = 0
    for step in range(done, until):
        t = (offset + step) * period
        span = find_span(breaks, u[step], span)
        phase = find_span(feed[0], t, phase)
        length = displacement(feed, t, period, phase)
        if length == 0.0 and settle(u, step, u[step], end):  # held
            continue
        following = _predict(spans, span, u, step, length, lengths, nodes, values, work)
        here = point(spans, span, u[step])
        counts[0] += 1
        chords[0], tried[0] = 0.0, u[step]
        for trial in range(1, (most if step < 4 else trials) + 1):
            following = min(following, end)
            chord = distance(point(spans, find_span(breaks, following, span), following), here)
            counts[0] += 1
            if (
                abs(chord - length) <= noise
                or chord == chords[trial - 1]
                or (following == end and chord < length)
            ):
                break
            chords[trial], tried[trial] = chord, following
            following = neville(chords, tried, trial + 1, length, work)
            if not following > u[step]:  # no polynomial fits the chords: in proportion to the last
                following = u[step] + (tried[trial] - u[step]) * length / chord
        push(lengths, length)
        if not settle(u, step, following, end):
            break
    return step


def _end_rows(count_):
    """Gauss points on [0, 1], their weights, and the rows that give value and two derivatives at 1."""
    x, w = np.polynomial.legendre.leggauss(count_)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    powers = np.linalg.inv(np.vander(x - 1.0, increasing=True))
    return np.vstack([x, w, powers[0], powers[1], 2.0 * powers[2]])


_SIX, _THREE = _end_rows(6), _end_rows(3)


@kernel
def _measure(spans, span, start, stop, rows, counts):
    """Arc from start to stop, and |C'| with two derivatives at stop, from Gauss points alone."""
    width = stop - start
    total = value = slope = second = 0.0
    for k in range(rows.shape[1]):
        at = speed(spans, span, start + rows[0, k] * width)
        total += rows[1, k] * at
        value += rows[2, k] * at
        slope += rows[3, k] * at
        second += rows[4, k] * at
    counts[1] += rows.shape[1]
    return total * width, value, slope / width, second / (width * width)


@kernel
def _arc(spans, feed, period, offset, done, until, u, counts, lengths, six, three):
    breaks = spans[0]
    end = breaks[-1]
    nodes, values, work = np.empty(4), np.empty(4), np.empty(4)
    span = phase = 0
    for step in range(done, until):
        t = (offset + step) * period
        span = find_span(breaks, u[step], span)
        phase = find_span(feed[0], t, phase)
        length = displacement(feed, t, period, phase)
        if length == 0.0 and settle(u, step, u[step], end):  # held
            continue
        trial = _predict(spans, span, u, step, length, lengths, nodes, values, work)
        rows = six if trial <= breaks[span + 1] else three
        start, missing = u[step], length
        at = span
        value = slope = second = 0.0
        while start < trial:
            stop = min(trial, breaks[at + 1])
            moved, value, slope, second = _measure(spans, at, start, stop, rows, counts)
            missing -= moved
            start = stop
            at += 1
        first = missing / value
        turn = slope / value
        factor = 1.0 - 0.5 * turn * first + (0.5 * turn * turn - second / (6.0 * value)) * first * first
        if not 0.5 <= factor <= 2.0:  # no small correction, or a piece so short that this is noise
            factor = 1.0
        following = trial + factor * first
        if not following > u[step]:  # the series fails: in proportion to the arc measured
            following = u[step] + (trial - u[step]) * length / (length - missing)
        push(lengths, length)
        if not settle(u, step, following, end):
            break
    return step


def _run_chord(job, *, trials=2):
    homogeneous = job.curve.homogeneous
    noise = _ROUNDING * np.abs(homogeneous[:, :-1]).max() / homogeneous[:, -1].min()
    return Rule(_chord, (np.zeros(3), trials, noise))


def _run_arc(job):
    return Rule(_arc, (np.zeros(3), _SIX, _THREE))


register(
    Stepper(
        "chord-corrected",
        "cubic prediction, then u by inverse interpolation over the chords to ``trials`` points (2), ours",
        (3, 0, 0, 0),
        _run_chord,
        options=(Option("trials", int, 2, (1, 20), "points tried in a step"),),
    )
)
register(
    Stepper(
        "arc-corrected",
        "cubic prediction, its arc by six Gauss points split at knots, one correction, ours",
        (0, 6, 0, 0),
        _run_arc,
    )
)
