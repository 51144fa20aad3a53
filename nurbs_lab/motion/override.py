"""Feed override, hold and abort: the tool goes to the commanded part of the plan's speed within A and J.

The tool stays on the path. A command o asks for the speed o v(s), where v(s) is the plan's speed at the
length s: a curve in the plane of length and speed, which the tool follows exactly once it is on it, because
the plan at o times its rate takes o² of its acceleration and o³ of its jerk.

To get there from a speed and an acceleration of its own, the tool raises the acceleration towards the goal by
the jerk J of the plan, up to its limit A, and then lowers it by J until both speed and acceleration are those
of the goal: an S-curve that touches the curve o v(s). It takes the longest first part from which the second
still stays on its own side of the curve. That is the least time, and since the speed never crosses o v(s),
the plan's own limits hold wherever the tool rejoins it. Where it is so fast towards the goal that it passes
it in any case, it does so as slowly as J allows and comes back from the other side. A hold is the goal o = 0.

For an override of 0 to 200 % of a programmed feed, plan with twice that feed and halve the commands: 0.5 is
then the programmed feed and 1 twice it, or what the limits leave of it. Every limit holds while a command is
followed; on the way to it, where the path turns, only acceleration and jerk along the path are bounded.
A hold resumes with the next command above 0. An abort, or a stop after a fault, is a hold that no command
follows: the motion ends where the tool comes to rest.

Acceleration and jerk are those along the path. Without a limit of jerk the acceleration steps; with a jerk of
axes, J is the least of them or, if that is more, the largest of the plan. ``hardware.feed_override`` follows
commands by a rule of its own, in integers.
"""

from dataclasses import replace
from math import sqrt

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind
from nurbs_lab.common.kernels import ZERO, kernel
from nurbs_lab.motion._kernels import at_length
from nurbs_lab.motion.feed import MOST_SAMPLES, FeedProfile, with_segments

#: Largest command; above 1 it acts as 1, because the plan is as fast as its limits allow.
LARGEST = 2.0
#: Speeds that differ by this part of the plan's highest are equal.
_EQUAL = 1e-9
#: Places at which the room to the goal is looked at while the acceleration turns round.
_PLACES = 48


def apply_override(feed, override):
    """The motion that a feed becomes under an override: a profile along the same path, as long or longer.

    Parameters
    ----------
    feed : FeedProfile
        With its limits of acceleration and jerk; where it has none, the rate follows the command at once.
    override : float or array_like, shape (n, 2)
        A constant rate, or rows (time in s, rate), each valid from its time on; before the first the rate is
        1. Rates lie in [0, 2]: 0 holds the tool, and above 1 acts as 1. If the last is 0, the motion is
        aborted: it ends where the tool comes to rest. The module's docstring says how to reach 200 % of a
        programmed feed.

    Returns
    -------
    FeedProfile
        Commands act at whole periods, by the rule in this module's docstring.

    Raises
    ------
    TypeError, ValueError
        Naming the rows that are no times that increase or no rates in [0, 2], or a motion that never begins
        or takes more than 5,000,000 periods.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    >>> held = nl.motion.apply_override(feed, [(0.5, 0.0), (1.0, 1.0)])  # half a second's hold
    >>> round(held.duration - feed.duration, 3)  # 0.5 s at rest and two ramps of 0.1 s at half the speed
    0.5
    """
    as_kind("feed", feed, FeedProfile)
    times, rates = _commands(override)
    if not (rates < 1.0).any():
        return feed
    slowest = rates[rates > 0.0].min(initial=1.0)
    if times[-1] + feed.duration / slowest > MOST_SAMPLES * feed.period_s:
        raise ValueError(
            f"override makes the motion longer than {MOST_SAMPLES} periods, with period_s = "
            f"{feed.period_s:g} s; raise its rates, the feed or period_s"
        )
    starts = feed.period_s * np.ceil(times / feed.period_s - 1e-9)
    parts = _parts(feed, [1.0, *rates], [*starts, np.inf])
    times, terms, names = (np.concatenate(one) for one in zip(*parts, strict=True))
    if not len(terms) or not terms[:, 1:].any():
        raise ValueError("override holds the tool before it has moved, and for ever; add a row that resumes")
    made = replace(with_segments(feed, times, terms, names.tolist()), curve=feed.curve)
    if feed.rests or made.length <= feed.length:  # rounding apart, none passes an end at rest
        return made
    return replace(made.portion(0.0, made.time_at(feed.length)), curve=feed.curve)  # it ends moving


def _commands(override):
    given = as_floats("override", override)
    rows = np.array([[0.0, float(given)]]) if given.ndim == 0 else given
    if rows.ndim != 2 or rows.shape[1] != 2 or not len(rows):
        raise ValueError(f"override must be one rate or rows (time, rate), got shape {given.shape}")
    times, rates = rows.T
    if times[0] < 0.0 or (np.diff(times) <= 0.0).any():
        raise ValueError(f"override must have times that increase from 0 or later, got {times.tolist()}")
    wrong = rates[(rates < 0.0) | (rates > LARGEST)]
    if wrong.size:
        raise ValueError(f"override must have rates from 0 (hold) to {LARGEST:g}, got {wrong[0]:g}")
    return np.ascontiguousarray(times), np.minimum(rates, 1.0)


def jerk_of(feed):
    """The jerk J, in mm/s³: the least of the feed's limits, or what it uses; infinite without a limit."""
    given = () if feed.limits is None else (feed.limits.jerk, feed.limits.axis_jerk)
    least = min((np.min(one) for one in given if one is not None), default=np.inf)
    return max(float(least), 6.0 * float(np.abs(feed.terms[:, 3]).max()))


