"""The closest point of a curve or surface to each of many points."""

import numpy as np

from nurbs_lab.nurbs import _checks, _kernels_closest, shape
from nurbs_lab.nurbs.measure import breaks

HALVES = np.array([0.0, 0.5, 1.0])  # where a piece's seeds lie
STRAIGHT, ROUNDS = 1.05, 6  # pieces of a curve longer than this times their chord are halved, so often
FINE, COARSE = 48, 8  # pieces wanted along a direction; the most that a span of a surface is cut into


def cut(knots, degree, most):
    """Breaks with every span cut into equal parts, fewer the more spans there are."""
    ends = breaks(knots, degree)
    parts = int(np.clip(FINE // (len(ends) - 1), 2, most))
    inner = ends[:-1, None] + np.diff(ends)[:, None] * np.arange(parts) / parts
    return np.append(inner.ravel(), ends[-1])


def query_points(points, dim):
    """Points ``(..., dim)`` as rows, and the leading shape."""
    points = _checks.as_floats("points", points)
    if points.ndim == 0 or points.shape[-1] != dim:
        raise ValueError(f"points must have shape (..., {dim}), got {points.shape}")
    return points.reshape(-1, dim), points.shape[:-1]


def closest_on_curve(curve, points):
    """See `NurbsCurve.closest_point`."""
    points, lead = query_points(points, curve.dim)
    degree = curve.degree
    ends = cut(curve.knots, degree, COARSE)
    for halvings in range(ROUNDS + 1):
        control = shape.project(shape.bezier_rows(degree, curve.knots, curve.homogeneous, ends))
        walk = _checks.lengths(np.diff(control, axis=1)).sum(axis=1)
        bent = walk > STRAIGHT * _checks.lengths(control[:, -1] - control[:, 0])
        if halvings == ROUNDS or not bent.any():
            break
        ends = np.sort(np.append(ends, 0.5 * (ends[:-1] + ends[1:])[bent]))
    pieces = np.column_stack([ends[:-1], ends[1:]])
    seeds = curve(ends[:-1, None] + np.diff(ends)[:, None] * HALVES)
    u, distance = np.empty(len(points)), np.empty(len(points))
    _kernels_closest.closest_on_curve(
        degree, curve.knots, curve.homogeneous, *leaf_boxes(control), pieces, seeds, points, u, distance
    )
    return u.reshape(lead)[()], distance.reshape(lead)[()]


def closest_on_surface(surface, points):
    """See `NurbsSurface.closest_point`."""
    points, lead = query_points(points, surface.dim)
    ends_u, ends_v, control = patches(surface)
    i, j = np.meshgrid(np.arange(len(ends_u) - 1), np.arange(len(ends_v) - 1))
    order = np.argsort(morton(i.ravel(), j.ravel()))
    pieces = np.stack([ends_u[i], ends_u[i + 1], ends_v[j], ends_v[j + 1]], axis=-1).reshape(-1, 4)[order]
    along_u, along_v = ((e[:-1, None] + np.diff(e)[:, None] * HALVES).ravel() for e in (ends_u, ends_v))
    seeds = surface.grid(along_u, along_v).reshape(len(ends_u) - 1, 3, len(ends_v) - 1, 3, surface.dim)
    seeds = np.ascontiguousarray(seeds.transpose(2, 0, 3, 1, 4).reshape(-1, 9, surface.dim)[order])
    uv, distance = np.empty((len(points), 2)), np.empty(len(points))
    _kernels_closest.closest_on_surface(
        *surface.degrees,
        *surface.knots,
        surface.homogeneous,
        *leaf_boxes(control[order]),
        pieces,
        seeds,
        points,
        uv,
        distance,
    )
    return uv.reshape(*lead, 2), distance.reshape(lead)[()]


def patches(surface):
    """Ends of the pieces along u and v, and their Bezier nets ``(pieces_v * pieces_u, points, dim)``."""
    (p, q), (knots_u, knots_v) = surface.degrees, surface.knots
    nu, nv, columns = surface.homogeneous.shape
    ends_u, ends_v = cut(knots_u, p, COARSE), cut(knots_v, q, COARSE)
    rows = shape.bezier_rows(p, knots_u, surface.homogeneous.reshape(nu, -1), ends_u)
    rows = np.ascontiguousarray(np.moveaxis(rows.reshape(-1, nv, columns), 1, 0))
    rows = shape.bezier_rows(q, knots_v, rows.reshape(nv, -1), ends_v)
    nets = rows.reshape(len(ends_v) - 1, q + 1, len(ends_u) - 1, p + 1, columns).swapaxes(1, 2)
    return ends_u, ends_v, shape.project(nets.reshape(-1, (p + 1) * (q + 1), columns))


def leaf_boxes(control):
    """Heap of upright boxes, and axes and corners of tilted ones, around points ``(m, k, dim)``."""
    heap = _kernels_closest.box_heap(np.stack([control.min(axis=1), control.max(axis=1)], axis=1))
    centred = control - control.mean(axis=1, keepdims=True)
    axes = np.linalg.eigh(centred.swapaxes(1, 2) @ centred)[1]
    along = control @ axes
    return heap, axes, np.stack([along.min(axis=1), along.max(axis=1)], axis=1)


def surface_box(surface):
    """See `NurbsSurface.bounding_box`."""
    control = patches(surface)[2]
    return control.min(axis=(0, 1)), control.max(axis=(0, 1))


def morton(i, j):
    """Place of cell (i, j) along the Z-order curve, on which neighbours stay together."""
    code = np.zeros_like(i)
    for bit in range(max(int(i.max()), int(j.max())).bit_length()):
        code |= (i >> bit & 1) << (2 * bit) | (j >> bit & 1) << (2 * bit + 1)
    return code
