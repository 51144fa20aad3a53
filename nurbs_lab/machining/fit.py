"""From polylines of cutter locations to cubic curves that neither gouge nor stay off the part."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.machining import _kernels_fit as kernels
from nurbs_lab.machining.drop import contact
from nurbs_lab.nurbs import NurbsCurve

COARSE, FINE = 1.0, 0.02  # of the tolerance: what a rolling ball may rise between two checked places
ROUNDS, CUTS = 13, 3  # of refinement, and of those the last ones that cut what still is wrong
FIT = 0.9  # of half the tolerance is for the fit, the rest for what lies between checked places
SHORTEST = 1e-3  # mm: cutter locations are not put closer


@dataclass(frozen=True, eq=False)
class Path:
    """Cutter locations ``(n, 3)`` on the grown part, and the spline through some of them.

    ``level`` is the height of a waterline, None for a pass over shallow parts.
    """

    points: np.ndarray
    level: float | None
    t: np.ndarray = None
    nodes: np.ndarray = None
    slopes: np.ndarray = None

    def fitted(self, tolerance):
        """With a spline within the tolerance of the points."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        t = np.concatenate([[0.0], np.cumsum(steps)])
        nodes, slopes = kernels.fit(t, self.points, tolerance)
        return replace(self, t=t, nodes=nodes, slopes=slopes)

    def samples(self, counts):
        """Points of the spline, ``counts[i]`` of them evenly within step i between cutter locations."""
        return kernels.samples(self.t, self.points, self.nodes, self.slopes, counts)

    def curve(self) -> NurbsCurve:
        """The spline as a NURBS curve: every control point is a blossom of the piece before it."""
        t, p, m = self.t[self.nodes], self.points[self.nodes], self.slopes
        knots = np.concatenate([[t[0]] * 3, t, [t[-1]] * 3])
        piece = np.clip(np.arange(len(t) + 2) - 2, 0, len(t) - 2)
        width = np.diff(t)[piece][:, None]
        step = (p[piece + 1] - p[piece]) / width
        low, high = m[piece] - step, step - m[piece + 1]
        # p0 + x step + x (w - x) ((w - x) low + x high) / w**2, as powers of x
        square = (-2.0 * low + high) / width
        cube = (low - high) / width**2
        a, b, c = (knots[k + 1 : k + 1 + len(t) + 2] - t[piece] for k in range(3))
        first, second, third = a + b + c, a * b + b * c + c * a, a * b * c
        control = (
            p[piece]
            + m[piece] * (first / 3.0)[:, None]
            + square * (second / 3.0)[:, None]
            + cube * third[:, None]
        )
        control[0], control[-1] = p[0], p[-1]
        return NurbsCurve(3, knots, control)


def fit_paths(part, cutter, tolerance, paths):
    """Curves within ``0 .. tolerance`` of the part: paths of the grown cutter, refined where they must be.

    The cutter locations lie on the part grown by half the tolerance. A spline that is nowhere farther than
    that from the right path leaves no gouge. It keeps that distance at the locations; where checks between
    them say that it does not, exact locations are put in. Where that does not help, the path jumps, at a wall
    that it met endwise: it is cut there.
    """
    grown = contact(part, cutter, 0.5 * tolerance)
    bare, far = contact(part, cutter), contact(part, cutter, tolerance)
    radius = cutter.corner_radius or cutter.radius
    trial = paths
    for rise, checks in ((COARSE, (bare, far)), (FINE, (bare,))):
        spacing = np.sqrt(8.0 * radius * rise * tolerance)
        done, unsure = [], [np.ones(len(path.points) - 1, bool) for path in trial]
        for left in range(ROUNDS, 0, -1):
            trial = [path.fitted(FIT * 0.5 * tolerance) for path in trial]
            wrong = _wrong(trial, unsure, spacing, *checks)
            done += [path for path, poor in zip(trial, wrong, strict=True) if not poor.any()]
            again = [(path, poor) for path, poor in zip(trial, wrong, strict=True) if poor.any()]
            if not again:
                trial = []
                break
            trial, unsure = _refined(grown, again, SHORTEST if left > CUTS else np.inf)
            if rise == FINE:  # a spline may change anywhere when it gets a location
                unsure = [np.ones(len(path.points) - 1, bool) for path in trial]
        trial = done + trial
    return done


def _wrong(paths, unsure, spacing, bare, far=None):
    """Which steps of each path, of those that nobody is sure of, lie too deep or, given ``far``, too high.

    They are checked at places no farther apart than ``spacing``.
    """
    if not paths:
        return []
    counts = [
        np.where(look, np.ceil(np.diff(path.t) / spacing).astype(np.int64), 0)
        for path, look in zip(paths, unsure, strict=True)
    ]
    places = np.concatenate([path.samples(count) for path, count in zip(paths, counts, strict=True)])
    wrong = bare.collides(places)
    if far is not None:
        wrong[~wrong] = ~far.collides(places[~wrong])
    counts = np.concatenate(counts)
    steps = np.bincount(np.repeat(np.arange(len(counts)), counts)[wrong], minlength=len(counts)) > 0
    return np.split(steps, np.cumsum([len(look) for look in unsure])[:-1])


def _refined(grown, again, shortest):
    """Paths with a new location in the middle of each wrong step, and the steps that nobody is sure of then.

    A step too short for that is left out, and the path cut there.
    """
    long = [poor & (np.diff(path.t) > 2.0 * shortest) for path, poor in again]
    middles = [
        0.5 * (path.points[:-1] + path.points[1:])[at] for (path, _), at in zip(again, long, strict=True)
    ]
    aside = np.concatenate([_left(path.points)[at] for (path, _), at in zip(again, long, strict=True)])
    level = np.repeat(
        [np.nan if path.level is None else path.level for path, _ in again], [len(m) for m in middles]
    )
    middle, flat = np.concatenate(middles), np.isfinite(level)
    way = grown.push(middle[flat, :2] - aside[flat], middle[flat, :2] + aside[flat], level[flat])
    found = np.isfinite(way)
    middle[flat, :2] += np.where(found, 2.0 * way - 1.0, 0.0)[:, None] * aside[flat]
    dropped = ~flat
    dropped[flat] = ~found
    height = np.fmax(grown.heights(middle[dropped, :2]), level[dropped])
    middle[dropped, 2] = np.where(np.isfinite(height), height, middle[dropped, 2])
    paths, unsure, first = [], [], 0
    for (path, poor), at in zip(again, long, strict=True):
        place = np.flatnonzero(at) + 1
        points = np.insert(path.points, place, middle[first : first + len(place)], axis=0)
        first += len(place)
        cuts = np.flatnonzero(np.insert(poor & ~at, place, False)) + 1
        look = np.convolve(np.insert(poor, place, True), [1, 1, 1])[1:-1] > 0  # the steps beside them too
        pieces = [piece for piece in np.split(points, cuts) if len(piece) > 3]
        paths += [Path(piece, path.level) for piece in pieces]
        unsure += [np.ones(len(piece) - 1, bool) if len(cuts) else look for piece in pieces]
    return paths, unsure


def _left(points):
    """For each step a vector of half its length to its left in the plane."""
    step = 0.5 * np.diff(points[:, :2], axis=0)
    return np.column_stack([-step[:, 1], step[:, 0]])
