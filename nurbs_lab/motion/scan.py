"""The speed that the limits allow along a path of one curve or several, sampled as finely as it needs."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.motion import _kernels
from nurbs_lab.motion._curvature_bounds import curvature_bounds
from nurbs_lab.motion.limits import NAMES
from nurbs_lab.motion.prepared_curve import golden_section
from nurbs_lab.nurbs import span_kernels

#: Cells are halved until the speed limit between their ends is linear to this part.
SCAN_TOLERANCE = 2e-4
#: Limits that follow from the curve are lowered by this part, for what happens between two samples.
MARGIN = 3e-4
#: Tangents, and curvatures times the length, that differ by more on the two sides of a knot, jump there.
JUMP = 1e-6
#: With limits of axes, the path turns by no more than this (radians) between two samples: without a limit of
#: jerk and with one, where the plan looks at both ends of every cell.
TURN = 5e-3, 1e-2
#: Tangents that differ by more (radians) make a corner.
CORNER = 1e-6
#: Beside a knot where the speed limit jumps by the first part, samples lie at the second part of its spans.
_JUMPING, _BESIDE = 1e-3, 1e-2
#: A certified bound of the curvature may exceed the samples of its cell by this factor.
_SURE = 1.1
#: Cells shorter than this part of the curve are not halved: rounding, not the curve, shapes what is in them.
_SHORTEST_CELL = 1e-12
#: Limits that follow from the curvature, and that no measured chords prove kept.
_OF_CURVATURE = "centripetal_acceleration", "axis_acceleration"
#: Radius of curvature, as part of the length, below which lengths have too few digits to place the speed.
_SHARPEST = 1e-11
#: Cells of a span before the first halving, and halvings at most.
_FIRST_CELLS, _HALVINGS = 8, 40
#: Most cells that are halved: so many in all, and so many more for each span.
_MOST_CELLS = 20_000, 2_000
#: Rounds of golden section that narrow a minimum of the speed limit between two samples.
_NARROWINGS = 20


@dataclass(frozen=True, eq=False)
class Scan:
    """Samples along a path of curves, each of which begins where the one before ends.

    Attributes
    ----------
    tracks : tuple of Track
    origins : ndarray, shape (curves,)
        Length from the start of the path at which each curve begins; negative for one that began before.
    curve : ndarray of int, shape (n,)
        Index of the curve of each sample.
    u, lengths, speeds : ndarray, shape (n,)
        Parameter, length from the start of the path, and the largest speed that the limits allow.
    causes : ndarray of str, shape (n,)
        Name of the limit that allows no more.
    corners : ndarray of bool, shape (n,)
        Samples where the tangent jumps and allows less speed than the curvature there.
    tangents, curvatures : ndarray, shape (n, dim)
        Unit tangents and curvature vectors. Where axes are limited and these jump at a knot, two samples have
        the same length, one for each side.
    axis_parts : ndarray, shape (n,)
        Part of the limits of axes that a plan may use there.
    """

    tracks: tuple
    origins: np.ndarray
    curve: np.ndarray
    u: np.ndarray
    lengths: np.ndarray
    speeds: np.ndarray
    causes: np.ndarray
    corners: np.ndarray
    tangents: np.ndarray
    curvatures: np.ndarray
    axis_parts: np.ndarray

    @property
    def length(self):
        """Length of the path, in mm."""
        return float(self.lengths[-1])

    def place(self, length):
        """Text for error messages: where on the path a length lies."""
        k = min(int(np.searchsorted(self.lengths, length)), len(self.u) - 1)
        which = f" of curve {self.curve[k]}" if len(self.tracks) > 1 else ""
        return f"{length:.6g} mm from the start (u = {self.u[k]:.6g}{which})"

    def rest(self, start):
        """The path from a length on."""
        near = 1e-12 * self.length
        k = int(np.searchsorted(self.lengths, start + near, side="right")) - 1
        rows = {name: getattr(self, name)[k:].copy() for name in _ROWS}
        before, after = rows["lengths"][:2]
        part, gone = (start - before) / (after - before), rows["curve"][0]
        if part * (after - before) > near:
            gone = rows["curve"][1]
            between = {"speeds", "tangents", "curvatures"} | ({"u"} if rows["curve"][0] == gone else set())
            for name, row in rows.items():
                row[0] = (1.0 - part) * row[0] + part * row[1] if name in between else row[1]
        rows["lengths"][0], rows["corners"][0] = start, False
        rows |= {"lengths": rows["lengths"] - start, "curve": rows["curve"] - gone}
        return Scan(self.tracks[gone:], self.origins[gone:] - start, **rows)


_ROWS = ("curve", "u", "lengths", "speeds", "causes", "corners", "tangents", "curvatures", "axis_parts")


def scan(track, limits):
    """Sample a curve so finely that the speed limit is piecewise linear, with its minima among the samples.

    Between two samples a bound of the curvature, certified by Bernstein coefficients, shows that no peak is
    overlooked: the limit is nowhere lower than at the samples by more than a few parts in a hundred, and by
    no more than ``MARGIN`` wherever the limit is smooth between them. There are at most `_HALVINGS` rounds,
    and a curve that needs more cells than `_MOST_CELLS` says is refused.
    """
    span, u = _samples(track, limits)
    tangents, curvatures = path_derivatives(track, span, u)
    table = limits.speed_table(tangents, curvatures)[:-1]
    causes, speeds = np.array(NAMES, dtype=object)[table.argmin(axis=0)], table.min(axis=0)
    _refuse_sharp_peaks(track, u, causes, curvatures)
    inner = causes != "speed"
    inner[[0, -1]] = False
    speeds[inner] *= 1.0 - MARGIN
    rows = {
        "curve": np.zeros(len(u), dtype=np.int64),
        "u": u,
        "lengths": arc_lengths(track, u),
        "speeds": speeds,
        "causes": causes,
        "corners": np.zeros(len(u), dtype=bool),
        "tangents": tangents,
        "curvatures": curvatures,
        "axis_parts": np.ones(len(u)),
    }
    return _merged((track,), np.zeros(1), rows, 1 + np.flatnonzero(span[1:] != span[:-1]), limits)


def join(paths, limits):
    """One path of several, each beginning where the one before ends."""
    paths = list(paths)
    before = np.cumsum([0.0, *(path.length for path in paths[:-1])])
    curves = np.cumsum([0, *(len(path.tracks) for path in paths[:-1])])
    rows = {name: np.concatenate([getattr(path, name) for path in paths]) for name in _ROWS}
    count = np.array([len(path.u) for path in paths])
    rows["lengths"] = rows["lengths"] + np.repeat(before, count)
    rows["curve"] = rows["curve"] + np.repeat(curves, count)
    origins = np.concatenate([path.origins + gone for path, gone in zip(paths, before, strict=True)])
    tracks = tuple(track for path in paths for track in path.tracks)
    return _merged(tracks, origins, rows, np.cumsum(count)[:-1], limits)


def _refuse_sharp_peaks(track, u, causes, curvatures):
    """Refuse a radius so small that a limit of acceleration cannot be kept around it in double precision."""
    sharpness = np.linalg.norm(curvatures, axis=1) * np.isin(causes, _OF_CURVATURE)
    if sharpness.max() * track.length > 1.0 / _SHARPEST:
        k = sharpness.argmax()
        raise ValueError(
            f"curve has a radius of {1.0 / sharpness[k]:.3g} mm at u = {u[k]:.12g}, too small for double "
            f"precision beside its length of {track.length:.6g} mm: {causes[k]} cannot be kept there; "
            "smooth it there or split it"
        )


def _merged(tracks, origins, rows, ends, limits):
    """Merge the two samples of every knot: ``ends`` are the indices of the second of each pair."""
    speeds, causes, corners = (rows[name].copy() for name in ("speeds", "causes", "corners"))
    tangents, curvatures = rows["tangents"], rows["curvatures"]
    strict = np.where(speeds[ends - 1] < speeds[ends], ends - 1, ends)
    for side in (ends - 1, ends):
        speeds[side], causes[side] = speeds[strict], causes[strict]
    turned = angles(tangents[ends - 1], tangents[ends])
    for k in np.flatnonzero(turned > CORNER):
        corner, cause = limits.corner_speed(turned[k])
        if corner < speeds[ends[k]]:
            both = slice(ends[k] - 1, ends[k] + 1)
            corners[both], speeds[both], causes[both] = True, corner, cause
    keep = np.ones(len(speeds), dtype=bool)
    keep[ends] = False
    if limits.axis_acceleration is not None:
        both = np.hstack([tangents, curvatures * rows["lengths"][-1]])
        keep[ends] = np.abs(both[ends] - both[ends - 1]).max(axis=1) > JUMP
    rows = rows | {"speeds": speeds, "causes": causes, "corners": corners}
    return Scan(tracks, origins, **{name: row[keep] for name, row in rows.items()})


def angles(before, after):
    """Angles between unit vectors, in radians."""
    return 2.0 * np.arctan2(np.linalg.norm(after - before, axis=1), np.linalg.norm(after + before, axis=1))


def arc_lengths(track, u):
    """Arc lengths from the start to parameters that do not fall, from the first to the last of the curve."""
    lengths = np.zeros(len(u))
    span_kernels.moved_lengths(track.spans, track.panels, u, lengths[1:])
    np.cumsum(lengths, out=lengths)
    return lengths * (track.length / lengths[-1])


def path_derivatives(track, span, u):
    """Unit tangents and curvature vectors, each parameter seen from the inside of its span."""
    shape = len(u), track.curve.control_points.shape[1]
    tangents, curvatures = np.empty(shape), np.empty(shape)
    _kernels.path_derivatives(track.spans, span, u, tangents, curvatures)
    return tangents, curvatures


def _samples(track, limits):
    """Spans and parameters of the samples in order, both ends of every span and all minima included."""

    def sampled(span, u):
        """One row each: the largest speed, the curvature and the unit tangent."""
        tangents, curvatures = path_derivatives(track, span, u)
        *table, curvature = limits.speed_table(tangents, curvatures)
        return np.column_stack([np.min(table, axis=0), curvature, tangents])

    breaks = track.spans[0]
    count, spans = _FIRST_CELLS if limits.of_the_curve else 1, np.arange(len(breaks) - 1)
    span = np.repeat(spans, count)
    start = (breaks[:-1, None] + np.diff(breaks)[:, None] * (np.arange(count) / count)).ravel()
    stop = np.append(start[1:], breaks[-1])
    found = [(spans, breaks[1:], sampled(spans, breaks[1:])[:, 0])]
    left, between, right = (sampled(span, u) for u in (start, 0.5 * (start + stop), stop))
    halved, most = 0, _MOST_CELLS[0] + _MOST_CELLS[1] * len(breaks)
    for _ in range(_HALVINGS):
        middle = 0.5 * (start + stop)
        quarter = sampled(span, 0.5 * (start + middle))  # the middle alone is blind to points of inflection
        poor = np.zeros(len(span), dtype=bool)
        for inner, part in ((between, 0.5), (quarter, 0.25)):
            linear = (1.0 - part) * left[:, 0] + part * right[:, 0]
            poor |= np.abs(inner[:, 0] - linear) > SCAN_TOLERANCE * inner[:, 0]
        if limits.axis_acceleration is not None:
            poor |= np.linalg.norm(right[:, 2:] - left[:, 2:], axis=1) > TURN[limits.jerk is not None]
        if limits.of_the_curve:
            doubtful = np.flatnonzero(~poor)
            cells = (row[doubtful] for row in (span, start, stop))
            poor[doubtful] = ~_sure(
                track, limits, *cells, [side[doubtful] for side in (left, between, right)]
            )
        poor &= (start < middle) & (middle < stop)
        poor[poor] &= _worth(track, span[poor], start[poor], stop[poor])
        found.append((span[~poor], start[~poor], left[~poor, 0]))
        cells = span, start, middle, stop, left, quarter, between, right
        span, start, middle, stop, left, quarter, between, right = (row[poor] for row in cells)
        if not len(span):
            break
        halved += len(span)
        if halved > most:
            raise ValueError(
                f"curve needs more than {most} samples, most of them near u = {np.median(middle):.9g}, where "
                "its curvature changes too much for its length; smooth it there or split it"
            )
        last = sampled(span, 0.5 * (middle + stop))
        left, between, right = map(np.concatenate, ([left, between], [quarter, last], [between, right]))
        span, start, stop = np.tile(span, 2), np.append(start, middle), np.append(middle, stop)
    found.append((span, start, left[:, 0]))
    found.append(_beside_jumps(breaks, sampled))
    span, u, speeds = (np.concatenate(rows) for rows in zip(*found, strict=True))
    order = np.lexsort((u, span))
    span, u, speeds = span[order], u[order], speeds[order]
    low, high = speeds[1:-1] < speeds[:-2], speeds[1:-1] <= speeds[2:]
    valley = 1 + np.flatnonzero(low & high & (span[:-2] == span[2:]))
    if valley.size:
        low, high, where = u[valley - 1], u[valley + 1], span[valley]
        least = golden_section(lambda u: sampled(where, u)[:, 0], low, high, _NARROWINGS)
        span, u = np.append(span, where), np.append(u, least)
        order = np.lexsort((u, span))
        span, u = span[order], u[order]
        fresh = np.append(True, (np.diff(u) > 0.0) | (np.diff(span) > 0))
        span, u = span[fresh], u[fresh]
    return span, u


def _beside_jumps(breaks, sampled):
    """Samples close to both ends of the curve and to knots where the speed limit or the tangent jumps."""
    spans = np.arange(len(breaks) - 1)
    before, after = sampled(spans[:-1], breaks[1:-1]), sampled(spans[1:], breaks[1:-1])
    jump = np.abs(before - after)[:, 0] > _JUMPING * np.minimum(before, after)[:, 0]
    left = np.flatnonzero(jump | (angles(before[:, 2:], after[:, 2:]) > CORNER))
    near = _BESIDE * np.diff(breaks)
    before, after = np.append(left, len(breaks) - 2), np.append(left + 1, 0)
    span = np.concatenate([before, after])
    u = np.concatenate([breaks[before + 1] - near[before], breaks[after] + near[after]])
    return span, u, sampled(span, u)[:, 0]


def _worth(track, span, start, stop):
    """Whether cells are long enough to be halved."""
    widths = np.empty(len(span))
    span_kernels.cell_lengths(track.spans, span, start, stop, widths)
    return widths > _SHORTEST_CELL * track.length


def _sure(track, limits, span, start, stop, samples):
    """Whether a certified bound of curvature shows that no lower speed limit hides inside a cell."""
    bound = curvature_bounds(track.spans, span, start, stop)
    slowest, sharpest = np.min(samples, axis=0)[:, 0], np.max(samples, axis=0)[:, 1]
    harmless = limits.least_speed(bound) >= slowest
    if limits.axis_speed is not None:
        width = np.linalg.norm(track.curve(stop) - track.curve(start), axis=1)
        harmless &= bound * width <= TURN[0]
    return (bound <= _SURE * sharpest) | harmless
