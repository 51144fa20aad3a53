"""A curve made ready for stepping: polynomials span by span, and its arc length."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_kind, lengths
from nurbs_lab.motion import _kernels
from nurbs_lab.nurbs import NurbsCurve, span_kernels
from nurbs_lab.nurbs.measure import ARC_TOLERANCE
from nurbs_lab.nurbs.spans import find_breaks, span_table

#: |C'| below this part of its mean counts as a cusp; about this part of the length of the span is left out at
#: a double or triple end point, where C' vanishes, and beyond it |C'| is larger.
CUSP = 1e-10
#: Lengths, periods, points, tangents and curvatures are equal that differ by no more than this, if need be of
#: the size of their curve.
EQUAL_WITHIN = 1e-6


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
    dips : tuple of ndarray
        Spans and parameters of the local minima of |C'|, beside which alone the curvature has narrow peaks.
    """

    curve: NurbsCurve
    spans: tuple
    panels: tuple
    dips: tuple

    def __reduce__(self):  # arrays that were sent are read-only, and kernels are compiled for others
        return prepare, (self.curve,)

    @property
    def straight(self):
        """Whether every span is a straight line."""
        return self.curve.degree == 1

    @property
    def length(self):
        """Arc length of the whole curve, in mm."""
        return float(self.panels[1][-1])

    @property
    def domain(self):
        """First and last parameter."""
        breaks = self.spans[0]
        return float(breaks[0]), float(breaks[-1])

    def parameters_at(self, lengths):
        """Parameters at lengths that do not fall."""
        found = np.empty(len(lengths))
        span_kernels.invert(self.spans, self.panels, np.ascontiguousarray(lengths), found)
        return found

    def spans_at(self, u):
        """Index of the span that holds each parameter."""
        breaks = self.spans[0]
        return np.clip(np.searchsorted(breaks, u, side="right") - 1, 0, len(breaks) - 2)

    def until(self, length):
        """The track of the curve up to a length, with the same polynomials."""
        (breaks, scales, coefficients, rational), (nodes, lengths) = self.spans, self.panels
        end = self.parameters_at(np.array([length]))
        breaks = np.append(breaks[breaks < end], end)
        nodes, lengths = np.append(nodes[nodes < end], end), np.append(lengths[nodes < end], length)
        count = len(breaks) - 1
        spans = breaks, scales[:count], coefficients[:count], rational
        return Track(self.curve, spans, (nodes, lengths), self.dips)


def prepare(curve):
    """Make the tables of a curve.

    It is refused if it is not 2-D or 3-D, has no length, or stops inside (C' = 0, a cusp), where
    du/dt = v / |C'| has no value. At a double end point C' vanishes too, but there is a tangent: the tables
    begin or end about 1e-10 of the length beside it.
    """
    as_kind("curve", curve, NurbsCurve)
    if curve.control_points.shape[1] not in (2, 3):
        raise ValueError(f"curve must be 2-D or 3-D, got {curve.control_points.shape[1]}-D control points")
    ends, panels, length = _beside_slow_ends(curve), None, 0.0
    points = curve.control_points - curve.control_points[0]  # differences keep their digits
    rows = np.column_stack([points * curve.weights[:, None], curve.weights])
    spans = span_table(curve.degree, curve.knots, rows, ends)
    if np.ptp(curve.control_points, axis=0).max() > 0.0:
        panels = span_kernels.panel_table(spans, ARC_TOLERANCE, ends[0], ends[-1])
        length = panels[1][-1]
    if not length > 0.0:
        raise ValueError("curve has no length worth a motion: all its points are one")
    dips = _kernels.slowest_places(spans)
    slowest = dips[2].argmin()
    if dips[2][slowest] < CUSP * length / (ends[-1] - ends[0]):
        raise ValueError(
            f"curve has a cusp at u = {dips[1][slowest]:.12g}: C' vanishes there, so v / |C'| has no value; "
            "move the control points that coincide, or split the curve there and plan the pieces apart"
        )
    return Track(curve, spans, panels, dips[:2])


def _beside_slow_ends(curve):
    """The different knots of the domain, its ends moved inwards where C' vanishes at them."""
    breaks = find_breaks(curve.knots, curve.degree)
    if curve.degree == 1:
        return breaks
    spans = np.diff(breaks)
    least = CUSP * lengths(np.diff(curve.control_points, axis=0)).sum() / spans.sum()
    parts = []
    for end, span in ((breaks[0], spans[0]), (breaks[-1], spans[-1])):
        slopes = curve.derivatives(end, curve.degree)[1:]
        order = 1 + (lengths(slopes) * span ** np.arange(curve.degree) >= least).argmax()
        parts.append(span * CUSP ** (1.0 / order) if order > 1 else 0.0)
    return np.concatenate([breaks[:1] + parts[0], breaks[1:-1], breaks[-1:] - parts[1]])
