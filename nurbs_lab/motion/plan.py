"""Plan the fastest feed that keeps every limit."""

from dataclasses import fields, replace

import numpy as np

from nurbs_lab.common.checks import as_kind, as_not_negative
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.motion._verify import BY_SPEED, chord_excesses, excesses, worst
from nurbs_lab.motion.limits import Limits
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.scan import SHARPEST, scan
from nurbs_lab.motion.scurve import WHOLE, s_curve
from nurbs_lab.motion.trapezoid import Trapezoid, fastest

#: Profiles tried at most.
_ROUNDS = 16
#: A limit may be exceeded by this part in speed, for what rounding leaves in short segments.
_ROUNDED = 1e-7
#: Columns of `Scan.parts` that are lowered where a limit is exceeded, each by a power of the factor in speed.
_LOWERED = dict.fromkeys(("speed", *BY_SPEED), ((0, 1),))
_LOWERED |= dict.fromkeys(("acceleration", "axis_acceleration"), ((0, 1), (1, 2)))
_LOWERED |= {"axis_jerk": ((0, 1), (2, 3)), "jerk": ((3, 3),)}
#: Factor of a limit, for each motion tried, that is cured by slowing down the whole motion; one that is
#: planned again instead is slower by as much more.
_TOLERATED = 1.0 + 1e-5


@one_or_many()
def plan_feed(curve, limits=None, *, period_s=None, start_speed=0.0, end_speed=0.0, **given):
    """Plan the speed along a curve: as fast as the limits allow, and never faster.

    Without ``jerk`` the acceleration may step (trapezoid); with it the profile is made of phases of constant
    jerk. The duration is a whole number of periods: the plan is stretched by less than two. With ``jerk`` it
    is the least one to some parts in a million, 33 periods of ten million on a line.

    Parameters
    ----------
    curve : NurbsCurve or list of NurbsCurve
        2-D or 3-D. The curves of a list are planned each for itself; `motion.plan_program` joins them.
    limits : Limits, optional
        Or its fields as keywords: ``speed`` and ``acceleration``, and if wanted ``jerk``, ``chord_error``,
        ``centripetal_acceleration``, ``axis_speed``, ``axis_acceleration``, ``axis_jerk`` and
        ``tangential_only``; see `motion.Limits`.
    period_s : float
        Interpolation period, in s; needed beside keywords, that of ``limits`` by default.
    start_speed, end_speed : float
        In mm/s, kept to a part in 1e9 (an end speed below that part of the highest speed counts as rest);
        with ``jerk`` the motion starts and ends there without acceleration.
        Where they leave no choice but to speed up or to brake all the way, the stretching to whole periods
        lowers them, by less than the fraction that one period is of the duration.

    Returns
    -------
    FeedProfile
        A list of them for a list of curves.

    Raises
    ------
    TypeError, ValueError
        Naming the limit that is no positive number, or the start or end speed that no plan can keep.

    Notes
    -----
    The limits are kept to a part of 1e-7 in speed. A corner is passed at the speed that the accelerations of
    one period allow; see `motion.Limits`. The work is bounded by the number n of spans: the speed limit is
    sampled at most 20,000 + 2,000 n times, or the curve is refused. Each of at most 16 motions then takes two
    passes over the samples; with ``jerk``, some ten Newton steps, at most 1,000, for each of some ten
    weights, on a grid of at most 20,000 cells and some for each sample.
    With ``jerk`` the time is the least one of that grid (see ``motion._scurve_kernels``). On the butterfly at
    250 mm/s, 2000 mm/s², 20 000 mm/s³ and 1 µm that is 4.325 s, 29 % more than the 3.350 s without a limit of
    jerk; a grid five times finer gives 4.324 s, so the difference is the price of the jerk, not of the plan.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (30, 40)])
    >>> feed = nl.plan_feed(line, speed=10.0, acceleration=100.0, period_s=1e-3)
    >>> round(feed.duration, 9)  # 50 mm at 10 mm/s, and half of each ramp of 0.1 s
    5.1
    """
    track = prepare(curve)
    limits = as_limits(limits, period_s, given).in_dimensions(curve.dim)
    ends = np.array([as_not_negative("start_speed", start_speed), as_not_negative("end_speed", end_speed)])
    path = scan(track, limits)
    refuse_ends(ends, path, limits)
    profile = fastest_profile(path, limits, ends, WHOLE)
    return replace(profile, curve=curve)


def as_limits(limits, period_s, given):
    """Limits that were given as one value or by their names."""
    if limits is None:
        known = [field.name for field in fields(Limits)]
        given = given if period_s is None else given | {"period_s": period_s}
        needed = "speed", "acceleration", "period_s"
        for name in (*given, *needed):  # a misspelt one before the one that it leaves out
            if name not in given or name not in known:
                what = "missing" if name in known else "no limit"
                raise TypeError(f"{name} is {what}; of {', '.join(known)} give {', '.join(needed)}")
        return Limits(**given)
    as_kind("limits", limits, Limits)
    if given:
        raise TypeError(f"limits are given already; put {', '.join(given)} into them by dataclasses.replace")
    return limits if period_s is None else replace(limits, period_s=period_s)


