"""A curve made ready for stepping: polynomials span by span, and its arc length."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_kind, lengths
from nurbs_lab.motion import _kernels
from nurbs_lab.nurbs import NurbsCurve, span_kernels
from nurbs_lab.nurbs.span_kernels import speed
from nurbs_lab.nurbs.spans import span_table

#: Eight Gauss points and twice eight must agree to this part of the whole length.
ARC_TOLERANCE = 1e-15
#: |C'| below this part of its mean counts as a cusp.
CUSP = 1e-9
#: Part of the domain that is left out at a double end point, where |C'| grows in proportion to u.
DOUBLE_END = 1e-5
#: Least length of a curve, in mm; shorter curves are refused.
SHORTEST = 1e-15


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

    def __reduce__(self):
        return _unpickled, (self.curve, self.spans, self.panels)

    @property
    def length(self):
        """Arc length of the whole curve, in mm."""
        return float(self.panels[1][-1])

    @property
    def domain(self):
        """First and last parameter."""
        breaks = self.spans[0]
        return float(breaks[0]), float(breaks[-1])

    def until(self, length):
        """The track of the curve up to a length, with the same polynomials."""
        (breaks, *polynomials), (nodes, lengths), end = self.spans, self.panels, np.empty(1)
        span_kernels.invert(self.spans, self.panels, np.array([length]), end)
        breaks = np.append(breaks[breaks < end], end)
        nodes, lengths = np.append(nodes[nodes < end], end), np.append(lengths[nodes < end], length)
        count = len(breaks) - 1
        scales, coefficients, rational = polynomials
        return Track(self.curve, (breaks, scales[:count], coefficients[:count], rational), (nodes, lengths))


def _unpickled(curve, spans, panels):
    """A track whose arrays are writable as those of `prepare` are: kernels are compiled for these."""
    *arrays, rational = spans
    arrays, panels = ([np.require(array, requirements="W") for array in rows] for rows in (arrays, panels))
    return Track(curve, (*arrays, rational), tuple(panels))


def prepare(curve, *, stepped=True):
    """Make the tables of a curve.

    It is refused if it is not 2-D or 3-D, has no length, or stops somewhere
    (C' = 0, a cusp), where du/dt = v / |C'| has no value. Double end points have a tangent, so that a plan
    can be made there: unless the curve is ``stepped``, the tables end about 1e-10 of its length before them.
    """
    as_kind("curve", curve, NurbsCurve)
    if curve.control_points.shape[1] not in (2, 3):
        raise ValueError(f"curve must be 2-D or 3-D, got {curve.control_points.shape[1]}-D control points")
    if not stepped:
        curve = _between_double_ends(curve)
    spans = span_table(curve.degree, curve.knots, _rows(curve))
    panels, length = None, 0.0
    if np.ptp(curve.control_points, axis=0).max() > 0.0:
        panels = span_kernels.panel_table(spans, ARC_TOLERANCE, *curve.domain)
        length = panels[1][-1]
    if not length > SHORTEST:
        raise ValueError(f"curve has no length worth a motion: it is {length:g} mm long")
    _refuse_cusps(spans, panels)
    return Track(curve, spans, panels)


def _between_double_ends(curve):
    low, high = curve.domain
    mean = lengths(np.diff(curve.control_points, axis=0)).sum() / (high - low)
    slow = lengths(curve.derivative(np.array(curve.domain))) < CUSP * mean
    if slow[0]:
        curve = curve.split(low + DOUBLE_END * (high - low))[1]
    if slow[1]:
        curve = curve.split(high - DOUBLE_END * (high - low))[0]
    return curve


def _rows(curve):
    """Homogeneous control points from the first one on: motion needs differences, which keep their digits."""
    points = curve.control_points - curve.control_points[0]
    return np.column_stack([points * curve.weights[:, None], curve.weights])


def _refuse_cusps(spans, panels):
    u, smallest = _slowest(spans)
    mean = panels[1][-1] / (spans[0][-1] - spans[0][0])
    if smallest < CUSP * mean:
        at_end = u in (spans[0][0], spans[0][-1])
        kind, cure = "a cusp", "split the curve there and plan the pieces apart"
        if at_end:  # where the shape may well be smooth
            kind, cure = "a double end point", "fit it anew, as by approximate_curve"
        raise ValueError(
            f"curve has {kind} at u = {u:.12g}: |C'| = {smallest:.3g} there, so v / |C'| has no value; "
            f"move the control points that coincide, or {cure}"
        )


def _slowest(spans):
    """Parameter and value of the smallest |C'|: 33 samples a span, the lowest of them narrowed.

    Beside a cusp |C'| grows at least in proportion to the distance, so that only a sample below half of a
    neighbour can have one beside it.
    """
    breaks, span = spans[0], np.arange(len(spans[0]) - 1)
    samples = breaks[:-1, None] + np.diff(breaks)[:, None] * np.linspace(0.0, 1.0, 33)
    values = np.empty(samples.shape)
    _kernels.speeds(spans, np.repeat(span, 33), samples.ravel(), values.ravel())
    at = values.argmin(axis=1)
    before, after = np.maximum(at - 1, 0), np.minimum(at + 1, 32)
    least, place = values.min(), samples.ravel()[values.argmin()]
    beside = np.maximum(values[span, before], values[span, after])
    for k in np.flatnonzero(2.0 * values[span, at] < beside):
        low, high = samples[k, before[k]], samples[k, after[k]]
        for _ in range(80):
            one, two = low + (high - low) / 3.0, high - (high - low) / 3.0
            low, high = (low, two) if speed(spans, k, one) < speed(spans, k, two) else (one, high)
        if speed(spans, k, low) < least:
            least, place = speed(spans, k, low), low
    return place, least
