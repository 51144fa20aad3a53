"""The feed profile: commanded length, speed, acceleration and jerk as functions of time."""

import itertools
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind, as_not_negative, as_positive, freeze, shown
from nurbs_lab.common.values import Value
from nurbs_lab.motion import _kernels
from nurbs_lab.motion.limits import Limits
from nurbs_lab.nurbs import NurbsCurve

#: Periods at most of which a path or an override keeps every sample, and a plan measures every chord.
MOST_SAMPLES = 5_000_000


@dataclass(frozen=True, eq=False)
class FeedProfile(Value):
    """Commanded motion along a path: the length s(t) is a cubic polynomial on every segment of time.

    Attributes
    ----------
    times : ndarray, shape (n + 1,)
        Ends of the segments, in s; the first is 0.
    terms : ndarray, shape (n, 4)
        ``s = terms[i] @ (1, tau, tau**2, tau**3)`` with ``tau = t - times[i]``, in mm.
    period_s : float
        Period that the profile was planned for, in s.
    limited_by : tuple of str
        The limit that binds on each segment: the name of an argument of ``plan_feed``.
    limits : Limits, optional
        That the profile was planned with.
    curve : NurbsCurve, optional
        That it was planned on.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (30, 40)])
    >>> feed = nl.plan_feed(line, speed=10.0, acceleration=100.0, period_s=1e-3)
    >>> [name for _, _, name in feed.stretches()]
    ['acceleration', 'speed', 'acceleration']
    """

    times: np.ndarray
    terms: np.ndarray
    period_s: float
    limited_by: tuple[str, ...] = field(default=())
    limits: Limits | None = None
    curve: NurbsCurve | None = None

    def __post_init__(self):
        times, terms = as_floats("times", self.times, ("n + 1",)), as_floats("terms", self.terms, ("n", "4"))
        if terms.shape[1] != 4 or len(times) != len(terms) + 1 or not len(terms):
            raise ValueError(f"times and terms must be (n + 1,) and (n, 4), got {times.shape}, {terms.shape}")
        if times[0] != 0.0 or not np.diff(times).min() > 0.0:
            raise ValueError(f"times must begin with 0 and increase, got {shown(times)}")
        causes = self.limited_by if isinstance(self.limited_by, (tuple, list)) else (None,)
        if len(causes) not in (0, len(terms)) or not set(map(type, causes)) <= {str}:
            raise ValueError(f"limited_by must be {len(terms)} names of limits, got {shown(self.limited_by)}")
        object.__setattr__(self, "times", freeze(times))
        object.__setattr__(self, "terms", freeze(terms))
        object.__setattr__(self, "period_s", as_positive("period_s", self.period_s))
        object.__setattr__(self, "limited_by", tuple(causes) or ("unknown",) * len(terms))
        for name, kind in (("limits", Limits), ("curve", NurbsCurve)):
            if getattr(self, name) is not None:
                as_kind(name, getattr(self, name), kind)

    def __repr__(self):
        return f"FeedProfile({self.duration:.6g} s, {self.length:.6g} mm, at most {self.peak:.6g} mm/s)"

    @property
    def duration(self):
        """Time of arrival, in s."""
        return float(self.times[-1])

    @cached_property
    def length(self):
        """Commanded length, in mm."""
        return float(self.displacement(self.duration))

    @cached_property
    def segments(self):
        """The exact motion, one row a segment: read-only, shape (n, 6).

        The columns are the start time t0 (s), the duration (s), and at the start the length s0 (mm), the
        speed v0 (mm/s), the acceleration a0 (mm/s²) and the constant jerk j (mm/s³). On the segment
        ``s(t) = s0 + v0 tau + a0 tau²/2 + j tau³/6`` with ``tau = t - t0``.
        """
        return freeze(
            np.column_stack([self.times[:-1], np.diff(self.times), self.terms * [1.0, 1.0, 2.0, 6.0]])
        )

    @cached_property
    def peak(self):
        """Largest commanded speed, in mm/s."""
        return float(largest_motion(*self.segments.T[[1, 3, 4, 5]])[0].max())

    @cached_property
    def rests(self):
        """Whether the motion ends at rest."""
        return bool(self.speed(self.duration) == 0.0)

    @cached_property
    def table(self):
        """Times and terms for kernels, with a last segment that goes on for ever at the end speed."""
        beyond = (self.length, self.speed(self.duration), 0.0, 0.0)
        return np.append(self.times, np.inf), np.vstack([self.terms, beyond])

    @cached_property
    def _position(self):
        from scipy.interpolate import PPoly

        return PPoly(self.terms[:, ::-1].T, self.times)

    def _at(self, t, order):
        return self._position(np.clip(as_floats("t", t), 0.0, self.duration), order)[()]

    def displacement(self, t):
        """Length s(t) travelled since the start, in mm; constant outside [0, duration]."""
        return self._at(t, 0)

    def speed(self, t):
        """v(t), in mm/s."""
        t = as_floats("t", t)
        speed = np.maximum(self._at(t, 1), 0.0)
        return np.where(t >= self.duration, self._end_speed, speed)[()]

    @cached_property
    def _end_speed(self):
        """Speed at the end; zero if it differs from rest by rounding only."""
        end = self._at(self.duration, 1)
        late = 4.0 * np.spacing(self.duration) * abs(self._at(self.duration, 2))
        return end if end > late + 1e-9 * np.max(np.abs(self.terms[:, 1])) else 0.0

    def acceleration(self, t):
        """Acceleration along the path, in mm/s²; where it jumps, the value after the jump."""
        return self._at(t, 2)

    def jerk(self, t):
        """Jerk along the path, in mm/s³; the infinite jerk where the acceleration jumps is left out."""
        return self._at(t, 3)

    def time_at(self, length):
        """Time at which each length has been travelled, in s: the inverse of ``displacement``.

        Parameters
        ----------
        length : array_like
            In mm, in any order; values outside [0, ``length``] give the start or the end.
        """
        lengths = np.clip(as_floats("length", length), 0.0, self.length)
        order = np.argsort(lengths, axis=None)
        times = np.empty(lengths.size)
        _kernels.times_at(*self.table, lengths.ravel()[order], times)
        found = np.empty(lengths.size)
        found[order] = np.minimum(times, self.duration)
        return found.reshape(lengths.shape)[()]

    def portion(self, start, stop):
        """The motion between two times as a profile of its own, with time and length counted from its start.

        Parameters
        ----------
        start, stop : float
            In s, with 0 <= start < stop <= duration.
        """
        start, stop = as_not_negative("start", start), as_positive("stop", stop)
        if not start < stop <= self.duration:
            raise ValueError(
                f"stop must lie above start and at most at {self.duration:g} s, "
                f"got start {start:g} and stop {stop:g}"
            )
        first = np.searchsorted(self.times, start, side="right") - 1
        last = np.searchsorted(self.times, stop, side="left")
        times = np.clip(self.times[first : last + 1], start, stop) - start
        terms = self.terms[first:last].copy()
        terms[0] = [self._at(start, 0), self._at(start, 1), 0.5 * self._at(start, 2), terms[0, 3]]
        terms[:, 0] -= terms[0, 0]
        return with_segments(self, times, terms, self.limited_by[first:last])

    def join(self, *others):
        """One motion of this feed and of those that follow it, along their curves as one curve.

        The feeds of a program become one feed, and ``trace(feed.curve, feed)`` one path whose samples are a
        period apart throughout.

        Parameters
        ----------
        *others : FeedProfile
            Each begins at the speed and, if both have one, on the curve with which the one before ends.

        Examples
        --------
        >>> import nurbs_lab as nl
        >>> lines = [nl.NurbsCurve(1, [0, 0, 1, 1], [(x, 0), (x + 5, 0)]) for x in (0, 5)]
        >>> first, second = nl.motion.plan_program(lines, speed=10.0, acceleration=100.0, period_s=1e-3)
        >>> feed = first.join(second)
        >>> nl.trace(feed.curve, feed).points[-1].tolist()
        [10.0, 0.0]
        """
        feeds = [self, *(as_kind("others", other, FeedProfile) for other in others)]
        for before, after in itertools.pairwise(feeds):
            end, start = before.speed(before.duration), after.speed(0.0)
            if abs(end - start) > 1e-6 * self.peak or after.period_s != self.period_s:
                raise ValueError(
                    f"others must go on as the feed before ends: one at {end:g} mm/s, with a period of "
                    f"{self.period_s:g} s, is followed by {start:g} mm/s and {after.period_s:g} s"
                )
        whole = concatenate(feeds)
        if any(feed.curve is None for feed in feeds):
            return whole
        curves = []  # their parameters as long as they are, so that no stepper meets a jump of |C'|
        for feed in feeds:
            curve, scale = feed.curve, feed.length / np.ptp(feed.curve.domain)
            curves.append(NurbsCurve(curve.degree, scale * curve.knots, curve.control_points, curve.weights))
        return replace(whole, curve=curves[0].join(*curves[1:]))

    def certificate(self):
        """A lower bound of the time of any motion within the limits, and the largest use of each limit.

        Returns
        -------
        Certificate
            It takes as long to find as the plan, with a limit of jerk up to ten times as long.

        Raises
        ------
        ValueError
            For a profile without the curve and the limits that it was planned with.

        Examples
        --------
        >>> import nurbs_lab as nl
        >>> feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, jerk=800.0, period_s=1e-3)
        >>> feed.certificate().gap < 0.01
        True
        """
        from nurbs_lab.motion.certificate import certify

        return certify(self)

    def limiting(self, t):
        """Name of the limit that binds at each time, an array of str (a str for one time)."""
        phase = np.searchsorted(self.times, as_floats("t", t), side="right") - 1
        return np.array(self.limited_by)[np.clip(phase, 0, len(self.terms) - 1)]

    def stretches(self):
        """(start, stop, name of the limit) in time order, segments with the same limit taken together."""
        names = self.limited_by
        changes = [k for k in range(1, len(names)) if names[k] != names[k - 1]]
        bounds = [0, *changes, len(names)]
        return [(float(self.times[a]), float(self.times[b]), names[a]) for a, b in itertools.pairwise(bounds)]


