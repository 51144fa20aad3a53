"""Parameters and knots for fitting.

The parametrisations are ``uniform``, ``chord``, ``centripetal``, ``foley`` (Foley & Nielson 1989, with
Euclidean lengths) and ``universal`` (Lim 1999).
"""

import numpy as np

from nurbs_lab.common.checks import freeze, lengths
from nurbs_lab.nurbs._kernels import curve_derivatives

PARAMETRIZATIONS = ("uniform", "chord", "centripetal", "foley", "universal")
REPEATED_WITHIN = 1e-14  # of the path's length: points nearer than this are one point
QUANTUM = 2.0**-50  # grid of periodic parameters on [0, 1]: shifting them by the period is then exact


def steps(points, parametrization, closed):
    """Parameter steps between neighbours along axis 0, any scale: ``(n - 1, ...)``; closed: ``(n, ...)``.

    ``points`` is ``(n, ..., dim)``: one path per entry of the middle axes.
    """
    edges = np.empty((len(points) - 1 + closed, *points.shape[1:]))
    np.subtract(points[1:], points[:-1], out=edges[: len(points) - 1])
    if closed:
        edges[-1] = points[0] - points[-1]
    chords = lengths(edges)
    if parametrization in ("uniform", "universal"):
        return np.ones_like(chords)
    if parametrization == "centripetal":
        return np.sqrt(chords)
    if parametrization == "foley":
        return _foley_steps(edges, chords, closed)
    return chords


def _foley_steps(edges, chords, closed):
    """Chords stretched by the turning angles at their two ends."""
    before, after = (np.roll(edges, 1, axis=0), edges) if closed else (edges[:-1], edges[1:])
    sizes = lengths(before), lengths(after)
    both = sizes[0] * sizes[1]
    cosine = np.divide((before * after).sum(axis=-1), both, out=np.ones_like(both), where=both > 0)
    turn = 1.5 * np.minimum(np.arccos(np.clip(cosine, -1, 1)), np.pi / 2)
    total = sizes[0] + sizes[1]
    rate = np.divide(turn, total, out=np.zeros_like(total), where=total > 0)
    start, end = rate * sizes[0], rate * sizes[1]  # seen from the edge after, and from the edge before
    if closed:
        end = np.roll(end, -1, axis=0)
    else:
        nothing = np.zeros_like(chords[:1])
        start, end = np.concatenate([nothing, start]), np.concatenate([end, nothing])
    return chords * (1 + start + end)


def accumulate(increments, closed):
    """Parameters from 0 to 1 whose differences are in the ratio of the increments."""
    t = np.zeros(len(increments) + 1)
    np.cumsum(increments, out=t[1:])
    t /= t[-1]
    if closed:
        t = on_grid(t)
    t[-1] = 1.0
    return t


def on_grid(t):
    """Parameters moved to the nearest multiples of the quantum."""
    return np.rint(t / QUANTUM) * QUANTUM


def universal_parameters(degree, count):
    """Parameters at the peaks of the basis functions of a clamped uniform knot vector."""
    knots = freeze(uniform_knots(degree, count))
    inner = np.lib.stride_tricks.sliding_window_view(knots[1:-1], degree).mean(axis=1)
    peaks = inner.copy()
    peaks[0], peaks[-1] = 0.0, 1.0
    for i in range(1, min(degree, (count + 1) // 2)):
        unit = np.zeros((count, 2))
        unit[:, 1] = 1.0
        unit[i, 0] = 1.0
        unit = freeze(unit)
        low, high = knots[i], knots[i + degree + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            slope = curve_derivatives(degree, knots, unit, np.array([middle]), 1)[0, 1, 0]
            low, high = (middle, high) if slope > 0 else (low, middle)
        peaks[i], peaks[-1 - i] = middle, 1.0 - middle
    return peaks


def uniform_knots(degree, count):
    """Clamped knots on [0, 1] with evenly spaced inner knots."""
    return clamp(np.linspace(0.0, 1.0, count - degree + 1), degree)


def averaged_knots(degree, parameters):
    """Clamped knots, each the mean of ``degree`` neighbouring parameters (NURBS Book Eq. 9.8)."""
    inner = np.lib.stride_tricks.sliding_window_view(parameters, degree)[1:-1].mean(axis=1)
    return clamp(np.concatenate([parameters[:1], inner, parameters[-1:]]), degree)


def clamp(breaks, degree):
    """Breaks with both ends repeated to multiplicity degree + 1."""
    return np.concatenate([np.repeat(breaks[0], degree), breaks, np.repeat(breaks[-1], degree)])


def periodic_knots(degree, parameters):
    """Unclamped periodic knots for n points at ``parameters (n + 1,)``, the last one closing the round.

    Odd degrees have a knot at every parameter, even ones halfway between two (and at the seam).
    """
    breaks = parameters.copy()
    if degree % 2 == 0:
        breaks[1:-1] = 0.5 * (parameters[:-2] + parameters[1:-1])
        if parameters[0] == 0.0 and parameters[-1] == 1.0:
            breaks = on_grid(breaks)
    return wrap(breaks, degree)


def wrap(breaks, degree):
    """Breaks of one period continued by ``degree`` knots to either side."""
    period = breaks[-1] - breaks[0]
    before = breaks[-1 - degree : -1] - period
    after = breaks[1 : degree + 1] + period
    return np.concatenate([before, breaks, after])


def spread_knots(degree, parameters, count, closed, density=None):
    """Knots for ``count`` control points, so that all spans hold equal parts of a density.

    ``density`` has a positive number for each step from one parameter to the next; they are equal if it is
    left out (compare Eq. 9.68). No step holds more knots than interpolation would put there, so that every
    basis function has data.
    """
    spans = count if closed else count - degree
    room = np.ones(len(parameters) - 1)
    if not closed:
        room[:degree] = room[-degree:] = (degree + 1) / (2 * degree)
    density = room if density is None else density
    place = np.zeros(len(parameters))
    np.cumsum(_limited(density, room, spans), out=place[1:])
    place *= spans / place[-1]
    place[-1] = spans
    breaks = np.interp(np.arange(spans + 1), place, parameters)
    return around(on_grid(breaks) if closed else breaks, degree, closed)


def around(breaks, degree, closed):
    """All knots of a closed or open spline with these breaks."""
    return wrap(breaks, degree) if closed else clamp(breaks, degree)


def _limited(density, room, total):
    """The density scaled so that it sums to the total and no step exceeds its room.

    Every round fills a step more, so there are at most as many rounds as steps.
    """
    full = np.zeros(len(density), dtype=bool)
    while not full.all():
        scale = (total - room[full].sum()) / density[~full].sum()
        crowded = ~full & (scale * density > room)
        if not crowded.any():
            return np.where(full, room, scale * density)
        full |= crowded
    return room
