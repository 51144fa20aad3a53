"""Random curves for the benches."""

import numpy as np

from nurbs_lab import NurbsCurve


def random_curve(rng, degree: int, dim: int, rational: bool) -> NurbsCurve:
    """A curve with uneven and double knots, clamped or not, at any place and scale."""
    count = int(rng.integers(degree + 1, 20))
    knots = rng.uniform(-3, 5) + np.cumsum(rng.uniform(0.05, 1.0, count + degree + 1))
    if degree > 1 and count > degree + 3:
        knots[degree + 2] = knots[degree + 1]
    if rng.random() < 0.5:
        knots[: degree + 1] = knots[degree]
        knots[count:] = knots[count]
    weights = rng.uniform(0.05, 3.0, count) if rational else None
    return NurbsCurve(degree, knots, rng.normal(size=(count, dim)) * 10.0 ** rng.uniform(-2, 3), weights)
