"""Cubic curves through cutter locations, within the tolerance of the part and never gouging it."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.common.threads import over_slices
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import contact
from nurbs_lab.machining.part import Part
from nurbs_lab.nurbs import NurbsCurve
from nurbs_lab.nurbs.along import lengths_along, spline_along, spline_changed

LOSS = 0.08  # fraction of the tolerance: possible loss of clearance between checked points
SHORTEST = 0.1  # tolerances: smallest distance of inserted cutter locations
FIT = 0.4  # fraction of the tolerance: largest distance of the spline from the locations


@dataclass(frozen=True, eq=False)
class Path:
    """Cutter locations ``(n, 3)`` and the cubic spline along them.

    ``level`` is the height of a waterline, None for other passes; it may be ``closed``.
    """

    points: np.ndarray
    level: float | None
    closed: bool = False
    curve: NurbsCurve | None = None

    def reversed(self):
        """The same spline in the opposite direction."""
        return Path(self.points[::-1], self.level, self.closed, self.curve.reverse())

    def with_more(self, at, points, tolerance):
        """This path with locations in its steps ``at``, which steps have another spline, and which are old.

        A location nearer to another than ``SHORTEST`` is left out.
        """
        least = SHORTEST * tolerance
        ends = np.minimum(lengths(points - self.points[at]), lengths(points - self.points[at + 1]))
        at, points = at[ends > least] + 1, points[ends > least]
        new = np.insert(np.zeros(len(self.points), bool), at, True)
        points = np.insert(self.points, at, points, axis=0)
        curve, changed = spline_changed(self.curve, points, new, FIT * tolerance)
        return replace(self, points=points, curve=curve), changed, np.flatnonzero(~new)[:-1]

    def between(self, first, last):
        """The part of this path between two of its locations."""
        curve, (begin, end) = self.curve, lengths_along(self.points)[[first, last]]
        if last < len(self.points) - 1:
            curve = curve.split(end)[0]
        if first > 0:
            curve = curve.split(begin)[1]
        return Path(self.points[first : last + 1], self.level, curve=curve)


@dataclass(frozen=True, eq=False)
class Fitting:
    """A part, a cutter and a tolerance, for which paths are fitted, and what roughing leaves on the part."""

    part: Part
    cutter: Cutter
    tolerance: float
    leave: float | None = None

    def touch(self, share):
        """Contact with the cutter enlarged by this fraction of the tolerance, for roughing at its level."""
        if self.leave is None:
            return contact(self.part, self.cutter, share * self.tolerance)
        return contact(self.part, self.cutter, self.leave, share * self.tolerance)

    def locations(self, paths, long):
        """For each path the numbers of its ``long`` steps, three times, and three locations in each of them.

        On a waterline the enlarged cutter is pushed across the step from right to left, over the length of
        the step. On other passes, or if that fails, it is dropped.
        """
        steps = [np.repeat(np.flatnonzero(some), 3) for some in long]
        here, then = (
            np.concatenate([path.points[at + k] for path, at in zip(paths, steps, strict=True)])
            for k in (0, 1)
        )
        counts = [len(at) for at in steps]
        level = np.repeat([np.nan if path.level is None else path.level for path in paths], counts)
        part = np.tile([[0.25], [0.5], [0.75]], (len(here) // 3, 1))
        new, aside = here + part * (then - here), 0.5 * (then - here)[:, [1, 0]] * (-1.0, 1.0)
        touch = self.touch(0.5)
        way = np.full(len(new), np.nan)
        flat = ~np.isnan(level)
        way[flat] = touch.push((new[:, :2] - aside)[flat], (new[:, :2] + aside)[flat], level[flat])
        pushed = np.isfinite(way)
        new[pushed, :2] += ((2.0 * way - 1.0)[:, None] * aside)[pushed]
        height = np.fmax(touch.heights(new[~pushed, :2]), level[~pushed])
        new[~pushed, 2] = np.where(np.isfinite(height), height, new[~pushed, 2])
        return steps, np.split(new, np.cumsum(counts)[:-1])

    def wrong(self, paths, steps):
        """In which of these steps the spline of a path gouges the part or is farther from it than asked.

        The spacing of the checked places follows from the radius of the cutter and the curvature of the
        spline, so that hardly anything is missed between them.
        """
        flat, corner, _, wide = self.cutter.shape
        straight = 1.0 / (corner if corner > 0.0 else max(flat, 0.1 * wide))
        tips, counts = [], []
        for path, some in zip(paths, steps, strict=True):
            t = lengths_along(path.points)
            begin, sizes = t[:-1][some], np.diff(t)[some]
            curved = lengths(path.curve.derivative(t, 2))
            curved = np.maximum(curved[:-1], curved[1:])[some] + straight
            several = np.ceil(sizes * np.sqrt(curved / (8.0 * LOSS * self.tolerance))).astype(int)
            step, begun = np.repeat(np.arange(len(sizes)), several), np.cumsum(several) - several
            part = (np.arange(len(step)) + 0.5 - begun[step]) / several[step]
            tips.append(path.curve(begin[step] + part * sizes[step]))
            counts.append(several)
        starts = np.cumsum(np.concatenate([[0], *counts]))
        farther = self.touch(1.0 - LOSS) if self.leave is None else None
        out = np.concatenate(steps)
        out[out] = self.touch(LOSS).strays(np.concatenate(tips), starts, farther)
        return np.split(out, np.cumsum([*map(len, steps)])[:-1])


def fit_paths(fitting, paths):
    """Paths with splines whose distance from contact with the part is between 0 and the tolerance.

    The cutter locations belong to a cutter enlarged by half the tolerance, so a spline that stays within half
    the tolerance of the exact path does not gouge. The fit guarantees this at the locations. Where a check
    between them fails, exact locations are inserted, as long as there are any; the spline changes, and is
    checked again, near them only. Where the check fails even then, the exact path jumps, as at a vertical
    wall; the path is split there. Level paths that ``leave`` so much on the part may be any distance from it.
    """
    if not paths:
        return []
    tolerance = fitting.tolerance
    curves = over_slices(lambda path: spline_along(path.points, FIT * tolerance), paths, "fitting")
    paths = [replace(path, curve=curve) for path, curve in zip(paths, curves, strict=True)]
    bad = fitting.wrong(paths, [np.ones(len(path.points) - 1, bool) for path in paths])

    def long(some):
        """Steps of some paths that fail their check and are long enough to be divided."""
        least = 4.0 * SHORTEST * tolerance
        found = {k: bad[k] & (lengths(np.diff(paths[k].points, axis=0)) > least) for k in some}
        return {k: steps for k, steps in found.items() if steps.any()}

    again = long(range(len(paths)))
    while again:
        old, grown = [paths[k] for k in again], []
        more = list(zip(old, *fitting.locations(old, list(again.values())), strict=True))
        new = over_slices(lambda one: one[0].with_more(*one[1:], tolerance), more, "fitting")
        found = fitting.wrong([path for path, *_ in new], [changed for _, changed, _ in new])
        for k, (path, changed, before), some in zip(again, new, found, strict=True):
            some[before] |= bad[k] & ~changed[before]
            grown += [k] * (len(path.points) > len(paths[k].points))
            paths[k], bad[k] = path, some
        again = long(grown)
    pieces = []
    for path, some in zip(paths, bad, strict=True):
        if some.any():  # beside a jump the spline need not pass through the location
            hit = fitting.touch(LOSS).collides(path.curve(lengths_along(path.points)))
            some = some | hit[1:] | hit[:-1]
            ends = np.flatnonzero(np.diff(np.concatenate([[0], ~some, [0]]))).reshape(-1, 2)
            pieces += [path.between(*pair) for pair in ends]
        else:
            pieces.append(path)
    return pieces
