"""S-curves: a grid along the path, and a slow motion on it from which the fastest is sought."""

import itertools
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from nurbs_lab.common.progress import bar
from nurbs_lab.motion import _kernels
from nurbs_lab.motion._scurve_problem import Block
from nurbs_lab.motion.feed import from_jerks, path_of_jerks, stretch
from nurbs_lab.motion.scan import angles
from nurbs_lab.motion.trapezoid import fastest

#: Part of the limits for a first motion straight from end to end. On an even grid its spline takes up to 7/6
#: of the jerk, in a cell where this changes sign.
_STEEP = 0.856
#: Cells at most between two stops, besides as many as the path has samples there.
_MOST = 20_000.0
#: Limits of axes are lowered by this part, for what happens between two nodes of the grid.
_AXIS_MARGIN = 1e-3
#: The grid has one more cell for each so many samples of the path.
_SAMPLES = 8.0
#: With limits of axes the path turns by about this at most (radians) in a cell.
_TURN = 2e-2
#: A motion that cannot be slowed down as a whole keeps this part of the jerk for what happens inside cells.
_JERK_MARGIN = 1e-3
#: Where the motion leaves rest, cells grow with the distance from it by this part.
_GROWTH = 0.03
#: A ramp of the acceleration is no shorter than the time in which it covers about this part of the length.
_SHORTEST = 1e-9
#: A phase out of rest covers no less than this part of the whole length.
_SHORTEST_RAMP = 1e-11
#: Two stops lie no nearer to each other than this part of the whole length.
_SHORTEST_LEG = 1e-10
#: Cells are no shorter than this part of sqrt(v³ / J); in shorter ones rounding would exceed the jerk J.
_SHORTEST_CELL = 6e-5


class Fineness(NamedTuple):
    """How finely a motion is planned.

    Cells for a period and for a ramp of the acceleration, the fewest between two stops, and the part of the
    time by which a motion may last longer than the least one of its grid.
    """

    per_period: float
    per_ramp: float
    fewest: float
    gap: float


#: Of a plan of a whole curve, and of a window of a program, whose motion lasts some parts in 10,000 longer.
#: With a smaller gap than the first, Newton steps lose their digits, and stretches of constant speed ripple.
WHOLE, WINDOW = Fineness(4.0, 40.0, 2000.0, 1e-4), Fineness(0.25, 5.0, 200.0, 3e-3)


@dataclass(frozen=True, eq=False)
class Motion:
    """Solved blocks, one after the other."""

    legs: list  # of blocks, their ordinates, and the weights that remain
    length: float
    limits: object

    @cached_property
    def profile(self):
        """The feed profile."""
        return self._joined([block.phases(middle) for block, middle, _ in self.legs])

    def lasting(self, duration):
        """The profile of a longer motion with the same speeds at both ends, farther from all limits."""
        factor = duration / self.profile.duration
        rows = []
        for block, middle, weight in self.legs:
            durations, jerks, causes = block.phases(middle)
            if not any(block.speeds):
                rows.append((durations * factor, jerks / factor**3, causes))
            else:
                slowed = middle.copy()
                block.stretch_to(slowed, weight, durations.sum() * factor * (1.0 - 1e-11))
                rows.append(block.phases(slowed))
        profile = self._joined(rows)
        return stretch(profile, duration / profile.duration)

    def _joined(self, rows):
        durations, jerks, causes = (np.concatenate([row[k] for row in rows]) for k in range(3))
        return from_jerks(durations, jerks, self.legs[0][0].speeds[0], self.length, self.limits, causes)


