"""Plans of long paths: many curves one after the other, planned window by window."""

import itertools
from dataclasses import replace

import numpy as np

from nurbs_lab.common.checks import as_kind, as_not_negative, as_positive, as_sequence, shown
from nurbs_lab.motion.feed import concatenate
from nurbs_lab.motion.plan import as_limits, fastest_profile, least_duration, refuse_ends
from nurbs_lab.motion.prepared_curve import EQUAL_WITHIN, prepare
from nurbs_lab.motion.scan import join, scan
from nurbs_lab.motion.scurve import WHOLE, WINDOW
from nurbs_lab.nurbs import NurbsCurve

#: Least periods in the first window, which is small so that a machine can start, and most asked of another;
#: each asks for four times those of the one before.
_FIRST, _WINDOW = 500, 16000
#: Spans of the first piece that curves are cut into; each piece has twice those of the one before, so often.
_SPANS, _DOUBLINGS = 16, 5
#: The part of a window that is kept before a longer window is tried instead.
_KEPT = 0.25


def plan_windows(curves, limits=None, *, speeds=None, period_s=None, start_speed=0.0, end_speed=0.0, **given):
    """Plan a program of many curves as one motion, window by window, in memory that does not grow.

    The tool passes from curve to curve without a stop where the tangents agree, or where the limits allow the
    corner. Each window is planned to rest at its end, and kept up to a place where the acceleration is zero
    and the braking to rest has no influence yet; there the next window begins at the same speed. A window
    whose kept part is short is planned again at twice the length, until the program ends: at most once for
    each factor of two in its length. If no motion is found from there on, not on a finer grid either, the
    window before is kept to its end at rest. The work of one window is bounded as that of `plan_feed`.

    Parameters
    ----------
    curves : NurbsCurve or iterable of NurbsCurve
        Each begins where the one before ends. An iterator is read as far as the next window needs.
    limits, period_s, start_speed, end_speed, **given
        As in `plan_feed`, of the whole program.
    speeds : iterable of float, optional
        Largest speed along each curve, in mm/s, where it is below that of the limits.

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
    pieces = _pieces(curves, speeds)
    first = next(pieces, None)
    if first is None:
        raise ValueError("curves is empty; a program needs at least one curve")
    machine = as_limits(limits, period_s, given).in_dimensions(first[0].dim)
    ends = as_not_negative("start_speed", start_speed), as_not_negative("end_speed", end_speed)
    return _Windows(itertools.chain([first], pieces), machine, *ends).feeds()


class _Windows:
    """A program that is being planned: the path that is read and not yet planned, and what is known of it."""

    def __init__(self, pieces, limits, speed, end_speed):
        self.pieces, self.limits = pieces, limits
        self.speed, self.end_speed = speed, end_speed
        self.path = self.known = None
        self.ended, self.clock = False, 0.0
        self.waiting, self.parts = [], []  # curves with the length left on each; profiles along the first

    def feeds(self):
        """Curves with their feeds."""
        horizon = _FIRST
        while not self.ended or self.path is not None:
            planned = self._read(horizon)
            profile, last = self._planned()
            stop = profile.duration if last else _last_even_time(profile, self.limits)
            short = stop < _KEPT * profile.duration
            if short and profile is self.known:
                short, stop = False, profile.duration  # it ends at rest
            at_end = stop == profile.duration and profile.length > self.path.length * (1.0 - 1e-12)
            if short or (at_end and not self.ended):  # at the end, whether more follows is not known yet
                horizon = 2.0 * planned / self.limits.period_s
                continue
            yield from self._kept(profile, stop, last or at_end)
            horizon = min(4 * horizon, _WINDOW)

    def _read(self, horizon):
        """Read curves until the path takes ``horizon`` periods: its least duration."""
        limits, fresh = self.limits, []
        planned = 0.0 if self.path is None else least_duration(self.path, limits, self.speed)
        while not self.ended and planned < horizon * limits.period_s:
            curve, speed = next(self.pieces, (None, None))
            self.ended = curve is None
            if not self.ended:
                track = prepare(curve)
                self.waiting.append((curve, track.length))
                own = limits if speed is None else replace(limits, speed=min(speed, limits.speed))
                fresh.append(scan(track, own))
                planned += least_duration(fresh[-1], limits, limits.speed)
        if not planned < 2**53 * limits.period_s:  # beyond it, a float64 does not count one by one
            said = f"the motion takes {planned:.3g} s, more periods than can be counted"
            raise ValueError(f"{said}; take a higher speed or acceleration, or a longer period")
        if fresh:
            self.path = join([*([] if self.path is None else [self.path]), *fresh], limits)
        return planned

    def _planned(self):
        """A motion along the path that was read, and whether it ends the program."""
        goals = np.array([self.speed, self.end_speed if self.ended else 0.0])
        if self.known is None:
            refuse_ends(goals, self.path, self.limits)
        gone = self.clock if self.ended else None
        for fineness in (WINDOW, WHOLE) if self.limits.soft else (WHOLE,):  # finer if no way on is found
            try:
                return fastest_profile(self.path, self.limits, goals, fineness, gone=gone), self.ended
            except ValueError:
                if self.known is None and fineness is WHOLE:
                    raise
        return self.known, False  # what the window before planned beyond its kept part is a way on

    def _kept(self, profile, stop, last):
        """The feeds of the part of a profile that is kept."""
        kept, self.known = profile, None
        if stop < profile.duration:
            kept, self.known = profile.portion(0.0, stop), profile.portion(stop, profile.duration)
        self.clock += kept.duration
        self.path = None if last else self.path.rest(kept.length)
        self.speed = kept.speed(kept.duration)
        lefts = np.array([left for _, left in self.waiting])
        ends = np.cumsum(lefts)
        count = len(ends) if last else np.count_nonzero(ends <= kept.length + 1e-9 * lefts)
        times = np.append(0.0, kept.time_at(ends[:count]))
        if last or (count and ends[count - 1] >= kept.length - 1e-9 * lefts[count - 1]):
            times[count] = kept.duration
        for start, stop in itertools.pairwise(times.tolist()):
            curve, _ = self.waiting.pop(0)
            yield curve, replace(concatenate([*self.parts, kept.portion(start, stop)]), curve=curve)
            self.parts = []
        if times[count] < kept.duration:
            self.parts.append(kept.portion(times[count], kept.duration))
            self.waiting[0] = self.waiting[0][0], ends[count] - kept.length


def plan_program(curves, limits=None, **given):
    """Plan a program of many curves as one motion: the feed profile of each.

    Parameters
    ----------
    curves : iterable of NurbsCurve
        Each begins where the one before ends.
    limits, **given
        As in `plan_windows`, which does the work.

    Returns
    -------
    list of FeedProfile
        One for each curve; each begins as the one before ends. `FeedProfile.join` makes them one, to trace.

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
    for piece, feed in plan_windows(curves, limits, **given):
        parts.append(feed)
        if piece.domain[1] == curves[len(feeds)].domain[1]:
            feeds.append(replace(concatenate(parts), curve=curves[len(feeds)]))
            parts = []
    return feeds


