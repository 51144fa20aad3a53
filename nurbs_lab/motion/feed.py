"""The feed profile: commanded length, speed, acceleration and jerk as functions of time."""

import itertools
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from nurbs_lab.common.checks import as_floats, as_positive, freeze, shown
from nurbs_lab.motion.prepared_curve import require_possible


@dataclass(frozen=True, eq=False)
class FeedProfile:
    """Commanded motion along a path: s(t) is a cubic polynomial on every piece.

    Attributes
    ----------
    times : ndarray, shape (n + 1,)
        Ends of the pieces, in s; the first is 0.
    terms : ndarray, shape (n, 4)
        ``s = terms[i] @ (1, tau, tau**2, tau**3)`` with ``tau = t - times[i]``, in mm.
    period_s : float
        Period that the profile was planned for, in s.
    limited_by : tuple of str
        What holds the speed down on each piece: the name of an argument of ``plan_feed``.
    """

    times: np.ndarray
    terms: np.ndarray
    period_s: float
    limited_by: tuple[str, ...] = field(default=())

    def __post_init__(self):
        times, terms = as_floats("times", self.times, ("n + 1",)), as_floats("terms", self.terms, ("n", "4"))
        if terms.shape[1] != 4 or len(times) != len(terms) + 1 or not len(terms):
            raise ValueError(f"times and terms must be (n + 1,) and (n, 4), got {times.shape}, {terms.shape}")
        if times[0] != 0.0 or np.diff(times).min() < 0.0:
            raise ValueError("times must begin with 0 and not decrease")
        causes = self.limited_by if isinstance(self.limited_by, (tuple, list)) else (None,)
        if len(causes) not in (0, len(terms)) or not all(isinstance(cause, str) for cause in causes):
            raise ValueError(f"limited_by must be {len(terms)} names of limits, got {shown(self.limited_by)}")
        object.__setattr__(self, "times", freeze(times))
        object.__setattr__(self, "terms", freeze(terms))
        object.__setattr__(self, "period_s", as_positive("period_s", self.period_s))
        object.__setattr__(self, "limited_by", tuple(causes) or ("unknown",) * len(terms))

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
    def peak(self):
        """Largest commanded speed, in mm/s."""
        with np.errstate(divide="ignore", invalid="ignore"):
            level = -self.terms[:, 2] / (3.0 * self.terms[:, 3])  # from the start of the piece
        inner = self.times[:-1] + np.clip(np.nan_to_num(level), 0.0, np.diff(self.times))
        return float(np.max(self.speed(np.append(inner, self.times))))

    @cached_property
    def rests(self):
        """Whether the motion ends at rest."""
        return bool(self.speed(self.duration) == 0.0)

    @cached_property
    def table(self):
        """Times and terms for kernels, with a last piece that goes on for ever at the end speed."""
        beyond = (self.length, self.speed(self.duration), 0.0, 0.0)
        return np.append(self.times, np.inf), np.vstack([self.terms, beyond])

    def _at(self, t, derivative):
        t = np.clip(as_floats("t", t), 0.0, self.duration)
        piece = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.terms) - 1)
        tau = t - self.times[piece]
        value = np.zeros_like(tau)
        for power in range(3, derivative - 1, -1):
            factor = np.prod(np.arange(power - derivative + 1, power + 1))
            value = value * tau + factor * self.terms[piece, power]
        return value[()]

    def displacement(self, t):
        """Length s(t) travelled since the start, in mm; held outside [0, duration]."""
        return self._at(t, 0)

    def speed(self, t):
        """v(t), in mm/s."""
        t = as_floats("t", t)
        speed = np.maximum(self._at(t, 1), 0.0)
        return np.where(t >= self.duration, self._end_speed, speed)[()]

    @cached_property
    def _end_speed(self):
        """Speed at the end, with rounding on the way to rest taken out."""
        end = self._at(self.duration, 1)
        late = 4.0 * np.spacing(self.duration) * abs(self._at(self.duration, 2))
        return end if end > late + 1e-9 * np.max(np.abs(self.terms[:, 1])) else 0.0

    def acceleration(self, t):
        """Acceleration along the path, in mm/s²; at a step of it, the value after the step."""
        return self._at(t, 2)

    def jerk(self, t):
        """Jerk along the path, in mm/s³; infinite where the acceleration steps is not shown."""
        return self._at(t, 3)

    def limiting(self, t):
        """Name of the limit that binds at each time, an array of str (a str for one time)."""
        piece = np.searchsorted(self.times, as_floats("t", t), side="right") - 1
        return np.array(self.limited_by)[np.clip(piece, 0, len(self.terms) - 1)]

    def stretches(self):
        """(start, stop, name of the limit) in time order, pieces held by the same limit taken together."""
        names = self.limited_by
        changes = [k for k in range(1, len(names)) if names[k] != names[k - 1]]
        bounds = [0, *changes, len(names)]
        return [(float(self.times[a]), float(self.times[b]), names[a]) for a, b in itertools.pairwise(bounds)]


def constant_feed(length, speed, period_s):
    """The same speed from the first instant to the last: the paper's experiment, no machine's.

    Parameters
    ----------
    length : float
        In mm.
    speed : float
        In mm/s.
    period_s : float
        In s.
    """
    speed, period_s = as_positive("speed", speed), as_positive("period_s", period_s)
    require_possible(length / speed, period_s)
    return FeedProfile([0.0, length / speed], [[0.0, speed, 0.0, 0.0]], period_s, ("speed",))


def from_speeds(times, speeds, period_s, limited_by):
    """A profile of constant accelerations between given speeds."""
    steps = np.diff(times)
    half = 0.5 * np.diff(speeds) / steps
    lengths = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * steps)])
    terms = np.column_stack([lengths[:-1], speeds[:-1], half, np.zeros(len(half))])
    return FeedProfile(times, terms, period_s, tuple(limited_by))


def from_jerks(durations, jerks, start_speed, length, period_s, limited_by):
    """A profile of constant jerks from a start speed; scaled by the little that its length is off."""
    times = np.concatenate([[0.0], np.cumsum(durations)])
    a = np.concatenate([[0.0], np.cumsum(jerks * durations)])
    v = start_speed + np.concatenate([[0.0], np.cumsum(durations * (a[:-1] + 0.5 * jerks * durations))])
    steps = durations * (v[:-1] + durations * (0.5 * a[:-1] + jerks * durations / 6.0))
    s = np.concatenate([[0.0], np.cumsum(steps)])
    terms = np.column_stack([s[:-1], v[:-1], 0.5 * a[:-1], jerks / 6.0]) * (length / s[-1])
    return FeedProfile(times, terms, period_s, tuple(limited_by))


def stretch(profile, factor):
    """The same path ``factor`` times slower: speed, acceleration and jerk fall by its first three powers."""
    powers = factor ** -np.arange(4.0)
    return FeedProfile(profile.times * factor, profile.terms * powers, profile.period_s, profile.limited_by)
