"""Cubic curves through cutter locations, within the tolerance of the part and never gouging it."""

import itertools
from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.threads import over_slices
from nurbs_lab.machining import _kernels_fit, _kernels_spline
from nurbs_lab.machining.drop import contact
from nurbs_lab.nurbs import NurbsCurve
from nurbs_lab.nurbs.curve import trusted_curve

SHORTEST = 0.1  # tolerances: smallest distance of inserted cutter locations
TOGETHER = 16  # paths in one item of work for a thread


@dataclass(frozen=True, eq=False)
class Path:
    """Cutter locations ``(n, 3)`` and the cubic spline along them.

    ``level`` is the height of a waterline, None for other passes; it may be ``closed``. ``t`` are the
    parameters of the locations, ``nodes`` the numbers of those at which the spline has knots, ``values`` and
    ``slopes`` its points and derivatives there.
    """

    points: np.ndarray
    level: float | None
    closed: bool = False
    t: np.ndarray = None
    nodes: np.ndarray = None
    values: np.ndarray = None
    slopes: np.ndarray = None

    def fitted(self, tolerance):
        """This path with a spline within the tolerance of its points."""
        t = _kernels_fit.lengths_along(self.points)
        nodes, values, slopes = _kernels_spline.fit(t, self.points, tolerance, np.zeros(len(t), bool), 2)
        return replace(self, t=t, nodes=nodes, values=values, slopes=slopes)

    def reversed(self):
        """The same spline in the opposite direction."""
        t, nodes = self.t[-1] - self.t[::-1], len(self.t) - 1 - self.nodes[::-1]
        return Path(
            self.points[::-1], self.level, self.closed, t, nodes, self.values[::-1], -self.slopes[::-1]
        )

    def free(self, direction):
        """Whether it may be cut either way."""
        return self.level is None or (direction == "both" and not self.closed)

    def samples(self, counts):
        """Points of the spline, ``counts[i]`` of them evenly spaced between cutter locations i and i + 1."""
        return _kernels_spline.samples(self.t, self.nodes, self.values, self.slopes, counts)

    def curve(self) -> NurbsCurve:
        """The spline as a NURBS curve."""
        return trusted_curve(3, *_kernels_spline.b_spline(self.t[self.nodes], self.values, self.slopes))


def fit_paths(part, cutter, tolerance, paths):
    """Paths with splines whose distance from contact with the part is between 0 and the tolerance.

    The cutter locations belong to a cutter enlarged by half the tolerance, so a spline that stays within half
    the tolerance of the exact path does not gouge. The fit guarantees this at the locations. Where a check
    between them fails, exact locations are inserted. Where the check fails even then, the exact path jumps,
    as at a vertical wall; the path is split there.
    """
    body, done = contact(part, cutter).body, []

    def fitted(some):
        with_levels = [(path.points, np.nan if path.level is None else path.level) for path in paths[some]]
        return [_kernels_fit.refined(*path, tolerance, SHORTEST * tolerance, *body) for path in with_levels]

    while paths:
        slices = [slice(k, k + TOGETHER) for k in range(0, len(paths), TOGETHER)]
        found = itertools.chain.from_iterable(over_slices(fitted, slices, "fitting the passes"))
        pieces = []
        for path, (points, *spline, wrong) in zip(paths, found, strict=True):
            if wrong.any():
                parts = np.split(points, np.flatnonzero(wrong) + 1)
                pieces += [Path(part, path.level) for part in parts if len(part) > 3]
            else:
                done.append(Path(points, path.level, path.closed, *spline))
        paths = pieces
    return done
