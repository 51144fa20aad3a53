"""Curves and surfaces near given points, with as few control points as a tolerance allows.

Least squares for a given number of control points (NURBS Book 9.4), and a search over that number; what
counts is the measured distance of the points to the result, not the residual at their parameters.
"""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.nurbs import _checks, _kernels_band, knots
from nurbs_lab.nurbs.curve import NurbsCurve
from nurbs_lab.nurbs.interpolate import (
    as_degrees,
    as_grid,
    drop_repeated_end,
    interpolate_values,
    require_distinct,
    surface_parameters,
)
from nurbs_lab.nurbs.surface import NurbsSurface

ENDS = ("fixed", "free")
SUSPECTS = 8  # farthest points tried first: one of them usually shows that a fit fails


@dataclass(frozen=True, eq=False)
class Fit:
    """A fit and what it reached."""

    spline: NurbsCurve | NurbsSurface
    #: Largest distance of a data point to the spline.
    deviation: float
    #: Root mean square of these distances.
    rms: float
    #: How many numbers of control points were tried.
    trials: int


def approximate_curve(
    points,
    degree=3,
    *,
    tolerance,
    closed=False,
    weights=None,
    ends="fixed",
    parametrization="chord",
    parameters=None,
):
    """The curve of few control points whose distance to every point is at most the tolerance.

    Parameters
    ----------
    points : array_like, shape (n, dim)
        At least degree + 1, no two neighbours equal.
    degree : int
        1 to 9.
    tolerance : float
        Largest distance allowed, in the unit of the points.
    closed : bool
        Periodic, with degree - 1 continuous derivatives at the seam.
    weights : array_like, shape (n,), optional
        Positive weights of the squared residuals.
    ends : {"fixed", "free"}
        Whether an open curve meets the first and the last point exactly.
    parametrization, parameters
        As for `interpolate_curve`.

    Returns
    -------
    NurbsCurve
        One control point less, spread the same way, misses the tolerance. `fit_curve` takes the same
        arguments and says what was reached.

    Raises
    ------
    ValueError
        If even the curve through all points misses the tolerance; the message says what it reached.
    """
    return fit_curve(
        points,
        degree,
        tolerance=tolerance,
        closed=closed,
        weights=weights,
        ends=ends,
        parametrization=parametrization,
        parameters=parameters,
    ).spline


def fit_curve(
    points,
    degree=3,
    *,
    tolerance,
    closed=False,
    weights=None,
    ends="fixed",
    parametrization="chord",
    parameters=None,
):
    """`approximate_curve` with its figures, as a `Fit`."""
    degree = _checks.as_count("degree", degree, 1, 9)
    points = _checks.as_points("points", points)
    tolerance = _checks.as_tolerance(tolerance)
    closed = _checks.as_flag("closed", closed)
    _checks.as_choice("parametrization", parametrization, knots.PARAMETRIZATIONS)
    _checks.as_choice("ends", ends, ENDS)
    weights = _checks.as_weights("weights", weights, (len(points),))
    if closed:
        points = drop_repeated_end(points)
        weights = weights[: len(points)]
    if len(points) <= degree:
        raise ValueError(f"points: degree {degree} needs at least {degree + 1} points, got {len(points)}")
    require_distinct(points, closed)
    if parameters is None:
        t = knots.accumulate(knots.steps(points, parametrization, closed), closed)
    else:
        t = _checks.as_increasing("parameters", parameters, len(points) + closed)

    def candidate(count):
        if count == len(points):
            return NurbsCurve(degree, *interpolate_values(degree, t, points, closed))
        return NurbsCurve(degree, *_least_squares(degree, t, points, weights, count, closed, ends == "fixed"))

    def reaches(curve):
        at_parameters = np.linalg.norm(curve(t[: len(points)]) - points, axis=1)
        if at_parameters.max() <= tolerance:
            return True
        suspects = points[np.argsort(at_parameters)[-SUSPECTS:]]
        return all(curve.closest_point(some)[1].max() <= tolerance for some in (suspects, points))

    count, curve, trials = _fewest(candidate, reaches, degree + 1, len(points))
    distance = curve.closest_point(points)[1]
    if distance.max() > tolerance:
        raise ValueError(
            f"tolerance = {tolerance} cannot be met: {count} control points, one per point, "
            f"reach {distance.max():.3g}"
        )
    return Fit(curve, float(distance.max()), float(np.sqrt(np.mean(distance**2))), trials)


