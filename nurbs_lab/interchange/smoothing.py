"""Programs of short straight moves made smooth again: arcs and splines within a tolerance on both sides.

A polyline is cut where it turns sharply, not only by noise, and where a segment is much longer than its
neighbours; what lies between is one stretch. Collinear points become a line, a stretch on a circle an arc,
any other the nearest cubic spline of continuous curvature, with as few knots as keep the tolerance. The
ends of the stretches, and so all corners, stay where they are.
"""

import itertools

import numpy as np

from nurbs_lab.common.checks import as_kind, as_points, as_positive, lengths
from nurbs_lab.interchange._moves import CUT, NO_FEED, RAPID, MoveTable, arc_curve, circle_through, polyline
from nurbs_lab.interchange._pieces import MARGIN, PROBES
from nurbs_lab.machining.program import Move, Program
from nurbs_lab.nurbs import NurbsCurve
from nurbs_lab.nurbs.along import lengths_along, points_along, spline_along

LONG = 5.0  # times as long as both its neighbours: such a segment is a line of its own
CORNER = np.radians(20.0)  # a polyline that turns by more has a corner
AROUND = 8.0  # tolerances: a point is a corner if the polyline turns between such places around it, too
STRAIGHT = 0.1  # of the tolerance: points as near as that to their chord, or plane, are in it
TRIALS = 5  # of a spline, each along one place more of every segment, and nearer


def smooth(program_or_points, *, tolerance):
    """Replace stretches of short straight moves by curves within a tolerance.

    Every point of the polyline is within the tolerance of the curves, and every point of the curves is
    within the tolerance of the polyline.

    Motion along the curves is faster where a limit depends on curvature and the segments are so short that
    the rounding of their ends turns them (notebook 13). The time grows as the number of points.

    Parameters
    ----------
    program_or_points : Program or array_like, shape (n, 2) or (n, 3)
        A program, such as `read` gives, or the points of one polyline.
    tolerance : float
        In mm.
        Points at which the polyline turns by more than 20 degrees are corners, and are kept exactly.

    Returns
    -------
    Program or NurbsCurve
        The program with fewer moves: each curve takes the feed and the line of the first move that it
        replaces; rapid and curved moves, and moves at other feeds, stay as they are. Of points, one curve
        through their corners.

    Raises
    ------
    ValueError, TypeError
        If a number is out of its range, all points are equal, or the argument is no program and no numbers.

    Examples
    --------
    >>> import numpy as np
    >>> import nurbs_lab as nl
    >>> angle = np.linspace(0.0, 3.0, 1000)
    >>> points = np.column_stack([30 * np.cos(angle), 20 * np.sin(angle)])
    >>> curve = nl.smooth(points, tolerance=0.01)
    >>> len(curve.control_points) < 50, bool(curve.closest_point(points)[1].max() <= 0.01)
    (True, True)
    """
    tolerance = as_positive("tolerance", tolerance)
    if isinstance(program_or_points, Program):
        return _smooth_program(program_or_points, tolerance)
    points = as_points("program_or_points", program_or_points, 2)
    dim = points.shape[1]
    if dim not in (2, 3):
        raise ValueError(f"program_or_points must have 2 or 3 columns, got {dim}")
    curves = _curves(np.pad(points, ((0, 0), (0, 3 - dim))), tolerance)
    if not curves:
        raise ValueError("program_or_points: all points are equal; give at least two that differ")
    return _joined([curve for curve, _ in curves]).transform(np.eye(dim, 3))


def _smooth_program(program, tolerance):
    moves, new = program.moves, []
    table = moves if isinstance(moves, MoveTable) else _table(moves)
    if not len(table):
        return program
    for a, b in table.runs():
        if table.kinds[a] != CUT or a in table.curves:
            new += table[a:b]
            continue
        points = np.concatenate([table.starts[a : a + 1], table.ends[a:b]])
        feed, place = float(table.feeds[a]), a
        for curve, segments in _curves(points, tolerance):
            new.append(Move("cut", curve, feed, int(table.lines[place]) or None))
            place += segments
    return Program(tuple(new), program.cutter, program.machine, program.tolerance + tolerance)


