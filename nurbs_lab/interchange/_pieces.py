"""Curves in the forms that controllers accept: chords, circular arcs and cubics, each within a tolerance.

All start from the Bezier pieces of a curve, as rows (w x, ..., w) of an array ``(m, p + 1, dim + 1)``, and
halve those that do not fit yet. Halving a piece leaves about a quarter of the chord error, an eighth of the
error of two arcs, and a sixteenth of that of a cubic.
"""

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.nurbs import NurbsCurve, refinement
from nurbs_lab.nurbs.measure import UNEVEN
from nurbs_lab.nurbs.refinement import halved, project
from nurbs_lab.nurbs.spans import find_breaks, span_parameters

MOST_PIECES = 1_000_000
MOST_HALVINGS = 60
PROBES = np.linspace(0, 1, 18)[1:-1]  # of a piece, where arcs and cubics are compared with it
SAMPLES = 32  # of a span, between which the curvature is taken as even
PARTS = 8  # of a chord's piece; the hull of an eighth is too wide by 1/64 of the error
MARGIN = 0.9  # of the tolerance, kept at the probes: errors between them are larger by less


def bezier_rows(curve):
    """The Bezier pieces of a curve, ``(m, p + 1, dim + 1)``, in order, in each of which the weights are even.

    Else nearly all of a piece may lie between two probes.
    """
    ends = find_breaks(curve.knots, curve.degree)
    rows = refinement.bezier_rows(curve.degree, curve.knots, curve.homogeneous, ends)
    return split_until(rows, lambda rows: rows[..., -1].max(axis=1) <= UNEVEN * rows[..., -1].min(axis=1))


def split_until(rows, fits):
    """The pieces in order, each halved until ``fits(pieces)`` is true for it.

    A piece is halved at most MOST_HALVINGS times, because it is then as short as rounding, and there are at
    most MOST_PIECES of them.
    """
    for _ in range(MOST_HALVINGS):
        good = fits(rows)
        if good.all():
            return rows
        if len(rows) + np.count_nonzero(~good) > MOST_PIECES:
            break
        parts = np.repeat(rows, 1 + ~good, axis=0)
        first = np.flatnonzero(~good) + np.arange(np.count_nonzero(~good))
        parts[np.sort(np.r_[first, first + 1])] = halved(rows[~good])
        rows = parts
    raise ValueError(f"tolerance: it would take more than {MOST_PIECES} pieces, or tiny ones; allow more")


def chord_points(curve, tolerance):
    """Points ``(n, dim)`` on the curve, whose chords are within the tolerance of it.

    A chord over a step h of the parameter is off by h^2 a / 8, where a is the length of C'' across C'. So the
    points are spread as the root of a asks for. Each eighth of a piece lies in the convex hull of its control
    points, so a chord is halved until they are all within the tolerance of it.
    """
    dense = span_parameters(curve.knots, curve.degree, SAMPLES)
    first, second = np.moveaxis(curve.derivatives((dense[1:] + dense[:-1]) / 2, 2), 1, 0)[1:]
    unit = first / np.maximum(lengths(first), 1e-300)[:, None]
    across = lengths(second - (second * unit).sum(axis=1, keepdims=True) * unit)
    along = np.r_[0.0, np.cumsum(np.sqrt(across / (8.0 * MARGIN * tolerance)) * np.diff(dense))]
    knots, times = np.unique(curve.knots, return_counts=True)
    corners = knots[(times >= curve.degree) & (dense[0] <= knots) & (knots <= dense[-1])]
    if not along[-1] < MOST_PIECES:
        raise ValueError(f"tolerance: it would take more than {MOST_PIECES} pieces; allow more")
    u = np.linspace(0.0, along[-1], 1 + int(np.ceil(along[-1])))
    u = np.unique(np.r_[np.interp(u, along, dense), corners])
    while True:
        points, steps = curve(u), np.diff(u)
        ends = np.unique(np.r_[span_parameters(u, 0, PARTS), dense[::SAMPLES]])  # knots too
        rows = project(refinement.bezier_rows(curve.degree, curve.knots, curve.homogeneous, ends))
        owner = np.searchsorted(u, ends[:-1], side="right") - 1
        inner, chord = rows - points[owner, None], np.diff(points, axis=0)[owner, None]
        part = (inner * chord).sum(-1) / np.maximum((chord**2).sum(-1), 1e-300)
        away = lengths(inner - np.clip(part, 0, 1)[..., None] * chord).max(axis=1)
        away = np.maximum.reduceat(away, np.searchsorted(ends, u[:-1]))
        off = (away > tolerance) & (steps > 1e-14 * (u[-1] - u[0]))
        if not off.any():
            return points
        u = np.sort(np.r_[u, (u[:-1] + steps / 2)[off]])


def evaluated(rows, t):
    """Points of the pieces at the parameters t in [0, 1]: ``(m, len(t), dim)``."""
    level = rows[:, :, None, :]
    t = np.asarray(t)[None, None, :, None]
    while level.shape[1] > 1:
        level = (1 - t) * level[:, :-1] + t * level[:, 1:]
    return project(level[:, 0])


def cubic_rows(rows, tolerance, most=np.inf):
    """Polynomial cubic Bezier pieces ``(m, 4, dim)`` within the tolerance, with the tangents of the curve.

    Exact where the pieces are polynomial cubics; else they have the points and derivatives at their ends
    (Hermite). No coefficient of their powers is larger than ``most``.
    """

    def small(cubics):
        return (np.abs(power_coefficients(cubics)[:, 1:]) <= most).all(axis=(1, 2))

    def fits(rows):
        cubics = hermite(rows)
        lifted = np.concatenate([cubics, np.ones((*cubics.shape[:-1], 1))], axis=-1)
        away = lengths(evaluated(lifted, PROBES) - evaluated(rows, PROBES)).max(axis=1)
        return (away <= MARGIN * tolerance) & small(cubics)

    if rows.shape[1] == 4 and not np.ptp(rows[..., -1]):
        return project(split_until(rows, lambda rows: small(project(rows))))
    return hermite(split_until(rows, fits))


