"""Plans of long paths: many curves one after the other, planned window by window."""

import itertools

import numpy as np

from nurbs_lab.common.checks import as_kind, as_not_negative, shown
from nurbs_lab.motion.feed import concatenate
from nurbs_lab.motion.plan import (
    as_limits,
    fastest_motion,
    least_duration,
    refuse_ends,
    whole_periods,
    within_limits,
)
from nurbs_lab.motion.prepared_curve import prepare, require_possible
from nurbs_lab.motion.scan import join, scan
from nurbs_lab.motion.scurve import WHOLE, WINDOW
from nurbs_lab.nurbs import NurbsCurve

#: Least periods in the first window, which is small so that a machine can start, and most asked of another;
#: each asks for four times those of the one before.
_FIRST, _WINDOW = 500, 16000
#: Spans of the first piece that curves are cut into, and most; each piece has twice those of the one before.
_SPANS = 16, 512
#: The part of a window that is kept before a longer window is tried instead.
_KEPT = 0.25
#: Ends of curves that follow each other may lie this far apart, as a part of their lengths.
_GAP = 1e-6


def plan_windows(
    curves,
    *,
    speed,
    acceleration,
    jerk=None,
    chord_error=None,
    period_s,
    start_speed=0.0,
    end_speed=0.0,
    centripetal_acceleration=None,
    axis_speed=None,
    axis_acceleration=None,
):
    """Plan a program of many curves as one motion, window by window, in memory that does not grow.

    The tool passes from curve to curve without a stop where the tangents agree, or where the limits allow the
    corner. Each window is planned to rest at its end, and kept up to a place where the acceleration is zero
    and the braking to rest has no influence yet; there the next window begins at the same speed. The limits
    are kept to a part of 1e-4 in speed. A window whose kept part is short is planned again at twice the
    length, until the program ends: at most once for each factor of two in its length. If no motion is found
    from there on, not on a finer grid either, the window before is kept to its end at rest. The work of one
    window is bounded as that of `plan_feed`.

    Parameters
    ----------
    curves : NurbsCurve or iterable of NurbsCurve
        Each begins where the one before ends. An iterator is read as far as the next window needs.
    speed, acceleration, jerk, chord_error, period_s, start_speed, end_speed : float
    centripetal_acceleration, axis_speed, axis_acceleration : float or array_like
        As in `plan_feed`, of the whole program.

    Yields
    ------
    curve : NurbsCurve
        The next curve, or a piece of it: long curves are cut at knots.
    feed : FeedProfile
        The motion along it, which begins with the speed and acceleration that the one before ends with. The
        durations of all together are a whole number of periods.

    Raises
    ------
    TypeError, ValueError
        As `plan_feed`, and for a curve that begins elsewhere than the one before ends.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> lines = [nl.NurbsCurve(1, [0, 0, 1, 1], [(x, 0), (x + 5, 0)]) for x in (0, 5, 10, 15)]
    >>> plan = nl.motion.plan_windows(lines, speed=10.0, acceleration=100.0, period_s=1e-3)
    >>> round(sum(feed.duration for _, feed in plan), 9)  # 20 mm at 10 mm/s, and half of two ramps of 0.1 s
    2.1
    """
    limits = {
        "speed": speed, "acceleration": acceleration, "jerk": jerk, "chord_error": chord_error,
        "period_s": period_s, "centripetal_acceleration": centripetal_acceleration,
        "axis_speed": axis_speed, "axis_acceleration": axis_acceleration,
    }  # fmt: skip
    ends = as_not_negative("start_speed", start_speed), as_not_negative("end_speed", end_speed)
    for _, curve, feed in _windows(_pieces(curves), limits, ends):
        yield curve, feed