def s_curve(path, limits, ends, fineness, known=None):
    """Fastest S-curves between the stops of the trapezoid for the same limits.

    ``known`` is a profile along the first part of the path that keeps the limits, from which the search may
    begin.
    """
    lengths, squares = fastest(path, limits, ends, path.speeds**2)
    shortest = np.sqrt(_SHORTEST * lengths[-1] / limits.acceleration)
    limits = replace(limits, jerk=min(limits.jerk, limits.acceleration / shortest))
    stops = np.flatnonzero(squares[1:-1] == 0.0) + 1
    bounds = list(itertools.pairwise([0, *stops, len(squares) - 1]))
    legs = []
    for first, last in bar(bounds, len(bounds), "S-curves", " stops"):
        if lengths[last] - lengths[first] < _SHORTEST_LEG * lengths[-1]:
            raise ValueError(
                f"curve has two corners {lengths[last] - lengths[first]:.3g} mm apart at "
                f"{path.place(lengths[first])}, too close for double precision beside its length; join them"
            )
        speeds = np.array([ends[0] if first == 0 else 0.0, ends[1] if last == len(squares) - 1 else 0.0])
        here = slice(first, last + 1)
        block, middle = _prepare(path, limits, speeds, lengths[here], squares[here], fineness)
        if known is not None and first == 0:
            guess = np.maximum(middle, _ordinates(partial(_known, known), block.nodes))
            guess[[0, -1]] = middle[[0, -1]]
            middle = min(guess, middle, key=block.infeasibility)
        if not block.make_feasible(middle):
            at, name = block.hardest(middle)
            raise ValueError(
                f"no S-curve fits between start_speed {ends[0]:g} mm/s and end_speed {ends[1]:g} mm/s: "
                f"{name} leaves no way on at {path.place(at + lengths[first])}; raise it or jerk, or lower "
                "these speeds"
            )
        legs.append((block, middle, block.solve(middle, fineness.gap)))
    return Motion(legs, lengths[-1], limits)


def _prepare(path, limits, speeds, lengths, squares, fineness):
    """A block between two stops, and a slow motion; both in lengths from the first stop."""
    origin, total = lengths[0], lengths[-1] - lengths[0]
    slow, gentle = _slow(path, limits, origin, total)
    ramp_jerk = _ramp_jerk(limits.jerk, slow, gentle, lengths[-1])
    rest = min(np.sqrt(0.5 * slow / ramp_jerk), 0.35 * gentle / ramp_jerk)  # to a quarter of the slow speed
    ramp_times = np.where(speeds <= 0.5 * ramp_jerk * rest**2, rest, 0.0)
    short = ramp_times * (speeds + ramp_jerk * ramp_times**2 / 6.0)
    nodes = _nodes(path, limits, speeds, ramp_times, short, lengths - origin, squares, origin, fineness)
    at = nodes + origin
    caps = _least_speeds(path, at)
    causes = path.causes[np.searchsorted(path.lengths, 0.5 * (at[1:] + at[:-1]))]
    along = across = np.empty((len(nodes), 0))
    if limits.axis_acceleration is not None:
        inner = np.ones(len(nodes))  # no margin at an end that moves, whose speed may be all that is allowed
        for speed, away in zip(speeds, (nodes, lengths[-1] - origin - nodes), strict=True):
            if speed > 0.0:
                inner = np.minimum(inner, away / (speed * np.sqrt(2.0 * speed / limits.jerk)))
        edges = np.concatenate([at[:1], 0.5 * (at[1:] + at[:-1]), at[-1:]])
        parts, _ = _extremes(edges, path.lengths, path.axis_parts[:, None])
        axis = (1.0 - _AXIS_MARGIN * inner)[:, None] * parts * limits.axis_acceleration
        (low, high), (least, most) = (
            [found / axis for found in _extremes(edges, path.lengths, rows)]
            for rows in (0.5 * path.tangents, path.curvatures)
        )
        along, across = np.hstack([low, high, -low, -high]), np.hstack([most, most, -least, -least])
    jerk = limits.jerk * (1.0 - _JERK_MARGIN * speeds.any())
    machine = limits.acceleration, jerk, tuple(speeds), tuple(ramp_times), ramp_jerk
    speeds = speeds + 0.5 * ramp_jerk * ramp_times**2
    accelerations = ramp_jerk * ramp_times
    signs = np.array([1.0, -1.0])
    ends = np.ravel(np.column_stack([speeds**2, 2.0 * signs * accelerations]))
    block = Block(nodes, ends, caps**2, causes, along, across, *machine)
    away = nodes - nodes[0], nodes[-1] - nodes
    guess = np.full(len(nodes) - 1, slow * slow)  # from both ends to the slow speed
    for s, v, a in zip(away, speeds, accelerations, strict=True):
        ramp = partial(_ramp, v, a, slow, 0.5 * gentle, 0.5 * limits.jerk)
        guess += _ordinates(ramp, s) - slow * slow
    lower = int(speeds[1] < speeds[0])
    ramp = partial(_ramp, speeds[lower], accelerations[lower], speeds[1 - lower])
    direct = _ordinates(partial(ramp, _STEEP * limits.acceleration, _STEEP * limits.jerk), away[lower])
    for middle in (guess, direct):
        middle[0] = ends[0] + 0.5 * ends[1] * (nodes[1] - nodes[0])
        middle[-1] = ends[2] - 0.5 * ends[3] * (nodes[-1] - nodes[-2])
    return block, min(guess, direct, key=block.infeasibility)