def _parts(feed, goals, stops):
    """Starts, terms and limits of segments under commands up to their ends; at last the end of the motion."""
    table, period, jerk = feed.table, feed.period_s, jerk_of(feed)
    most = np.inf if feed.limits is None else feed.limits.acceleration
    limits, equal = (most, jerk, _EQUAL * feed.peak), 2e-6 * jerk * period
    time, state = 0.0, (0.0, float(feed.speed(0.0)), float(feed.acceleration(0.0)))
    for goal, stop in zip(goals, stops, strict=True):
        sign, turn, met = 0, 0.0, time >= stop
        while time < stop and not met:
            v, a, _ = at_length(table, state[0], 0)
            off, turning = state[1] - goal * v, state[2] - goal * goal * a
            met = most == np.inf or (abs(off) <= limits[2] and abs(turning) <= equal)
            if met:
                break
            sign = -sign if turn else (1 if off < 0.0 else -1)
            first, turn, met = _approach(table, goal, sign, state, limits, period, stop - time)
            if jerk == np.inf:
                state = *state[:2], sign * most
            ramp = min(max((most - sign * state[2]) / jerk, 0.0), first)
            for h, j in ((ramp, sign * jerk), (first - ramp, 0.0), (turn, -sign * jerk)):
                h = min(h, stop - time)
                if time + h > time:
                    yield [time], [[state[0], state[1], 0.5 * state[2], j / 6.0]], ["override"]
                    time, state = time + h, _after(state, j, h)
        if time >= stop:
            continue
        begin = feed.time_at(state[0])  # along the plan at a constant rate, or at rest
        end = min(begin + goal * (stop - time), feed.duration) if goal else begin
        if end > begin:
            part = feed.portion(begin, end)
            names = part.limited_by if goal == 1.0 else ["override"] * len(part.terms)
            terms = part.terms * goal ** np.arange(4.0) + [state[0], 0.0, 0.0, 0.0]
            yield time + part.times[:-1] / goal, terms, names
        if end == feed.duration or stop == np.inf:
            time += (end - begin) / goal if goal else 0.0
            break
        if not goal:
            yield [time], [[state[0], 0.0, 0.0, 0.0]], ["override"]
        s = state[0] if not goal else feed.displacement(end)
        v, a, _ = at_length(table, s, 0)
        time, state = stop, (float(s), goal * v, goal * goal * a)
    yield [time], np.empty((0, 4)), []


@kernel
def _after(state, jerk, h):
    """Length, speed and acceleration after a time of constant jerk."""
    s, v, a = state
    return s + h * (v + h * (0.5 * a + h * jerk / 6.0)), v + h * (a + 0.5 * h * jerk), a + h * jerk


@kernel
def _room(feed, goal, sign, state, hint):
    """How far the speed is on its side of the goal, by how much that grows, and the segment of the plan."""
    s, v, a = state
    planned, slope, hint = at_length(feed, s, hint)
    growth = goal * slope * v / planned if planned > 0.0 else 0.0
    return sign * (goal * planned - v), sign * (growth - a), hint


@kernel
def _turned(feed, goal, sign, state, limits, first):
    """The least room while the acceleration turns round after the time ``first``, and when it is least."""
    most, jerk, _ = limits
    if jerk == np.inf:
        return _room(feed, goal, sign, _after((state[0], state[1], sign * most), 0.0, first), ZERO)[0], 0.0
    ramp = min(max((most - sign * state[2]) / jerk, 0.0), first)
    state = _after(_after(state, sign * jerk, ramp), 0.0, first - ramp)
    end = max(sign * state[2] + most, 0.0) / jerk
    if sign > 0.0:  # or until it comes to rest
        v, a = max(state[1], 0.0), state[2]
        end = min(end, (a + sqrt(a * a + 2.0 * jerk * v)) / jerk)
    least, at, hint = np.inf, 0.0, 0
    for k in range(1, _PLACES + 1):
        there = _after(state, -sign * jerk, end * k / _PLACES)
        room, _, hint = _room(feed, goal, sign, there, hint)
        if room < least:
            least, at = room, end * k / _PLACES
    low, high = at - end / _PLACES, min(at + end / _PLACES, end)
    if low <= 0.0 and _room(feed, goal, sign, state, hint)[1] > 0.0:  # it goes away from the goal
        return least, 0.0
    for _ in range(60):
        at = 0.5 * (low + high)
        room, growth, hint = _room(feed, goal, sign, _after(state, -sign * jerk, at), hint)
        if growth > 0.0:
            high = at
        else:
            low = at
    return min(room, least), at


@kernel
def _approach(feed, goal, sign, state, limits, period, left):
    """Times to raise and hold the acceleration and to turn it round, and whether it ends on the goal.

    After the time ``left`` the next command comes.
    """
    least, at = _turned(feed, goal, sign, state, limits, 0.0)
    if abs(least) <= limits[2] and at > 0.0:
        return 0.0, at, True
    if least < 0.0:  # it passes the goal in any case: up to there
        low, high = 0.0, at
        for _ in range(60):
            at = 0.5 * (low + high)
            if _room(feed, goal, sign, _after(state, -sign * limits[1], at), 0)[0] > 0.0:
                low = at
            else:
                high = at
        return 0.0, high, False
    low = high = 0.0
    while least > 0.0:
        if high >= left:
            return left, 0.0, False
        low, high = high, min(high + 4.0 * period, left)
        least, _ = _turned(feed, goal, sign, state, limits, high)
    for _ in range(60):
        middle = 0.5 * (low + high)
        if _turned(feed, goal, sign, state, limits, middle)[0] > 0.0:
            low = middle
        else:
            high = middle
    return low, _turned(feed, goal, sign, state, limits, low)[1], True
