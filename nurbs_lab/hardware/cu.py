"""Twin of rtl/cu.v: the point C(u), bit for bit, and how far it can be from the exact curve."""

from bisect import bisect_right
from typing import NamedTuple

import numpy as np

from nurbs_lab.common.checks import as_integer, as_kind
from nurbs_lab.hardware.arithmetic import divide, round_shift
from nurbs_lab.hardware.loader import LoadedCurve
from nurbs_lab.nurbs import NurbsCurve


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
        apart = [_differences(knots, span, level) for level in range(1, degree + 1)]
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


def _differences(knots, span, level):
    """The knot differences that a level of the recurrence divides by."""
    starts = np.arange(span + 1 - level, span + 1)
    return knots[starts + level] - knots[starts]