def approximate_surface(grid, degrees=(3, 3), *, tolerance, closed=(False, False), parametrization="chord"):
    """The surface of few control points whose distance to every grid point is at most the tolerance.

    Arguments as for `interpolate_surface`; the outermost rows of an open direction are fitted alone, so
    that edges and poles stay where they are. `fit_surface` says what was reached.
    """
    return fit_surface(
        grid, degrees, tolerance=tolerance, closed=closed, parametrization=parametrization
    ).spline


def fit_surface(grid, degrees=(3, 3), *, tolerance, closed=(False, False), parametrization="chord"):
    """`approximate_surface` with its figures, as a `Fit`."""
    degrees = as_degrees(degrees)
    tolerance = _checks.as_tolerance(tolerance)
    _checks.as_choice("parametrization", parametrization, knots.PARAMETRIZATIONS)
    net, closed = as_grid(grid, degrees, closed)
    sides = [_Side(net, axis, degrees[axis], closed[axis], parametrization) for axis in (0, 1)]
    points = net.reshape(-1, net.shape[2])
    trials = 0
    for share in (0.8, 0.4, 0.2, 0.1, 0.0):
        counts = []
        for side in sides:
            count, _, tried = _fewest(
                side.alone, lambda error, s=share: error <= s * tolerance, side.degree + 1, len(side.rows)
            )
            counts.append(count)
            trials += tried
        control, vectors = net, []
        for side, count in zip(sides, counts, strict=True):
            vector, control = side.fit(control, count)
            vectors.append(vector)
        surface = NurbsSurface(degrees, vectors, control)
        at_parameters = surface.grid(*(side.parameters[: len(side.rows)] for side in sides)) - net
        if np.linalg.norm(at_parameters, axis=-1).max() <= tolerance or share == 0.0:
            distance = surface.closest_point(points)[1]
            if distance.max() <= tolerance:
                return Fit(surface, float(distance.max()), float(np.sqrt(np.mean(distance**2))), trials)
    raise ValueError(
        f"tolerance = {tolerance} cannot be met: {counts[0]} x {counts[1]} control points, one per point, "
        f"reach {distance.max():.3g}"
    )


class _Side:
    """One direction of a surface fit: all its paths at once, as rows of one curve fit."""

    def __init__(self, net, axis, degree, closed, parametrization):
        self.axis, self.degree, self.closed = axis, degree, closed
        self.parameters = surface_parameters(net.swapaxes(0, axis), axis, degree, parametrization, closed)
        self.width = net.shape[2]
        self.rows = self._flat(net)

    def _flat(self, net):
        rows = np.ascontiguousarray(net.swapaxes(0, self.axis))
        return rows.reshape(len(rows), -1)

    def _solve(self, rows, count):
        if count == len(rows):
            return interpolate_values(self.degree, self.parameters, rows, self.closed)
        even = np.ones(len(rows))
        return _least_squares(self.degree, self.parameters, rows, even, count, self.closed, True)

    def alone(self, count):
        """Largest residual if only this direction is fitted."""
        vector, control = self._solve(self.rows, count)
        spline = NurbsCurve(self.degree, vector, control)
        residual = spline(self.parameters[: len(self.rows)]) - self.rows
        return np.linalg.norm(residual.reshape(len(residual), -1, self.width), axis=-1).max()

    def fit(self, net, count):
        """Knots, and the net with this direction's points replaced by control points."""
        vector, control = self._solve(self._flat(net), count)
        other = net.shape[1 - self.axis]
        return vector, control.reshape(len(control), other, self.width).swapaxes(0, self.axis)


def _least_squares(degree, t, values, weights, count, closed, fixed):
    """Knots and control values of the least-squares spline with ``count`` different control points."""
    vector = knots.spread_knots(degree, t, count, closed)
    if closed:
        return vector, _kernels_band.fit_periodic(degree, vector, t[:-1].copy(), values, weights)
    return vector, _kernels_band.fit_open(degree, vector, t, values, weights, fixed)


def _fewest(candidate, good, least, most):
    """Smallest good count by doubling, then halving the gap: (count, candidate, trials); ``most`` if none."""
    trials, failed, count = 0, least - 1, least
    while True:
        trial = candidate(count)
        trials += 1
        if count == most or good(trial):
            break
        failed, count = count, min(2 * count, most)
    while count - failed > 1:
        middle = (count + failed) // 2
        other = candidate(middle)
        trials += 1
        if good(other):
            count, trial = middle, other
        else:
            failed = middle
    return count, trial, trials
