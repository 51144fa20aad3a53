"""A curve made ready for stepping: polynomials span by span, and its arc length."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_kind
from nurbs_lab.motion import _kernels
from nurbs_lab.nurbs import NurbsCurve, span_kernels
from nurbs_lab.nurbs.spans import span_table

#: Eight Gauss points and twice eight must agree to this part of the whole length.
ARC_TOLERANCE = 1e-15
#: |C'| below this part of its mean counts as a cusp.
CUSP = 1e-9
#: mm; nothing moves on a curve the size of a proton.
SHORTEST = 1e-15
#: Periods of one motion; each takes about 70 bytes.
MOST_PERIODS = 10**8


@dataclass(frozen=True, eq=False)
class Track:
    """Tables of a curve, in the form the kernels take.

    Attributes
    ----------
    curve : NurbsCurve
    spans : tuple
        Homogeneous polynomials of the non-empty spans; see `nurbs.span_kernels`.
    panels : tuple of ndarray
        Parameters and the arc length up to each.
    """

    curve: NurbsCurve
    spans: tuple
    panels: tuple

    @property
    def length(self):
        """Arc length of the whole curve, in mm."""
        return float(self.panels[1][-1])

    @property
    def domain(self):
        """First and last parameter."""
        breaks = self.spans[0]
        return float(breaks[0]), float(breaks[-1])


def prepare(curve):
    """Make the tables of a curve.

    Raises
    ------
    TypeError
        If it is not a curve.
    ValueError
        If the curve is not 2-D or 3-D, has no length, or stops (C' = 0, a cusp) somewhere: there
        du/dt = v / |C'| has no value.
    """
    as_kind("curve", curve, NurbsCurve)
    if curve.control_points.shape[1] not in (2, 3):
        raise ValueError(f"curve must be 2-D or 3-D, got {curve.control_points.shape[1]}-D control points")
    spans = span_table(curve.degree, curve.knots, curve.homogeneous)
    panels = None, np.zeros(1)
    if _spread(curve):
        panels = span_kernels.panel_table(spans, ARC_TOLERANCE, *curve.domain)
    if not panels[1][-1] > SHORTEST:
        raise ValueError(f"curve has no length worth a motion: it is {panels[1][-1]:g} mm long")
    _refuse_cusps(spans, panels)
    return Track(curve, spans, panels)


def require_possible(seconds, period_s):
    """Refuse a motion that no memory holds."""
    if seconds > MOST_PERIODS * period_s:
        raise ValueError(
            f"period_s = {period_s:g} s is too short for a motion of {seconds:g} s: at most {MOST_PERIODS:g} "
            "periods; raise it, the speed, the acceleration, axis_speed or axis_acceleration, "
            "or split the curve"
        )


def _spread(curve):
    return np.ptp(curve.control_points, axis=0).max() > 0.0


def _refuse_cusps(spans, panels):
    u, smallest = _kernels.slowest(spans)
    mean = panels[1][-1] / (spans[0][-1] - spans[0][0])
    if smallest < CUSP * mean:
        raise ValueError(
            f"curve has a cusp at u = {u:.12g}: |C'| = {smallest:.3g} there, so v / |C'| has no value; "
            "move the control points that coincide, or split the curve there and plan the pieces apart"
        )
