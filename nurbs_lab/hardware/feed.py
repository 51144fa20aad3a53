"""Twin of rtl/vt.v: a feed as three lines in integers, and its samples every half period."""

from dataclasses import dataclass
from itertools import count

import numpy as np

from nurbs_lab.common.checks import as_count, as_kind, as_positive
from nurbs_lab.hardware.arithmetic import round_shift
from nurbs_lab.hardware.formats import Format
from nurbs_lab.motion import FeedProfile

#: The samples may miss the feed's own speed by this part of its largest.
_AGREE = 1e-6
#: More fraction bits than any curve has, that a float still holds.
_MOST_BITS = 400


@dataclass(frozen=True)
class LoadedFeed:
    """The lines of ``vt``: distances of a period over 24, with 16 more fraction bits than the samples."""

    format: Format
    rise_from: int
    rise_by: int
    cruise: int
    fall_at: int
    fall_from: int
    fall_by: int
    end_speed: int
    #: Number of the step that has to end at the curve's end.
    periods: int

    def __post_init__(self):
        for name in ("rise_from", "rise_by", "cruise", "fall_from", "fall_by", "end_speed"):
            line = getattr(self, name)
            if not 0 <= line <= self.format.largest_speed:
                raise ValueError(
                    f"{name} must be from 0 to {self.format.largest_speed}, got {line}: "
                    "lower the speed, the acceleration or the period"
                )

    def samples(self):
        """The distance of a period over 24 at t = 0, T/2, T, ... without end."""
        rising, falling = self.rise_from, self.fall_from
        for half_period in count():
            fallen = half_period >= self.fall_at
            yield round_shift(min(rising, falling) if fallen else rising, self.format.ramp_guard)
            rising = min(rising + self.rise_by, self.cruise)
            if fallen:
                falling = max(falling - self.fall_by, self.end_speed)

    def writes(self) -> list[tuple[int, int, int]]:
        """What to put on the load bus: ``(space, index, data)``."""
        lines = (
            self.rise_from,
            self.rise_by,
            self.cruise,
            self.fall_at,
            self.fall_from,
            self.fall_by,
            self.end_speed,
        )
        return [*((4, i, line) for i, line in enumerate(lines)), (5, 0, self.periods)]


def load_feed(feed, period_s: float, periods: int, point_fraction: int, format: Format) -> LoadedFeed:
    """Translate a feed of one ramp up, one cruise and one ramp down.

    Parameters
    ----------
    feed : FeedProfile
        A trapezoid or triangle of speeds, or one constant speed.
    period_s : float
    periods : int
        Number of the step that has to end at the curve's end.
    point_fraction : int
        Fraction bits of the coordinates.
    format : Format

    Raises
    ------
    ValueError
        If the feed has another shape, or is too fast for the format.
    """
    as_kind("feed", feed, FeedProfile)
    as_kind("format", format, Format)
    period_s, periods = as_positive("period_s", period_s), as_count("periods", periods)
    point_fraction = as_count("point_fraction", point_fraction, -_MOST_BITS, _MOST_BITS)
    unit = period_s / 24 * 2.0 ** (point_fraction + format.guard + format.ramp_guard)
    if unit < 1e-200:
        raise ValueError(f"period_s = {period_s:g} s is too short: its speeds would round to zero")
    half = period_s / 2
    t = half * np.arange(2 * periods + 1)
    speeds = np.asarray(feed.speed(t))
    peak = float(np.max(feed.speed(feed.times)))
    rise, fall = max(2.0 * feed.terms[0, 2], 0.0), max(-2.0 * feed.terms[-1, 2], 0.0)
    start, end = float(feed.speed(0.0)), float(feed.speed(feed.duration))
    largest = format.largest << format.ramp_guard
    # The sum of a corrected step takes six samples.
    if 6 * peak * unit > largest:
        raise ValueError(
            f"period_s = {period_s:g} s: a period of this feed moves {peak * period_s:.3g} mm; the format "
            f"takes {largest / 6 / unit * period_s:.3g} mm on this curve: lower the speed or the period"
        )
    # The falling line begins where it is low enough for its register.
    line = end + fall * feed.duration
    fall_at = max(0, int(np.ceil((line - largest / unit) / (fall * half)))) if fall else 2 * periods + 8
    loaded = LoadedFeed(
        format=format,
        rise_from=round(start * unit),
        rise_by=round(rise * half * unit),
        cruise=round(peak * unit),
        fall_at=fall_at,
        fall_from=round(min(line - fall * half * fall_at, largest / unit) * unit),
        fall_by=round(fall * half * unit),
        end_speed=round(end * unit),
        periods=periods,
    )
    samples = np.fromiter(loaded.samples(), dtype=np.int64, count=len(t))
    made = samples * 2.0**format.ramp_guard / unit
    worst = int(np.argmax(np.abs(made - speeds)))
    if abs(made[worst] - speeds[worst]) > _AGREE * peak + 2.0**format.ramp_guard / unit:
        raise ValueError(
            "feed must be one ramp up, one cruise and one ramp down for the hardware; "
            f"at t = {t[worst]:.6g} s it is {speeds[worst]:.6g} mm/s: plan it without jerk "
            "and with limits that do not bind on the way"
        )
    return loaded
