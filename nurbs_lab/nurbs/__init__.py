"""Curves and surfaces as mathematical objects (paper 2.2 and 2.3).

Constants and rules of `approximate` that steer, and what they change in the control points of 56 fits to
closed and open random curves, some with noise, and in their time (2026-11).

==============================  =====================================================
IDLE, 3                         0: +19 %, 0.6 x; 1: +4 %, 0.7 x; 6: -5 %, 1.2 x
knots where the errors are      without: +6.9 %, 0.5 x
knots taken out at the end      without: +5.7 %, 1.0 x
SUSPECTS, 8                     4, 16: 0, 1.0 x; none: 0, 1.4 x
QUIET, 0.05 of an error         0.025: -1.8 %; 0.1: +0.4 %; on four curves
==============================  =====================================================

Others, by the time they take; `spline_along` on 20,000 points of a sine by control points, `skin` by shape:

==============================  =====================================================
FINE (closest), 12 pieces       6: torus 1.6 x, sphere 1.5 x, paper's curve 1.2 x;
                                24: 1.2 x, 1.2 x, 1.1 x
EVERY (closest), 4 halvings     2: a graph 1.2 x, the butterfly 1.0 x; 8: 1.1 x, 1.0 x
MANY (curve), 24 a knot         12: 1.15 x, 48: 1.03 x, 1,500 points of the butterfly
FEWER (along), 5 knots          3: +15 %, 0.6 x; 10: -3 %, 1.3 x
SAFETY (tessellation), 0.8      0.4: 1.8 x the triangles of a torus, 1.6: it misses its tolerance
UNEVEN (measure), 4             2, 8: 6 % more, 1 % fewer arcs of 25 curves with weights of 1e-3 to 1e3;
                                none: 5 of them up to 83 tolerances off
LONG (measure), 4 steps         2: 0.2 % more tips of a finished ball; 8: 0; none: `verify` misses
                                moves whose knots are uneven
CORNER (skin), 45 degrees       22: a tube of 12 sides has flat sides, 90: a square may lose its corners
BESIDE (skin), 1e-3             1e-6: ovals with seams of their own are sampled, 0.03 off, not exact;
                                0.5e-3: 0; 2e-3, 0.01: circles up to 0.7, 3.6 degrees beside are turned
SLOW (span_kernels), 0.1        0.05, 0.2: 0; without: 6 % of cubics that turn back and turn again have
                                lengths up to 1.3e-3 wrong
DENSE (skin), 4001 points       2001: circles beside aerofoils 1.1e-6 off, 8001: 0.9e-6, not 1.0e-6
==============================  =====================================================

CELLS are of pictures. POLYNOMIAL_UP_TO, EVEN and CANCELLING bound the digits that powers lose. The others
are tolerances of rounding (TIE, NOISE, FLAT, ENOUGH, TOLD, ROUNDING, CLOSED_WITHIN, SAME_KNOT, VANISHES,
PARALLEL, POLE, NEAR, UNIT, REPEATED_WITHIN, QUANTUM, MISSED, ARC_TOLERANCE, AREA_TOLERANCE) or limits of
work and size (ITERATIONS, DEEPEST, AREA_ROUNDS, ROUNDS of spans, MOST, MOST_PANELS, MOST_SAMPLES).
"""

from nurbs_lab.nurbs.approximate import approximate_curve
from nurbs_lab.nurbs.curve import NurbsCurve
from nurbs_lab.nurbs.factories import arc, circle, cylinder, revolve, sphere, torus
from nurbs_lab.nurbs.interpolate import interpolate_curve, interpolate_surface
from nurbs_lab.nurbs.skin import skin
from nurbs_lab.nurbs.surface import NurbsSurface

__all__ = [
    "NurbsCurve",
    "NurbsSurface",
    "approximate_curve",
    "arc",
    "circle",
    "cylinder",
    "interpolate_curve",
    "interpolate_surface",
    "revolve",
    "skin",
    "sphere",
    "torus",
]