def _known(profile, s):
    """v² at lengths along a profile; zero beyond its end."""
    return np.where(s < profile.length, profile.speed(profile.time_at(s)) ** 2, 0.0)


def _ramp_jerk(jerk, slow, gentle, whole):
    """Jerk out of rest and into it: the limit, or less where rounding would swallow lengths so short."""
    by_acceleration = gentle**1.5 / np.sqrt(_SHORTEST * whole)
    by_speed = (0.25 * slow) ** 3 / (4.5 * (_SHORTEST_RAMP * whole) ** 2)
    return min(jerk, by_acceleration, by_speed)


def _extremes(edges, lengths, rows):
    """The least and the largest of samples, and of lines between them, from each edge to the next."""
    least, most = (np.empty((len(edges) - 1, rows.shape[1])) for _ in range(2))
    _kernels.extremes(edges, lengths, rows, least, most)
    return least, most


def _least_speeds(path, at):
    """The lowest speed limit in every cell."""
    smooth = ~path.corners
    caps = _extremes(at, path.lengths[smooth], path.speeds[smooth, None])[0][:, 0]
    inner = path.corners & (path.speeds > 0.0) & (path.lengths > at[0]) & (path.lengths < at[-1])
    for side in ("left", "right"):
        cells = np.searchsorted(at, path.lengths[inner], side) - 1
        np.minimum.at(caps, cells, path.speeds[inner])
    return caps


def _slow(path, limits, origin, total):
    """A speed far below every limit of the block, and an acceleration that leaves room for every axis."""
    mine = (path.lengths >= origin) & (path.lengths <= origin + total) & (path.speeds > 0.0)
    gentle, slow = limits.acceleration, 0.5 * path.speeds[mine].min()
    if limits.axis_acceleration is not None:
        gentle = min(gentle, 0.5 * limits.axis_acceleration.min())
        curvature = np.abs(path.curvatures[mine]).max(axis=0)
        with np.errstate(divide="ignore"):
            slow = min(slow, np.sqrt(0.25 * (limits.axis_acceleration / curvature).min()))
    short = 0.125 * total
    return min(slow, np.sqrt(0.5 * gentle * short), np.cbrt(0.25 * limits.jerk * short**2)), gentle


def _nodes(path, limits, speeds, ramp_times, short, lengths, squares, origin, fineness):
    """The grid: even in the time of the trapezoid, finer near rest and where the path turns."""
    jerk, total = limits.jerk, lengths[-1]
    first, last = short[0], total - short[1]
    # towards a level end the speed of full jerk from there is the measure: v = (J s² 9 / 2)^(1/3) from rest
    reach = np.where(ramp_times > 0.0, short, speeds * np.sqrt(2.0 * speeds / jerk))
    if not reach.any():
        raise ValueError(
            "no S-curve with these limits can be written in double precision; choose acceleration, jerk and "
            "axis_acceleration nearer to the size of the curve"
        )
    fine = np.concatenate([np.geomspace(1e-2 * r, total, 300) for r in reach if r > 0.0])
    fine = [lengths, _graded(lengths, squares), fine, total - fine]
    base = np.unique(np.clip(np.concatenate(fine), first, last))
    base = base[np.append(True, np.diff(base) > 1e-12 * total)]
    base[-1] = last
    half = 0.5 * (base[1:] + base[:-1])
    pace = np.interp(half, lengths, np.sqrt(squares))
    pace = np.minimum(pace, speeds[0] + np.cbrt(4.5 * jerk * half**2))
    pace = np.minimum(pace, speeds[1] + np.cbrt(4.5 * jerk * (total - half) ** 2))
    clock = np.concatenate([[0.0], np.cumsum(np.diff(base) / pace)])
    tick = min(limits.period_s / fineness.per_period, limits.acceleration / jerk / fineness.per_ramp)
    measure = clock * (np.clip(clock[-1] / tick, fineness.fewest, _MOST + len(lengths)) / clock[-1])
    if limits.axis_acceleration is not None:
        turned = np.concatenate([[0.0], np.cumsum(angles(path.tangents[:-1], path.tangents[1:]))])
        measure += np.interp(base + origin, path.lengths, turned) / _TURN
    measure += np.interp(base, lengths, np.arange(len(lengths))) / _SAMPLES
    measure += np.log1p((base - first) / reach[0]) / _GROWTH - np.log1p((last - base) / reach[1]) / _GROWTH
    counts = np.minimum(np.diff(measure), np.diff(base) / (_SHORTEST_CELL * np.sqrt(pace**3 / jerk)))
    measure = np.concatenate([[0.0], np.cumsum(counts)])
    nodes = np.interp(np.linspace(0.0, measure[-1], int(np.ceil(measure[-1])) + 1), measure, base)
    nodes[0], nodes[-1] = first, last
    return nodes