def hermite(rows):
    """The cubic Bezier pieces with the same ends and the same derivatives there."""
    points, weights = project(rows), rows[..., -1:]
    third = (rows.shape[1] - 1) / 3
    first = third * weights[:, 1] / weights[:, 0] * (points[:, 1] - points[:, 0])
    last = third * weights[:, -2] / weights[:, -1] * (points[:, -1] - points[:, -2])
    ends = points[:, 0], points[:, -1]
    return np.stack([ends[0], ends[0] + first, ends[1] - last, ends[1]], axis=1)


def joined(cubics):
    """Cubic Bezier pieces, end to end, as one B-spline curve, its knots at the lengths of their polygons."""
    spans = np.maximum(lengths(np.diff(cubics, axis=1)).sum(axis=1), 1e-9)
    ends = np.r_[0.0, np.cumsum(spans)]
    points = np.concatenate([cubics[0, :1], cubics[:, 1:].reshape(-1, cubics.shape[-1])])
    return NurbsCurve(3, np.r_[0.0, np.repeat(ends, 3), ends[-1]], points)


def power_coefficients(cubics):
    """X, K1, K2, K3 of X + K1 t + K2 t^2 + K3 t^3, where t runs from 1 at the start to 0 at the end."""
    a, b, c, d = np.moveaxis(cubics, 1, 0)
    return np.stack([d, 3 * (c - d), 3 * (b - 2 * c + d), a - 3 * b + 3 * c - d], axis=1)


def biarcs(rows, tolerance, least=0.0):
    """Arcs along plane pieces ``(m, p + 1, 3)``: their ends ``(n + 1, 2)`` and centres ``(n, 2)``.

    Two arcs a piece, tangent to it at both ends and to each other where they meet; halves of the chord
    where a radius would be at most ``least``. The centre of a straight one is not finite.
    """

    def fits(rows):
        start, joint, end, first, last = _biarc(rows, least)
        points, both = evaluated(rows, PROBES), []
        for centre, one, two in ((first, start, joint), (last, joint, end)):
            radius = lengths(one - centre)
            with np.errstate(invalid="ignore"):  # the radius of a straight one is not finite
                off = np.abs(lengths(points - centre[:, None]) - radius[:, None])
            chord, step = (two - one)[:, None], points - one[:, None]
            flat = np.abs(chord[..., 0] * step[..., 1] - chord[..., 1] * step[..., 0])
            flat /= lengths(chord) + 1e-300
            both.append(np.where(np.isfinite(radius)[:, None], off, flat))
        (t0, t1), chord = _tangents(rows), end - start
        away = np.where(((points - joint[:, None]) * chord[:, None]).sum(-1) < 0, *both)
        steps = np.diff(points, axis=1, prepend=start[:, None], append=end[:, None])
        onward = (chord[:, None] * steps).sum(-1).min(axis=1)  # a piece that turns back leaves its arcs
        forward = (chord * t0).sum(-1), (chord * t1).sum(-1), (t0 * t1).sum(-1), onward
        short = lengths(np.diff(project(rows), axis=1)).sum(axis=1) <= tolerance
        return (away.max(axis=1) <= MARGIN * tolerance) & (np.min(forward, axis=0) > 0) | short

    start, joint, end, first, last = _biarc(split_until(rows, fits), least)
    ends = np.stack([joint, end], axis=1).reshape(-1, 2)
    return np.concatenate([start[:1], ends]), np.stack([first, last], axis=1).reshape(-1, 2)


def _biarc(rows, least):
    """Start, joint and end, and both centres, with equal lengths of the two tangents."""
    points = project(rows)
    start, end = points[:, 0], points[:, -1]
    t0, t1 = _tangents(rows)
    chord, tangents = end - start, t0 + t1
    b = (chord * tangents).sum(-1)
    a, c = 2 * (1 - (t0 * t1).sum(-1)), (chord**2).sum(-1)
    with np.errstate(all="ignore"):  # of straight and of empty pieces
        length = c / (b + np.sqrt(b * b + a * c))
        joint = (start + end + length[:, None] * (t0 - t1)) / 2
        first, last = _centre(start, t0, joint), _centre(end, t1, joint)
        sharp = (np.fmin(lengths(first - start), lengths(last - end)) <= least) | (b <= 0)
    first[sharp] = last[sharp] = np.nan
    joint[sharp] = (start + end)[sharp] / 2
    return start, joint, end, first, last


def _centre(point, tangent, other):
    """Of the circle through both points with that tangent at the first."""
    normal, step = np.stack([-tangent[:, 1], tangent[:, 0]], axis=-1), other - point
    return point + normal * ((step**2).sum(-1) / (2 * (normal * step).sum(-1)))[:, None]


def _tangents(rows):
    """Unit tangents at both ends; along the chord where the derivative vanishes."""
    points = project(rows)
    chord = points[:, -1] - points[:, 0]
    for step in (points[:, 1] - points[:, 0], points[:, -1] - points[:, -2]):
        step = np.where(lengths(step)[:, None] > 1e-12 * lengths(chord)[:, None], step, chord)
        yield step / np.maximum(lengths(step), 1e-300)[:, None]
