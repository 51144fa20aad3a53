"""Curves in the plane: control polygon, knots, curvature comb, points."""

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.nurbs.spans import find_breaks, span_parameters
from nurbs_lab.plotting.style import BLACK, BLUE, GREEN, GREY, ORANGE, RED, canvas, equal_mm, takes_axes

SAMPLES = 1000  # of a curve, evenly in u
PER_SPAN = 16  # of them, at least, so that short spans stay round in an enlargement


@takes_axes
def curve(
    curve, *, control_polygon=True, knots=True, comb=False, points=None, label=None, window=None, ax=None
):
    """A curve with its control polygon, knots, curvature comb and data points.

    Parameters
    ----------
    curve : NurbsCurve
        Drawn are x and y.
    control_polygon, knots : bool
        Draw the control points and the points of the curve at its knots.
    comb : bool
        Draw the curvature comb: teeth along the normal, as long as the curvature, the longest a
        tenth of the picture.
    points : array_like, shape (n, dim), optional
        Data points to show beside it.
    label : str, optional
        In the legend.
    window : pair of pairs, optional
        Least and greatest coordinate of the picture in both directions, which keeps the frames of a moving
        picture alike.
    """
    if curve.dim < 2:
        raise ValueError("curve is 1-D and has no y: draw its coordinate over u by ax.plot(u, curve(u))")
    even = np.linspace(*curve.domain, SAMPLES)
    u = np.union1d(even, span_parameters(curve.knots, curve.degree, PER_SPAN))
    low, high = curve.domain
    path = curve(u)[:, :2]
    with canvas(7, 4.2, ax) as (figure, ax):
        if comb:
            slope = curve.derivative(even)
            moving = lengths(slope) > 1e-9 * np.ptp(curve.control_points) / (high - low)
            inner = even[moving]  # C' vanishes at a double end point, where the curvature has no value
            _comb(ax, curve(inner)[:, :2], slope[moving, :2], curve.curvature(inner))
        ax.plot(
            *path.T, color=BLUE, linestyle="-", linewidth=2, label=label or f"curve, degree {curve.degree}"
        )
        if control_polygon:
            polygon, degree = curve.control_points[:, :2], curve.degree
            if np.array_equal(polygon[:degree], polygon[-degree:]):  # closed: they come again
                polygon = polygon[: len(polygon) - degree + 1]
            ax.plot(*polygon.T, "o--", color=GREY, linewidth=1, label="control polygon", zorder=1)
        if knots:
            inner = find_breaks(curve.knots, curve.degree)
            size = 5 if len(inner) <= 40 else 2
            ax.plot(*curve(inner)[:, :2].T, "D", color=RED, markersize=size, label="knots", zorder=4)
        if points is not None:
            size = 4 if len(points) > 60 else 8
            ax.plot(*np.asarray(points)[:, :2].T, ".", color=BLACK, markersize=size, label="points")
        equal_mm(ax)
        if window is not None:
            ax.set(xlim=window[0], ylim=window[1], adjustable="box")
        ax.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=4, borderaxespad=0.2)
    return figure


@takes_axes
def basis(curve, *, ax=None):
    """The basis functions N_i(u) of a curve, its knots as ticks.

    Parameters
    ----------
    curve : NurbsCurve
    """
    u = np.linspace(*curve.domain, SAMPLES)
    count = len(curve.control_points)
    unit = type(curve)(curve.degree, curve.knots, np.eye(count), curve.weights)
    with canvas(7, 2.8, ax) as (figure, ax):
        for i, values in enumerate(unit(u).T):
            (line,) = ax.plot(u, values)
            peak = values.argmax()
            ax.annotate(
                f"$N_{{{i}}}$", (u[peak], values[peak]), (0, 3), textcoords="offset points",
                ha="center", color=line.get_color(),
            )  # fmt: skip
        ax.set_xticks(find_breaks(curve.knots, curve.degree))
        ax.set(xlabel="parameter u", ylabel="basis function", ylim=(0, 1.14))
    return figure


def _comb(ax, path, slope, curvature):
    """Teeth on the convex side, so that they do not cross each other."""
    size = np.linalg.norm(np.ptp(path, axis=0))
    normal = np.column_stack([slope[:, 1], -slope[:, 0]])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    second = np.gradient(slope, axis=0)
    side = -np.sign(np.einsum("ij,ij->i", normal, second))[:, None]
    tips = path + side * normal * (0.1 * size * curvature / max(curvature.max(), 1e-9 / size))[:, None]
    every = max(1, len(path) // 200)
    teeth = np.stack([path[::every], tips[::every]], axis=1)
    for tooth in teeth:
        ax.plot(*tooth.T, color=ORANGE, linestyle="-", linewidth=0.6)
    ax.plot(*tips.T, color=GREEN, linestyle="-", linewidth=0.9, label="curvature comb")
