"""Curves and surfaces as mathematical objects (paper 2.2 and 2.3)."""

from nurbs_lab.nurbs.curve import NurbsCurve

__all__ = ["NurbsCurve"]
