"""A NURBS curve as the integers that the hardware loads; bad curves stop here, with a reason."""

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind, as_parameters
from nurbs_lab.hardware.formats import SHIPPED, Format
from nurbs_lab.nurbs import NurbsCurve

#: Load spaces of rtl/cu.v.
KNOTS, RECIPROCALS, POINTS, SHAPE = range(4)


@dataclass(frozen=True)
class LoadedCurve:
    """A curve in the integers of one format.

    A parameter is ``knot_origin + knot_scale * u / 2**format.fraction``,
    a coordinate ``x / 2**point_fraction``.

    Attributes
    ----------
    knots : tuple of int
    reciprocals : dict
        ``(level, index) -> (exponent, mantissa)`` of ``1 / (knots[index + level] - knots[index])``.
    points : tuple of tuple of int
        Homogeneous control points, the weight last.
    first_u, last_u : int
        Ends of the domain.
    """

    format: Format
    degree: int
    dim: int
    rational: bool
    knots: tuple
    reciprocals: dict
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
    _check(curve, format)
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


def _check(curve, format):
    count, weights = len(curve.control_points), curve.weights
    if curve.degree > format.max_degree:
        raise ValueError(f"the hardware takes degree 1 to {format.max_degree}, the curve has {curve.degree}")
    if curve.dim not in (2, 3):
        raise ValueError(f"the hardware takes curves in 2 or 3 dimensions, this one has {curve.dim}")
    if count > format.max_points:
        raise ValueError(
            f"the hardware holds {format.max_points} control points, the curve has {count}: "
            "split it, or approximate it with fewer"
        )
    if weights.min() * format.max_weight_ratio < weights.max():
        raise ValueError(
            f"weights may differ by a factor of at most {format.max_weight_ratio}, but these go from "
            f"{weights.min()} to {weights.max()}: the division by the weight would lose too many digits"
        )
    ends = curve.knots[[curve.degree, curve.degree + 1, count - 1, count]]
    if ends[0] == ends[1] or ends[2] == ends[3]:
        raise ValueError("the first or the last span of the curve is empty: split it into its beziers")
    # The recurrence uses all knots but the outermost two.
    used = curve.knots[1:-1] if curve.degree > 1 else curve.knots
    spans = np.diff(used) / (curve.knots[-1] - curve.knots[0])
    shortest = spans[spans > 0].min()
    if shortest < 2.0**-format.max_exponent:
        raise ValueError(
            f"knot spans must be at least 1/{2**format.max_exponent} of the knot range, the shortest is "
            f"{shortest:.3g} of it: remove the knot or split the curve"
        )
