"""Lengths of curves."""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.common.progress import blocks, interruptible
from nurbs_lab.nurbs import refinement, span_kernels
from nurbs_lab.nurbs.spans import span_table

ARC_TOLERANCE = 1e-15  # of the whole length: the quadrature of a panel and of its halves must agree to that


def centred_spans(curve):
    """The span table of a curve moved to its first control point and scaled to size one, and the scale.

    So no digits are lost to the distance from the origin or to the unit of length.
    """
    if curve.dim > 3:
        raise ValueError(f"only curves in up to 3-D have a length here, this one is in {curve.dim}-D")
    points = curve.control_points - curve.control_points[0]
    size = 2.0 ** np.frexp(np.abs(points).max())[1]
    rows = refinement.lift(points / size, curve.weights / curve.weights.max())
    return span_table(curve.degree, curve.knots, rows), size


def length(curve, u0, u1):
    """Arc length between two parameters, negative if u1 < u0; closed curves go round."""
    low, high = curve.domain
    given = {"u0": low if u0 is None else u0, "u1": high if u1 is None else u1}
    u = [checks.as_number(name, value) for name, value in given.items()]
    start, stop = (
        float(checks.wrapped(name, value, (low, high), lambda: curve.closed))
        for name, value in zip(given, u, strict=True)
    )
    rounds = round((u[1] - stop) / (high - low)) - round((u[0] - start) / (high - low))
    spans, size = centred_spans(curve)
    total = span_kernels.panel_table(spans, ARC_TOLERANCE, min(start, stop), max(start, stop))[1][-1]
    total = total if stop >= start else -total
    if rounds:
        total += rounds * span_kernels.panel_table(spans, ARC_TOLERANCE, low, high)[1][-1]
    return float(size * total)


@interruptible()
def parameter_at(curve, wanted):
    """Parameters at the given arc lengths from the start, by at most 60 steps of Newton's method each."""
    wanted = checks.as_floats("length", wanted)
    spans, size = centred_spans(curve)
    low, high = curve.domain
    panels = span_kernels.panel_table(spans, ARC_TOLERANCE, low, high)
    total = size * panels[1][-1]
    slack = 1e-12 * total
    wrong = (wanted < -slack) | (wanted > total + slack)
    if wrong.any():
        raise ValueError(f"length = {wanted[wrong][0]} is outside [0, {total}], the length of the curve")
    order = np.argsort(wanted, axis=None)
    inside, found = wanted.ravel()[order] / size, np.empty(wanted.size)
    for block in blocks(wanted.size, "parameters"):
        span_kernels.invert(spans, panels, inside[block], found[block])
    found[inside <= 0.0], found[inside >= panels[1][-1]] = low, high
    out = np.empty(wanted.size)
    out[order] = found
    return out.reshape(wanted.shape)[()]