def _pieces(curves, speeds):
    """The pieces that curves are cut into at knots, the first ones short, each with its speed or None."""
    try:
        each = iter([curves] if isinstance(curves, NurbsCurve) else curves)
    except Exception as error:  # an iterator of the user's may fail with anything
        raise TypeError(f"curves must be a NurbsCurve or an iterable of them, got {shown(curves)}") from error
    taken, before, speeds = 0, None, itertools.repeat(None) if speeds is None else iter(speeds)
    for number, curve in enumerate(each):
        as_kind(f"curves[{number}]", curve, NurbsCurve)
        if (speed := next(speeds, 0)) == 0:
            raise ValueError(f"speeds has none above 0 for curves[{number}]; give one for each curve")
        if speed not in (None, np.inf):
            as_positive(f"speeds[{number}]", speed)
        if before is not None:
            _require_joined(before, curve, number)
        before, degree, knots, count = curve, curve.degree, curve.knots, len(curve.control_points)
        doublings = np.minimum(taken + np.arange(count // _SPANS + 1), _DOUBLINGS)
        places = np.cumsum(_SPANS << doublings)
        different = np.unique(knots[degree : count + 1])
        inner = different[places[places < len(different) - 1]]
        cuts = np.searchsorted(knots, inner, side="right") - 1  # the last of equal knots
        cuts = [degree, *cuts[cuts < count], count]
        taken += len(cuts) - 1
        for first, last in itertools.pairwise(cuts):
            rows, near = slice(first - degree, last), knots[first - degree : last + degree + 1]
            own = degree, near, curve.control_points[rows], curve.weights[rows]
            yield (curve if last - first == count - degree else NurbsCurve(*own)), speed


def _require_joined(before, curve, number):
    if before.dim != curve.dim:
        raise ValueError(f"curves[{number}] has {curve.dim} coordinates, those before have {before.dim}")
    end, start = before(before.domain[1]), curve(curve.domain[0])
    gap = np.linalg.norm(end - start)
    if gap > EQUAL_WITHIN * max(np.ptp(curve.control_points, axis=0).max(), np.abs(start).max() * 1e-6):
        raise ValueError(f"curves[{number}] begins {gap:.3g} mm off the end of the last; join them by a line")


def _last_even_time(profile, limits):
    """The latest time well before the final braking at which the acceleration is zero and does not fall."""
    t, h, _, _, a, j = profile.segments.T
    level = np.abs(a) + np.abs(j) * h <= 1e-9 * limits.acceleration
    with np.errstate(divide="ignore", invalid="ignore"):
        zero = np.where(j > 0.0, -a / j, -1.0)
    speeding = np.flatnonzero(a + 0.5 * j * h >= 0.0)
    top = t[speeding[-1]] + h[speeding[-1]] if len(speeding) else 0.0
    latest = max(top - (profile.duration - top), 0.0)
    even = np.concatenate([
        np.minimum(t[level] + h[level], latest)[t[level] < latest],
        (t + zero)[(zero >= 0.0) & (zero < h)],
    ])  # fmt: skip
    return float(even[even <= latest].max(initial=0.0))