def _graded(lengths, squares):
    """Lengths between the nodes of the trapezoid where its v² is 4, 16, ... times that of the slower node."""
    rising = squares[1:] > squares[:-1]
    slow, fast = np.where(rising, squares[:-1], squares[1:]), np.where(rising, squares[1:], squares[:-1])
    slow = np.maximum(slow, 1e-12 * fast)
    count = np.maximum(np.ceil(np.log(fast / slow) / np.log(4.0)) - 1.0, 0.0).astype(int)
    cell = np.repeat(np.arange(len(count)), count)
    power = 1.0 + np.arange(len(cell)) - np.repeat(np.cumsum(count) - count, count)
    part = (slow[cell] * 4.0**power - slow[cell]) / (fast - slow)[cell]
    return (
        np.where(rising, lengths[:-1], lengths[1:])[cell]
        + part * (np.diff(lengths) * np.where(rising, 1, -1))[cell]
    )


def _ordinates(square, nodes):
    """Those of the spline that is v², a function of the length, wherever this is a parabola."""
    at_nodes, inside = square(nodes), square(0.5 * (nodes[1:] + nodes[:-1]))
    exact = 2.0 * inside - 0.5 * (at_nodes[1:] + at_nodes[:-1])
    return np.maximum(exact, 0.5 * np.minimum(at_nodes[1:], at_nodes[:-1]))  # where a cell holds a whole ramp


def _ramp(v, a, goal, acceleration, jerk, away):
    """v² at lengths along an S-curve from (v, a >= 0) to a level speed."""
    top = v + 0.5 * a * a / jerk
    rises = goal > top
    gain = goal - v if rises else top - goal
    gentlest = 0.5 * a * a if rises else 0.0
    peak = max(min(acceleration, np.sqrt(jerk * gain + gentlest)), a if rises else 0.0)
    hold = max((gain - (peak * peak - gentlest) / jerk) / peak, 0.0) if peak > 0.0 else 0.0
    sign = 1.0 if rises else -1.0
    durations = np.array([(peak - sign * a) / jerk, hold, peak / jerk])
    if not durations.any():
        return np.full(len(away), goal * goal)
    jerks = sign * jerk * np.array([1.0, 0.0, -1.0])[durations > 0.0]
    times, terms = path_of_jerks(durations[durations > 0.0], jerks, v, a)
    h, (start, v, half, sixth) = times[-1] - times[-2], terms[-1]
    beyond = start + h * (v + h * (half + h * sixth)), goal, 0.0, 0.0
    lengths = away if away[0] <= away[-1] else away[::-1]
    lengths = lengths[: np.searchsorted(lengths, beyond[0])]
    reached, squares = np.empty(len(lengths)), np.full(len(away), goal * goal)
    _kernels.times_at(np.append(times, np.inf), np.vstack([terms, beyond]), lengths, reached)
    phase = np.clip(np.searchsorted(times, reached, side="right") - 1, 0, len(terms) - 1)
    tau = reached - times[phase]
    squares[: len(lengths)] = (
        terms[phase, 1] + tau * (2.0 * terms[phase, 2] + tau * 3.0 * terms[phase, 3])
    ) ** 2
    return squares if away[0] <= away[-1] else squares[::-1]