def fastest_profile(path, limits, ends, fineness, *, gone=0.0):
    """The profile of the fastest motion, slowed down to end with a whole period and to keep every limit.

    A motion that exceeds a limit of the curve is planned again under lower limits, but not where slowing it
    down takes no period more. At most `_ROUNDS` profiles are tried.

    ``gone`` is the time, in s, of what was planned before. If it is None, more is planned later, and the
    profile ends at any time.
    """
    motion = _motion(path, limits, ends, fineness)
    profile, periods, slowed, look = motion.profile, 0, False, excesses
    for number in range(1, 1 + _ROUNDS):
        found = look(path, limits, profile)
        name, at, factor = worst(found)
        factor = max(1.0, factor)
        if factor <= 1.0 + _ROUNDED and (slowed or gone is None):
            return profile
        again = slowed and ends.any()  # a slower motion between moving ends is no slow copy of the first
        most = 1.0 + _ROUNDED if again else _TOLERATED**number
        slower = (gone or 0.0) + profile.duration * np.array([1.0, factor])
        whole = np.ceil(slower / limits.period_s - 1e-9)
        costs = gone is None or ends.any() or whole[1] > whole[0]  # to slow it down
        if costs and any(row[3].max() > most for row in found):
            path = _tightened(path, found, number)
            motion = _motion(path, limits, ends, fineness)
            slowed = slowed and motion.profile.duration <= profile.duration
            profile, look = motion.lasting(profile.duration) if slowed else motion.profile, excesses
            continue
        # from rest to rest it becomes a slow copy of itself, which keeps all but the errors of other chords
        look = excesses if ends.any() else chord_excesses
        if gone is None:
            profile = motion.lasting(profile.duration * factor)
        else:
            periods = max(periods + 1, int(whole[1]))
            profile, slowed = motion.lasting(periods * limits.period_s - gone), True
    raise ValueError(
        f"no plan of whole periods keeps {name} at {path.place(at)} between start_speed "
        f"{ends[0]:g} mm/s and end_speed {ends[1]:g} mm/s: it is exceeded by {100 * (factor - 1):.2g} % in "
        "speed; lower these speeds or period_s"
    )


def _motion(path, limits, ends, fineness):
    return s_curve(path, limits, ends, fineness) if limits.soft else Trapezoid(path, limits, ends)


def _tightened(path, found, times):
    """The path with lower limits wherever the motion was too fast, ``times`` as much as it was.

    Within a cell a limit may be exceeded by much less than what its ends leave of it.
    """
    parts, hidden = path.parts.copy(), SHARPEST * path.length  # rounding takes samples so near for one place
    for name, start, stop, factors in found:
        first = np.maximum(np.searchsorted(path.lengths, start - hidden) - 1, 0)
        last = np.searchsorted(path.lengths, stop + hidden) + 1
        for k in np.flatnonzero(factors > 1.0):
            near = slice(first[k], last[k])
            for column, power in _LOWERED[name]:
                lower = path.parts[near, column] / (factors[k] * _TOLERATED) ** (times * power)
                parts[near, column] = np.minimum(parts[near, column], lower)
    return replace(path, parts=parts)


def least_duration(path, limits, end):
    """A duration that no plan can beat: all of the way at speeds that hardly any plan reaches."""
    length = path.lengths[-1]
    top = end + np.sqrt(2.0 * limits.acceleration * length)
    if limits.jerk is not None:
        top = min(top, end + np.cbrt(4.5 * limits.jerk * length**2))
    speeds, gone = np.minimum(np.maximum(path.speeds[1:], path.speeds[:-1]), top), np.diff(path.lengths)
    with np.errstate(divide="ignore", over="ignore"):
        return float((gone[gone > 0.0] / speeds[gone > 0.0]).sum())


def refuse_ends(ends, path, limits):
    _, squares = fastest(path, limits, ends, path.caps)
    for name, asked, at in zip(("start_speed", "end_speed"), ends, (0, -1), strict=True):
        level = np.inf
        if limits.soft and limits.axis_acceleration is not None:  # no acceleration along the path
            with np.errstate(divide="ignore"):
                level = (limits.axis_acceleration / np.abs(path.curvatures[at])).min()
        square = min(squares[at], level)
        most = np.sqrt(square)
        if asked**2 > square * (1.0 + 2e-9):
            held = np.sqrt(path.caps[at]) <= most * (1.0 + 1e-9)
            reason = path.causes[at] if held else "acceleration, over the way to the other end"
            reason = "axis_acceleration" if square == level else reason
            raise ValueError(
                f"{name} {asked:g} mm/s is above what the limits allow: at most {most:.6g} mm/s, by {reason}"
            )
