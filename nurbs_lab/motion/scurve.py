"""S-curves: a grid along the path, and a slow motion on it from which the fastest is sought."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from nurbs_lab.motion._scurve_problem import Block
from nurbs_lab.motion.feed import FeedProfile, from_jerks, path_of_jerks, stretch
from nurbs_lab.motion.prepared_curve import EQUAL_WITHIN
from nurbs_lab.motion.trapezoid import fastest

#: Cells at most: so many in all, so many more for each corner, and one for each sample of the path.
_MOST = 20_000.0, 30.0
#: The first motion takes at most this part of accelerations and jerks, and the root of it of speeds.
_PART = 0.5
#: The grid has one more cell for each so many samples of the path.
_SAMPLES = 8.0
#: Where the motion leaves rest or a corner, cells grow with the distance from it by this part.
_GROWTH = 0.03
#: A ramp of the acceleration is no shorter than the time in which it covers about this part of the length.
_SHORTEST = 1e-9
#: Cells are no shorter than this part of sqrt(v³ / J); in shorter ones rounding would exceed the jerk J.
_SHORTEST_CELL = 6e-5


class Fineness(NamedTuple):
    """How finely a motion is planned.

    Cells for a period and for a ramp of the acceleration, the fewest between two stops, the part of the time
    by which a motion may last longer than the least one of its grid, and the part by which accelerations and
    jerks of axes are lowered where the path turns, for what happens between two nodes.
    """

    per_period: float
    per_ramp: float
    fewest: float
    gap: float
    margin: float


#: Of a plan of a whole curve, and of a window of a program, whose motion lasts some parts in 10,000 longer.
#: With a smaller gap than the first, Newton steps lose their digits, and stretches of constant speed ripple.
WHOLE, WINDOW = Fineness(4.0, 40.0, 2000.0, 1e-4, 1e-3), Fineness(0.25, 5.0, 200.0, 3e-3, 4e-3)


@dataclass(frozen=True, eq=False)
class Motion:
    """A solved block, its ordinates, and the weight that remains on the room to the limits."""

    block: Block
    middle: np.ndarray
    weight: float
    length: float
    limits: object

    @cached_property
    def profile(self):
        """The feed profile."""
        return self._profile(self.middle)

    def lasting(self, duration):
        """The profile of a longer motion with the same speeds at both ends, farther from all limits."""
        profile = self.profile
        if any(self.block.speeds):
            slowed = self.middle.copy()
            self.block.stretch_to(slowed, self.weight, duration * (1.0 - 1e-11))
            profile = self._profile(slowed)
        return stretch(profile, duration / profile.duration)

    def _profile(self, middle):
        durations, jerks, causes = self.block.phases(middle)
        return from_jerks(durations, jerks, self.block.speeds[0], self.length, self.limits, causes)


def s_curve(path, limits, ends, fineness):
    """The fastest motion with limited jerk."""
    lengths, squares = fastest(replace(path, zones=path.zones[:0]), limits, ends, path.caps)
    shortest = np.sqrt(_SHORTEST * lengths[-1] / limits.acceleration)
    gentlest = squares.max() ** 1.5 / (_SHORTEST * lengths[-1]) ** 2  # a ramp so long to the top speed
    jerk = np.inf if limits.jerk is None else limits.jerk
    if limits.axis_jerk is not None:  # the axes together limit the jerk along the path
        jerk = min(jerk, 2.0 * float(np.linalg.norm(limits.axis_jerk)))
    steep = replace(limits, jerk=min(jerk, limits.acceleration / shortest, gentlest))
    block, middle = _prepare(path, steep, ends, lengths, squares, fineness)
    weight = block.make_feasible(middle)
    if not weight:
        names, parts = block.binding(middle)
        at, name = block.nodes[parts.argmax()], names[parts.argmax()]
        raise ValueError(
            f"no S-curve fits between start_speed {ends[0]:g} mm/s and end_speed {ends[1]:g} mm/s: "
            f"{name} leaves no way on at {path.place(at)}; raise it or jerk, or lower these speeds"
        )
    block, weight = block.solve(middle, weight, fineness.gap)
    return Motion(block, middle, weight, lengths[-1], limits)


def _prepare(path, limits, speeds, lengths, squares, fineness):
    """The block of a path, and a slow motion."""
    zones = _one_zone_a_place(path)
    places = np.concatenate([[0.0], zones[:, :2].mean(axis=1).clip(0.0, path.length), [path.length]])
    slowest = np.concatenate([speeds[:1], zones[:, 2] * zones[:, 3], speeds[1:]])
    near = path.lengths <= places[1], path.lengths >= places[-2]
    ramps = [_out_of_rest(path, limits, fineness.margin, near[end], end) for end in (0, -1)]
    most, rest = np.transpose(ramps)
    ramp_times = np.where(speeds <= 0.5 * most * rest**2, rest, 0.0)
    short = ramp_times * (speeds + most * ramp_times**2 / 6.0)
    jumps = path.jumps if limits.axis_jerk is None else path.knots
    nodes = _nodes(path, limits, (places, slowest), short, (lengths, squares), fineness)
    nodes = _through(_through(nodes, np.unique(path.zones[:, :2])), jumps)
    ends = (speeds + 0.5 * most * ramp_times**2) ** 2
    ends = np.ravel(np.column_stack([ends, np.array([2.0, -2.0]) * most * ramp_times]))
    of_nodes = limits_on(path, limits, nodes, speeds, fineness.margin)
    of_ends = map(tuple, (speeds, ramp_times, most))
    block = Block(nodes, ends, *of_nodes, *of_ends, np.ones(len(nodes) - 1))
    axes = limits.axis_acceleration, limits.axis_jerk
    along = zip((limits.acceleration, limits.jerk), axes, strict=True)
    steepest = [one if axis is None else min(one, axis.min()) for one, axis in along]
    return block, _guess(block, steepest, slowest, places, _fastest_between(path, places))


def _one_zone_a_place(path):
    """The zones of the path; of a corner at which curvatures jump too, the slower one."""
    order = np.argsort(path.zones[:, 2] * path.zones[:, 3], kind="stable")
    at = np.round(path.zones[order, :2].mean(axis=1) / path.length, 12)
    return path.zones[order[np.unique(at, return_index=True)[1]]]


def _fastest_between(path, places):
    """The largest speed that is allowed all along each stretch between corners."""
    start, stop = places[:-1], places[1:]
    runs = np.stack([np.searchsorted(path.lengths, start, "right"), np.searchsorted(path.lengths, stop)])
    tops = path.tops[runs[0] - 1]
    runs = np.where(runs[1] > runs[0], runs, [[len(path.caps)], [len(path.caps) + 1]])
    least = np.minimum.reduceat(np.append(path.caps, [np.inf, np.inf]), runs.T.ravel())[::2]
    return np.minimum(tops, np.sqrt(least))


def _out_of_rest(path, limits, margin, near, end):
    """The jerk and the time of the phase that leads out of an end at rest, or into it.

    The jerk leaves what turning takes up to a quarter of a slow speed and to 0.35 of the acceleration.
    """
    gentle, jerk, slow = limits.acceleration, limits.jerk, 0.5 * np.sqrt(path.caps[near].min())
    kappas, short = np.abs(path.curvatures[near]).max(axis=0), 0.125 * np.ptp(path.lengths[near])
    with np.errstate(divide="ignore"):
        if limits.axis_acceleration is not None:
            gentle = min(gentle, 0.5 * limits.axis_acceleration.min())
            slow = min(slow, np.sqrt(0.25 * (limits.axis_acceleration / kappas).min()))
        if limits.axis_jerk is not None:
            lengths = path.lengths[near]
            rates = np.abs(path.geometry(lengths, lengths)[3]).max(axis=0)
            slow = min(slow, np.cbrt(0.25 * (limits.axis_jerk / rates).min()))
            gentle = min(gentle, (limits.axis_jerk / (kappas * slow)).min() / 12.0)
            turning = 3.5 * kappas * (0.25 * slow) * (0.35 * gentle) + rates * (0.25 * slow) ** 3
            room = (1.0 - margin) * limits.axis_jerk - turning
            jerk = min(jerk, (room / np.abs(path.tangents[end])).min())
    slow = min(slow, np.sqrt(0.5 * gentle * short), np.cbrt(0.25 * limits.jerk * short**2))
    return jerk, min(np.sqrt(0.5 * slow / jerk), 0.35 * gentle / jerk)


def _guess(block, steepest, slowest, places, slow):
    """Ordinates of a motion that is level behind the ends, at corners and between them."""
    nodes, speeds, slopes = block.nodes, np.sqrt(block.ends[::2]), 0.5 * np.abs(block.ends[1::2])
    most = _PART * np.array(steepest)
    least = np.cbrt(_SHORTEST**2 * steepest[1] * np.ptp(nodes) ** 2)  # else the ramps are lost by rounding
    slow, outer = np.sqrt(_PART) * np.maximum(slow, least), 0.5 * np.array(block.ramp_jerks)
    level = np.minimum(np.sqrt(_PART) * slowest, np.minimum(np.append(np.inf, slow), np.append(slow, np.inf)))
    turns = slopes / outer  # times in which the accelerations of both ends vanish
    gone = turns * (speeds + slopes * turns / 3.0)
    edges = np.concatenate([nodes[:1] + gone[0], places[1:-1], nodes[-1:] - gone[1]])
    ways, level[[0, -1]] = np.maximum(np.diff(edges), 0.0), speeds + 0.5 * slopes * turns
    least, share = np.maximum(level[1:], level[:-1]), np.zeros(len(ways))
    for power in range(1, 40):
        top = least + (share + 0.5**power) * (slow - least)
        way = _rise(level[:-1], top, *most)[0] + _rise(level[1:], top, *most)[0]
        share = np.where(way <= ways, share + 0.5**power, share)
    top = least + share * (slow - least)
    rises, falls = _rise(level[:-1], top, *most), _rise(level[1:], top, *most)
    held, zero = np.maximum(ways - rises[0] - falls[0], 0.0) / top, np.zeros(len(ways))
    durations = np.column_stack([*rises[1], held, *falls[1]])
    changes = np.column_stack([rises[2], zero, -rises[2], zero, -falls[2], zero, falls[2]]).ravel()
    durations = np.concatenate([turns[:1], durations.ravel(), turns[1:]])
    changes = np.concatenate([-outer[:1], changes, -outer[1:]])
    there = durations > 1e-12 * durations.sum()
    path = path_of_jerks(durations[there], changes[there], speeds[0], slopes[0])
    profile = FeedProfile(*path, 1.0)
    begun = np.append(profile.terms[:, 0], profile.length)[np.cumsum(there) - there]
    met = np.concatenate([[0.0], begun[1::7], [profile.length]])
    places = np.concatenate([nodes[:1], edges, nodes[-1:]])

    def square(lengths):  # where a stretch is too short for its S-curves, these are shortened
        return profile.speed(profile.time_at(np.interp(lengths, places, met))) ** 2

    guess = _ordinates(square, nodes)
    guess[0] = block.ends[0] + 0.5 * block.ends[1] * (nodes[1] - nodes[0])
    guess[-1] = block.ends[2] - 0.5 * block.ends[3] * (nodes[-1] - nodes[-2])
    return guess


def _rise(low, high, accelerations, jerks):
    """Of S-curves from one speed to another: the ways, the times of three phases, the jerk of the first."""
    gain = np.abs(high - low)
    peak = np.minimum(accelerations, np.sqrt(jerks * gain))
    ramp = peak / jerks
    hold = np.where(peak > 0.0, gain / np.where(peak > 0.0, peak, 1.0) - ramp, 0.0)
    return 0.5 * (low + high) * (2.0 * ramp + hold), (ramp, hold, ramp), np.sign(high - low) * jerks


def _through(nodes, places):
    """The grid with nodes at places inside it, and without nodes that would be too near to them."""
    places = places[(places > nodes[1]) & (places < nodes[-2])]
    if not len(places):
        return nodes
    cell = np.searchsorted(nodes, places) - 1
    widths = nodes[cell + 1] - nodes[cell]
    places = places[np.append(True, np.diff(places) > 0.3 * widths[1:])]
    near = np.minimum(np.searchsorted(places, nodes), len(places) - 1)
    apart = np.minimum(np.abs(places[near] - nodes), np.abs(places[np.maximum(near - 1, 0)] - nodes))
    around = np.minimum(np.diff(nodes, prepend=-np.inf), np.diff(nodes, append=np.inf))
    keep = apart > 0.3 * around
    keep[[0, 1, -2, -1]] = True
    return np.sort(np.append(nodes[keep], places))


def limits_on(path, limits, nodes, speeds, margin):
    """The limits that `Block` holds, from caps to jerk, all of the true curve at both ends of every cell."""
    path = path if limits.axis_jerk is not None else _with_room(path, limits, nodes)
    half = 0.5 * (nodes[1:] + nodes[:-1])
    sides = [path.geometry(at, half)[1:] for at in (nodes[:-1], nodes[1:])]
    parts = extremes_between(nodes, path.lengths, path.parts)[0]
    start, stop = (limits.speed_table(t, n)[:-1] for t, n, _ in sides)
    table = np.minimum(np.column_stack([start, stop[:, -1]]), np.column_stack([start[:, 0], stop]))
    slower = np.arange(len(half)) + (table[:, 1:].min(axis=0) < table[:, :-1].min(axis=0))  # end of a cell
    caps = table.min(axis=0)[slower]
    causes = np.array(limits.names, dtype=object)[table.argmin(axis=0)[slower]]
    own = extremes_between(nodes, path.lengths, path.tops[:, None])[0][:, 0]
    own = np.minimum(own, np.minimum(np.append(own[1:], own[-1]), np.append(own[0], own[:-1])))
    causes[own < caps] = "speed"
    caps = np.minimum(caps, own)
    held, taken = path.near_corners(nodes)
    held, taken = np.minimum(held[1:], held[:-1]), np.maximum(taken[1:], taken[:-1])
    causes[held < caps] = "acceleration"
    caps = np.minimum(caps, held)
    (low, high), (least, most), kappas = _around_nodes(path, nodes, sides)
    inner = np.where(kappas * path.length > EQUAL_WITHIN, 1.0, 0.0)
    # no margin at an end that moves, whose speed may be all that is allowed
    for speed, away in zip(speeds, (nodes, nodes[-1] - nodes), strict=True):
        if speed * speed > 0.0:
            inner = np.minimum(inner, away / (speed * np.sqrt(2.0 * speed / limits.jerk)))
    room = (1.0 - margin * inner) * np.minimum(np.append(parts[:, 1], 1.0), np.append(1.0, parts[:, 1]))
    along = across = np.empty((len(nodes), 0))
    kappas = kappas / (limits.acceleration * room) * (not limits.tangential_only)
    if limits.axis_acceleration is not None:
        axis = room[:, None] * limits.axis_acceleration
        along = np.hstack([low / axis, high / axis, -low / axis, -high / axis])
        across = np.hstack([most / axis, most / axis, -least / axis, -least / axis])
    if len(path.zones):
        t, n = path.shares(nodes, limits, 2.0 * np.maximum(-low, high), np.maximum(-least, most))
        along, across = np.column_stack([along, 0.5 * t, -0.5 * t]), np.column_stack([across, n, n])
    turns = np.empty((len(half), 0, 3))
    if limits.axis_jerk is not None:  # a corner takes up to one half of them
        near = 1.0 - np.minimum(2.0 * taken, 0.5)
        axis = ((1.0 - margin) * parts[:, 2] * near)[:, None] * limits.axis_jerk
        fast, turns = np.where(taken > 0.0, np.sqrt(caps), 0.0), []
        for at, (t, n, m) in zip((nodes[:-1], nodes[1:]), sides, strict=True):
            n = n + path.turned(at, fast, limits.period_s)
            turns.append([0.5 * t / axis, 1.5 * n / axis, m / axis])
        turns = np.moveaxis(np.stack(turns), (2, 3, 0, 1), (0, 1, 2, 3)).reshape(len(half), -1, 3)
    steepest, jerk = limits.acceleration * room, limits.jerk * parts[:, 3]
    return (caps * parts[:, 0]) ** 2, causes, along, across, steepest, kappas, turns, jerk


def _with_room(path, limits, nodes):
    """The path whose corners leave room for what changes the speed in the outer cells of their zones.

    Two periods around the corner see the acceleration there, which grows with the jerk from the node inside,
    the less the farther away it is.
    """
    (start, stop, held, _), axes = path.zones.T, limits.axis_acceleration
    half, steepest = 0.5 * (stop - start), min(limits.acceleration, np.inf if axes is None else axes.min())
    first, last = np.searchsorted(nodes, start + 1e-9 * half), np.searchsorted(nodes, stop - 1e-9 * half) - 1
    parts = np.clip(np.stack([nodes[first] - start, stop - nodes[last]]) / half, 0.0, 1.0)
    grown = np.minimum(limits.jerk * limits.period_s / steepest * parts / 3.0, 1.0)
    seen = np.minimum((0.5 * parts**2 * grown).sum(axis=0), 0.5)
    return replace(path, zones=np.column_stack([path.zones[:, :2], held * (1.0 - seen), path.zones[:, 3]]))


def _around_nodes(path, nodes, sides):
    """Least and largest of half the tangent and of the curvature vector near every node, and the curvature.

    Where curvatures jump more often than nodes lie, as in arcs shorter than a cell, all samples count.
    """
    edges = np.concatenate([nodes[:1], 0.5 * (nodes[1:] + nodes[:-1]), nodes[-1:]])
    (start, kappa, _), (stop, last, _) = sides
    before, after = np.hstack([0.5 * start, kappa]), np.hstack([0.5 * stop, last])
    both = np.stack([np.vstack([before, after[-1:]]), np.vstack([before[:1], after])])
    least, most = both.min(axis=0), both.max(axis=0)
    kappas = np.linalg.norm(both[:, :, start.shape[1] :], axis=2).max(axis=0)
    missed = path.jumps[~np.isin(path.jumps, nodes)]
    if len(missed):
        where = np.unique(np.clip(np.searchsorted(edges, missed) - 1, 0, len(nodes) - 1))
        turning = np.linalg.norm(path.curvatures, axis=1)[:, None]
        low, high = extremes_between(
            edges, path.lengths, np.hstack([0.5 * path.tangents, path.curvatures, turning])
        )
        least[where] = np.minimum(least[where], low[where, :-1])
        most[where] = np.maximum(most[where], high[where, :-1])
        kappas[where] = np.maximum(kappas[where], high[where, -1])
    half = start.shape[1]
    return (least[:, :half], most[:, :half]), (least[:, half:], most[:, half:]), kappas


def extremes_between(edges, lengths, rows):
    """The least and the largest of samples, and of lines between them, from each edge to the next."""
    after = np.minimum(np.searchsorted(lengths, edges), len(lengths) - 1)
    before = np.maximum(after - 1, 0)
    way = lengths[after] - lengths[before]
    part = np.clip((edges - lengths[before]) / np.where(way > 0.0, way, 1.0), 0.0, 1.0)[:, None]
    at = np.where(way[:, None] > 0.0, (1.0 - part) * rows[before] + part * rows[after], rows[after])
    first, beyond = after[:-1], np.searchsorted(lengths, edges[1:], side="right")
    some, runs = (beyond > first)[:, None], np.column_stack([first, np.maximum(beyond, first + 1)]).ravel()
    inside, found = np.vstack([rows, rows[-1:]]), []
    for pick in (np.minimum, np.maximum):
        ends = pick(at[:-1], at[1:])
        found.append(np.where(some, pick(ends, pick.reduceat(inside, runs, axis=0)[::2]), ends))
    return found


def _nodes(path, limits, corners, short, trapezoid, fineness):
    """The grid: even in the time of the trapezoid, finer near rest, at corners and where the path turns."""
    lengths, squares = trapezoid
    jerk, total = limits.jerk, lengths[-1]
    first, last = short[0], total - short[1]
    # away from an end or a corner the speed of full jerk is the measure: v = (J s² 9 / 2)^(1/3) from rest
    places, slow = corners
    reach = slow * np.sqrt(2.0 * slow / jerk)
    reach[[0, -1]] = np.where(short > 0.0, short, reach[[0, -1]])
    away = np.outer(np.geomspace(1e-10, 1.0, 80), np.diff(places))
    base = np.concatenate([lengths, (places[:-1] + away).ravel(), (places[1:] - away).ravel()])
    base = np.unique(np.clip(base, first, last))
    base = base[np.append(True, np.diff(base) > 1e-12 * total)]
    base[-1] = last
    half = 0.5 * (base[1:] + base[:-1])
    pace = np.sqrt(np.interp(half, lengths, squares))
    tick = min(limits.period_s / fineness.per_period, limits.acceleration / jerk / fineness.per_ramp)
    beyond, growth = np.searchsorted(places, half).clip(1, len(places) - 1), 0.0
    for near in (beyond - 1, beyond):
        away = np.abs(half - places[near])
        pace = np.minimum(pace, slow[near] + np.cbrt(4.5 * jerk * away**2))
        growth += tick / _GROWTH / (reach[near] + away)
    clock = np.concatenate([[0.0], np.cumsum(np.diff(base) * (1.0 / pace + growth))])
    most = _MOST[0] + _MOST[1] * len(path.zones) + len(lengths)
    measure = clock * (np.clip(clock[-1] / tick, fineness.fewest, most) / clock[-1])
    if clock[-1] > most * tick:  # no fewer cells in the ramps of both ends
        ramps = 1.0 / (reach[0] + half) + 1.0 / (reach[-1] + total - half)
        measure[1:] += np.cumsum(np.diff(base) * ramps / _GROWTH)
    measure += np.interp(base, lengths, np.arange(len(lengths))) / _SAMPLES
    counts = np.minimum(np.diff(measure), np.diff(base) / (_SHORTEST_CELL * np.sqrt(pace**3 / jerk)))
    measure = np.concatenate([[0.0], np.cumsum(counts)])
    rising = np.diff(measure, prepend=-1.0) > 0.0
    nodes = np.linspace(0.0, measure[-1], int(np.ceil(measure[-1])) + 1)
    nodes = _smooth_inverse(measure[rising], base[rising])(nodes)
    nodes[0], nodes[-1] = first, last
    return nodes


def _smooth_inverse(measure, lengths):
    """The length at a measure: monotone cubics with harmonic means of the slopes of both sides.

    With lines between them the widths of cells jump. The limits of cells and the jerk would jump with them.
    """
    from scipy.interpolate import CubicHermiteSpline

    slopes = np.diff(lengths) / np.diff(measure)
    means = 2.0 / (1.0 / slopes[1:] + 1.0 / slopes[:-1])
    return CubicHermiteSpline(measure, lengths, np.concatenate([slopes[:1], means, slopes[-1:]]))


def _ordinates(square, nodes):
    """Those of the spline that is v², a function of the length, wherever this is a parabola."""
    at_nodes, inside = square(nodes), square(0.5 * (nodes[1:] + nodes[:-1]))
    exact = 2.0 * inside - 0.5 * (at_nodes[1:] + at_nodes[:-1])
    return np.maximum(exact, 0.5 * np.minimum(at_nodes[1:], at_nodes[:-1]))  # where a cell holds a whole ramp
