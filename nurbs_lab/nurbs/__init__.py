"""Curves and surfaces as mathematical objects (paper 2.2 and 2.3)."""

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
