"""Approximation of points within a tolerance by curves with few control points.

Least squares gives the spline for a given number of control points (NURBS Book 9.4), and a search finds the
number. The measured distance of the points to the result decides, not the residual at their parameters. Knots
move to where the errors are until all spans have similar errors (compare de Boor, *A Practical Guide to
Splines*, XII); knots that a curve does not need are then removed.
"""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.progress import interruptible
from nurbs_lab.nurbs import _kernels_band, knots
from nurbs_lab.nurbs.curve import NurbsCurve
from nurbs_lab.nurbs.interpolate import as_points_and_parameters, interpolate_values
from nurbs_lab.nurbs.spans import find_breaks

SUSPECTS = 8  # points with the largest residuals that are tested first; one of them usually rejects a fit
IDLE = 3  # moves of the knots in a row that save no control point are the last
QUIET = 0.05  # of the largest error; the error of a span counts as at least this much


@one_or_many(ndim=2)
@interruptible()
def approximate_curve(points, degree=3, *, tolerance, closed=False):
    """A curve with few control points whose distance to every point is at most the tolerance.

    Parameters
    ----------
    points : array_like, shape (n, dim), or list of such arrays
        At least degree + 1, no two neighbours equal.
    degree : int
        1 to 9.
    tolerance : float
        Largest distance allowed, in the unit of the points.
    closed : bool
        Periodic, with degree - 1 continuous derivatives at the seam. An open curve meets the first and the
        last point.

    Returns
    -------
    NurbsCurve, or list of NurbsCurve
        No further knot can be removed by the rule of least jumps without missing the tolerance.

    Raises
    ------
    ValueError
        If even the curve through all points misses the tolerance; the message says what it reached.

    Examples
    --------
    >>> import numpy as np
    >>> import nurbs_lab as nl
    >>> angle = np.linspace(0.0, 6.0, 500)
    >>> curve = nl.approximate_curve(np.column_stack([np.cos(angle), np.sin(angle)]), tolerance=1e-3)
    >>> len(curve.control_points)
    10
    """
    degree = checks.as_count("degree", degree, 1, 9)
    points = checks.as_points("points", points)
    tolerance = checks.as_not_negative("tolerance", tolerance)
    closed = checks.as_flag("closed", closed)
    points, t = as_points_and_parameters(points, degree, "chord", closed, None)
    data = degree, t, points, closed

    def fit(count, density):
        return _spline(*data, count, density)

    def errors(curve):
        return checks.lengths(curve(t[: len(points)]) - points)

    def reaches(curve, error):
        outside = np.argsort(error)[np.count_nonzero(error <= tolerance) :]
        parts = outside[-SUSPECTS:], outside[:-SUSPECTS]
        return all(curve.closest_point(points[part])[1].max() <= tolerance for part in parts if part.size)

    def works(curve):
        return reaches(curve, errors(curve))

    def on_breaks(breaks):
        return _least_squares(*data, knots.around(breaks, degree, closed))

    count, curve = _fewest(fit, errors, reaches, t, degree + 1)
    if works(curve):
        curve = _pruned(curve, on_breaks, works, degree if closed else 0)
    distance = np.minimum(curve.closest_point(points)[1], errors(curve))  # apart from rounding
    if distance.max() > tolerance:
        raise ValueError(
            f"tolerance = {tolerance} cannot be met: {count} control points, one per point, "
            f"reach {distance.max():.3g}"
        )
    return curve


def _spline(degree, t, values, closed, count, density):
    """The least-squares spline with ``count`` control points; as many as values interpolate them."""
    if count == len(values):
        return NurbsCurve(degree, *interpolate_values(degree, t, values, closed))
    vector = knots.spread_knots(degree, t, count, closed, density)
    return _least_squares(degree, t, values, closed, vector)


def _least_squares(degree, t, values, closed, vector):
    """The least-squares spline over given knots."""
    if closed:
        control = _kernels_band.fit_periodic(degree, vector, t[:-1].copy(), values)
    else:
        control = _kernels_band.fit_open(degree, vector, t, values, np.ones(t.size))
    return NurbsCurve(degree, vector, control)


def _fewest(fit, errors, good, t, least):
    """The accepted spline with the fewest control points found: (count, spline).

    The number is doubled until a spline is accepted, and the gap to the last rejected number is halved; the
    knots follow the errors of the last spline. Then knots are moved for as long as that saves control points.
    A spline with one control point for each point is always accepted, so there is an end.
    """
    last, best, failed = None, None, least - 1

    def works(count, density):
        nonlocal last, best, failed
        spline = fit(count, density)
        error = errors(spline)
        last = spline, error
        if count == len(error) or good(spline, error):
            best = count, spline
            return True
        failed = count
        return False

    def close_gap(density):
        while best[0] - failed > 1:
            works((best[0] + failed) // 2, density)

    count, density = least, None
    while not works(count, density):
        count = min(2 * count, len(last[1]))
        density = _density(*last, t)
    close_gap(density)
    idle = 0
    while idle < IDLE and best[0] > least:
        before, failed, saving = best[0], least - 1, 1
        density = _density(*last, t)
        while best[0] > least and works(max(best[0] - saving, least), density):
            saving *= 2
        close_gap(density)
        idle = idle + 1 if best[0] == before else 0
    return best


def _pruned(spline, fit, good, least):
    """The accepted spline without the knots that it does not need.

    Knots at which the highest derivative jumps least are removed first: half of all inner knots at once, or
    half as many if that is rejected, and so on. At least ``least`` stay. A trial removes knots or halves
    their number, so there are fewer trials than knots and halvings together.
    """
    breaks = find_breaks(spline.knots, spline.degree)
    size = len(breaks)
    while size := min(size, len(breaks) - 2 - least):
        order = np.argsort(_jumps(spline, breaks))
        fewer = np.delete(breaks, 1 + order[:size])
        if good(trial := fit(fewer)):
            spline, breaks = trial, fewer
        else:
            size //= 2
    return spline


def _jumps(spline, breaks):
    """The jump of derivative p at each inner knot, scaled to a distance."""
    control, vector = spline.control_points, spline.knots
    for degree in range(spline.degree, 0, -1):
        control = np.diff(control, axis=0) / (vector[degree + 1 : -1] - vector[1 : -degree - 1])[:, None]
        vector = vector[1:-1]
    return checks.lengths(np.diff(control, axis=0)) * (breaks[2:] - breaks[:-2]) ** spline.degree


def _density(spline, error, t):
    """Knots that each step of t should get so that all spans of a spline of order p + 1 have equal errors."""
    if not error.max() > 0.0:
        return None
    ends = find_breaks(spline.knots, spline.degree)
    span = np.searchsorted(ends[1:-1], t, side="right")
    largest = np.full(len(ends) - 1, QUIET * error.max())
    np.maximum.at(largest, span[: len(error)], error)
    steps = np.diff(t)
    middle = np.searchsorted(ends[1:-1], t[:-1] + 0.5 * steps)
    return ((largest / error.max()) ** (1 / (spline.degree + 1)) / np.diff(ends))[middle] * steps
