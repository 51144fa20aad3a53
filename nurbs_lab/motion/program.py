"""Plans of long paths: many curves one after the other, planned window by window."""

import itertools

import numpy as np

from nurbs_lab.common.checks import as_kind, as_not_negative, as_sequence, shown
from nurbs_lab.motion.feed import concatenate, on_track, require_possible
from nurbs_lab.motion.limits import Limits
from nurbs_lab.motion.plan import fastest_profile, least_duration, refuse_ends
from nurbs_lab.motion.prepared_curve import prepare
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
    pieces = _pieces(curves)
    first = next(pieces, None)
    if first is None:
        raise ValueError("curves is empty; a program needs at least one curve")
    machine = Limits.checked(
        first.dim, speed=speed, acceleration=acceleration, period_s=period_s, jerk=jerk,
        chord_error=chord_error, centripetal_acceleration=centripetal_acceleration, axis_speed=axis_speed,
        axis_acceleration=axis_acceleration,
    )  # fmt: skip
    speed, end_speed = as_not_negative("start_speed", start_speed), as_not_negative("end_speed", end_speed)
    pieces = itertools.chain([first], pieces)
    clock, horizon, ended, path, known = 0.0, _FIRST, False, None, None
    waiting, parts = [], []  # tracks with the length left on each, and the profiles along the first so far
    while not ended or path is not None:
        planned = 0.0 if path is None else least_duration(path, machine, speed)
        fresh = []
        while not ended and planned < horizon * machine.period_s:
            curve = next(pieces, None)
            ended = curve is None
            if not ended:
                track = prepare(curve)
                waiting.append((track, track.length))
                fresh.append(scan(track, machine))
                planned += least_duration(fresh[-1], machine, machine.speed)
        if fresh:
            path = join([*([] if path is None else [path]), *fresh], machine)
        goals = np.array([speed, end_speed if ended else 0.0])
        require_possible(least_duration(path, machine, goals.max()), machine.period_s)
        if known is None:
            refuse_ends(goals, path, machine)
        try:
            profile, last = _planned(path, machine, goals, clock if ended else None, known), ended
        except ValueError:
            if known is None:
                raise
            profile, last = known, False  # what the window before planned beyond its kept part is a way on
        stop = profile.duration if last else _last_even_time(profile, machine)
        short = stop < _KEPT * profile.duration
        if short and profile is known:
            short, stop = False, profile.duration  # it ends at rest
        at_end = stop == profile.duration and profile.length > path.length * (1.0 - 1e-12)
        if short or (at_end and not ended):  # if it is at the end, whether more follows is not known yet
            horizon = 2.0 * planned / machine.period_s
            continue
        kept, known = profile, None
        if stop < profile.duration:
            kept, known = profile.portion(0.0, stop), profile.portion(stop, profile.duration)
        last = last or at_end
        clock += kept.duration
        path = None if last else path.rest(kept.length)
        speed, horizon = kept.speed(kept.duration), min(4 * horizon, _WINDOW)
        while waiting and kept is not None:
            track, left = waiting.pop(0)
            final = last and not waiting
            if kept.length < left * (1.0 - 1e-9) and not final:
                parts.append(kept)
                waiting.insert(0, (track, left - kept.length))
                break
            head, kept = kept, None
            if head.length > left * (1.0 + 1e-9) and not final:
                time = head.time_at(left)
                head, kept = head.portion(0.0, time), head.portion(time, head.duration)
            yield track.curve, on_track(concatenate([*parts, head]), track)
            parts = []


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
    curves = [curves] if isinstance(curves, NurbsCurve) else as_sequence("curves", curves)
    feeds, parts = [], []
    for piece, feed in plan_windows(curves, **limits):
        parts.append(feed)
        if piece.domain[1] == curves[len(feeds)].domain[1]:
            feeds.append(feed if len(parts) == 1 else concatenate(parts))
            parts = []
    return feeds


def _pieces(curves):
    """The pieces that curves are cut into at knots, the first ones short."""
    try:
        each = iter([curves] if isinstance(curves, NurbsCurve) else curves)
    except Exception as error:  # an iterator of the user's may fail with anything
        raise TypeError(f"curves must be a NurbsCurve or an iterable of them, got {shown(curves)}") from error
    taken, before = 0, None
    for number, curve in enumerate(each):
        as_kind(f"curves[{number}]", curve, NurbsCurve)
        if before is not None:
            _require_joined(before, curve, number)
        before, degree, knots, count = curve, curve.degree, curve.knots, len(curve.control_points)
        doublings = np.minimum(taken + np.arange(count // _SPANS[0] + 1), 20)
        places = np.cumsum(np.minimum(_SPANS[0] << doublings, _SPANS[1]))
        different = np.unique(knots[degree : count + 1])
        inner = different[places[places < len(different) - 1]]
        cuts = np.searchsorted(knots, inner, side="right") - 1  # the last of equal knots
        cuts = [degree, *cuts[cuts < count], count]
        taken += len(cuts) - 1
        for first, last in itertools.pairwise(cuts):
            rows, near = slice(first - degree, last), knots[first - degree : last + degree + 1]
            whole = last - first == count - degree
            yield (
                curve if whole else NurbsCurve(degree, near, curve.control_points[rows], curve.weights[rows])
            )


def _planned(path, limits, ends, gone, known):
    """The profile of a window, on a finer grid if the coarse one leaves no way on."""
    try:
        return fastest_profile(path, limits, ends, WINDOW, gone=gone, known=known)
    except ValueError:
        if limits.jerk is None:
            raise
        return fastest_profile(path, limits, ends, WHOLE, gone=gone, known=known)


def _require_joined(before, curve, number):
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
