"""Feed override, hold and abort: the tool goes to the commanded part of the plan's speed within all limits.

The tool stays on the path. A command o asks for the speed o v(s), where v(s) is the plan's speed at the
length s: a curve in the plane of length and speed, which the tool follows exactly once it is on it, because
the plan at o times its rate takes o² of its acceleration and o³ of its jerk.

On the way to it every limit of the plan holds too, for the vector, the axes and at corners: a step takes the
largest jerk or, without a limit of jerk, the largest acceleration that they all allow at its two ends, but
only if the tool can still *land* after it, which means to stop changing its rate within the limits, before it
has passed the goal. From there the plan at that constant rate keeps every limit, so that the tool is never
caught between two of them, whatever is commanded meanwhile. Where no step is allowed, as where the plan takes
all of a limit, it follows the plan at the rate it has until there is one. A hold is the goal o = 0.

On 90 curves with corners, sharp turns, axes and jerks, 540 motions of up to 30 commands took at most 1.0023
times an acceleration, all of the jerk along the path and 1.021 times that of an axis, by differences of
positions. Stops took 1.01 times (median) and up to 2.4 times as long as on a straight line, where nothing but
the acceleration and the jerk of the plan limits them.

For an override of 0 to 200 % of a programmed feed, plan with twice that feed and halve the commands: 0.5 is
then the programmed feed and 1 twice it, or what the limits leave of it. A hold resumes with the next command
above 0. An abort, or a stop after a fault, is a hold that no command follows: the motion ends where the tool
comes to rest. Of a feed without its curve only the limits along the path are known.
``hardware.feed_override`` follows commands by a rule of its own, in integers, within limits along the path.
"""

from dataclasses import replace

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind
from nurbs_lab.motion._kernels import plan_at
from nurbs_lab.motion._override_kernels import EQUAL, approach
from nurbs_lab.motion.feed import MOST_SAMPLES, FeedProfile, with_segments
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.scan import scan
from nurbs_lab.nurbs import NurbsCurve

#: Largest command; above 1 it acts as 1, because the plan is as fast as its limits allow.
LARGEST = 2.0
#: Steps a period.
_FINER = 4


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
    task = None if feed.limits is None else _task(feed)
    step, time = feed.period_s / _FINER, 0.0
    motion = 0.0, float(feed.speed(0.0)), float(feed.acceleration(0.0))
    for goal, stop in zip(goals, stops, strict=True):
        while time < stop - 1e-3 * step:
            rate = goal
            if task is not None and feed.speed(feed.time_at(motion[0])) > EQUAL * feed.peak:
                rows = np.empty((int(min(np.rint((stop - time) / step), len(task[2][1]))), 4))
                count, last, motion, rate = approach(task, motion, goal, rows)
                s, v, a, control = rows[:count].T
                a, jerk = (a, control) if feed.limits.soft else (control, 0.0 * control)
                terms = np.column_stack([s, v, 0.5 * a, jerk / 6.0])
                yield time + step * np.arange(count), terms, ["override"] * count
                time += step * (count - 1) + last if count else 0.0
                rate = goal if abs(rate - goal) <= 2.0 * EQUAL else rate
            end = stop if rate == goal else min(stop, step * (np.floor(time / step + 1e-6) + 1.0))
            if np.isnan(rate) or end <= time:
                continue
            begin = feed.time_at(motion[0])  # along the plan at a constant rate, or at rest
            finish = min(begin + rate * (end - time), feed.duration) if rate else begin
            if finish > begin:
                part = feed.portion(begin, finish)
                names = part.limited_by if rate == 1.0 else ["override"] * len(part.terms)
                terms = part.terms * rate ** np.arange(4.0) + [motion[0], 0.0, 0.0, 0.0]
                yield time + part.times[:-1] / rate, terms, names
            if finish == feed.duration or end == np.inf:
                yield [time + ((finish - begin) / rate if rate else 0.0)], np.empty((0, 4)), []
                return
            if not rate:
                yield [time], [[motion[0], 0.0, 0.0, 0.0]], ["override"]
            s = float(feed.displacement(finish)) if rate else motion[0]
            v, a, *_ = plan_at(feed.table, s, 0)
            time, motion = end, (s, rate * v, rate * rate * a)


def _task(feed):
    """What the kernels need of a plan with limits: see `_override_kernels`."""
    limits, step = feed.limits, feed.period_s / _FINER
    if feed.curve is None:  # what is known is the motion along the path
        limits = replace(limits, tangential_only=True, axis_acceleration=None, axis_jerk=None)
    track = prepare(feed.curve or NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (1, 0)]))
    count, dim = int(np.ceil(feed.duration / step)) + 2, track.curve.dim
    limits, free, corners = limits.in_dimensions(dim), np.full(dim, np.inf), np.zeros((count, 2))
    path, t, geometry = scan(track, limits), step * np.arange(count), np.zeros((count, 4, dim))
    geometry[:, 3] = path.turned(feed.displacement(t), feed.speed(t), feed.period_s)
    near = (feed.time_at(path.zones[:, :2]) / step + [0.0, 2.0]).astype(int)
    taken = np.column_stack([0.5 * path.zones[:, 3], 0.5 / (path.zones[:, 3] * path.zones[:, 2] ** 2)])
    for (first, last), part in zip(near, taken, strict=True):
        corners[first:last] = np.maximum(corners[first:last], part)
    nodes = 1.0 / step, np.zeros(count, dtype=bool), geometry, corners
    axes = (free if one is None else np.array(one) for one in (limits.axis_acceleration, limits.axis_jerk))
    vector = np.inf if limits.tangential_only else limits.acceleration
    jerk = jerk_of(feed) if feed.curve is None or limits.jerk is not None else np.inf
    rows = (limits.acceleration, vector, next(axes)), (jerk, np.inf, next(axes))
    hints = np.zeros(3, dtype=np.int64)
    return feed.table, (track.spans, track.panels), nodes, hints, rows, step, feed.limits.soft
