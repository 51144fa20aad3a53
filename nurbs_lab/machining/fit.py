"""From polylines of cutter locations to cubic curves that neither gouge nor stay off the part."""

import itertools
from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.threads import over_slices
from nurbs_lab.machining import _kernels_fit as kernels
from nurbs_lab.machining.drop import contact
from nurbs_lab.nurbs import NurbsCurve

SHORTEST = 1e-3  # mm: cutter locations are not put closer
TOGETHER = 16  # paths that a thread fits before it takes others


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
        t = kernels.lengths_along(self.points)
        nodes, slopes = kernels.fit(t, self.points, tolerance)
        return replace(self, t=t, nodes=nodes, slopes=slopes)

    def reversed(self):
        """The same spline from its other end."""
        last = len(self.points) - 1
        return Path(
            self.points[::-1],
            self.level,
            self.t[-1] - self.t[::-1],
            last - self.nodes[::-1],
            -self.slopes[::-1],
        )

    def samples(self, counts):
        """Points of the spline, ``counts[i]`` of them evenly within step i between cutter locations."""
        return kernels.samples(self.t, self.points, self.nodes, self.slopes, counts)

    def curve(self) -> NurbsCurve:
        """The spline as a NURBS curve."""
        return NurbsCurve(3, *kernels.b_spline(self.t[self.nodes], self.points[self.nodes], self.slopes))


def fit_paths(part, cutter, tolerance, paths):
    """Curves within ``0 .. tolerance`` of the part: paths of the grown cutter, refined where they must be.

    The cutter locations lie on the part grown by half the tolerance. A spline that is nowhere farther than
    that from the right path leaves no gouge. It keeps that distance at the locations; where checks between
    them say that it does not, exact locations are put in. Where that does not help, the path jumps, at a wall
    that it met endwise: it is cut there.
    """
    body, done = contact(part, cutter).body, []

    def fitted(some):
        return [kernels.refined(path.points, level(path), tolerance, SHORTEST, *body) for path in paths[some]]

    def level(path):
        return np.nan if path.level is None else path.level

    while paths:
        slices = [slice(k, k + TOGETHER) for k in range(0, len(paths), TOGETHER)]
        found = itertools.chain.from_iterable(over_slices(fitted, slices, "fitting the passes"))
        pieces = []
        for path, (points, t, nodes, slopes, wrong) in zip(paths, found, strict=True):
            if wrong.any():
                parts = np.split(points, np.flatnonzero(wrong) + 1)
                pieces += [Path(part, path.level) for part in parts if len(part) > 3]
            else:
                done.append(Path(points, path.level, t, nodes, slopes))
        paths = pieces
    return done
