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

ROUNDS = 9  # of insertion; each halves the steps that fail their check
WIDE, FINE = 0.3, 0.04  # fractions of the tolerance: possible loss of clearance between checked points
MARGIN = 0.3  # fraction of the tolerance: with that much clearance the wide spacing is enough
LONG = 3.0  # steps longer than this many wide spacings are halved before the first check
FEWEST = 4  # locations that determine a spline
SHORTEST = 0.1  # tolerances: smallest distance of inserted cutter locations
FIT = 0.45  # fraction of the tolerance: largest distance of the spline from the locations
STILL = 0.03  # fraction of the tolerance: a step along which the spline moved less is not checked again
TOGETHER = 16  # paths in one item of work for a thread


@dataclass(frozen=True, eq=False)
class Path:
    """Cutter locations ``(n, 3)`` and the cubic spline along them.

    ``level`` is the height of a waterline, None for other passes; it may be ``closed``. While it is fitted,
    ``kept (n,)`` are the locations at which the spline has knots, and ``seen (n - 1, 9)`` its places in each
    step when that was checked.
    """

    points: np.ndarray
    level: float | None
    closed: bool = False
    curve: NurbsCurve | None = None
    kept: np.ndarray | None = None
    seen: np.ndarray | None = None

    @property
    def steps(self):
        """Distances of successive locations."""
        return lengths(np.diff(self.points, axis=0))

    def fitted(self, tolerance):
        """This path with a spline within the tolerance of its points."""
        return replace(self, curve=spline_along(self.points, tolerance, self.kept))

    def reversed(self):
        """The same spline in the opposite direction."""
        return Path(self.points[::-1], self.level, self.closed, self.curve.reverse())

    def free(self, direction):
        """Whether it may be cut either way."""
        return self.level is None or (direction == "both" and not self.closed)

    def inserted(self, long, new, least):
        """This path with ``new`` locations in its ``long`` steps, where no other is nearer than ``least``."""
        at = np.flatnonzero(long)
        apart = np.minimum(lengths(new - self.points[at]), lengths(new - self.points[at + 1])) > least
        at, new = at[apart] + 1, new[apart]
        self.seen[at - 1] = np.nan
        arrays = (self.points, new), (self.kept, False), (self.seen, np.nan)
        points, kept, seen = (np.insert(array, at, row, axis=0) for array, row in arrays)
        return replace(self, points=points, kept=kept, seen=seen)


