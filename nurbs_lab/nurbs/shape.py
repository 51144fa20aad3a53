"""Changes of representation along one direction that leave the shape exactly as it is.

Functions of a degree, knots and homogeneous rows ``(n, m)``; curves pass their control points, surfaces
a flattened net for either direction.
"""

import numpy as np

from nurbs_lab.nurbs import _checks, _kernels_shape
from nurbs_lab.nurbs.knots import clamp

SAME_KNOT = 1e-13  # of the domain: a parameter this near to a knot means that knot


def multiplicity(knots, u):
    """How often u occurs among the knots."""
    return int(np.count_nonzero(knots == u))


def snap(knots, u, domain):
    """u itself, or the knot that it misses by rounding only."""
    nearest = knots[np.argmin(np.abs(knots - u))]
    return float(nearest) if abs(nearest - u) <= SAME_KNOT * (domain[1] - domain[0]) else float(u)


def refined(degree, knots, rows, finer):
    """Rows of the same spline over finer knots, and those knots."""
    finer = _checks.freeze(finer)
    return finer, _kernels_shape.refine(degree, knots, rows, finer)


def clamped(degree, knots, rows):
    """The same spline with both ends of multiplicity degree + 1."""
    low, high = knots[degree], knots[-degree - 1]
    inner = knots[(knots > low) & (knots < high)]
    return refined(degree, knots, rows, clamp(np.concatenate([[low], inner, [high]]), degree))
