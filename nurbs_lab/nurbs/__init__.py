"""Curves and surfaces as mathematical objects (paper 2.2 and 2.3).

Constants and rules of `approximate` that steer, and what they change in the control points of 56 fits to
closed and open random curves, some with noise, and in their time (2026-11). All others of this room are
tolerances of rounding, or limits of work.

==============================  =====================================================
ROUNDS, 10                      5: +2.5 %, 0.7 x; 20: -0.4 %; none: +12 %, 0.6 x
IDLE, 3                         1: +2.5 %, 0.7 x
knots where the errors are      without: +6.9 %, 0.5 x
knots taken out at the end      without: +5.7 %, 1.0 x
==============================  =====================================================
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
