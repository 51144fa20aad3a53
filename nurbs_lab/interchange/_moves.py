"""The moves of programs: arcs, helices and Bezier pieces as NURBS curves in space, and tables of moves."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.interchange._pieces import joined
from nurbs_lab.machining.program import Move
from nurbs_lab.nurbs import NurbsCurve, arc

RAPID, CUT = 0, 1
NO_FEED = 0.0
HELIX_MM = 1e-7  # largest distance of the cubics from a helix, which is no NURBS
WHOLE = 1e-6  # radians: a smaller turn is a whole one, as in LinuxCNC


def bezier(points):
    """The polynomial Bezier curve of these control points."""
    ends = np.repeat([0.0, 1.0], len(points))
    return NurbsCurve(len(points) - 1, ends, np.array(points))


def arc_curve(start, end, centre, clockwise, turns, axes):
    """The arc from start to end about a centre ``(2,)``; ``axes`` are its plane's two and that of a helix.

    An arc is a rational quadratic and exact, and its end drifts to the given one if it has another radius; a
    helix becomes cubics within HELIX_MM.
    """
    start, end, plane, along = np.array(start), np.array(end), list(axes[:2]), axes[2]
    radius, last, sense = start[plane] - centre, end[plane] - centre, -1 if clockwise else 1
    across = sense * np.array([-radius[1], radius[0]])
    turn = math.atan2(across @ last, radius @ last) % (2 * np.pi)
    if min(turn, 2 * np.pi - turn) <= WHOLE:
        turn = 2 * np.pi
    rise = end[along] - start[along]
    if rise == 0:
        curve = arc(1.0, 0.0, turn, (0.0, 0.0))
        for _ in range(turns - 1):
            curve = arc(1.0, 0.0, 2 * np.pi, (0.0, 0.0)).join(curve)
        points = np.tile(start, (len(curve.control_points), 1))
        points[:, plane] = centre + curve.control_points @ np.array([radius, across])
        points += np.linspace(0, 1, len(points))[:, None] * (end - points[-1])
        return NurbsCurve(2, curve.knots, points, curve.weights)
    turn += 2 * np.pi * (turns - 1)
    step = min(np.pi / 2, (384 * HELIX_MM / max(lengths(radius), HELIX_MM)) ** 0.25)  # cubic Hermite
    angles = np.linspace(0, turn, 1 + max(1, math.ceil(turn / step)))
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    points, slopes = np.empty((2, len(angles), 3))
    points[:, plane] = centre + c * radius + s * across
    points[:, along] = start[along] + rise * angles / turn
    points[0], points[-1] = start, end
    slopes[:, plane] = (c * across - s * radius) * angles[1] / 3
    slopes[:, along] = rise / (len(angles) - 1) / 3
    inner = points[:-1] + slopes[:-1], points[1:] - slopes[1:]
    return joined(np.stack([points[:-1], *inner, points[1:]], axis=1))


def centre_of_radius(start, end, radius, clockwise):
    """The centre of an arc in its plane, and by how much its ends are too far apart for the radius.

    A positive radius means the shorter of the two arcs, a negative one the longer.
    """
    dx, dy = end[0] - start[0], end[1] - start[1]
    long = math.hypot(dx, dy)
    if long == 0:
        return start, math.inf
    height = math.sqrt(max(radius**2 - long**2 / 4, 0.0)) / long
    side = -height if clockwise == (radius > 0) else height
    centre = start[0] + dx / 2 - side * dy, start[1] + dy / 2 + side * dx
    return centre, max(long / 2 - abs(radius), 0.0)


def bisecting(start, end, centre):
    """The centre of an arc in its plane, moved to be as far from its start as from its end."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    square = dx * dx + dy * dy
    if square == 0:
        return centre
    mx, my = start[0] + dx / 2, start[1] + dy / 2
    along = (dx * (centre[1] - my) - dy * (centre[0] - mx)) / square
    return mx - along * dy, my + along * dx


def circle_through(points, columns, tolerance):
    """Centre and angle of the circle or helix on which points ``(n, dim)`` lie within the tolerance, or None.

    Two of the coordinates, ``columns``, are the plane of the circle; the others keep step with the angle.
    """
    plane = points[:, columns]
    local = plane - plane[0]
    system = np.column_stack([2 * local, np.ones(len(local))])
    centre, _, rank, _ = np.linalg.lstsq(system, (local**2).sum(axis=1), rcond=None)
    if rank < 3:
        return None
    if lengths(local[-1]) > tolerance:
        centre = np.array(bisecting((0.0, 0.0), local[-1], centre[:2]))
    spokes = local - centre[:2]
    one, two = spokes[:-1], spokes[1:]
    turns = np.arctan2(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0], (one * two).sum(axis=1))
    turn = turns.sum()
    radius = lengths(spokes[0])
    if (turns * turn <= 0).any():
        return None
    others = [i for i in range(points.shape[1]) if i not in columns]
    along = np.r_[0.0, np.cumsum(turns)][:, None] / turn
    off = points[:, others] - points[0, others] - along * (points[-1, others] - points[0, others])
    away = np.abs(lengths(spokes) - radius).max() + np.abs(off).max(initial=0.0)
    return (centre[:2] + plane[0], turn) if away <= tolerance else None


class MoveTable(Sequence):
    """The moves of a long program by column; a row becomes a `Move` when it is asked for.

    Attributes
    ----------
    kinds, feeds, lines : ndarray, shape (n,)
        RAPID or CUT; mm/s, NO_FEED of rapid moves; lines of the file, counted from 1, 0 where there is none.
    starts, ends : ndarray, shape (n, 3)
        In mm.
    curves : mapping of int to NurbsCurve or tuple
        The curve of a move that is not straight, by the index of the move; or of an arc, what `arc_curve`
        needs beside its ends.
    """

    def __init__(self, kinds, starts, ends, feeds, lines, curves):
        columns = [np.array(column) for column in (kinds, starts, ends, feeds, lines)]
        for column in columns:
            column.setflags(write=False)
        self.kinds, self.starts, self.ends, self.feeds, self.lines = columns
        self.curves = curves

    def __len__(self):
        return len(self.kinds)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return tuple(self[i] for i in range(*index.indices(len(self))))
        i = range(len(self))[index]
        ends = self.starts[i], self.ends[i]
        curve = self.curves.get(i) or polyline(*ends)
        curve = arc_curve(*ends, *curve) if isinstance(curve, tuple) else curve
        kind = ("rapid", "cut")[self.kinds[i]]
        return Move(kind, curve, float(self.feeds[i]) or None, int(self.lines[i]) or None)

    def runs(self):
        """First and end of straight moves that go on with the same kind and feed; a curve is alone."""
        bent = np.zeros(len(self), dtype=bool)
        bent[list(self.curves)] = True
        alike = (np.diff(self.kinds) == 0) & (np.diff(self.feeds) == 0) & ~bent[1:] & ~bent[:-1]
        alike &= (self.starts[1:] == self.ends[:-1]).all(axis=1)
        return pairwise([*np.flatnonzero(np.r_[len(self) > 0, ~alike]), len(self)])

    def strokes(self):
        """Kind, curve, feed and first number of the moves; straight ones that go on are one polyline."""
        for i, end in self.runs():
            move = self[i]
            curve = polyline(self.starts[i], *self.ends[i:end]) if end > i + 1 else move.curve
            yield move.kind, curve, move.feed, i


def polyline(*points):
    """The polyline through points as a curve of degree 1, its knots at the numbers of the points."""
    inner = np.arange(len(points), dtype=float)
    return NurbsCurve(1, np.r_[0.0, inner, inner[-1]], np.array(points))