@dataclass(frozen=True, eq=False)
class Fitting:
    """A part, a cutter and a tolerance, for which paths are fitted."""

    part: Part
    cutter: Cutter
    tolerance: float

    def touch(self, share):
        """Contact with the cutter enlarged by this fraction of the tolerance."""
        return contact(self.part, self.cutter, share * self.tolerance)

    @property
    def spacing(self):
        """Distance of places on a straight path between which no clearance of the tolerance is lost."""
        flat, corner, _, wide = self.cutter.shape
        return np.sqrt(8.0 * self.tolerance * (corner if corner > 0.0 else max(flat, 0.1 * wide)))

    def inserted(self, paths, long):
        """The paths with a location near the middle of each of their ``long`` steps.

        On a waterline the enlarged cutter is pushed across the step from right to left, over the length of
        the step. On other passes, or if that fails, it is dropped.
        """
        both = list(zip(paths, long, strict=True))
        here, then = (
            np.concatenate([path.points[some.nonzero()[0] + k] for path, some in both]) for k in (0, 1)
        )
        counts = [np.count_nonzero(some) for some in long]
        level = np.repeat([np.nan if path.level is None else path.level for path in paths], counts)
        new, aside, touch = 0.5 * (here + then), 0.5 * (then - here)[:, [1, 0]] * (-1.0, 1.0), self.touch(0.5)
        way = np.full(len(new), np.nan)
        flat = ~np.isnan(level)
        way[flat] = touch.push((new[:, :2] - aside)[flat], (new[:, :2] + aside)[flat], level[flat])
        pushed = np.isfinite(way)
        new[pushed, :2] += ((2.0 * way - 1.0)[:, None] * aside)[pushed]
        height = np.fmax(touch.heights(new[~pushed, :2]), level[~pushed])
        new[~pushed, 2] = np.where(np.isfinite(height), height, new[~pushed, 2])
        rows, least = np.split(new, np.cumsum(counts)[:-1]), SHORTEST * self.tolerance
        return [path.inserted(some, row, least) for (path, some), row in zip(both, rows, strict=True)]

    def wrong(self, paths):
        """The steps of each path along which its spline gouges the part or is farther from it than asked.

        The spacing of the checked places follows from the radius of the cutter and the curvature of the
        spline, so that hardly anything is missed between them. Where the clearance is small they are denser.
        """
        moved, rows = [], []
        for path in paths:
            t = lengths_along(path.points)
            at, second, sizes = path.curve(t), lengths(path.curve.derivative(t, 2)), np.diff(t)
            places = np.hstack([at[:-1], path.curve(t[:-1] + 0.5 * sizes), at[1:]])
            moved.append(~(np.abs(places - path.seen) <= STILL * self.tolerance).all(axis=1))
            path.seen[moved[-1]] = places[moved[-1]]
            curved = np.maximum(second[1:], second[:-1]) / (8.0 * self.tolerance)
            counts = sizes * np.sqrt(1.0 / self.spacing**2 + curved)
            rows.append(np.column_stack([t[:-1], sizes, counts])[moved[-1]])
        ends = np.cumsum([len(row) for row in rows])
        starts, sizes, counts = np.concatenate(rows).T
        bad = np.zeros(len(starts), bool)

        def places(steps, share):
            """Places in these steps, and the step of each."""
            several = np.ceil(counts[steps] / np.sqrt(share)).astype(int)
            step, part = np.repeat(steps, several), np.arange(several.sum()) + 0.5
            part = (part - np.repeat(np.cumsum(several) - several, several)) / np.repeat(several, several)
            split = np.split(starts[step] + part * sizes[step], np.searchsorted(step, ends[:-1]))
            return step, np.concatenate([path.curve(u) for path, u in zip(paths, split, strict=True)])

        step, tips = places(np.arange(len(bad)), WIDE)
        tight = self.touch(MARGIN).collides(tips)
        bad[step[~tight][~self.touch(1.0).collides(tips[~tight])]] = True
        near = np.unique(step[tight])
        step, tips = places(near[~bad[near]], FINE)
        bad[step[self.touch(FINE).collides(tips)]] = True
        for some, part in zip(moved, np.split(bad, ends[:-1]), strict=True):
            some[some] = part
        return moved


def fit_paths(part, cutter, tolerance, paths):
    """Paths with splines whose distance from contact with the part is between 0 and the tolerance.

    The cutter locations belong to a cutter enlarged by half the tolerance, so a spline that stays within half
    the tolerance of the exact path does not gouge. The fit guarantees this at the locations. Where a check
    between them fails, exact locations are inserted. Where the check fails even then, the exact path jumps,
    as at a vertical wall; the path is split there.
    """
    fitting, done, pieces = Fitting(part, cutter, tolerance), [], []
    longest, shortest = LONG * np.sqrt(WIDE) * fitting.spacing, 2.0 * SHORTEST * tolerance
    counts = [len(path.points) for path in paths]
    paths = [
        replace(path, kept=np.zeros(n, bool), seen=np.full((n - 1, 9), np.nan))
        for path, n in zip(paths, counts, strict=True)
    ]
    long = [(path.steps > longest) | (len(path.points) < FEWEST) for path in paths]
    for left in range(ROUNDS - 1, -1, -1):
        if not paths:
            break
        paths = fitting.inserted(paths, long)
        some = [paths[k : k + TOGETHER] for k in range(0, len(paths), TOGETHER)]
        fitted = over_slices(lambda paths: [path.fitted(FIT * tolerance) for path in paths], some, "fitting")
        fitted, paths, long = list(itertools.chain.from_iterable(fitted)), [], []
        for path, bad in zip(fitted, fitting.wrong(fitted), strict=True):
            path.seen[bad] = np.nan
            more = bad & (path.steps > shortest)
            if not bad.any():
                done.append(path)
            elif left and more.any():
                paths.append(path)
                long.append(more)
            else:
                parts = np.split(path.points, np.flatnonzero(bad) + 1)
                pieces += [Path(points, path.level) for points in parts if len(points) > 3]
    return done + fit_paths(part, cutter, tolerance, pieces) if pieces else done
