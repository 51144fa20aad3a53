"""Curves and surfaces through given points (paper Eq. 6 to 9; NURBS Book 9.2)."""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.nurbs import _kernels_band, knots
from nurbs_lab.nurbs.curve import CLOSED_WITHIN, NurbsCurve
from nurbs_lab.nurbs.surface import NurbsSurface

MISSED = 1e-6  # of the extent: a curve that swings so wildly is not one through its points
UNIT = 1e-6  # a tangent whose length differs from 1 by less is a direction


@one_or_many(ndim=2)
def interpolate_curve(
    points, degree=3, *, parametrization="chord", closed=False, parameters=None, tangents=None
):
    """The B-spline curve through the points.

    Parameters
    ----------
    points : array_like, shape (n, dim), or list of such arrays
        At least degree + 1, tangents counted, no two neighbours equal. Of a closed curve the first point may
        be given again as the last.
    degree : int
        1 to 9.
    parametrization : {"chord", "centripetal", "uniform", "foley", "universal"}
        How the parameter is spread over the points; the domain is [0, 1].
    closed : bool
        Run smoothly through the seam: degree - 1 continuous derivatives there as at every knot.
    parameters : array_like, optional
        Given parameters of the points, increasing, instead of a parametrisation; for a closed curve one
        more than there are different points, the last one being where the first point comes again.
    tangents : dict of int to array_like, optional
        By the index of a point of an open curve, negative ones from the end, a vector of shape (dim,): the
        tangent there. A unit vector is a direction, and |C'| is that of the polyline through the points
        beside it; a vector of another length is C' itself.

    Returns
    -------
    NurbsCurve, or list of NurbsCurve
        Clamped with averaged knots if open, with a periodic knot vector if closed.

    Raises
    ------
    TypeError, ValueError
        Too few or repeated points, parameters that do not increase, or another invalid argument.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> curve = nl.interpolate_curve([(0, 0), (3, 4), (6, 0), (9, 4)])
    >>> curve(1.0).tolist(), bool(curve.closest_point((3, 4))[1] < 1e-12)
    ([9.0, 4.0], True)
    """
    degree = checks.as_count("degree", degree, 1, 9)
    points = checks.as_points("points", points)
    closed = checks.as_flag("closed", closed)
    checks.as_choice("parametrization", parametrization, knots.PARAMETRIZATIONS)
    tangents = checks.as_kind("tangents", tangents or {}, dict)
    points, t = as_points_and_parameters(points, degree, parametrization, closed, parameters, len(tangents))
    uniform = parametrization == "universal" and parameters is None
    if tangents:
        solved = _with_tangents(degree, t, points, tangents, closed)
    else:
        solved = interpolate_values(degree, t, points, closed, uniform)
    curve = NurbsCurve(degree, *solved)
    require_met("points", degree, curve, curve(t[: len(points)]), points)
    return curve


@one_or_many(ndim=3)
def interpolate_surface(grid, degrees=(3, 3), *, parametrization="chord", closed=(False, False)):
    """The B-spline surface through a grid of points, by two passes of curve fitting (paper Eq. 6 to 9).

    Parameters
    ----------
    grid : array_like, shape (nu, nv, dim), or list of such arrays
        Rows and columns may collapse to one point (a pole). In a closed direction the first row may be
        given again as the last.
    degrees : (int, int)
        1 to 9 along u and v.
    parametrization : str
        As for `interpolate_curve`; parameters of all rows are averaged, collapsed rows left out (Eq. 7).
    closed : (bool, bool)
        Smooth seams along u, along v.

    Returns
    -------
    NurbsSurface, or list of NurbsSurface

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> hill = [[(x, y, x * (3 - x) * y) for y in range(5)] for x in range(4)]
    >>> surface = nl.interpolate_surface(hill)
    >>> surface.control_points.shape, surface(1.0, 1.0).round(9).tolist()
    ((4, 5, 3), [3.0, 4.0, 0.0])
    """
    degrees = checks.as_pair("degrees", degrees, checks.as_count, 1, 9)
    checks.as_choice("parametrization", parametrization, knots.PARAMETRIZATIONS)
    net, closed = as_grid(grid, degrees, closed)
    uniform, control, knot_vectors, fitted = parametrization == "universal", net, [], []
    for axis, degree in enumerate(degrees):
        t = surface_parameters(net.swapaxes(0, axis), axis, degree, parametrization, closed[axis])
        rows = np.ascontiguousarray(control.swapaxes(0, axis))
        flat = rows.reshape(len(rows), -1)
        vector, flat = interpolate_values(degree, t, flat, closed[axis], uniform)
        control = flat.reshape(-1, *rows.shape[1:]).swapaxes(0, axis)
        knot_vectors.append(vector)
        fitted.append(t[: len(rows)])
    surface = NurbsSurface(degrees, knot_vectors, control)
    require_met("grid", max(degrees), surface, surface.grid(*fitted), net)
    return surface


def require_met(name, degree, spline, there, points, cure="parametrization='centripetal'"):
    """Refuse a spline that swings so wildly that rounding keeps it from the points that it was made for."""
    away, rounding = checks.lengths(there - points).max(), 8 * np.spacing(np.abs(points).max())
    if away > rounding and away > MISSED * checks.extent(points):
        swings = f"swings up to {np.abs(spline.control_points).max():.3g} and misses them by {away:.3g}"
        raise ValueError(f"{name}: the spline of degree {degree} {swings}; take a lower degree, or {cure}")


