"""What rtl/cu.v is loaded with, its twin bit for bit, and how far C(u) can be from the exact curve.

Bad curves stop here, with a reason.
"""

from bisect import bisect_right
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from nurbs_lab.common.checks import as_floats, as_integer, as_kind, as_parameters
from nurbs_lab.hardware.arithmetic import SHIPPED, Format, divide, round_shift
from nurbs_lab.nurbs import NurbsCurve

#: Of the degree, the control points, the largest weight over the smallest, and the power of two in the
#: reciprocal of a knot difference.
MOST_DEGREE, MOST_POINTS, MOST_WEIGHT, MOST_EXPONENT = 5, 64, 1024, 15
#: Load spaces of rtl/cu.v.
KNOTS, RECIPROCALS, POINTS, SHAPE = range(4)


@dataclass(frozen=True)
class LoadedCurve:
    """A curve in the integers of one format.

    A parameter is ``knot_origin + knot_scale * u / 2**format.fraction``, from ``first_u`` to ``last_u``, and
    a coordinate ``x / 2**point_fraction``.
    """

    format: Format
    degree: int
    dim: int
    rational: bool
    knots: tuple
    #: ``(level, index) -> (exponent, mantissa)`` of ``1 / (knots[index + level] - knots[index])``.
    reciprocals: dict
    #: Homogeneous control points, the weight last.
    points: tuple
    first_u: int
    last_u: int
    point_fraction: int
    knot_origin: float
    knot_scale: float

    def to_u(self, u) -> np.ndarray:
        """Parameters of the curve as integers, to nearest."""
        u = as_parameters("u", u, (self.knot_origin, self.knot_origin + self.knot_scale))
        unit = (u - self.knot_origin) / self.knot_scale
        return np.rint(np.ldexp(unit, self.format.fraction)).astype(np.int64)

    def from_u(self, u) -> np.ndarray:
        """Parameters of the curve from integers."""
        unit = np.ldexp(as_floats("u", u), -self.format.fraction)
        return self.knot_origin + self.knot_scale * unit

    def from_points(self, points) -> np.ndarray:
        """Coordinates from integers."""
        return np.ldexp(as_floats("points", points), -self.point_fraction)

    def writes(self) -> list[tuple[int, int, int]]:
        """What to put on the load bus: ``(space, index, data)``."""
        bits = self.format.word - 1
        found = [(KNOTS, i, knot) for i, knot in enumerate(self.knots)]
        found += [
            (RECIPROCALS, (level - 1) << 7 | i, exponent << bits | mantissa)
            for (level, i), (exponent, mantissa) in self.reciprocals.items()
        ]
        for i, (*xyz, weight) in enumerate(self.points):
            found += [(POINTS, i << 2 | axis, x) for axis, x in enumerate(xyz)]
            found.append((POINTS, i << 2 | 3, weight))
        shape = self.rational << 10 | (len(self.points) - 1) << 3 | self.degree
        return [*found, (SHAPE, 0, shape), (SHAPE, 1, self.first_u), (SHAPE, 2, self.last_u)]


def load_curve(curve, format: Format = SHIPPED) -> LoadedCurve:
    """Translate a curve for the hardware.

    The whole knot range becomes 0 to 1, weights are divided by the largest, and the binary point of
    the coordinates is put where the largest of them just fits.

    Parameters
    ----------
    curve : NurbsCurve
        Degree 1 to 5, plane or space, at most 64 control points.
    format : Format, optional

    Raises
    ------
    TypeError, ValueError
        If the curve breaks a limit of the hardware; the message names the limit and the cure.
    """
    as_kind("curve", curve, NurbsCurve)
    as_kind("format", format, Format)
    points, knots = curve.control_points, curve.knots
    _check(curve)
    weights = curve.weights / curve.weights.max()
    homogeneous = points * weights[:, None]
    # Rounding can never pass the largest word: 8 units are kept free, and more where a small weight divides.
    spare = 1 + 2.0 ** (3 - format.word) / weights.min()
    integer_bits = int(np.frexp(max(np.abs(points).max(), 2.0**-60) * spare)[1])
    point_fraction = format.word - 1 - integer_bits

    scale = knots[-1] - knots[0]
    knot_words = np.rint(np.ldexp((knots - knots[0]) / scale, format.fraction)).astype(np.int64).tolist()
    degree, last = curve.degree, len(points) - 1
    reciprocals = {
        (level, i): _reciprocal(knot_words[i + level] - knot_words[i], format)
        for level in range(1, degree + 1)
        for i in range(degree + 1 - level, last + 1)
        if knot_words[i + level] > knot_words[i]
    }
    words = np.rint(np.ldexp(homogeneous, point_fraction)).astype(np.int64)
    weight_words = np.rint(np.ldexp(weights, format.fraction)).astype(np.int64)
    return LoadedCurve(
        format=format,
        degree=degree,
        dim=points.shape[1],
        rational=curve.rational,
        knots=tuple(knot_words),
        reciprocals=reciprocals,
        points=tuple(map(tuple, np.column_stack([words, weight_words]).tolist())),
        first_u=knot_words[degree],
        last_u=knot_words[last + 1],
        point_fraction=point_fraction,
        knot_origin=float(knots[0]),
        knot_scale=float(scale),
    )


