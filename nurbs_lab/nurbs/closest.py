"""The closest point of a curve or surface to each of many points."""

from math import comb

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.common.box_tree import box_tree, morton
from nurbs_lab.common.progress import interruptible
from nurbs_lab.common.threads import over_blocks
from nurbs_lab.nurbs import _kernels_closest, refinement
from nurbs_lab.nurbs.spans import find_breaks, span_parameters

FINE = 12  # pieces wanted along a direction
NO_KNOTS = checks.freeze([0.0, 1.0])  # of degree 0, in the second direction of a curve as a surface


def cut(knots, degree):
    """Breaks with every span cut into equal parts, fewer the more spans there are."""
    spans = len(find_breaks(knots, degree)) - 1
    return span_parameters(knots, degree, max(FINE // spans, 1))


def closest_on_curve(curve, points):
    """Nearest point of the curve to each point ``(..., dim)``: (u, distance), each of shape ``(...)``."""
    net = curve.homogeneous[:, None]  # of a surface of degree 0 along v
    uv, distance = closest((curve.degree, 0), (curve.knots, NO_KNOTS), net, points)
    return uv[..., 0][()], distance


def closest_on_surface(surface, points):
    """Nearest point of the surface to each of ``(..., dim)``: (uv ``(..., 2)``, distance ``(...)``)."""
    return closest(surface.degrees, surface.knots, surface.homogeneous, points)


@interruptible()
def closest(degrees, knots, homogeneous, points):
    """Parameters ``(..., 2)`` and distances ``(...)`` for points ``(..., dim)``."""
    points, dim = checks.as_floats("points", points), homogeneous.shape[-1] - 1
    if points.ndim == 0 or points.shape[-1] != dim:
        raise ValueError(f"points must have shape (..., {dim}), got {points.shape}")
    points, lead = points.reshape(-1, dim), points.shape[:-1]
    ends_u, ends_v, nets = patches(degrees, knots, homogeneous)
    i, j = np.meshgrid(np.arange(len(ends_u) - 1), np.arange(len(ends_v) - 1))
    order = np.argsort(morton(np.column_stack([i.ravel(), j.ravel()])))
    pieces = np.stack([ends_u[i], ends_u[i + 1], ends_v[j], ends_v[j + 1]], axis=-1).reshape(-1, 4)[order]
    nets = nets[order]
    control = refinement.project(nets)
    boxes = box_tree(np.hstack([control.min(axis=(1, 2)), control.max(axis=(1, 2))]))
    uv, distance = np.empty((len(points), 2)), np.empty(len(points))
    factors = tuple(product_factors(p) for p in degrees)

    def search(part):
        _kernels_closest.closest(boxes, nets, pieces, factors, points[part], uv[part], distance[part])

    over_blocks(search, len(points), "closest points")
    return uv.reshape(*lead, 2), distance.reshape(lead)[()]


def product_factors(degree):
    """Binomial factors ``(p + 1, p + 1)`` of the product of two Bernstein polynomials."""
    i = range(degree + 1)
    return np.array([[comb(degree, a) * comb(degree, b) / comb(2 * degree, a + b) for b in i] for a in i])


def patches(degrees, knots, homogeneous):
    """Ends of the pieces along u and v, and their homogeneous Bezier nets.

    The nets are ``(pieces, p + 1, q + 1, dim + 1)``, u running fastest over the pieces.
    """
    (p, q), (knots_u, knots_v) = degrees, knots
    nu, nv, columns = homogeneous.shape
    ends_u = cut(knots_u, p)
    ends_v = cut(knots_v, q) if q else knots_v
    rows = refinement.bezier_rows(p, knots_u, homogeneous.reshape(nu, -1), ends_u)
    rows = np.ascontiguousarray(np.moveaxis(rows.reshape(-1, nv, columns), 1, 0))
    if q:
        rows = refinement.bezier_rows(q, knots_v, rows.reshape(nv, -1), ends_v)
    nets = rows.reshape(len(ends_v) - 1, q + 1, len(ends_u) - 1, p + 1, columns)
    return ends_u, ends_v, nets.transpose(0, 2, 3, 1, 4).reshape(-1, p + 1, q + 1, columns)
