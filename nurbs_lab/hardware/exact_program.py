"""What rtl/streamer.v is loaded with: polynomial pieces of the curves, and records of the feed."""

from bisect import bisect_left, bisect_right
from dataclasses import dataclass
from itertools import accumulate, islice, pairwise
from math import ceil, comb, floor

import numpy as np
from numpy.polynomial import Polynomial, legendre

from nurbs_lab.common.checks import as_count, as_kind, as_positive, as_sequence
from nurbs_lab.hardware.arithmetic import SHIPPED, Format, round_shift
from nurbs_lab.hardware.feed import RECORDS, distances, feed_records
from nurbs_lab.hardware.feed_override import OverrideLimits, override_limits
from nurbs_lab.hardware.stepper import limit_writes, loaded_limits
from nurbs_lab.motion import FeedProfile
from nurbs_lab.motion.feed import MOST_SAMPLES
from nurbs_lab.nurbs import NurbsCurve, approximate_curve
from nurbs_lab.nurbs.along import lengths_along
from nurbs_lab.nurbs.measure import UNEVEN, samples_along

#: Bits of t below those that enter a product; bits of lengths below the last one of a step.
T_GUARD, S_GUARD = 12, 12
#: Largest |C'| of a piece over its smallest; most halvings of a span.
_RATIO, _HALVINGS = 1.9, 12
#: A curve with weights is missed by this part of its size.
_NEAR = 8e-7
#: A period's distance is missed by these parts of the largest: the first whose records fit into the banks.
_AGREE = 10.0 ** np.arange(-8, -4)
#: The step stops where |C'|² has changed by this part in the middle of a step.
_UNSETTLED = 1 / 16
#: A step errs by less than this part of it: rtl/README.md.
_STEP_ERROR = 1e-3
#: Pieces that a bank holds; the longest reserve of periods that can be loaded.
BANK, _RESERVE = 32, 0xFFFF


@dataclass(frozen=True)
class Piece:
    """One polynomial piece, t from 0 to 1."""

    #: Coefficients of each axis, the constant first.
    points: tuple
    #: Coefficients of |C'|² as a part of its bound, the constant first: 3 up to degree 2, else 5.
    metric: tuple
    #: 1 / |C'| at t = 0, as a part of its bound.
    root: int
    #: Arc length, with ``S_GUARD`` more bits than a step.
    length: int
    #: A step times 1 / |C'|, shifted right by this, is a step of t with ``T_GUARD`` more bits.
    shift: int
    #: The piece covers this of the curve's parameter.
    interval: tuple
    #: Four bits that are on while the tool moves on it.
    outputs: int = 0


