"""Lengths of curves and areas of surfaces."""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.common.progress import interruptible
from nurbs_lab.common.threads import over_blocks
from nurbs_lab.nurbs import refinement, span_kernels
from nurbs_lab.nurbs.spans import find_breaks, span_table

AREA_TOLERANCE = 1e-13  # of the whole area: a patch and its quarters must agree to that
AREA_ROUNDS = 8  # of quartering
UNEVEN = 4.0  # ratio of weights in a piece: even steps of its parameter are not even lengths beyond it
LONG = 4.0  # even steps of the control polygon: longer ones are halved
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


def length(curve, u0=None, u1=None):
    """Arc length from u0 to u1 (the whole domain by default), to near machine precision.

    Negative if u1 < u0. On a closed curve both may lie outside the domain.
    """
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


def samples_along(curve, count):
    """Parameters from end to end and the points there: ``count`` even ones, and more where a step is long.

    That is where it is more than `LONG` times as long as one of as many even steps along the control polygon.
    """
    longest = LONG * checks.lengths(np.diff(curve.control_points, axis=0)).sum() / (count - 1)
    u = np.linspace(*curve.domain, count)
    while True:
        points, middle = curve(u), (u[:-1] + u[1:]) / 2
        long = (checks.lengths(np.diff(points, axis=0)) > longest) & (u[:-1] < middle) & (middle < u[1:])
        if not long.any():
            return u, points
        u = np.sort(np.r_[u, middle[long]])


@interruptible()
def parameter_at(curve, length):
    """Parameters at arc lengths from the start, an array of any shape, by at most 60 steps of Newton.

    They are the nearest that double precision has.
    """
    wanted = checks.as_floats("length", length)
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
    over_blocks(
        lambda part: span_kernels.invert(spans, panels, inside[part], found[part]), wanted.size, "parameters"
    )
    found[inside <= 0.0], found[inside >= panels[1][-1]] = low, high
    out = np.empty(wanted.size)
    out[order] = found
    return out.reshape(wanted.shape)[()]


def area(surface):
    """Area of a surface in 3-D, to about twelve digits where it is smooth.

    Patches are quartered until eight by eight Gauss points agree with the quarters, in at most eight rounds;
    what does not agree then is added as it is.
    """
    if surface.dim != 3:
        raise ValueError(f"only surfaces in 3-D have an area here, this one is in {surface.dim}-D")
    u, v = (find_breaks(k, p) for k, p in zip(surface.knots, surface.degrees, strict=True))
    corners = np.stack(np.meshgrid(u[:-1], v[:-1], indexing="ij"), axis=-1).reshape(-1, 2)
    sides = np.stack(np.meshgrid(np.diff(u), np.diff(v), indexing="ij"), axis=-1).reshape(-1, 2)
    whole, total = _patch_areas(surface, corners, sides), 0.0
    for _ in range(AREA_ROUNDS):
        sides = np.repeat(0.5 * sides, 4, axis=0)
        steps = np.tile([(0, 0), (0, 1), (1, 0), (1, 1)], (len(corners), 1))
        corners = np.repeat(corners, 4, axis=0) + sides * steps
        parts = _patch_areas(surface, corners, sides)
        four = parts.reshape(-1, 4).sum(axis=1)
        good = np.abs(four - whole) <= AREA_TOLERANCE * (total + four.sum())
        total += four[good].sum()
        rest = np.repeat(~good, 4)
        corners, sides, whole = corners[rest], sides[rest], parts[rest]
        if not len(whole):
            break
    return float(total + whole.sum())


def _patch_areas(surface, corners, sides):
    """Areas of rectangles of the parameter plane, by eight by eight Gauss points each."""
    places, weights = 0.5 * (1.0 + span_kernels.GAUSS_NODES), 0.5 * span_kernels.GAUSS_WEIGHTS
    out = np.empty(len(corners))

    def measure(part):
        corner, side = corners[part, :, None, None], sides[part, :, None, None]
        u, v = corner[:, 0] + side[:, 0] * places[:, None], corner[:, 1] + side[:, 1] * places
        values = surface.derivatives(u, v, (1, 1))
        along, across = (values[..., 1, 0, :] * side[:, :1], values[..., 0, 1, :] * side[:, 1:])
        out[part] = checks.lengths(np.cross(along, across)) @ weights @ weights

    over_blocks(measure, len(corners), "area")
    return out
