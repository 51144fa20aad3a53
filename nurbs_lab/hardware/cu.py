"""Twin of rtl/cu.v: the point C(u), bit for bit."""

from bisect import bisect_right
from typing import NamedTuple

from nurbs_lab.common.checks import as_integer, as_kind
from nurbs_lab.hardware.arithmetic import divide, round_shift
from nurbs_lab.hardware.loader import LoadedCurve


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
