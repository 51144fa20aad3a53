"""From polylines of cutter locations to cubic curves that neither gouge nor stay off the part."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import binary_dilation

from nurbs_lab.machining import _kernels_fit as kernels
from nurbs_lab.machining.drop import contact
from nurbs_lab.nurbs import NurbsCurve

TIMES = 10  # checked places for every cutter location
ROUNDS = 8
SHARE = 0.9  # of what the allowance leaves on both sides goes to the fit, the rest to what lies between checks
NEAR = 4  # steps: farther away a new location does not move the spline
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

    def samples(self, times=TIMES):
        """Points of the spline, ``times`` for every step between cutter locations."""
        return kernels.samples(self.t, self.points, self.nodes, self.slopes, times)

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
    that from the right path leaves no gouge; where ten checks a step say that it is, exact locations are put
    in between. Where that does not help, the path jumps, at a wall that it met endwise: it is cut there.
    """
    grown = contact(part, cutter, 0.5 * tolerance)
    bare, far = contact(part, cutter), contact(part, cutter, tolerance)
    done, trial, unsure = [], [path.fitted(SHARE * 0.5 * tolerance) for path in paths], None
    unsure = [np.ones(len(path.points) - 1, bool) for path in trial]
    for left in range(ROUNDS, -1, -1):
        poor = _poor(trial, unsure, bare, far)
        done += [path for path, wrong in zip(trial, poor, strict=True) if not wrong.any()]
        trial = [(path, wrong) for path, wrong in zip(trial, poor, strict=True) if wrong.any()]
        if not trial:
            break
        if left:
            trial, unsure = _refined(grown, trial)
        else:
            trial = [piece for path, wrong in trial for piece in _pieces(path, wrong)]
        trial = [path.fitted(SHARE * 0.5 * tolerance) for path in trial]
    every = done + trial
    gouges = _poor(every, [np.ones(len(path.points) - 1, bool) for path in every], bare, None)
    rest = [piece for path, wrong in zip(every, gouges, strict=True) for piece in _pieces(path, wrong)]
    return [path if path.nodes is not None else path.fitted(0.0) for path in rest]


def _poor(paths, unsure, bare, far):
    """Which steps of each path, of those that nobody is sure of, lie too deep or, if ``far``, too high."""
    samples = [path.samples()[:-1].reshape(-1, TIMES, 3)[look] for path, look in zip(paths, unsure, strict=True)]
    every = np.concatenate([s.reshape(-1, 3) for s in samples]) if samples else np.empty((0, 3))
    wrong = bare.collides(every)
    if far is not None:
        wrong[~wrong] = ~far.collides(every[~wrong])
    poor, first = [], 0
    for path, look in zip(paths, unsure, strict=True):
        count = TIMES * np.count_nonzero(look)
        bad = np.zeros(len(look), bool)
        bad[look] = wrong[first : first + count].reshape(-1, TIMES).any(axis=1)
        poor.append(bad & (np.diff(path.t) > 2.0 * SHORTEST) if far is not None else bad)
        first += count
    return poor


def _pieces(path, poor):
    """The path without its poor steps; as it is if it has none."""
    if not poor.any():
        return [path]
    cuts = np.flatnonzero(poor) + 1
    parts = np.split(path.points, cuts)
    return [Path(points, path.level) for points in parts if len(points) > 3]


def _refined(grown, poor):
    """Paths with a new location in the middle of each poor step, and the steps that nobody is sure of then."""
    middles = [0.5 * (path.points[:-1] + path.points[1:])[wrong] for path, wrong in poor]
    aside = np.concatenate([_left(path.points)[wrong] for path, wrong in poor])
    levels = [np.nan if path.level is None else path.level for path, _ in poor]
    level = np.repeat(levels, [len(m) for m in middles])
    middle, flat = np.concatenate(middles), np.isfinite(level)
    way = grown.push(middle[flat, :2] - aside[flat], middle[flat, :2] + aside[flat], level[flat])
    found = np.isfinite(way)
    middle[flat, :2] += np.where(found, 2.0 * way - 1.0, 0.0)[:, None] * aside[flat]
    dropped = ~flat
    dropped[flat] = ~found
    middle[dropped, 2] = np.fmax(grown.heights(middle[dropped, :2]), level[dropped])
    paths, unsure, first = [], [], 0
    for path, wrong in poor:
        at = np.flatnonzero(wrong) + 1
        paths.append(replace(path, points=np.insert(path.points, at, middle[first : first + len(at)], axis=0)))
        new = np.insert(wrong, at, True)
        unsure.append(binary_dilation(new, iterations=NEAR))
        first += len(at)
    return paths, unsure


def _left(points):
    """For each step a vector of half its length to its left in the plane."""
    step = 0.5 * np.diff(points[:, :2], axis=0)
    return np.column_stack([-step[:, 1], step[:, 0]])
