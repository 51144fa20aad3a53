"""Twin of rtl/vt.v and rtl/feed_table.v: a feed as a table of segments, in integers."""

from dataclasses import dataclass
from itertools import chain, islice, repeat
from math import ceil

import numpy as np

from nurbs_lab.common.checks import as_count, as_kind, as_positive
from nurbs_lab.hardware.arithmetic import Format, round_shift
from nurbs_lab.motion import FeedProfile

#: Records that a bank of the table holds; a LoadedFeed fills two.
RECORDS = 128
#: Speeds may miss the feed's own by these parts of its largest: the first for which the table is long enough.
_AGREE = 10.0 ** np.arange(-12, -3)


def distances(records):
    """The numbers that records stand for, each for d, d + e, d + 2 e + f, d + 3 e + 3 f, ..."""
    for count, d, e, f in records:
        for _ in range(count):
            yield d
            d, e = d + e, e + f


def feed_records(values, tolerance):
    """Yield records ``(count, d, e, f)`` in integers that stand for these numbers, one after another.

    A record has the sum of its numbers to half a unit each, and is as long as none of them is missed by more
    than the tolerance, or by one unit where that is more.
    """
    tolerance, done = max(tolerance, 1.0), 0
    while done < len(values):
        left = values[done:]
        found, beyond = _record(left[:1]), 2
        while beyond <= len(left) and (longer := _record(left[:beyond], tolerance)):
            found, beyond = longer, 2 * beyond
        beyond = min(beyond, len(left) + 1)
        while beyond - found[0] > 1:
            middle = (found[0] + beyond) // 2
            longer = _record(left[:middle], tolerance)
            found, beyond = (longer, beyond) if longer else (found, middle)
        yield found
        done += found[0]


def _record(values, tolerance=np.inf):
    """The record through the first, middle and last number, with the sum of all; None if it misses one."""
    last = len(values) - 1
    middle = last // 2
    e = f = 0
    if middle:
        rise = (values[last] - values[0]) / last - (values[middle] - values[0]) / middle
        f = round(2.0 * rise / (last - middle))
    if last:
        e = round((values[last] - values[0]) / last - 0.5 * (last - 1) * f)
    k = np.arange(last + 1)
    rest = values - (k * e + k * (k - 1) // 2 * f)
    d = round(float(np.mean(rest)))
    return (last + 1, d, e, f) if np.abs(rest - d).max() <= tolerance else None


@dataclass(frozen=True)
class LoadedFeed:
    """The table of ``vt``: distances of a period over 24 at every half period, with 28 more fraction bits."""

    format: Format
    #: Rows (samples, d, e, f): the next samples are d, d + e, d + 2 e + f, and so on.
    records: tuple
    #: The speed that holds after them.
    end_speed: int
    #: Number of the step that has to end at the curve's end.
    periods: int

    def samples(self):
        """The distance of a period over 24 at t = 0, T/2, T, ... without end."""
        table = chain(distances(self.records), repeat(self.end_speed))
        return (round_shift(speed, self.format.ramp_guard) for speed in table)

    def writes(self) -> list[tuple[int, int, int]]:
        """What to put on the load bus: ``(space, index, data)``."""
        table = [*self.records, (0, self.end_speed, 0, 0)]
        words = [(4, n << 2 | i, word) for n, record in enumerate(table) for i, word in enumerate(record)]
        return [*words, (5, 0, self.periods)]


def load_feed(feed, period_s: float, periods: int, point_fraction: int, format: Format) -> LoadedFeed:
    """Translate a feed of any shape to the table of the module ``vt``.

    Parameters
    ----------
    feed : FeedProfile
        A trapezoid, an S-curve, or a plan limited by curvature.
    period_s : float
    periods : int
        Number of the step that has to end at the curve's end.
    point_fraction : int
        Fraction bits of the coordinates.
    format : Format

    Raises
    ------
    ValueError
        If the feed is too fast for the format, or has more segments than the table.
    """
    as_kind("feed", feed, FeedProfile)
    as_kind("format", format, Format)
    period_s, periods = as_positive("period_s", period_s), as_count("periods", periods)
    point_fraction = as_count("point_fraction", point_fraction, least=-900, most=900)  # a float's exponents
    unit = period_s / 24 * 2.0 ** (point_fraction + format.guard + format.ramp_guard)
    largest = format.largest >> 1 << format.ramp_guard  # in the table a speed has a sign
    if feed.peak * unit > largest:
        raise ValueError(
            f"period_s = {period_s:g} s: a period of this feed moves {feed.peak * period_s:.3g} mm; on this "
            f"curve the format takes {largest / unit * period_s:.3g} mm: lower the speed or the period"
        )
    samples = min(2 * periods, ceil(2.0 * feed.duration / period_s)) + 1
    speeds = np.maximum(feed.speed(period_s / 2 * np.arange(samples)), 0.0) * unit
    for tolerance in _AGREE:
        records = tuple(islice(feed_records(speeds, tolerance * speeds.max()), 2 * RECORDS))
        if len(records) < 2 * RECORDS:
            return LoadedFeed(format, records, round(float(feed.speed(feed.duration)) * unit), periods)
    raise ValueError(
        f"the feed needs more than {2 * RECORDS - 1} segments of constant jerk to be followed within "
        f"{_AGREE[-1]:g} of its peak: take slope 'exact', or split the curve"
    )