def plan_program(curves, **limits):
    """Plan a program of many curves as one motion: the feed profile of each.

    Parameters
    ----------
    curves : iterable of NurbsCurve
        Each begins where the one before ends.
    **limits
        Those of `plan_windows`, which does the work.

    Returns
    -------
    list of FeedProfile
        One for each curve; each begins as the one before ends.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> lines = [nl.NurbsCurve(1, [0, 0, 1, 1], [(x, 0), (x + 5, 0)]) for x in (0, 5)]
    >>> first, second = nl.motion.plan_program(lines, speed=10.0, acceleration=100.0, period_s=1e-3)
    >>> float(round(first.speed(first.duration), 6)), float(round(second.speed(0.0), 6))
    (10.0, 10.0)
    """
    ends = [as_not_negative(name, limits.pop(name, 0.0)) for name in ("start_speed", "end_speed")]
    optional = ("jerk", "chord_error", "centripetal_acceleration", "axis_speed", "axis_acceleration")
    unknown = sorted(set(limits) - {"speed", "acceleration", "period_s", *optional})
    missing = sorted({"speed", "acceleration", "period_s"} - set(limits))
    if unknown or missing:
        raise TypeError(
            f"limits must hold speed, acceleration and period_s: {unknown or missing} "
            + ("is no limit" if unknown else "is missing")
        )
    pieces = _windows(_pieces(curves), dict.fromkeys(optional) | limits, ends)
    groups = itertools.groupby(pieces, key=lambda piece: piece[0])
    return [concatenate([feed for _, _, feed in group]) for _, group in groups]