def _reciprocal(difference: int, format: Format) -> tuple[int, int]:
    """Exponent and mantissa of ``2**fraction / difference``, the mantissa to nearest."""
    exponent = format.fraction - (difference - 1).bit_length()
    mantissa = round(Fraction(1 << (2 * format.fraction - exponent), difference))
    return exponent, mantissa


def _check(curve):
    count, weights = len(curve.control_points), curve.weights
    if curve.degree > MOST_DEGREE:
        raise ValueError(f"the hardware takes degree 1 to {MOST_DEGREE}, the curve has {curve.degree}")
    if curve.dim not in (2, 3):
        raise ValueError(f"the hardware takes curves in 2 or 3 dimensions, this one has {curve.dim}")
    if count > MOST_POINTS:
        raise ValueError(
            f"the hardware holds {MOST_POINTS} control points, the curve has {count}: "
            "split it, or approximate it with fewer"
        )
    if weights.min() * MOST_WEIGHT < weights.max():
        raise ValueError(
            f"weights may differ by a factor of at most {MOST_WEIGHT}, but these go from "
            f"{weights.min()} to {weights.max()}: the division by the weight would lose too many digits"
        )
    ends = curve.knots[[curve.degree, curve.degree + 1, count - 1, count]]
    if ends[0] == ends[1] or ends[2] == ends[3]:
        raise ValueError("the first or the last span of the curve is empty: split it into its beziers")
    # The recurrence uses all knots but the outermost two.
    used = curve.knots[1:-1] if curve.degree > 1 else curve.knots
    spans = np.diff(used) / (curve.knots[-1] - curve.knots[0])
    shortest = spans[spans > 0].min()
    if shortest < 2.0**-MOST_EXPONENT:
        raise ValueError(
            f"knot spans must be at least 1/{2**MOST_EXPONENT} of the knot range, the shortest is "
            f"{shortest:.3g} of it: remove the knot or split the curve"
        )


class Evaluation(NamedTuple):
    """What ``cu`` answers."""

    point: tuple
    out_of_range: bool = False
    overflow: bool = False
    by_zero: bool = False


def evaluate_cu(loaded: LoadedCurve, u: int) -> Evaluation:
    """C(u) in integers.

    Parameters
    ----------
    loaded : LoadedCurve
    u : int
        Parameter with ``loaded.format.fraction`` fraction bits.
    """
    as_kind("loaded", loaded, LoadedCurve)
    u = as_integer("u", u)
    inside = min(max(u, loaded.first_u), loaded.last_u)
    degree, fraction = loaded.degree, loaded.format.fraction
    last = len(loaded.points) - 1
    span = bisect_right(loaded.knots, inside, degree + 1, last + 1) - 1

    basis = _basis(loaded, span, inside)
    rows = loaded.points[span - degree : span + 1]
    sums = [round_shift(sum(map(int.__mul__, basis, column)), fraction) for column in zip(*rows, strict=True)]
    *point, weight = sums
    if not loaded.rational:
        return Evaluation(tuple(point), u != inside)
    quotients, overflow, by_zero = zip(
        *(divide(x << fraction, weight, loaded.format.word) for x in point), strict=True
    )
    return Evaluation(quotients, u != inside, any(overflow), any(by_zero))