@dataclass(frozen=True)
class ExactProgram:
    """All that ``streamer`` is loaded with for one job, of one curve or many."""

    format: Format
    dim: int
    point_fraction: int
    step_fraction: int
    pieces: tuple
    #: Rows (periods, d, e, f): the next periods move d, d + e, d + 2 e + f, and so on.
    feed: tuple
    #: The last point.
    end: tuple
    #: Of the feed override.
    override: OverrideLimits
    largest_step: int
    axis_limits: tuple
    period_s: float
    #: At its start and at its end, in mm/s.
    end_speeds: tuple

    def bounds(self):
        """Yield the bounds of each batch, with rounding: ``(2 axis + side, place)``, ``(7, step)``.

        The step is the most that an axis moves in a period at any rate. Within a period of the feed the speed
        changes evenly, by half of what the distances beside it differ; so a period that begins in one of the
        feed and ends in the next moves at most 1/16 of how these differences differ more than the larger one.
        """
        moves = np.array([self.override.prior, *distances(self.feed), 0, 0])
        gains = np.clip(moves[2:] - moves[:-2], -4 * moves[1:-1], 4 * moves[1:-1])
        steps = np.maximum(moves[1:-2], moves[2:-1]) + (np.maximum(-np.diff(gains), 0) >> 4)
        shift = self.point_fraction - self.step_fraction - self.format.ramp_guard
        for (first, start), (last, end) in pairwise(self.cuts()):
            step = np.ldexp(steps[start:end].max() * (1 + _STEP_ERROR), shift)
            step = min(int(step) + 4, 2 * self.format.largest + 1)
            yield [*enumerate(_bounds(self.pieces[first:last], self.format.word)), (7, step)]

    def from_positions(self, positions) -> np.ndarray:
        """Parameters of the curves from ``bank, piece, t`` in one integer each, in the order of the run."""
        bits = self.format.word - 1
        positions = as_sequence("positions", positions)
        words = np.array([as_count("positions", word, 0, 1 << 62) for word in positions], np.int64)
        banks = words >> bits + 5
        batch = np.cumsum(np.diff(banks, prepend=0) != 0)
        starts = np.array([first for first, _ in self.cuts()])
        piece = starts[np.minimum(batch, len(starts) - 1)] + (words >> bits & BANK - 1)
        if piece.max(initial=0) >= len(self.pieces):
            raise ValueError(f"positions must lie on the {len(self.pieces)} pieces of the program")
        ends = np.array([piece.interval for piece in self.pieces])[piece]
        t = (words & (1 << bits) - 1) * 2.0**-bits
        return ends[:, 0] + np.diff(ends, axis=1)[:, 0] * t

    def cuts(self) -> list[tuple[int, int]]:
        """First piece and first period of each batch, what one bank holds at a time, then those of the end.

        The records of a batch are those of the periods that begin on its pieces; the last one may end beyond.
        """
        periods = [0, *accumulate(record[0] for record in self.feed)]
        moves = (round_shift(move, Format.ramp_guard - S_GUARD) for move in distances(self.feed))
        along = list(accumulate(moves))
        ends = accumulate(piece.length for piece in self.pieces)
        # Periods that begin before the end of each piece.
        begun = [min(bisect_left(along, end) + 1, periods[-1]) for end in ends]
        begun[-1] = periods[-1]
        found, first, period = [], 0, 0
        while first < len(self.pieces):
            found.append((first, period))
            record = bisect_right(periods, period) - 1
            latest = periods[min(record + RECORDS, len(self.feed))]
            last = min(first + BANK, len(self.pieces)) - 1
            while last >= first and begun[last] > latest:
                last -= 1
            if last < first or begun[last] <= period:
                raise ValueError(
                    f"piece {first} of the job needs more than {RECORDS} records of constant jerk, or {BANK} "
                    "pieces take less than a period: split the curve, or lower the speed or the period"
                )
            first, period = last + 1, begun[last]
        # A bank may be loaded again as soon as it is left, so only the periods of the next bank are certain.
        reserve = self.override.reserve
        known = min([_RESERVE if found[1:] else reserve, *(b - a for (_, a), (_, b) in pairwise(found[1:]))])
        if known < reserve:
            raise ValueError(
                f"a stop may take {reserve} periods, but {known} fill a bank: lower the speed, raise the "
                "acceleration or the jerk, or join short curves"
            )
        return [*found, (first, period)]

    def batches(self) -> list[list[tuple[int, int, int]]]:
        """What to put on the load bus for each bank in its turn: ``(space, index, data)``."""
        cuts, found = self.cuts(), []
        for n, (bounds, ends) in enumerate(zip(self.bounds(), pairwise(cuts), strict=True)):
            (first, start), (last, end) = ends
            pieces, records, bank = self.pieces[first:last], _portion(self.feed, start, end), n & 1
            shape = (end - start) << 16 | (n + 2 == len(cuts)) << 13 | is_cubic(pieces) << 12
            shape |= (len(records) - 1) << 5 | (len(pieces) - 1)
            writes = [(3, bank << 3, shape)]
            for i, piece in enumerate(pieces, bank * BANK):
                metrics = (*piece.metric, piece.root, piece.length, piece.outputs << 6 | piece.shift)
                writes += [(0, i << 3 | k, value) for k, value in enumerate(metrics)]
                axes = enumerate(piece.points)
                writes += [(2, i << 4 | axis << 2 | k, a) for axis, x in axes for k, a in enumerate(x)]
            for i, record in enumerate(records, bank * RECORDS):
                writes += [(1, i << 2 | k, value) for k, value in enumerate(record)]
            if n == 0:
                writes += [(3, 1 + i, x) for i, x in enumerate(self.end)]
                words = (*self.override[:3], min(self.override.reserve, _RESERVE))
                writes += [(5, at, x) for at, x in zip((5, 7, 14, 6), words, strict=True)]
                writes += limit_writes(self)
            found.append(writes + [(3, i << 4 | bank << 3 | 4, bound) for i, bound in bounds])
        return found


def is_cubic(pieces) -> bool:
    """Whether |C'|² is of fourth degree in some piece."""
    return any(piece.metric[3] or piece.metric[4] for piece in pieces)


def _bounds(pieces, word) -> list[int]:
    """Lowest and highest coordinate of each axis on these pieces, with the rounding of Horner's scheme."""
    found, most = [], 1 << word - 1
    for axes in zip(*(piece.points for piece in pieces), strict=True):
        curves = [Polynomial(x).trim() for x in axes]  # extreme at an end or where the slope is 0
        values = [y for x in curves for y in x(np.clip([0.0, 1.0, *x.deriv().roots().real], 0.0, 1.0))]
        found += [max(floor(min(values)) - 2, -most), min(ceil(max(values)) + 2, most - 1)]
    return found


