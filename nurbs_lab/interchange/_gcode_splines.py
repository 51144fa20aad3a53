"""Splines that take several blocks: G5.2 and G6.2 of LinuxCNC, G06.2 of Fanuc, and BSPLINE of Siemens."""

import math
from functools import partial

import numpy as np

from nurbs_lab.nurbs import NurbsCurve

#: Kind -> letters of the degree, of the weight and of the knot; by how much the first is larger; the default.
WORDS = {"nurbs": ("L", "P", "", 1, 2), "knots": ("P", "R", "K", 1, 3), "siemens": ("d", "w", "l", 0, 3)}
EVEN = 1e4  # weights from its inverse to it: a uniform spline with them cannot be refused
SAME_MM = 1e-6  # a first control point that is the start of the spline


class OpenSpline:
    """The blocks of a spline: its control points (None where a block has none), weights and knots."""

    def __init__(self, kind, start, line):
        self.kind, self.start, self.line, self.degree = kind, start, line, None
        self.points, self.weights, self.knots = [], [], []

    def add(self, point, words):
        """Add a block, whose words of the degree, the weight and the knot are taken out."""
        letter, weight, knot, larger, _ = WORDS[self.kind]
        if letter in words and (self.degree is None or letter != weight):
            self.degree = int(words.pop(letter)) - larger
        words.pop("Q", None)  # how LinuxCNC is to follow it
        self.points.append(point)
        self.weights.append(words.pop(weight, 1.0))
        self.knots.append(words.pop(knot, None))
        if not self.weights[-1] > 0:
            raise ValueError(f"the weight {self.weights[-1]:g} of a control point is not positive; mend it")

    def closed(self):
        """The start and end of the spline, and what makes its curve; ValueError if the blocks make none."""
        if self.degree is None:
            self.degree = WORDS[self.kind][-1]
        if not 1 <= self.degree <= 25:
            raise ValueError(f"its degree {self.degree} is not from 1 to 25; mend it")
        knots, points, weights = getattr(self, f"_{self.kind}")()
        make = partial(NurbsCurve, self.degree, knots, points, weights)
        if self.kind != "nurbs" or not 1 / EVEN < min(weights) <= max(weights) < EVEN:
            make()  # what is refused is refused now
        return points[0], points[-1], make

    def _nurbs(self):
        """Uniform knots, and the weight of the start in the block of G5.2."""
        kept = [i for i, point in enumerate(self.points) if point is not None]
        points = [self.start, *(self.points[i] for i in kept)]
        spans, degree = len(points) - self.degree, self.degree
        if spans < 1:
            raise ValueError(f"{len(points)} control points are too few for L{degree + 1}")
        knots = [0] * degree + list(range(spans + 1)) + [spans] * degree
        return knots, points, [self.weights[0], *(self.weights[i] for i in kept)]

    def _knots(self):
        """A knot in every block; the last ones have nothing else."""
        points = self.points[: max(len(self.points) - self.degree - 1, 0)]
        if None in self.knots or None in points or not points:
            raise ValueError(
                f"every block needs its knot K, and all but the last {self.degree + 1} a control point"
            )
        ends = self.knots[: self.degree + 1], self.knots[-self.degree - 1 :]
        if any(len(set(end)) > 1 for end in ends):
            raise ValueError(
                f"its first {self.degree + 1} knots K must be equal, and its last; a block is missing"
            )
        return self.knots, points, self.weights[: len(points)]

    def _siemens(self):
        """Lengths of the spans of the knots; empty ones may stand before or after them, or all are 1."""
        if None in self.points:
            raise ValueError("every block needs a control point")
        points, weights, given = [self.start, *self.points], [1.0, *self.weights], self.knots
        if math.dist(points[0], points[1]) <= SAME_MM and given[0] == 0:
            points, weights = points[1:], weights[1:]
        count = len(points) - self.degree
        if not any(given):
            given = [1.0] * max(count, 1)
        filled = np.flatnonzero(given) if None not in given else range(len(given))
        spans = given[filled[0] : filled[-1] + 1]
        if None in spans or len(spans) != count:
            raise ValueError(
                f"its {len(points)} control points need {count} lengths PL of the spans of the knots"
            )
        ends = np.r_[0.0, np.cumsum(spans)]
        return np.r_[[0.0] * self.degree, ends, [ends[-1]] * self.degree], points, weights