def _basis(loaded, span, u):
    """The degree + 1 functions N that are not zero, which add up to exactly 1 (Cox-de Boor)."""
    fraction = loaded.format.fraction
    basis = [loaded.format.one]
    for level in range(1, loaded.degree + 1):
        carried = 0
        for r, n in enumerate(basis):
            index = span + 1 - level + r
            exponent, mantissa = loaded.reciprocals[level, index]
            ratio = round_shift((u - loaded.knots[index] << exponent) * mantissa, fraction)
            product = round_shift(n * ratio, fraction)
            basis[r] = carried + n - product
            carried = product
        basis.append(carried)
    return basis


def cu_error_bound(curve, loaded: LoadedCurve) -> np.ndarray:
    """Largest error of a coordinate of C(u), in mm, for any u of the format.

    The roundings are counted level by level of the recurrence of the basis functions N, as if all later
    levels were exact. Moving a fraction s of an N at level l to its neighbour then moves the point by
    ``s (b - a)``, where a and b are neighbouring points in de Boor's triangle. They are at most ``D q``
    apart. Here D is the knot difference by which this N is divided, and q is the largest step between control
    points of the span, each divided by the p knot spans that it covers. With ``e = 2**-fraction``, the last
    place of u:

    - Rounding both knots, by e / 2 each, moves the ratio (u - knot) / D by at most e / (2 D): their
      errors enter with weights that add up to 1. D cancels: ``e q / 2`` a level.
    - The reciprocal and the ratio are rounded by e / 2 each. As the N add up to 1: ``e q max D`` a level.
    - The products themselves are rounded by e / 2: ``e q / 2`` times the sum of the D of the level.
    - The effect of these errors on one another is of second order. It is the factor ``(1 + doubt)**2``, where
      doubt is the amount by which the absolute values of the N may add up to more than 1.
    - Rounding the control points and the sum adds one last place, of a coordinate or of the weight.
    - With weights, the point moves by (error of numerator - C error of W) / W. Coordinates are counted
      from the middle of the span's control points, where |C| is at most half of their spread; the last
      place of the weight alone meets |C| as it is. The division adds half a last place.

    Parameters
    ----------
    curve : NurbsCurve
    loaded : LoadedCurve
        The same curve, from ``load_curve``.

    Returns
    -------
    numpy.ndarray, shape (dim,)
        Infinite where a knot difference is no more than a last place of u.
    """
    as_kind("curve", curve, NurbsCurve)
    as_kind("loaded", loaded, LoadedCurve)
    place = 2.0**-loaded.format.fraction
    unit = 2.0**-loaded.point_fraction
    degree, knots = curve.degree, (curve.knots - loaded.knot_origin) / loaded.knot_scale
    weights = curve.weights / curve.weights.max()
    worst = np.zeros(curve.dim)
    for span in range(degree, len(curve.control_points)):
        if knots[span] == knots[span + 1]:
            continue
        points, weight = (rows[span - degree : span + 1] for rows in (curve.control_points, weights))
        spread = np.ptp(points, axis=0) / 2
        rows = np.column_stack([weight[:, None] * (points - points.min(axis=0) - spread), weight])
        after = span + 1  # apart: the knot differences that each level of the recurrence divides by
        apart = [knots[after : after + n] - knots[after - n : after] for n in range(1, degree + 1)]
        if min(d.min() for d in apart) <= place:
            return np.full(curve.dim, np.inf)
        slope = (np.abs(np.diff(rows, axis=0)) / apart[-1][:, None]).max(axis=0)
        moved = sum(place * (0.5 + d.max() + 0.5 * d.sum()) for d in apart)
        doubt = sum(place * (2 + 1 / (d.min() - place) + len(d)) for d in apart)
        *error, of_weight = moved * slope * (1 + doubt) ** 2
        found = np.add(error, unit)
        if loaded.rational:
            found += spread * of_weight + np.abs(points).max(axis=0) * place
            found = found / (weight.min() - of_weight - place) + unit / 2
        worst = np.maximum(worst, found)
    return worst
