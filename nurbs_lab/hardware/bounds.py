"""How far the twin of ``cu`` can be from the exact curve: a bound derived from its roundings."""

import numpy as np

from nurbs_lab.hardware.loader import LoadedCurve


def cu_error_bound(curve, loaded: LoadedCurve) -> np.ndarray:
    """Largest error of a coordinate of C(u), in mm, for any u of the format.

    With ``e = 2**-fraction``, the last place of u, and D the shortest knot difference that a level of the
    recurrence divides by:

    - A ratio (u - knot) / D is off by 3/2 e / D from rounding the knots, e / 2 from the reciprocal and
      e / 2 from its own rounding.
    - Level j splits each N in two, so its errors count twice; the sizes of the errors of all N together
      grow by ``2 (ratio error) + j e``.
    - The N add up to exactly 1, so their errors cancel but for the spread of the p + 1 control points that
      meet: half of the errors times that spread. Rounding the control points and the sum adds one last
      place of a coordinate.
    - The division by the weight W turns the errors of numerator x and weight into
      ``(error of x + |C| error of W) / W``, and adds half a last place.

    Parameters
    ----------
    curve : NurbsCurve
    loaded : LoadedCurve
        The same curve, from ``load``.
    """
    place = 2.0**-loaded.format.fraction
    unit = 2.0**-loaded.point_fraction
    degree, knots = curve.degree, (curve.knots - loaded.knot_origin) / loaded.knot_scale
    homogeneous = curve.homogeneous / curve.weights.max()
    largest = np.abs(curve.control_points).max(axis=0)
    worst = np.zeros(curve.dim)
    for span in range(degree, len(curve.control_points)):
        if knots[span] == knots[span + 1]:
            continue
        basis = 0.0
        for level in range(1, degree + 1):
            starts = np.arange(span + 1 - level, span + 1)
            shortest = (knots[starts + level] - knots[starts]).min() - place
            basis += 2 * place * (1 + 1.5 / shortest) + level * place
        rows = homogeneous[span - degree : span + 1]
        spread = 0.5 * basis * np.ptp(rows, axis=0)
        error = spread[:-1] + unit
        if loaded.rational:
            weight = spread[-1] + place
            error = (error + largest * weight) / (rows[:, -1].min() - weight) + unit / 2
        worst = np.maximum(worst, error)
    return worst
