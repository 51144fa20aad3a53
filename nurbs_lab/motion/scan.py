"""The speed that the limits allow along a path of one curve or several, sampled as finely as it needs."""

from dataclasses import dataclass, field, replace

import numpy as np

from nurbs_lab.common.checks import largest
from nurbs_lab.common.checks import lengths as lengths_of
from nurbs_lab.motion import _kernels
from nurbs_lab.motion.corners import ROWS, sampled, slowed_at_corners
from nurbs_lab.motion.prepared_curve import EQUAL_WITHIN
from nurbs_lab.nurbs import span_kernels

#: Cells are halved until the speed limit between their ends is linear to this part, by which limits that
#: follow from the curve are lowered, for what happens between two samples.
SCAN_TOLERANCE = 2e-4
#: Where the acceleration may step, the path turns by no more than this (radians) between two samples, since
#: what a limit leaves along it changes with its direction.
TURN = 5e-3
#: Beside a knot where the speed limit jumps, samples lie at this part of its spans.
_BESIDE = 1e-2
#: Radii below this part of the length count as this large: rounding of the length hides what happens there.
SHARPEST = 1e-12
#: Cells of a span before the first halving.
_FIRST_CELLS = 8
#: Most cells that are halved: so many in all, and so many more for each span.
_MOST_CELLS = 20_000, 2_000


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
    tangents, curvatures : ndarray, shape (n, dim)
        Unit tangents and curvature vectors. Where these jump at a knot and accelerations are limited, two
        samples have the same length, one for each side.
    parts : ndarray, shape (n, 4)
        Parts of the limits of speed, of acceleration, of the jerk of axes and of that along the path that a
        plan may use there.
    tops : ndarray, shape (n,)
        The limit of speed that the curve has of its own.
    kinks : ndarray, shape (k, 1 + dim)
        Length of every place where the tangent jumps, and the jump.
    zones : ndarray, shape (m, 4)
        From where to where, a period's way to both sides of a corner; the speed at which it takes all of the
        acceleration, and the largest part of that speed that the other limits allow.
    """

    tracks: tuple
    origins: np.ndarray
    curve: np.ndarray
    u: np.ndarray
    lengths: np.ndarray
    speeds: np.ndarray
    causes: np.ndarray
    tangents: np.ndarray
    curvatures: np.ndarray
    parts: np.ndarray
    tops: np.ndarray
    kinks: np.ndarray
    zones: np.ndarray = field(default_factory=lambda: np.empty((0, 4)))

    @property
    def length(self):
        """Length of the path, in mm."""
        return float(self.lengths[-1])

    def place(self, length):
        """Text for error messages: where on the path a length lies."""
        k = min(int(np.searchsorted(self.lengths, length)), len(self.u) - 1)
        which = f" of curve {self.curve[k]}" if len(self.tracks) > 1 else ""
        return f"{length:.6g} mm from the start (u = {self.u[k]:.6g}{which})"

    @property
    def caps(self):
        """Largest v² at the samples, lowered for what happens between two of them."""
        inner = self.causes != "speed"
        inner[[0, -1]] = False
        return (self.speeds * self.parts[:, 0] * np.where(inner, 1.0 - SCAN_TOLERANCE, 1.0)) ** 2

    @property
    def jumps(self):
        """Lengths at which tangents or curvatures jump."""
        return self.lengths[1:][np.diff(self.lengths) == 0.0]

    @property
    def knots(self):
        """Lengths of all knots inside the path, at which the rate of the curvature may jump."""
        inner = [
            origin + np.interp(track.spans[0], *track.panels)
            for origin, track in zip(self.origins, self.tracks, strict=True)
        ]
        return np.unique(np.concatenate(inner))

    def near_corners(self, lengths):
        """At increasing lengths: the least speed held near a corner, and the largest part of it in use."""
        held, parts = np.full(len(lengths), np.inf), np.zeros(len(lengths))
        _kernels.near_corners(lengths, self.zones, held, parts)
        return held, parts

    def shares(self, lengths, limits, tangents, curvatures):
        """What accelerating near a corner costs: t and n of ``t |a| + n v² <= 1``, zero elsewhere.

        The corner takes the part x = v / held of the acceleration of a period. The curvature beside it and
        what changes the speed share the rest. As v² is what is planned, x is bounded by its tangent at the
        fastest x that the rest allows.
        """
        held, parts = self.near_corners(lengths)
        near = parts > 0.0
        along = np.full(len(lengths), 1.0 / limits.acceleration)
        across = np.linalg.norm(curvatures, axis=1) / limits.across[0]
        if limits.axis_acceleration is not None:
            along = np.maximum(along, largest(tangents / limits.axis_acceleration))
            across = np.maximum(across, largest(curvatures / limits.axis_acceleration))
        square = np.where(near, held, 1.0) ** 2
        most = np.minimum(np.where(near, parts, 1.0), 2.0 / (1.0 + np.sqrt(1.0 + 4.0 * across * square)))
        rest = 1.0 - 0.5 * most
        return near * [along / rest, (across + 0.5 / (most * square)) / rest]

    def turned(self, lengths, speeds, period):
        """Curvature vectors that periods see of corners at lengths and speeds, none at rest.

        The third difference of positions has ``3 v a`` times it, as of the curvature. A corner that shares no
        period with another is none: its speed is held.
        """
        at, ways = self.kinks[:, 0], speeds * period
        gaps = np.diff(at, prepend=-np.inf, append=np.inf)
        near = np.minimum(gaps[1:], gaps[:-1]) <= 3.0 * period * np.interp(at, self.lengths, self.speeds)
        total = np.vstack([0.0 * self.tangents[:1], np.cumsum(near[:, None] * self.kinks[:, 1:], axis=0)])

        def within(reach):
            first, beyond = (np.searchsorted(at, lengths + side * reach * ways) for side in (-1.0, 1.0))
            return total[beyond] - total[first]

        return (0.375 * within(1.5) - 0.125 * within(0.5)) / np.where(ways > 0.0, ways, 1.0)[:, None]

    def geometry(self, lengths, inside):
        """Parameters, unit tangents, curvature vectors and their rates at lengths that do not fall.

        Each is seen from the span in which the length ``inside`` lies.
        """
        u, found = np.empty(len(lengths)), np.empty((3, len(lengths), self.tangents.shape[1]))
        which = np.clip(np.searchsorted(self.origins, inside, side="right") - 1, 0, len(self.tracks) - 1)
        for k in range(which[0], which[-1] + 1) if len(which) else ():
            track, mine = self.tracks[k], slice(*np.searchsorted(which, [k, k + 1]))
            at, seen = (np.clip(one[mine] - self.origins[k], 0.0, track.length) for one in (lengths, inside))
            u[mine] = track.parameters_at(at)
            span = track.spans_at(track.parameters_at(seen))
            found[:, mine] = path_derivatives(track, span, u[mine])
        return u, *found

    def rest(self, start):
        """The path from a length on."""
        near = 1e-12 * self.length
        k = int(np.searchsorted(self.lengths, start + near, side="right")) - 1
        rows = {name: getattr(self, name)[k:].copy() for name in ROWS}
        before, after = rows["lengths"][:2]
        part, gone = (start - before) / (after - before), rows["curve"][0]
        if part * (after - before) > near:
            gone = rows["curve"][1]
            between = {"speeds", "tangents", "curvatures"} | ({"u"} if rows["curve"][0] == gone else set())
            for name, row in rows.items():
                row[0] = (1.0 - part) * row[0] + part * row[1] if name in between else row[1]
        rows["lengths"][0] = start
        kinks, zones = self.kinks[self.kinks[:, 0] > start], self.zones[self.zones[:, 1] > start]
        kinks[:, 0] -= start
        zones[:, :2] -= start
        rows |= {"lengths": rows["lengths"] - start, "curve": rows["curve"] - gone}
        return Scan(self.tracks[gone:], self.origins[gone:] - start, **rows, kinks=kinks, zones=zones)


def scan(track, limits, finer=1.0):
    """Sample a curve so finely that the speed limit is piecewise linear.

    The curvature has narrow peaks only where |C'| has a minimum, so that each of these is a sample. Between
    two samples the limit is lower than both by no more than `SCAN_TOLERANCE`. A curve that needs more cells
    than `_MOST_CELLS` says is refused. ``finer`` divides `SCAN_TOLERANCE` and `TURN`.
    """
    span, u = _samples(track, limits, finer)
    tangents, curvatures, _ = path_derivatives(track, span, u)
    first = np.zeros(len(u), dtype=np.int64)
    rows = sampled(limits, first, u, arc_lengths(track, u), tangents, curvatures)
    path = Scan((track,), np.zeros(1), **rows, kinks=np.empty((0, 1 + track.curve.dim)))
    ends = 1 + np.flatnonzero(span[1:] != span[:-1])
    return _merged(path, ends, limits) if len(ends) else path


def join(paths, limits):
    """One path of a list of several, each beginning where the one before ends."""
    before = np.cumsum([0.0, *(path.length for path in paths[:-1])])
    curves = np.cumsum([0, *(len(path.tracks) for path in paths[:-1])])
    rows = {name: np.concatenate([getattr(path, name) for path in paths]) for name in ROWS}
    count = np.array([len(path.u) for path in paths])
    rows["lengths"] = rows["lengths"] + np.repeat(before, count)
    rows["curve"] = rows["curve"] + np.repeat(curves, count)
    origins = np.concatenate([path.origins + gone for path, gone in zip(paths, before, strict=True)])
    kinks = np.concatenate([path.kinks for path in paths])
    kinks[:, 0] += np.repeat(before, [len(path.kinks) for path in paths])
    tracks = tuple(track for path in paths for track in path.tracks)
    path = Scan(tracks, origins, **rows, kinks=kinks)
    return _merged(path, np.cumsum(count)[:-1], limits)


def _merged(path, ends, limits):
    """Merge the two samples of every knot: ``ends`` are the indices of the second of each pair."""
    speeds, causes, tops = path.speeds.copy(), path.causes.copy(), path.tops.copy()
    strict = np.where(speeds[ends - 1] < speeds[ends], ends - 1, ends)
    for side in (ends - 1, ends):
        speeds[side], causes[side] = speeds[strict], causes[strict]
    tops[[ends - 1, ends]] = tops[[ends - 1, ends]].min(axis=0)
    both = np.hstack([path.tangents, path.curvatures * path.length])
    keep = np.ones(len(speeds), dtype=bool)
    keep[ends] = largest(both[ends] - both[ends - 1]) > EQUAL_WITHIN
    steps = path.tangents[ends] - path.tangents[ends - 1]
    kinked = steps.any(axis=1)
    kinks = np.concatenate([path.kinks, np.column_stack([path.lengths[ends], steps])[kinked]])
    kinks = kinks[np.argsort(kinks[:, 0], kind="stable")]
    path = replace(path, speeds=speeds, causes=causes, tops=tops, kinks=kinks)
    return slowed_at_corners(replace(path, **{name: getattr(path, name)[keep] for name in ROWS}), limits)


def arc_lengths(track, u):
    """Arc lengths from the start to parameters that do not fall, from the first to the last of the curve."""
    lengths = np.zeros(len(u))
    span_kernels.moved_lengths(track.spans, track.panels, u, lengths[1:])
    np.cumsum(lengths, out=lengths)
    return lengths * (track.length / lengths[-1])


def path_derivatives(track, span, u):
    """Unit tangents, curvature vectors and their rates, each parameter seen from the inside of its span."""
    found, sharpest = np.empty((3, len(u), track.curve.dim)), 1.0 / (SHARPEST * track.length)
    _kernels.path_derivatives(track.spans, span, u, *found)
    found[1] *= (sharpest / np.maximum(lengths_of(found[1]), sharpest))[:, None]
    return found


def _samples(track, limits, finer):
    """Spans and parameters of the samples in order, both ends of every span included."""
    turns = not (limits.soft or (limits.tangential_only and limits.axis_acceleration is None))

    def limits_at(span, u):
        """One row each: the largest speed, the curvature and the unit tangent."""
        tangents, curvatures, _ = path_derivatives(track, span, u)
        *table, curvature = limits.speed_table(tangents, curvatures)
        return np.column_stack([np.min(table, axis=0), curvature, tangents])

    breaks = track.spans[0]
    count, spans = _FIRST_CELLS if limits.of_the_curve else 1, np.arange(len(breaks) - 1)
    even = (breaks[:-1, None] + np.diff(breaks)[:, None] * (np.arange(count) / count)).ravel()
    dip_span, dips = track.dips
    span, start = np.append(np.repeat(spans, count), dip_span), np.append(even, dips)
    order = np.lexsort((start, span))
    span, start = span[order], start[order]
    stop = np.append(start[1:], breaks[-1])
    # of u: a minimum of |C'| may end a cell
    rounding = max(1e-13 * np.ptp(breaks), 4.0 * np.spacing(np.abs(breaks).max()))
    span, start, stop = (row[stop - start > rounding] for row in (span, start, stop))
    found = [(spans, breaks[1:])]
    if track.straight:  # the limits are the same all along a span
        found, span = [*found, (span, start)], span[:0]
    else:
        left, between, right = (limits_at(span, u) for u in (start, 0.5 * (start + stop), stop))
    halved, most = 0, int(finer) * (_MOST_CELLS[0] + _MOST_CELLS[1] * len(breaks))
    while len(span):
        middle = 0.5 * (start + stop)
        quarter = limits_at(span, 0.5 * (start + middle))  # the middle alone is blind to points of inflection
        poor = np.zeros(len(span), dtype=bool)
        for inner, part in ((between, 0.5), (quarter, 0.25)):
            linear = (1.0 - part) * left[:, 0] + part * right[:, 0]
            poor |= np.abs(inner[:, 0] - linear) > SCAN_TOLERANCE / finer * inner[:, 0]
        poor |= turns & (np.linalg.norm(right[:, 2:] - left[:, 2:], axis=1) > TURN / finer)
        poor &= stop - start > rounding  # at points of inflection no limit holds
        found.append((span[~poor], start[~poor]))
        cells = span, start, middle, stop, left, quarter, between, right
        span, start, middle, stop, left, quarter, between, right = (row[poor] for row in cells)
        halved += len(span)
        if halved > most:
            raise ValueError(
                f"curve needs more than {most} samples, most of them near u = {np.median(middle):.9g}, where "
                "its curvature changes too much for its length; smooth it there or split it"
            )
        last = limits_at(span, 0.5 * (middle + stop))
        left, between, right = map(np.concatenate, ([left, between], [quarter, last], [between, right]))
        span, start, stop = np.tile(span, 2), np.append(start, middle), np.append(middle, stop)
    found.append(_beside_jumps(breaks, limits_at))
    span, u = (np.concatenate(rows) for rows in zip(*found, strict=True))
    order = np.lexsort((u, span))
    return span[order], u[order]


def _beside_jumps(breaks, limits_at):
    """Samples close to both ends of the curve and to knots where the speed limit or the tangent jumps."""
    spans = np.arange(len(breaks) - 1)
    before, after = limits_at(spans[:-1], breaks[1:-1]), limits_at(spans[1:], breaks[1:-1])
    jump = np.abs(before - after)[:, 0] > SCAN_TOLERANCE * np.minimum(before, after)[:, 0]
    left = np.flatnonzero(jump | (np.linalg.norm(after[:, 2:] - before[:, 2:], axis=1) > EQUAL_WITHIN))
    near = _BESIDE * np.diff(breaks)
    before, after = np.append(left, len(breaks) - 2), np.append(left + 1, 0)
    span = np.concatenate([before, after])
    u = np.concatenate([breaks[before + 1] - near[before], breaks[after] + near[after]])
    return span, u