def largest_motion(h, v, a, j):
    """Largest speeds and accelerations of phases of constant jerk, from how long they last and begin."""
    with np.errstate(divide="ignore", invalid="ignore"):
        level = np.clip(np.nan_to_num(-a / j), 0.0, h)  # where the acceleration is zero
    fastest = np.max([v, v + h * (a + 0.5 * h * j), v + level * (a + 0.5 * level * j)], axis=0)
    return fastest, np.maximum(np.abs(a), np.abs(a + j * h))


def constant_feed(length, speed, period_s):
    """The same speed from the first instant to the last, without a ramp: the paper's experiment."""
    return FeedProfile([0.0, length / speed], [[0.0, speed, 0.0, 0.0]], period_s, ("speed",))


def from_speeds(lengths, speeds, limits, limited_by):
    """A profile of constant accelerations between speeds at given lengths.

    Where v² is linear in the length over several intervals under the same limit, they are one segment.
    """
    squares, causes = speeds**2, np.asarray(limited_by, dtype=object)
    slopes = np.diff(squares) / np.diff(lengths)
    same = np.abs(np.diff(slopes)) <= 1e-9 * limits.acceleration
    keep = np.concatenate([[True], ~same | (causes[1:] != causes[:-1]), [True]])
    lengths, speeds, causes = lengths[keep], speeds[keep], causes[keep[:-1]]
    with np.errstate(all="ignore"):
        steps = 2.0 * np.diff(lengths) / (speeds[1:] + speeds[:-1])
        half = 0.5 * np.diff(speeds) / steps
    times = np.concatenate([[0.0], np.cumsum(steps)])
    terms = np.column_stack([lengths[:-1], speeds[:-1], half, np.zeros(len(half))])
    return FeedProfile(times, terms, limits.period_s, tuple(causes), limits)


