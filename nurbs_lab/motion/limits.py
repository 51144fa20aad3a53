"""What holds the speed down where: the limits of a machine, met by the bends of a path."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.motion import _measure
from nurbs_lab.nurbs import span_kernels

#: The scan is refined until the speed limit between two samples is a straight line to this part.
SCAN_TOLERANCE = 2e-4
#: Tangents, and curvatures times the length, that differ by more on the two sides of a knot, jump there.
JUMP = 1e-6
#: With limits on axes, the path turns by no more than this (radians) between two samples.
TURN = 5e-3
_FIRST_SAMPLES = 16
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

        Bow height: ``2/T sqrt(2 rho eps - eps**2)``, and 2 rho / T where eps is above the radius rho.
        """
        bend = np.linalg.norm(curvatures, axis=1)
        found = {"speed": np.full(len(bend), self.speed)}
        with np.errstate(divide="ignore"):
            if self.chord_error is not None:
                radius = 1.0 / bend
                depth = np.minimum(self.chord_error, radius)
                found["chord_error"] = 2.0 / self.period_s * np.sqrt(depth * (2.0 / bend - depth))
            if self.centripetal_acceleration is not None:
                found["centripetal_acceleration"] = np.sqrt(self.centripetal_acceleration / bend)
            if self.axis_speed is not None:
                found["axis_speed"] = (self.axis_speed / np.abs(tangents)).min(axis=1)
            if self.axis_acceleration is not None:
                found["axis_acceleration"] = np.sqrt(self._largest_square(tangents, curvatures))
        return found

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

    Where axes are limited and the path bends otherwise behind a knot than before it, two samples have the
    same length, one for each side. ``corners`` marks the samples where the path turns on the spot by more
    than the speed elsewhere allows.
    """

    u: np.ndarray
    lengths: np.ndarray
    speeds: np.ndarray
    causes: np.ndarray
    corners: np.ndarray
    tangents: np.ndarray
    curvatures: np.ndarray


def scan(track, limits):
    """Sample a path so finely that the speed limit is piecewise linear, its minima included exactly."""
    breaks = track.spans[0]
    rows = [_scan_span(track, limits, i) for i in range(len(breaks) - 1)]
    u, tangents, curvatures = (np.concatenate([row[k] for row in rows]) for k in range(3))
    by_name = limits.speeds(tangents, curvatures)
    names = list(by_name)
    table = np.array([by_name[name] for name in names])
    causes = np.array(names, dtype=object)[table.argmin(axis=0)]
    speeds = table.min(axis=0)
    ends = np.cumsum([len(row[0]) for row in rows])[:-1]
    corners = np.zeros(len(u), dtype=bool)
    for left in ends - 1:  # a knot is sampled from both sides: the stricter one holds
        corner, cause = _corner(limits, tangents[left], tangents[left + 1])
        strict = left if speeds[left] < speeds[left + 1] else left + 1
        corners[left] = corner < speeds[strict]
        speeds[left], causes[left] = min(
            (speeds[strict], causes[strict]), (corner, cause), key=lambda x: x[0]
        )
        corners[left + 1], speeds[left + 1], causes[left + 1] = corners[left], speeds[left], causes[left]
    keep = np.ones(len(u), dtype=bool)
    if limits.axis_acceleration is None:
        keep[ends] = False
    else:
        both = np.hstack([tangents, curvatures * track.length])
        keep[ends] = np.abs(both[ends] - both[ends - 1]).max(axis=1) > JUMP
    lengths = np.empty(keep.sum())
    _arc_lengths(track, u[keep], lengths)
    return Scan(u[keep], lengths, *(x[keep] for x in (speeds, causes, corners, tangents, curvatures)))


def _corner(limits, before, after):
    turn = 2.0 * np.arctan2(np.linalg.norm(after - before), np.linalg.norm(after + before))
    return limits.corner_speed(turn) if turn > 1e-6 else (np.inf, "speed")


def _arc_lengths(track, u, lengths):
    steps = np.empty(len(u) - 1)
    span_kernels.moved_lengths(track.spans, track.panels, u, steps)
    lengths[0] = 0.0
    np.cumsum(steps, out=lengths[1:])
    lengths *= track.length / lengths[-1]


def _bends(track, span, u):
    tangents, curvatures = np.empty((len(u), 3)), np.empty((len(u), 3))
    _measure.bends(track.spans, np.full(len(u), span), u, tangents, curvatures)
    dim = track.curve.control_points.shape[1]
    return tangents[:, :dim], curvatures[:, :dim]


def _scan_span(track, limits, span):
    """Parameters of one span, both ends included, with tangents and curvature vectors."""

    def lowest(u):
        tangents, curvatures = _bends(track, span, u)
        return np.min(list(limits.speeds(tangents, curvatures).values()), axis=0), tangents

    breaks = track.spans[0]
    u = np.linspace(breaks[span], breaks[span + 1], _FIRST_SAMPLES + 1)
    speeds, tangents = lowest(u)
    for _ in range(20):
        middle = 0.5 * (u[1:] + u[:-1])
        found, between = lowest(middle)
        poor = np.abs(found - 0.5 * (speeds[1:] + speeds[:-1])) > SCAN_TOLERANCE * found
        if limits.axis_acceleration is not None:
            poor |= np.linalg.norm(np.diff(tangents, axis=0), axis=1) > TURN
        if not poor.any():
            break
        at = 1 + np.flatnonzero(poor)
        u, speeds = np.insert(u, at, middle[poor]), np.insert(speeds, at, found[poor])
        tangents = np.insert(tangents, at, between[poor], axis=0)
    valley = 1 + np.flatnonzero((speeds[1:-1] < speeds[:-2]) & (speeds[1:-1] <= speeds[2:]))
    if valley.size:
        low, high = u[valley - 1], u[valley + 1]
        for _ in range(40):
            first, second = low + _GOLDEN * (high - low), high - _GOLDEN * (high - low)
            left = lowest(first)[0] < lowest(second)[0]
            low, high = np.where(left, low, first), np.where(left, second, high)
        u = np.union1d(u, 0.5 * (low + high))
    return u, *_bends(track, span, u)