def _pieces(curves):
    """Number of the curve, and the pieces that it is cut into at knots, the first ones short."""
    try:
        each = iter([curves] if isinstance(curves, NurbsCurve) else curves)
    except Exception as error:  # an iterator of the user's may fail with anything
        raise TypeError(f"curves must be a NurbsCurve or an iterable of them, got {shown(curves)}") from error
    taken = 0
    for number, curve in enumerate(each):
        as_kind(f"curves[{number}]", curve, NurbsCurve)
        degree, knots, count = curve.degree, curve.knots, len(curve.control_points)
        doublings = np.minimum(taken + np.arange(count // _SPANS[0] + 1), 20)
        sizes = np.minimum(_SPANS[0] << doublings, _SPANS[1])
        places = np.cumsum(sizes)
        different = np.unique(knots[degree : count + 1])
        inner = different[places[places < len(different) - 1]]
        cuts = np.searchsorted(knots, inner, side="right") - 1  # the last of equal knots
        cuts = [degree, *cuts[cuts < count], count]
        taken += len(cuts) - 1
        for first, last in itertools.pairwise(cuts):
            piece = curve
            if len(cuts) > 2:
                rows, near = slice(first - degree, last), knots[first - degree : last + degree + 1]
                piece = NurbsCurve(degree, near, curve.control_points[rows], curve.weights[rows])
            yield number, piece


def _windows(pieces, limits, ends):
    """Number of the curve, piece of it and feed, in order: the generator behind both planners."""
    speed, clock, horizon, ended = ends[0], 0.0, _FIRST, False
    path, waiting, parts, machine, known = None, [], [], None, None
    while not ended or path is not None:
        fresh, planned = [], 0.0
        if path is not None:
            planned = least_duration(path, machine, speed)
        while not ended and (machine is None or planned < horizon * machine.period_s):
            number, curve = next(pieces, (None, None))
            ended = curve is None
            if ended:
                break
            if machine is None:
                machine = as_limits(curve.control_points.shape[1], **limits)
            _require_joined(waiting[-1][1] if waiting else None, curve, number)
            track = prepare(curve)
            fresh.append(scan(track, machine))
            waiting.append((number, curve, track.length))
            planned += least_duration(fresh[-1], machine, machine.speed)
        if machine is None:
            raise ValueError("curves is empty; a program needs at least one curve")
        if fresh:
            path = join([*([] if path is None else [path]), *fresh], machine)
        goals = np.array([speed, ends[1] if ended else 0.0])
        require_possible(least_duration(path, machine, goals.max()), machine.period_s)
        if known is None:
            refuse_ends(goals, path, machine)
        try:
            profile, last = _planned(path, machine, goals, known, clock if ended else None), ended
        except ValueError:
            if known is None:
                raise
            profile, last = known, False  # what the window before planned beyond its kept part is a way on
        stop = profile.duration if last else _last_even_time(profile, machine)
        if stop < _KEPT * profile.duration:
            if profile is not known:
                horizon = 2.0 * planned / machine.period_s
                continue
            stop = profile.duration  # it ends at rest
        if not ended and stop == profile.duration and profile.length > path.length * (1.0 - 1e-12):
            horizon = 2.0 * planned / machine.period_s  # whether the program ends here is not known yet
            continue
        kept, known = profile, None
        if stop < profile.duration:
            kept, known = profile.portion(0.0, stop), profile.portion(stop, profile.duration)
        last = last or kept.length > path.length * (1.0 - 1e-12)
        clock += kept.duration
        path = None if last else path.rest(kept.length)
        speed, horizon = kept.speed(kept.duration), min(4 * horizon, _WINDOW)
        while waiting and kept is not None:
            number, curve, length = waiting[0]
            left = length - sum(part.length for part in parts)
            if kept.length < left * (1.0 - 1e-9) and not (last and len(waiting) == 1):
                parts.append(kept)
                break
            head, after = kept, None
            if kept.length > left * (1.0 + 1e-9) and not (last and len(waiting) == 1):
                time = kept.time_at(left)
                head, after = kept.portion(0.0, time), kept.portion(time, kept.duration)
            kept = after
            yield number, curve, concatenate([*parts, head])
            parts = []
            waiting.pop(0)


def _planned(path, limits, ends, known, gone):
    """The profile of a window, on a finer grid if the coarse one leaves no way on.

    ``gone`` is the time before a window that ends the program with a whole period, else None.
    """

    def planned(fineness):
        found = fastest_motion(path, limits, ends, fineness, known)
        if gone is None:
            return within_limits(path, limits, *found, ends)
        return whole_periods(path, limits, *found, ends, gone)

    try:
        return planned(WINDOW)
    except ValueError:
        if limits.jerk is None:
            raise
        return planned(WHOLE)


def _require_joined(before, curve, number):
    if before is not None:
        end, start = before(before.domain[1]), curve(curve.domain[0])
        gap = np.linalg.norm(end - start)
        if gap > _GAP * max(np.ptp(curve.control_points, axis=0).max(), np.abs(start).max() * 1e-6):
            raise ValueError(
                f"curves[{number}] begins {gap:.3g} mm from the end of the curve before; join them by a line"
            )


def _last_even_time(profile, limits):
    """A time well before the final braking at which the acceleration is zero and does not fall.

    Of the latest tenth the fastest is taken: it lies between two valleys of the speed limit, where
    axes have room to spare.
    """
    t, h, _, _, a, j = profile.segments.T
    level = np.abs(a) + np.abs(j) * h <= 1e-9 * limits.acceleration
    rising = np.append(False, (a[:-1] + j[:-1] * h[:-1] <= 0.0) & (a[1:] >= 0.0)) & (limits.jerk is None)
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = np.where(j > 0.0, -a / j, -1.0)
    speeding = np.flatnonzero(a + 0.5 * j * h >= 0.0)
    top = t[speeding[-1]] + h[speeding[-1]] if len(speeding) else 0.0
    latest = max(top - (profile.duration - top), 0.0)
    even = np.concatenate([
        np.minimum(t[level] + h[level], latest)[t[level] < latest],
        t[rising],
        (t + zero)[(zero >= 0.0) & (zero < h)],
    ])  # fmt: skip
    even = even[even <= latest]
    late = even[even >= 0.9 * even.max(initial=0.0)]
    return float(late[profile.speed(late).argmax()]) if len(late) else 0.0