def from_jerks(durations, jerks, start_speed, length, limits, limited_by):
    """A profile of constant jerks from a start speed; scaled by the little that its length is off."""
    times, terms = path_of_jerks(durations, jerks, start_speed)
    h, (s, v, half, sixth) = durations[-1], terms[-1]
    reached = s + h * (v + h * (half + h * sixth))
    return FeedProfile(times, terms * (length / reached), limits.period_s, tuple(limited_by), limits)


def path_of_jerks(durations, jerks, speed, acceleration=0.0):
    """Times and terms, as in `FeedProfile`, of constant jerks from a speed and an acceleration."""
    times = np.concatenate([[0.0], np.cumsum(durations)])
    a = acceleration + np.concatenate([[0.0], np.cumsum(jerks * durations)])
    v = speed + np.concatenate([[0.0], np.cumsum(durations * (a[:-1] + 0.5 * jerks * durations))])
    steps = durations * (v[:-1] + durations * (0.5 * a[:-1] + jerks * durations / 6.0))
    s = np.concatenate([[0.0], np.cumsum(steps)])
    return times, np.column_stack([s[:-1], v[:-1], 0.5 * a[:-1], jerks / 6.0])


def concatenate(profiles):
    """One profile of several that follow each other."""
    first, *others = profiles
    if not others:
        return replace(first, curve=None)
    starts = np.cumsum([0.0, *(profile.duration for profile in profiles)])
    gone = np.cumsum([0.0, *(profile.length for profile in profiles)])
    times = [profile.times[:-1] + start for profile, start in zip(profiles, starts, strict=False)]
    terms = np.concatenate([profile.terms for profile in profiles])
    terms[:, 0] += np.repeat(gone[:-1], [len(profile.terms) for profile in profiles])
    causes = [name for profile in profiles for name in profile.limited_by]
    return with_segments(first, np.concatenate([*times, starts[-1:]]), terms, causes)


def with_segments(feed, times, terms, causes):
    """The feed with other segments, on no curve, and without those that rounding of the times swallows."""
    lasting = np.diff(times) > 0.0
    times, causes = np.append(times[:-1][lasting], times[-1]), np.array(causes, dtype=object)[lasting]
    return replace(feed, curve=None, times=times, terms=terms[lasting], limited_by=tuple(causes))


def stretch(profile, factor):
    """The same path ``factor`` times slower: speed, acceleration and jerk fall by its first three powers."""
    terms = profile.terms * factor ** -np.arange(4.0)
    return replace(profile, times=profile.times * factor, terms=terms)