def as_points_and_parameters(points, degree, parametrization, closed, given, more=0):
    """The checked points of a curve and their parameters; a closed curve has one parameter more.

    Besides the points the curve has to meet so many ``more`` conditions.
    """
    if closed:
        points = drop_repeated_end(points)
    if len(points) + (0 if parametrization == "universal" else more) <= degree:
        raise ValueError(f"points: degree {degree} needs at least {degree + 1} points, got {len(points)}")
    chords = require_distinct(points, closed)
    if given is not None:
        return points, checks.as_increasing("parameters", given, len(points) + closed, "points")
    if parametrization == "universal" and not closed:
        return points, knots.universal_parameters(degree, len(points))
    increments = chords if parametrization == "chord" else knots.steps(points, parametrization, closed)
    return points, knots.accumulate(increments, closed)


def as_grid(grid, degrees, closed):
    """The checked points without repeated seams, and both flags."""
    net = checks.as_floats("grid", grid, ("nu", "nv", "dim"))
    if 0 in net.shape:
        raise ValueError(f"grid must hold points, got shape {net.shape}")
    closed = checks.as_pair("closed", closed, checks.as_flag)
    for axis in (0, 1):
        if closed[axis]:
            net = drop_repeated_end(net.swapaxes(0, axis)).swapaxes(0, axis)
        if net.shape[axis] <= degrees[axis]:
            raise ValueError(
                f"grid: degree {degrees[axis]} along {'uv'[axis]} needs at least {degrees[axis] + 1} points, "
                f"got {net.shape[axis]}"
            )
    return net, closed


def surface_parameters(net, axis, degree, parametrization, closed):
    """Parameters along axis 0 of a net: the mean over all paths that do not collapse."""
    if parametrization == "universal" and not closed:
        return knots.universal_parameters(degree, len(net))
    increments = knots.steps(net, parametrization, closed)
    chords = (increments if parametrization == "chord" else knots.steps(net, "chord", closed)).sum(axis=0)
    alive = chords > 1e-12 * checks.extent(net)
    if not alive.any():
        raise ValueError(f"grid: all its points coincide along {'uv'[axis]}")
    increments = increments[:, alive]
    mean = (increments / increments.sum(axis=0)).mean(axis=1)
    if mean.min() <= knots.REPEATED_WITHIN:
        i = int(np.argmin(mean))
        raise ValueError(
            f"grid: rows {i} and {(i + 1) % len(net)} along {'uv'[axis]} coincide; drop one of them"
        )
    return knots.accumulate(mean, closed)


def interpolate_values(degree, t, values, closed, uniform=False):
    """Knots and control values of the spline through ``values (n, m)`` at the parameters t."""
    if closed:
        vector = knots.periodic_knots(degree, t)
        return vector, _kernels_band.solve_periodic(degree, vector, t[:-1], values)
    vector = knots.uniform_knots(degree, len(t)) if uniform else knots.averaged_knots(degree, t)
    control = values.copy()
    _kernels_band.solve_open(degree, vector, t, np.zeros(len(t), dtype=bool), control)
    return vector, control


def _with_tangents(degree, t, points, tangents, closed):
    """Knots and control points of an open curve with C' given at points whose parameters count twice."""
    if closed or degree < 2:
        raise ValueError("tangents: only open curves of degree 2 or more take them")
    count, rows = len(points), {}
    for index, vector in tangents.items():
        k = checks.as_count("an index of tangents", index, -count, count - 1) % count
        vector = checks.as_vector(f"tangents[{index}]", vector, points.shape[1])
        length, near = np.linalg.norm(vector), slice(max(k - 1, 0), k + 2)
        if not length > 0.0:
            raise ValueError(f"tangents[{index}] has no length, so no direction; leave it out")
        if k in rows:
            raise ValueError(f"tangents[{index}] is a second one of point {k}; give one")
        if abs(length - 1.0) < UNIT:
            vector = vector * (knots.steps(points[near], "chord", False).sum() / np.ptp(t[near]))
        rows[k] = vector
    given = np.sort(np.array(list(rows)))
    # the slope's row follows the value's, but at the end it comes before, which keeps the matrix a band
    order = np.sort(np.concatenate([np.arange(count), given]))
    slopes = np.append(False, order[1:] == order[:-1])
    control = points[order]
    control[slopes] = [rows[k] for k in given]
    if slopes[-1]:
        slopes[-2:], control[-2:] = [True, False], control[:-3:-1].copy()
    vector = knots.averaged_knots(degree, t[order])
    _kernels_band.solve_open(degree, vector, t[order], slopes, control)
    return vector, control


def drop_repeated_end(points):
    """Points without a last one (or row) that repeats the first."""
    gap = np.abs(points[-1] - points[0]).max(initial=0.0)
    return points[:-1] if len(points) > 1 and gap <= CLOSED_WITHIN * checks.extent(points) else points


def require_distinct(points, closed):
    """The distances of neighbours; neighbours that coincide are refused."""
    chords = knots.steps(points, "chord", closed)
    least = knots.REPEATED_WITHIN * chords.sum()
    if chords.min() <= least:
        near = chords <= least
        pairs = ", ".join(f"{i} and {(i + 1) % len(points)}" for i in np.flatnonzero(near)[:5])
        raise ValueError(f"points repeat their neighbour at indices {pairs}; drop one of each pair")
    return chords
