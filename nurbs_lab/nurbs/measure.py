"""Lengths, curvatures, boxes: numbers about a curve or surface."""

import numpy as np

from nurbs_lab.nurbs import _checks, _kernels_measure
from nurbs_lab.nurbs._interrupts import blocks


def breaks(knots, degree):
    """The different knots of the domain, its ends included."""
    return np.unique(knots[degree : len(knots) - degree])


def curvature(first, second, u):
    """|C''| across the tangent over |C'|^2; ``first``, ``second`` are C' and C'' ``(..., dim)`` at u."""
    square = (first**2).sum(axis=-1)
    size = np.abs(first).max(initial=0.0)
    if (square <= (1e-14 * size) ** 2).any():
        where = np.asarray(u)[square <= (1e-14 * size) ** 2].flat[0]
        raise ValueError(f"curvature has no value at u = {where}: the derivative vanishes there")
    along = (first * second).sum(axis=-1) / square
    return np.linalg.norm(second - along[..., None] * first, axis=-1) / square


def break_lengths(curve):
    """Breaks of a curve and the arc length up to each."""
    ends = breaks(curve.knots, curve.degree)
    return ends, _kernels_measure.break_lengths(curve.degree, curve.knots, curve.homogeneous, ends)


def length(curve, u0, u1):
    """Arc length between two parameters, negative if u1 < u0."""
    low, high = curve.domain
    u0, u1 = (
        float(_checks.as_parameters(name, _checks.as_number(name, u), curve.domain))
        for name, u in (("u0", low if u0 is None else u0), ("u1", high if u1 is None else u1))
    )
    a, b = min(u0, u1), max(u0, u1)
    inner = breaks(curve.knots, curve.degree)
    ends = np.concatenate([[a], inner[(inner > a) & (inner < b)], [b]])
    total = _kernels_measure.break_lengths(curve.degree, curve.knots, curve.homogeneous, ends)[-1]
    return float(total if u1 >= u0 else -total)


def parameter_at(curve, wanted):
    """Parameters at the given arc lengths from the start."""
    wanted = _checks.as_floats("length", wanted)
    ends, lengths = break_lengths(curve)
    total = lengths[-1]
    slack = 1e-12 * total
    wrong = (wanted < -slack) | (wanted > total + slack)
    if wrong.any():
        raise ValueError(f"length = {wanted[wrong][0]} is outside [0, {total}], the length of the curve")
    inside, found = np.clip(wanted, 0.0, total).ravel(), np.empty(wanted.size)
    for block in blocks(wanted.size, "parameters"):
        found[block] = _kernels_measure.parameters_at(
            curve.degree, curve.knots, curve.homogeneous, ends, lengths, inside[block]
        )
    return found.reshape(wanted.shape)[()]


def normal(surface, values, u, v):
    """Unit normals from the derivatives up to (1, 1), ``(..., 2, 2, 3)``."""
    if surface.dim != 3:
        raise ValueError(f"only surfaces in 3-D have normals, this one is in {surface.dim}-D")
    along_u, along_v, mixed = values[..., 1, 0, :], values[..., 0, 1, :], values[..., 1, 1, :]
    u, v = np.broadcast_arrays(u, v)
    (u0, u1), (v0, v1) = surface.domain
    sizes = [np.linalg.norm(x, axis=-1, keepdims=True) for x in (along_u, along_v)]
    extent = _checks.extent(surface.control_points)
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
    """Corners of the box: extremes of each coordinate, by bisection between samples."""
    ends = breaks(curve.knots, curve.degree)
    share = np.linspace(0.0, 1.0, 4 * curve.degree + 1)
    u = np.unique(np.concatenate([ends[:-1, None] + np.diff(ends)[:, None] * share, ends[1:, None]], axis=1))
    points, slopes = np.moveaxis(curve.derivatives(u, 1), 1, 0)
    low, high = points.min(axis=0), points.max(axis=0)
    for d in range(curve.dim):
        turn = np.flatnonzero(slopes[:-1, d] * slopes[1:, d] < 0)
        a, b, falling = u[turn], u[turn + 1], slopes[turn, d] < 0
        for _ in range(60):
            middle = 0.5 * (a + b)
            left = (curve.derivative(middle)[:, d] < 0) == falling
            a, b = np.where(left, middle, a), np.where(left, b, middle)
        extremes = curve(a)[:, d]
        low[d], high[d] = extremes.min(initial=low[d]), extremes.max(initial=high[d])
    return low, high
