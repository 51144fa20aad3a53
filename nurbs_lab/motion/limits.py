"""The limits of a machine, and the speed that they allow at every place of a path."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.motion import _measure
from nurbs_lab.motion._curvature_bounds import curvature_bounds
from nurbs_lab.nurbs import span_kernels

#: Cells are halved until the speed limit between their ends is linear to this part.
SCAN_TOLERANCE = 2e-4
#: Limits that follow from the curve are lowered by this part, for what happens between two samples.
MARGIN = 3e-4
#: Tangents, and curvatures times the length, that differ by more on the two sides of a knot, jump there.
JUMP = 1e-6
#: With limits of axes, the path turns by no more than this (radians) between two samples.
TURN = 5e-3
#: Tangents that differ by more (radians) make a corner.
CORNER = 1e-6
#: Beside a knot where the speed limit jumps by the first part, samples lie at the second part of its spans.
_JUMPING, _BESIDE = 1e-3, 1e-2
#: A certified bound of the curvature may exceed the samples of its cell by this factor.
_SURE = 1.1
#: Cells of a span before the first halving, halvings at most, and cells at most that one halving may make.
_FIRST_CELLS, _HALVINGS, _MOST_CELLS = 8, 40, 10_000_000
_GOLDEN = 0.381966011250105


@dataclass(frozen=True)
class Limits:
    """Limits of the motion, None where there is none; units mm and s."""

    speed: float
    acceleration: float
    period_s: float
    jerk: float | None = None
    chord_error: float | None = None
    centripetal_acceleration: float | None = None
    axis_speed: np.ndarray | None = None
    axis_acceleration: np.ndarray | None = None

    def speeds(self, tangents, curvatures):
        """Largest speed by each limit, as {name: array}.

        The chord error eps allows ``2/T sqrt(2 rho eps - eps**2)``, and 2 rho / T where it exceeds the
        radius of curvature rho.
        """
        curvature = np.linalg.norm(curvatures, axis=1)
        found = {"speed": np.full(len(curvature), self.speed)}
        with np.errstate(divide="ignore"):
            if self.chord_error is not None:
                radius = 1.0 / curvature
                depth = np.minimum(self.chord_error, radius)
                found["chord_error"] = 2.0 / self.period_s * np.sqrt(depth * (2.0 * radius - depth))
            if self.centripetal_acceleration is not None:
                found["centripetal_acceleration"] = np.sqrt(self.centripetal_acceleration / curvature)
            if self.axis_speed is not None:
                found["axis_speed"] = (self.axis_speed / np.abs(tangents)).min(axis=1)
            if self.axis_acceleration is not None:
                found["axis_acceleration"] = np.sqrt(self._largest_square(tangents, curvatures))
        return found

    @property
    def of_the_curve(self):
        """Whether any limit depends on the shape of the curve."""
        limits = self.chord_error, self.centripetal_acceleration, self.axis_speed, self.axis_acceleration
        return any(limit is not None for limit in limits)

    def least_speed(self, curvature):
        """A speed that keeps every limit but ``axis_speed`` wherever the curvature is at most this."""
        across = np.column_stack([curvature, np.zeros((len(curvature), 1))])
        bare = replace(self, axis_speed=None, axis_acceleration=None)
        least = np.min(list(bare.speeds(None, across).values()), axis=0)
        if self.axis_acceleration is not None:
            with np.errstate(divide="ignore"):
                least = np.minimum(least, np.sqrt(self.axis_acceleration.min() / curvature))
        return least

    def _largest_square(self, tangents, curvatures):
        """Largest v² for which some acceleration keeps every axis: |t_i a + n_i v²| <= A_i for all i.

        Axis i alone allows ``n_i v² <= A_i``-like strips in the (a, v²) plane; two of them cross where
        eliminating a leaves ``|n_i t_k - n_k t_i| v² <= A_i |t_k| + A_k |t_i|``.
        """
        limit, dim = self.axis_acceleration, tangents.shape[1]
        best = np.full(len(tangents), np.inf)
        for i in range(dim):
            for k in range(i):
                cross = np.abs(curvatures[:, i] * tangents[:, k] - curvatures[:, k] * tangents[:, i])
                room = limit[i] * np.abs(tangents[:, k]) + limit[k] * np.abs(tangents[:, i])
                free = np.full_like(room, np.inf)
                best = np.minimum(best, np.divide(room, cross, out=free, where=cross > 0.0))
        return best

    def corner_speed(self, turn):
        """Largest speed through a corner that turns by ``turn`` radians, and the limit that says so."""
        if self.centripetal_acceleration is not None:
            return 0.0, "centripetal_acceleration"
        if self.axis_acceleration is not None:
            return 0.0, "axis_acceleration"
        if self.chord_error is not None:
            return 2.0 * self.chord_error / (self.period_s * np.sin(0.5 * turn)), "chord_error"
        return np.inf, "speed"


@dataclass(frozen=True, eq=False)
class Scan:
    """Samples along a path: lengths, the speed limit there and its cause, tangents and curvature vectors.

    Where axes are limited and the curvature jumps at a knot, two samples have the same length, one for each
    side. ``corners`` marks samples where the tangent jumps and allows less speed than the curvature there.
    """

    u: np.ndarray
    lengths: np.ndarray
    speeds: np.ndarray
    causes: np.ndarray
    corners: np.ndarray
    tangents: np.ndarray
    curvatures: np.ndarray

    def place(self, k):
        """Where sample k lies, in words."""
        return f"{self.lengths[k]:.6g} mm from the start (u = {self.u[k]:.6g})"


def scan(track, limits):
    """Sample a path so finely that the speed limit is piecewise linear, with its minima among the samples.

    Between two samples a bound of the curvature, certified by Bernstein coefficients, shows that no peak is
    overlooked: the limit is nowhere lower than at the samples by more than a few parts in a hundred, and by
    no more than ``MARGIN`` wherever the limit is smooth between them.
    """
    span, u = _samples(track, limits)
    tangents, curvatures = path_derivatives(track, span, u)
    by_name = limits.speeds(tangents, curvatures)
    names = np.array(list(by_name), dtype=object)
    table = np.array(list(by_name.values()))
    causes, speeds = names[table.argmin(axis=0)], table.min(axis=0)
    inner = causes != "speed"
    inner[[0, -1]] = False
    speeds[inner] *= 1.0 - MARGIN
    ends = 1 + np.flatnonzero(span[1:] != span[:-1])
    corners = np.zeros(len(u), dtype=bool)
    strict = np.where(speeds[ends - 1] < speeds[ends], ends - 1, ends)  # a knot is sampled on both sides
    for side in (ends - 1, ends):
        speeds[side], causes[side] = speeds[strict], causes[strict]
    turns = _turns(tangents[ends - 1], tangents[ends])
    for k in np.flatnonzero(turns > CORNER):
        corner, cause = limits.corner_speed(turns[k])
        if corner < speeds[ends[k]]:
            both = slice(ends[k] - 1, ends[k] + 1)
            corners[both], speeds[both], causes[both] = True, corner, cause
    keep = np.ones(len(u), dtype=bool)
    keep[ends] = False
    if limits.axis_acceleration is not None:
        both = np.hstack([tangents, curvatures * track.length])
        keep[ends] = np.abs(both[ends] - both[ends - 1]).max(axis=1) > JUMP
    rows = speeds, causes, corners, tangents, curvatures
    return Scan(u[keep], arc_lengths(track, u[keep]), *(row[keep] for row in rows))


def _turns(before, after):
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
    tangents, curvatures = np.empty((len(u), 3)), np.empty((len(u), 3))
    _measure.path_derivatives(track.spans, span, u, tangents, curvatures)
    dim = track.curve.control_points.shape[1]
    return tangents[:, :dim], curvatures[:, :dim]


def _samples(track, limits):
    """Spans and parameters of the samples in order, both ends of every span and all minima included."""

    def lowest(span, u):
        tangents, curvatures = path_derivatives(track, span, u)
        speeds = np.min(list(limits.speeds(tangents, curvatures).values()), axis=0)
        return speeds, tangents, np.linalg.norm(curvatures, axis=1)

    breaks = track.spans[0]
    count = _FIRST_CELLS if limits.of_the_curve else 1
    span = np.repeat(np.arange(len(breaks) - 1), count)
    part = np.tile(np.arange(count) / count, len(breaks) - 1)
    start = breaks[span] + part * (breaks[span + 1] - breaks[span])
    stop = np.append(start[1:], breaks[-1])
    found = [(np.arange(len(breaks) - 1), breaks[1:], lowest(np.arange(len(breaks) - 1), breaks[1:])[0])]
    left, right = lowest(span, start), lowest(span, stop)
    for _ in range(_HALVINGS):
        middle = 0.5 * (start + stop)
        between = lowest(span, middle)
        quarter = lowest(span, 0.5 * (start + middle))[0]  # the middle alone is blind to points of inflection
        poor = np.abs(between[0] - 0.5 * (left[0] + right[0])) > SCAN_TOLERANCE * between[0]
        poor |= np.abs(quarter - 0.75 * left[0] - 0.25 * right[0]) > SCAN_TOLERANCE * quarter
        if limits.axis_acceleration is not None:
            poor |= np.linalg.norm(right[1] - left[1], axis=1) > TURN
        if limits.of_the_curve:
            doubtful = np.flatnonzero(~poor)
            cells = (row[doubtful] for row in (span, start, stop))
            samples = [[row[doubtful] for row in side] for side in (left, between, right)]
            poor[doubtful] = ~_sure(track, limits, *cells, samples)
        poor &= (start < middle) & (middle < stop)
        found.append((span[~poor], start[~poor], left[0][~poor]))
        span, start, middle, stop = (row[poor] for row in (span, start, middle, stop))
        if not len(span):
            break
        if len(span) > _MOST_CELLS:
            raise ValueError(f"curve has more than {_MOST_CELLS:g} places of high curvature; split it")
        left, between, right = ([row[poor] for row in side] for side in (left, between, right))
        left, right = (
            [np.concatenate(rows) for rows in zip(*sides, strict=True)]
            for sides in ((left, between), (between, right))
        )
        span, start, stop = np.tile(span, 2), np.append(start, middle), np.append(middle, stop)
    found.append((span, start, left[0][: len(span)]))
    found.append(_beside_jumps(breaks, lowest))
    span, u, speeds = (np.concatenate(rows) for rows in zip(*found, strict=True))
    order = np.lexsort((u, span))
    span, u, speeds = span[order], u[order], speeds[order]
    low, high = speeds[1:-1] < speeds[:-2], speeds[1:-1] <= speeds[2:]
    valley = 1 + np.flatnonzero(low & high & (span[:-2] == span[2:]))
    if valley.size:
        low, high, where = u[valley - 1], u[valley + 1], span[valley]
        for _ in range(40):
            first, second = low + _GOLDEN * (high - low), high - _GOLDEN * (high - low)
            before = lowest(where, first)[0] < lowest(where, second)[0]
            low, high = np.where(before, low, first), np.where(before, second, high)
        span, u = np.append(span, where), np.append(u, 0.5 * (low + high))
        order = np.lexsort((u, span))
        span, u = span[order], u[order]
        fresh = np.append(True, (np.diff(u) > 0.0) | (np.diff(span) > 0))
        span, u = span[fresh], u[fresh]
    return span, u


def _beside_jumps(breaks, lowest):
    """Samples close to both sides of every knot where the speed limit or the tangent jumps."""
    spans = np.arange(len(breaks) - 1)
    before, ends, _ = lowest(spans[:-1], breaks[1:-1])
    after, starts, _ = lowest(spans[1:], breaks[1:-1])
    jump = np.abs(before - after) > _JUMPING * np.minimum(before, after)
    left = np.flatnonzero(jump | (_turns(ends, starts) > CORNER))
    near = _BESIDE * np.diff(breaks)
    span = np.concatenate([left, left + 1])
    u = np.concatenate([breaks[left + 1] - near[left], breaks[left + 1] + near[left + 1]])
    return span, u, lowest(span, u)[0]


def _sure(track, limits, span, start, stop, samples):
    """Whether a certified bound of curvature shows that no lower speed limit hides inside a cell."""
    bound = curvature_bounds(track.spans, span, start, stop)
    slowest = np.min([speeds for speeds, _, _ in samples], axis=0)
    sharpest = np.max([curvature for _, _, curvature in samples], axis=0)
    harmless = limits.least_speed(bound) >= slowest
    if limits.axis_speed is not None:
        width = np.linalg.norm(track.curve(stop) - track.curve(start), axis=1)
        harmless &= bound * width <= TURN
    return (bound <= _SURE * sharpest) | harmless
