"""A cubic spline along a polyline, fast enough for programs of a million points."""

import numpy as np

from nurbs_lab.common.checks import freeze, lengths
from nurbs_lab.nurbs import _kernels_along
from nurbs_lab.nurbs.curve import NurbsCurve, trusted_curve


def lengths_along(points) -> np.ndarray:
    """Length of a polyline up to each of its points: the parameters of `spline_along`."""
    return np.concatenate([[0.0], np.cumsum(lengths(np.diff(points, axis=0)))])


def points_along(points, at) -> np.ndarray:
    """Points of a polyline at lengths ``at (m,)`` along it, ``(m, dim)``."""
    length = lengths_along(points)
    return np.column_stack([np.interp(at, length, column) for column in points.T])


def spline_along(points, tolerance) -> NurbsCurve:
    """The cubic spline nearest to a polyline, with as few knots as keep the tolerance at its points.

    It begins and ends at those of the polyline, has continuous curvature, and its parameter is nearly the
    length. The time grows in proportion to the number of points; `approximate_curve` takes longer and finds
    fewer control points.

    Parameters
    ----------
    points : (n, dim) array
        At least two, no two neighbours equal.
    tolerance : float
        Largest distance of the spline at the parameter of a point from the segments beside it. A span between
        two neighbouring points is not split further.
    """
    points = np.ascontiguousarray(points, dtype=float)
    if len(points) == 2:  # fewer than the control points of a cubic
        points = np.linspace(*points, 4)
    ends, steps = np.zeros(len(points), bool), np.ones(len(points) - 1, bool)
    ends[[0, -1]] = True
    return _along(points, tolerance, ends, points[[0, 0, -1, -1]], steps)[0]


def spline_changed(curve, points, new, tolerance):
    """The curve by `spline_along`, changed for the points that are ``new (n,)``, and no more than nearby.

    Returns
    -------
    curve : NurbsCurve
    changed : (n - 1,) bool array
        The steps of the polyline on which it is not the curve as it was, but for its parameter.
    """
    old, kept = np.flatnonzero(~new), np.zeros(len(points), bool)
    kept[old[np.searchsorted(lengths_along(points[old]), (1.0 - 1e-12) * curve.knots[3:-3])]] = True
    return _along(points, tolerance, kept, curve.control_points, new[1:] | new[:-1])


def _along(points, tolerance, kept, control, changed):
    control = freeze(control[:])  # as a curve's, so that the kernel is compiled once
    rows = _kernels_along.along(lengths_along(points), points, tolerance, kept, control, changed)
    return trusted_curve(3, *rows[:2]), rows[2]