def _table(moves):
    """Moves of any program as columns: polylines by their segments, all others with their curves."""
    rows, curves = [], {}
    for move in moves:
        as_kind("moves", move, Move)
        kind, points = CUT if move.kind == "cut" else RAPID, move.curve.clamped().control_points
        if kind == RAPID or move.curve.degree > 1:
            curves[len(rows)] = move.curve
            points = points[[0, -1]]
        for start, end in itertools.pairwise(points):
            rows.append((kind, start, end, move.feed or NO_FEED, move.line or 0))
    return MoveTable(*map(np.array, zip(*rows, strict=True)), curves)


def _curves(points, tolerance):
    """Lines, arcs and splines along a polyline, in order, and the number of segments that each replaces."""
    long = lengths(np.diff(points, axis=0))
    kept = np.r_[True, long > np.finfo(float).eps * long.sum()]
    points = points[kept]
    if len(points) < 2:
        return []
    long = lengths(steps := np.diff(points, axis=0))
    unit = steps / long[:, None]
    turn = 2 * np.arcsin(np.minimum(lengths(unit[1:] - unit[:-1]) / 2, 1.0))
    beside = np.maximum(np.r_[0.0, long[:-1]], np.r_[long[1:], 0.0])
    lone = long > LONG * beside
    sharp = turn > CORNER
    sharp[sharp] = _turns_around(points, 1 + np.flatnonzero(sharp), AROUND * tolerance) > CORNER
    breaks = np.flatnonzero(np.r_[True, sharp | lone[1:] | lone[:-1], True])
    place, pieces = np.flatnonzero(kept), []
    for a, b in itertools.pairwise(breaks):
        some = points[a : b + 1]  # without a corner: a line, an arc or a spline, or as it is
        curve = polyline(some[0], some[-1]) if _straight(some, tolerance) else _arc(some, tolerance)
        curve = curve or _spline(some, tolerance) or polyline(*some)
        both = pieces and len(curve.control_points) == len(pieces[-1][0].control_points) == 2
        if both and _straight(points[pieces[-1][1] : b + 1], tolerance):
            a = pieces.pop()[1]
            curve = polyline(points[a], points[b])
        pieces.append((curve, a, b))
    return [(curve, place[b] - place[a]) for curve, a, b in pieces]


def _turns_around(points, at, reach):
    """Angles by which a polyline turns at some of its points, between places ``reach`` before and after."""
    places = lengths_along(points)[at]
    before, after = (points_along(points, places + side) for side in (-reach, reach))
    one, two = points[at] - before, after - points[at]
    return np.arctan2(lengths(np.cross(one, two)), (one * two).sum(axis=1))


def _straight(points, tolerance):
    """Whether points run along their chord, and nearer to it than noise."""
    chord = points[-1] - points[0]
    if not chord.any():
        return False
    unit = chord / lengths(chord)
    off = points - points[0]
    away = lengths(off - (off @ unit)[:, None] * unit)
    return away.max() <= STRAIGHT * tolerance and (np.diff(points, axis=0) @ unit > 0).all()


def _spline(points, tolerance):
    """The cubic spline nearest to the segments; None if no trial brings it near to them."""
    chord, t, near = np.diff(points, axis=0), lengths_along(points)[:, None], 0.5 * (1 + MARGIN)
    probed = t[:-1] + np.diff(t, axis=0) * PROBES
    for trial in range(TRIALS):
        parts = np.arange(trial + 1)[:, None] / (trial + 1)
        fine = np.vstack([(points[:-1, None] + parts * chord[:, None]).reshape(-1, 3), points[-1:]])
        curve = spline_along(fine, MARGIN * tolerance * near**trial)
        places, at = curve(probed.ravel()), np.repeat(np.arange(len(chord)), len(PROBES))
        for beside in (0, -1, 1):  # those that are far from their own segment may be near to its neighbours
            i = np.clip(at + beside, 0, len(chord) - 1)
            along = np.clip(((places - points[i]) * chord[i]).sum(1) / (chord[i] ** 2).sum(1), 0, 1)
            far = lengths(places - points[i] - along[:, None] * chord[i]) > near * tolerance
            places, at = places[far], at[far]
        drifted = points[1:-1][lengths(curve(t[1:-1, 0]) - points[1:-1]) > near * tolerance]
        if not len(at) and (not len(drifted) or curve.closest_point(drifted)[1].max() <= tolerance):
            return curve
    return None


