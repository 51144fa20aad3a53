"""Cubic curves through cutter locations, within the tolerance of the part and never gouging it."""

import itertools
from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.common.threads import over_slices
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import contact
from nurbs_lab.machining.part import Part
from nurbs_lab.nurbs import NurbsCurve
from nurbs_lab.nurbs.along import lengths_along, spline_along

ROUNDS = 5  # of insertion; each quarters the steps that fail their check
LOSS = 0.04  # fraction of the tolerance: possible loss of clearance between checked points
FAR = 0.92  # fraction of the tolerance: largest distance of the spline from contact with the part
SHORTEST = 0.1  # tolerances: smallest distance of inserted cutter locations
FIT = 0.4  # fraction of the tolerance: largest distance of the spline from the locations
TOGETHER = 16  # paths in one item of work for a thread


@dataclass(frozen=True, eq=False)
class Path:
    """Cutter locations ``(n, 3)`` and the cubic spline along them.

    ``level`` is the height of a waterline, None for other passes; it may be ``closed``.
    """

    points: np.ndarray
    level: float | None
    closed: bool = False
    curve: NurbsCurve | None = None

    def fitted(self, tolerance):
        """This path with a spline within the tolerance of its points."""
        return replace(self, curve=spline_along(self.points, tolerance))

    def reversed(self):
        """The same spline in the opposite direction."""
        return Path(self.points[::-1], self.level, self.closed, self.curve.reverse())

    def inserted(self, at, new, least):
        """This path with ``new`` locations in its steps ``at``, where no other is nearer than ``least``."""
        apart = np.minimum(lengths(new - self.points[at]), lengths(new - self.points[at + 1])) > least
        return replace(self, points=np.insert(self.points, at[apart] + 1, new[apart], axis=0))


@dataclass(frozen=True, eq=False)
class Fitting:
    """A part, a cutter and a tolerance, for which paths are fitted."""

    part: Part
    cutter: Cutter
    tolerance: float

    def touch(self, share):
        """Contact with the cutter enlarged by this fraction of the tolerance."""
        return contact(self.part, self.cutter, share * self.tolerance)

    def inserted(self, paths, long):
        """The paths with three locations in each of their ``long`` steps.

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
        rows, least = np.split(new, np.cumsum(counts)[:-1]), SHORTEST * self.tolerance
        return [path.inserted(at, row, least) for path, at, row in zip(paths, steps, rows, strict=True)]

    def wrong(self, paths):
        """The steps of each path along which its spline gouges the part or is farther from it than asked.

        The spacing of the checked places follows from the radius of the cutter and the curvature of the
        spline, so that hardly anything is missed between them.
        """
        flat, corner, _, wide = self.cutter.shape
        straight = 1.0 / (corner if corner > 0.0 else max(flat, 0.1 * wide))
        tips, counts = [], []
        for path in paths:
            t = lengths_along(path.points)
            curved, sizes = lengths(path.curve.derivative(t, 2)), np.diff(t)
            curved = np.maximum(curved[1:], curved[:-1]) + straight
            several = np.ceil(sizes * np.sqrt(curved / (8.0 * LOSS * self.tolerance))).astype(int)
            step, begun = np.repeat(np.arange(len(sizes)), several), np.cumsum(several) - several
            part = (np.arange(len(step)) + 0.5 - begun[step]) / several[step]
            tips.append(path.curve(t[step] + part * sizes[step]))
            counts.append(several)
        tips, ends = np.concatenate(tips), np.cumsum([len(several) for several in counts])
        bad = self.touch(LOSS).collides(tips) | ~self.touch(FAR).collides(tips)
        starts = np.cumsum(np.concatenate([[0], *counts]))[:-1]
        return np.split(np.logical_or.reduceat(bad, starts), ends[:-1])


def fit_paths(part, cutter, tolerance, paths):
    """Paths with splines whose distance from contact with the part is between 0 and the tolerance.

    The cutter locations belong to a cutter enlarged by half the tolerance, so a spline that stays within half
    the tolerance of the exact path does not gouge. The fit guarantees this at the locations. Where a check
    between them fails, exact locations are inserted. Where the check fails even then, the exact path jumps,
    as at a vertical wall; the path is split there.
    """
    fitting, done, pieces = Fitting(part, cutter, tolerance), [], []
    for left in reversed(range(ROUNDS)):
        if not paths:
            break
        some = [paths[k : k + TOGETHER] for k in range(0, len(paths), TOGETHER)]
        fitted = over_slices(lambda paths: [path.fitted(FIT * tolerance) for path in paths], some, "fitting")
        fitted, paths, long = list(itertools.chain.from_iterable(fitted)), [], []
        for path, bad in zip(fitted, fitting.wrong(fitted), strict=True):
            more = bad & (lengths(np.diff(path.points, axis=0)) > 4.0 * SHORTEST * tolerance)
            if not bad.any():
                done.append(path)
            elif left and more.any():
                paths.append(path)
                long.append(more)
            else:
                parts = np.split(path.points, np.flatnonzero(bad) + 1)
                pieces += [Path(points, path.level) for points in parts if len(points) > 1]
        paths = fitting.inserted(paths, long) if paths else []
    return done + fit_paths(part, cutter, tolerance, pieces) if pieces else done
