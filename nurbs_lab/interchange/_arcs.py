"""Arcs, helices and Bezier pieces of programs as NURBS curves in space."""

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.interchange._pieces import bisecting, joined
from nurbs_lab.nurbs import NurbsCurve

HELIX_MM = 1e-7  # largest distance of the cubics from a helix, which is no NURBS


def bezier(points):
    """The polynomial Bezier curve of these control points."""
    ends = np.repeat([0.0, 1.0], len(points))
    return NurbsCurve(len(points) - 1, ends, np.array(points))


def arc_curve(start, end, centre, clockwise, turns, axes):
    """The arc from start to end about a centre ``(2,)``; ``axes`` are its plane's two and that of a helix.

    An arc is a rational quadratic and exact; a helix becomes cubics within HELIX_MM.
    """
    a, b, along = axes
    start, end = np.array(start), np.array(end)
    p, q = start[[a, b]], end[[a, b]]
    radius, last = p - centre, q - centre
    turn = np.arctan2(radius[0] * last[1] - radius[1] * last[0], radius @ last)
    sense = -1 if clockwise else 1
    if sense * turn <= 1e-12:
        turn += sense * 2 * np.pi
    turn += sense * 2 * np.pi * (turns - 1)
    centre = bisecting(p, q, centre)
    radius = p - centre
    rise = end[along] - start[along]
    quarters = max(1, int(np.ceil(abs(turn) / (np.pi / 2) - 1e-9)))
    if rise == 0:
        angles = np.linspace(0, turn, 2 * quarters + 1)
        weights = np.where(np.arange(len(angles)) % 2, np.cos(angles[1]), 1.0)
        points = np.tile(start, (len(angles), 1))
        points[:, [a, b]] = centre + _turned(radius, angles) / weights[:, None]
        points[-1] = end
        knots = np.r_[0.0, np.repeat(np.arange(quarters + 1.0), 2), quarters]
        return NurbsCurve(2, knots, points, weights)
    step = (384 * HELIX_MM / max(lengths(radius), HELIX_MM)) ** 0.25  # cubic Hermite interpolation
    angles = np.linspace(0, turn, 1 + max(quarters, int(np.ceil(abs(turn) / step))))
    points, slopes = np.empty((2, len(angles), 3))
    points[:, [a, b]] = centre + _turned(radius, angles)
    points[:, along] = start[along] + rise * angles / turn
    points[0], points[-1] = start, end
    slopes[:, [a, b]] = _turned(np.array([-radius[1], radius[0]]), angles) * angles[1] / 3
    slopes[:, along] = rise / (len(angles) - 1) / 3
    inner = points[:-1] + slopes[:-1], points[1:] - slopes[1:]
    return joined(np.stack([points[:-1], *inner, points[1:]], axis=1))


def centres_of_radius(starts, ends, radii, clockwise):
    """The centres ``(n, 2)`` of arcs in their plane; NaN where no circle of that radius joins the ends.

    A positive radius means the shorter of the two arcs, a negative one the longer.
    """
    chords = ends - starts
    long = lengths(chords)
    with np.errstate(all="ignore"):
        heights = np.sqrt(np.maximum(radii**2 - long**2 / 4, 0.0)) / long
        heights[~(np.abs(radii) >= long / 2 * (1 - 1e-6))] = np.nan
        sides = np.where(clockwise == (radii > 0), -heights, heights)[:, None]
        return starts + chords / 2 + sides * np.column_stack([-chords[:, 1], chords[:, 0]])


def _turned(vector, angles):
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    return c * vector + s * np.array([-vector[1], vector[0]])