def _portion(feed, start, stop):
    """The records of the periods from ``start`` to ``stop``; a record that they cut begins anew there."""
    found, done = [], 0
    for periods, d, e, f in feed:
        skip, kept = max(start - done, 0), min(stop - done, periods)
        if skip < kept:
            found.append((kept - skip, d + skip * e + skip * (skip - 1) // 2 * f, e + skip * f, f))
        done += periods
    return found


def pieces_of(curve):
    """Yield interval, polynomials of axes and |C'|², largest |C'|; spans are halved until |C'| is even."""
    waiting = [(*piece, 0) for piece in _cubics(curve)][::-1]
    while waiting:
        bezier, (first, last), halvings = waiting.pop()
        degree, points = bezier.degree, bezier.control_points
        coefficients = [comb(degree, k) * np.diff(points, k, axis=0)[0] for k in range(degree + 1)]
        axes = [Polynomial(x) for x in np.transpose(coefficients)]
        metric = sum(x.deriv() ** 2 for x in axes)
        speeds = np.sqrt(np.abs(metric(np.linspace(0.0, 1.0, 65))))
        steepest = max(np.abs(slope.coef).sum() for slope in (metric.deriv(), metric.deriv(2)))
        even = speeds.max() <= speeds.min() * _RATIO
        if even and steepest < 15.0 * speeds.max() ** 2:  # of 16 in the format
            yield (first, last), axes, metric, float(speeds.max())
            continue
        if halvings == _HALVINGS:
            raise ValueError(f"the curve nearly stops at u = {first:.6g}, where it needs a smoother turn")
        one, two = bezier.split(sum(bezier.domain) / 2)
        middle = (first + last) / 2
        waiting += [(two, (middle, last), halvings + 1), (one, (first, middle), halvings + 1)]


def _cubics(curve):
    """Bezier curves of degree 3 at most and the interval of each; near the curve if it has weights."""
    waiting = curve.beziers()[::-1]
    while waiting:
        bezier = waiting.pop()
        if not curve.rational and curve.degree <= 3:
            yield bezier, bezier.domain
        elif bezier.weights.max() > UNEVEN * bezier.weights.min():
            waiting += bezier.split(sum(bezier.domain) / 2)[::-1]
        else:
            u, points = samples_along(bezier, 201)
            near = approximate_curve(points, 3, tolerance=_NEAR * np.ptp(curve.control_points, axis=0).max())
            along = lengths_along(points)
            for piece in near.beziers():
                yield piece, np.interp(piece.domain, along / along[-1], u)


def build_exact_program(
    curves, feed, period_s, *, largest_step=None, axis_limits=None, outputs=0, format: Format = SHIPPED
) -> ExactProgram:
    """What to load for the exact slope: curves, and any feed along them.

    Polynomial curves of degree 1 to 3 are run as they are. With weights, or of a higher degree, a curve is
    approximated by cubics within 1e-6 of the extent of its control points: a full circle by 36.

    Parameters
    ----------
    curves : NurbsCurve or iterable of NurbsCurve
        Each beginning where the one before ends. Jobs beyond 32 pieces (see ``Piece``)
        or 128 records of the feed stream through two banks.
    feed : FeedProfile
        Any: trapezoid, S-curve or limited by curvature; for several curves one for all of them, as
        ``FeedProfile.join`` makes it from what ``nurbs_lab.motion.plan_windows`` yields.
    period_s : float
    largest_step, axis_limits : optional
        As for ``build_program``.
    outputs : int or sequence of int, optional
        Bits, 0 to 15, that are on while the tool moves on a curve: of all, or of each curve.
    format : Format, optional

    Raises
    ------
    ValueError
        If a curve has a cusp, a tiny span, or begins elsewhere than the one before ends; for wrong outputs.
    """
    curves = [curves] if isinstance(curves, NurbsCurve) else as_sequence("curves", curves)
    dims = {as_kind("curves", curve, NurbsCurve).dim for curve in curves}
    if dims not in ({2}, {3}):
        found = f"dimensions {dims}" if dims else "none"
        raise ValueError(f"curves must be one or more, all in the plane or all in space, got {found}")
    as_kind("feed", feed, FeedProfile)
    period_s = as_positive("period_s", period_s)
    if as_kind("format", format, Format).word < 25:
        raise ValueError(f"exact slopes need a format of 25 to 35 bits, got {format.word}")
    if not feed.duration / MOST_SAMPLES < period_s <= feed.duration * (1 + 1e-6):
        raise ValueError(
            f"period_s = {period_s:g} s must be at most the feed's duration of {feed.duration:g} s, "
            f"and at least 1/{MOST_SAMPLES:g} of it"
        )
    word, moved = format.word, feed.peak * period_s
    gained = period_s**2 * np.abs(feed.segments[:, 4]).max()  # more than the peak, to the override
    sizes = moved + min(gained, moved) / 4, feed.length
    step_fraction = min(np.array([word - 2, 63 - S_GUARD]) - np.frexp(sizes)[1]).item()
    unit = 2.0 ** (step_fraction + format.ramp_guard)
    places = feed.displacement(period_s * np.arange(int(np.ceil(feed.duration / period_s - 1e-9)) + 1.0))
    bits = [outputs] * len(curves) if np.isscalar(outputs) else as_sequence("outputs", outputs)
    if len(bits) != len(curves):
        raise ValueError(
            f"outputs must be one number (bits 1 and 2 together are 3) or {len(curves)}, one for each curve, "
            f"got {len(bits)}"
        )
    bits = [as_count("outputs", one, 0, 15) for one in bits]
    found = [(*piece, on) for curve, on in zip(curves, bits, strict=True) for piece in pieces_of(curve)]
    size = max(sum(np.abs(x.coef)) for _, axes, *_ in found for x in axes)
    point_fraction = word - 1 - int(np.frexp(max(size, 2.0**-60) * (1 + 2.0 ** (4 - word)))[1])
    _require_even(found, places)
    pieces = tuple(_piece(*row, word, point_fraction, step_fraction) for row in found)
    check_chain(curves, feed, 16 * 2.0**-point_fraction)
    limits = loaded_limits(curves[0].dim, moved, largest_step, axis_limits, point_fraction, format)
    end = tuple(_words(curves[-1](curves[-1].domain[1]), point_fraction))
    for tolerance in _AGREE:
        records = tuple(feed_records(np.diff(places) * unit, tolerance * moved * unit))
        first, second = [*islice(distances(records), 2), 0][:2]
        override = override_limits(feed, period_s, unit, first, second, word)
        described = format, curves[0].dim, point_fraction, step_fraction, pieces, records, end, override
        program = ExactProgram(*described, *limits, period_s, tuple(feed.speed([0.0, feed.duration])))
        try:
            program.cuts()
            return program
        except ValueError as error:
            trouble = error
    raise trouble


def _require_even(found, places):
    """Refuse a feed at which |C'|² changes within half of a period by more than ``exact_step.v`` corrects."""
    begin, t = 0.0, np.linspace(0.0, 1.0, 257)
    for interval, _, metric, *_ in found:
        speeds = np.sqrt(metric(t))
        along = np.append(begin, begin + np.cumsum(speeds[1:] + speeds[:-1]) * t[1] / 2)
        first, last = np.searchsorted(places, along[[0, -1]], side="right")
        starts = np.maximum(places[first - 1 : last - 1], begin)
        now, moves, begin = np.interp(starts, along, t), places[first:last] - starts, along[-1]
        middle = np.minimum(now + moves / (2.0 * np.sqrt(metric(now))), 1.0)
        change = np.abs(metric(middle) / metric(now) - 1.0)
        if change.max(initial=0.0) > _UNSETTLED:
            u = np.interp(now[change.argmax()], [0.0, 1.0], interval)
            raise ValueError(
                f"the curve nearly stops at u = {u:.6g}: |C'| changes too much within the "
                f"{moves[change.argmax()]:.3g} mm of a period; take a shorter period, or plan a slower feed"
            )


def check_chain(curves, feed, most=0.0):
    """Refuse curves that do not meet, and a feed of another length."""
    for n, (a, b) in enumerate(pairwise(curves), 1):
        gap = np.abs(b(b.domain[0]) - a(a.domain[1])).max()
        if gap > most:
            raise ValueError(
                f"curves[{n}] begins {gap:.3g} mm from the end of curves[{n - 1}]: they must meet"
            )
    length = sum(curve.length() for curve in curves)
    if abs(feed.length - length) > 1e-6 * length:
        raise ValueError(
            f"feed covers {feed.length:.9g} mm, but the curves are {length:.9g} mm long: plan it on them"
        )


def _piece(interval, axes, metric, fastest, outputs, word, point_fraction, step_fraction):
    scale = int(np.frexp(fastest * 1.0000001)[1])  # |C'| is at most 2**scale
    bits = word - 5
    nodes, weights = legendre.leggauss(24)
    length = np.sqrt(metric((nodes + 1) / 2)) @ weights / 2
    coefficients = np.append(metric.coef * 4.0**-scale, np.zeros(4))[:5]
    shift = step_fraction + bits + scale - (word - 1) - T_GUARD
    if shift < 0:
        raise ValueError(
            f"curves hold a piece of {length:.2g} mm, too short beside what a period moves: leave it out"
        )
    return Piece(
        points=tuple(tuple(_words(np.append(x.coef, np.zeros(3))[:4], point_fraction)) for x in axes),
        metric=tuple(_words(coefficients, bits)),
        root=round(2.0**bits / np.sqrt(coefficients[0])),
        length=_words([length], step_fraction + S_GUARD)[0],
        shift=shift,
        interval=interval,
        outputs=outputs,
    )


def _words(values, bits):
    return [round(float(value) * 2.0**bits) for value in values]
