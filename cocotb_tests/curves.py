"""Random curves for the benches, and feeds on them."""

import numpy as np

from nurbs_lab import NurbsCurve, plan_feed
from nurbs_lab.hardware import program
from nurbs_lab.motion.track import prepare


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


def planned(curve, periods, trials=0, speed=1.0):
    """Leaves rest on this curve for its ``speed`` lengths a second, cut after some periods."""
    length = prepare(curve).length
    feed = plan_feed(curve, speed=speed * length, acceleration=100 * speed * length, period_s=1e-3)
    return program(curve, feed, 1e-3, periods, trials=trials)