def _arc(points, tolerance):
    """The arc through both ends nearest to the points; None if it is not near enough."""
    centred = points - points.mean(axis=0)
    flat = np.linalg.svd(centred, full_matrices=False)[2]
    if np.abs(centred @ flat[2]).max() > STRAIGHT * tolerance:
        return None
    local = (points - points[0]) @ flat[:2].T
    found = circle_through(local, [0, 1], MARGIN * tolerance)
    if found is None or abs(found[1]) > 2 * np.pi + 1e-6:
        return None
    centre, turn = found
    radius, middles = lengths(centre), (local[1:] + local[:-1]) / 2
    if np.abs(lengths(middles - centre) - radius).max() > MARGIN * tolerance:
        return None
    ends = np.pad(local[[0, -1]], ((0, 0), (0, 1)))
    curve = arc_curve(*ends, centre, turn < 0, 1, (0, 1, 2)).transform(flat[:2].T @ np.eye(2, 3), points[0])
    away = points[-1] - curve.control_points[-1]  # off the plane, by less than the points themselves
    control = curve.control_points + np.linspace(0, 1, len(curve.control_points))[:, None] * away
    control[[0, -1]] = points[[0, -1]]
    return NurbsCurve(2, curve.knots, control, curve.weights)


def _joined(curves):
    """Curves end to end as one, its parameter about as long as each of their control polygons."""
    parts = []
    for c in curves:
        size = max(lengths(np.diff(c.control_points, axis=0)).sum(), 1e-12) / np.ptp(c.domain)
        parts.append(NurbsCurve(c.degree, size * c.knots, c.control_points, c.weights))
    return parts[0].join(*parts[1:])


def blend(points, *, tolerance):
    """A polyline ``(n, dim)`` with a parabola at every corner, as a controller in continuous mode runs it.

    Each parabola is as long as half of the shorter segment beside it allows, and the tolerance, which is the
    largest distance from a corner. The curve has degree 2 and a continuous tangent.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> corner = nl.interchange.blend([(0, 0), (10, 0), (10, 10)], tolerance=0.1)
    >>> round(float(corner.closest_point((10, 0))[1]), 9)
    0.1
    """
    points = as_points("points", points, 2)
    tolerance = as_positive("tolerance", tolerance)
    points = points[np.r_[True, np.diff(points, axis=0).any(axis=1)]]
    steps = np.diff(points, axis=0)
    long = lengths(steps)
    unit = steps / long[:, None]
    sine = lengths(unit[1:] - unit[:-1]) / 2
    reach = np.minimum(np.minimum(long[:-1], long[1:]) / 2, 2 * tolerance / np.maximum(sine, 1e-12))[:, None]
    corner = points[1:-1]
    before, after = corner - reach * unit[:-1], corner + reach * unit[1:]
    straight = (np.vstack([points[:1], after]) + np.vstack([before, points[-1:]])) / 2
    inner = np.stack([straight[:-1], before, corner, after], axis=1).reshape(-1, points.shape[1])
    control = np.vstack([points[:1], inner, straight[-1:], points[-1:]])
    spans = lengths(np.diff(control, axis=0)).reshape(-1, 2).sum(axis=1)
    kept = spans > 1e-12 * spans.max()
    ends = np.r_[0.0, np.cumsum(spans[kept])]
    return NurbsCurve(2, np.r_[0.0, np.repeat(ends, 2), ends[-1]], control[np.r_[True, np.repeat(kept, 2)]])
