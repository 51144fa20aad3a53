"""Lengths, curvatures, boxes: numbers about a curve or surface."""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.common.progress import blocks
from nurbs_lab.nurbs import refinement, span_kernels
from nurbs_lab.nurbs.spans import find_breaks, span_table

ARC_TOLERANCE = 1e-15  # of the whole length: the quadrature of a panel and of its halves must agree to that


def curvature(first, second, u):
    """|C''| across the tangent over |C'|^2; ``first``, ``second`` are C' and C'' ``(..., dim)`` at u."""
    square = (first**2).sum(axis=-1)
    size = np.abs(first).max(initial=0.0)
    if (square <= (1e-14 * size) ** 2).any():
        where = np.asarray(u)[square <= (1e-14 * size) ** 2].flat[0]
        raise ValueError(f"curvature has no value at u = {where}: the derivative vanishes there")
    along = (first * second).sum(axis=-1) / square
    return np.linalg.norm(second - along[..., None] * first, axis=-1) / square


def centred_spans(curve):
    """The span table of a curve moved to its first control point and scaled to size one, and the scale.

    Neither the distance from the origin nor the unit of length then costs digits.
    """
    points = curve.control_points - curve.control_points[0]
    size = 2.0 ** np.frexp(np.abs(points).max())[1]
    rows = refinement.lift(points / size, curve.weights / curve.weights.max())
    return span_table(curve.degree, curve.knots, rows), size


def length(curve, u0, u1):
    """Arc length between two parameters, negative if u1 < u0."""
    low, high = curve.domain
    u0, u1 = (
        float(checks.as_parameters(name, checks.as_number(name, u), curve.domain))
        for name, u in (("u0", low if u0 is None else u0), ("u1", high if u1 is None else u1))
    )
    spans, size = centred_spans(curve)
    total = size * span_kernels.panel_table(spans, ARC_TOLERANCE, min(u0, u1), max(u0, u1))[1][-1]
    return float(total if u1 >= u0 else -total)


def parameter_at(curve, wanted):
    """Parameters at the given arc lengths from the start."""
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


def normal(surface, values, u, v):
    """Unit normals from the derivatives up to (1, 1), ``(..., 2, 2, 3)``."""
    if surface.dim != 3:
        raise ValueError(f"only surfaces in 3-D have normals, this one is in {surface.dim}-D")
    along_u, along_v, mixed = values[..., 1, 0, :], values[..., 0, 1, :], values[..., 1, 1, :]
    u, v = np.broadcast_arrays(u, v)
    (u0, u1), (v0, v1) = surface.domain
    sizes = [np.linalg.norm(x, axis=-1, keepdims=True) for x in (along_u, along_v)]
    extent = checks.extent(surface.control_points)
    flat_u, flat_v = sizes[0] <= 1e-11 * extent / (u1 - u0), sizes[1] <= 1e-11 * extent / (v1 - v0)
    # at a pole the vanishing tangent is replaced by its growth towards the inside
    inward_v = np.where(v < 0.5 * (v0 + v1), 1.0, -1.0)[..., None]
    inward_u = np.where(u < 0.5 * (u0 + u1), 1.0, -1.0)[..., None]
    along_u, along_v = (
        np.where(flat_u, inward_v * mixed, along_u),
        np.where(flat_v, inward_u * mixed, along_v),
    )
    across = np.cross(along_u, along_v)
    size = np.linalg.norm(across, axis=-1)
    full = np.linalg.norm(along_u, axis=-1) * np.linalg.norm(along_v, axis=-1)
    if (size <= 1e-13 * full).any():
        where = tuple(np.argwhere(size <= 1e-13 * full)[0])
        raise ValueError(f"normal has no value at u = {u[where]}, v = {v[where]}: the tangents are parallel")
    return across / size[..., None]


def curve_box(curve):
    """Corners of the box: the extremes of each coordinate."""
    ends = find_breaks(curve.knots, curve.degree)
    pieces = refinement.bezier_rows(curve.degree, curve.knots, curve.homogeneous, ends)
    slack = 1e-13 * checks.extent(curve.control_points) + 1e-15 * np.abs(curve.control_points).max()
    corners = [
        [sign * _highest(pieces[..., [d, -1]] * [sign, 1.0], slack) for d in range(curve.dim)]
        for sign in (-1.0, 1.0)
    ]
    return np.array(corners[0]), np.array(corners[1])


def _highest(rows, slack):
    """The largest value of Bezier pieces ``(pieces, p + 1, 2)`` of (w x, w), found from below.

    A piece is halved until its control points, between which it lies, are no higher than some end of a piece.
    """
    best = -np.inf
    while len(rows):
        control = rows[..., 0] / rows[..., 1]
        best = max(best, control[:, [0, -1]].max())
        rows = rows[control.max(axis=1) > best + slack]
        left, right = [rows[:, 0]], [rows[:, -1]]
        while rows.shape[1] > 1:
            rows = 0.5 * (rows[:, 1:] + rows[:, :-1])
            left.append(rows[:, 0])
            right.append(rows[:, -1])
        rows = np.concatenate([np.stack(left, axis=1), np.stack(right[::-1], axis=1)])
    return best
