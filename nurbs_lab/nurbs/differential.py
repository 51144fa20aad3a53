"""Tangents, normals and curvatures from derivatives (do Carmo, *Differential Geometry*, 1 and 3)."""

import numpy as np

from nurbs_lab.common import checks

VANISHES = 1e-14  # of the size over the parameter range: a derivative this small has no direction
PARALLEL = 1e-13  # of the product of their lengths: tangents this near to parallel span no plane
POLE = 1e-11  # of the size over the parameter range: a tangent this short belongs to a pole


def _size(shape):
    """A power of two near the size of the control points."""
    points = shape.control_points.reshape(-1, shape.dim)
    return 2.0 ** np.frexp(np.abs(points - points[0]).max())[1]


def _scaled(curve, u, order):
    """C', C'', ... ``(order, ..., dim)`` of the curve scaled to size and parameter range near one.

    No square overflows or vanishes then. The second result is the size.
    """
    size, unit = _size(curve), 2.0 ** np.frexp(np.ptp(curve.domain))[1]
    values = np.moveaxis(curve.derivatives(u, order), -2, 0)[1:] / size
    for k in range(order):
        values[k:] *= unit
    return values, size


def _refuse(what, bad, u, why):
    if bad.any():
        raise ValueError(f"{what} has no value at u = {np.asarray(u)[bad].flat[0]}: {why} there")


def _tangent(u, first, what):
    size = checks.lengths(first)
    _refuse(what, size <= VANISHES, u, "the derivative vanishes")
    return first / size[..., None], size


def tangent(curve, u):
    """See `NurbsCurve.tangent`."""
    return _tangent(u, _scaled(curve, u, 1)[0][0], "tangent")[0]


def _across(curve, u, what):
    """Unit tangent, the part of C'' across it and |C'|, and the size they are scaled by."""
    (first, second), size = _scaled(curve, u, 2)
    along, speed = _tangent(u, first, what)
    return along, second - (along * second).sum(axis=-1, keepdims=True) * along, speed, size


def curvature(curve, u):
    """See `NurbsCurve.curvature`."""
    _, across, speed, size = _across(curve, u, "curvature")
    return np.linalg.norm(across, axis=-1) / speed / speed / size


def normal(curve, u):
    """See `NurbsCurve.normal`."""
    along, across, speed, _ = _across(curve, u, "normal")
    size = np.linalg.norm(across, axis=-1)
    _refuse("normal", size <= PARALLEL * speed, u, "the curve is straight")
    across = across / size[..., None]
    across -= (along * across).sum(axis=-1, keepdims=True) * along
    return across / np.linalg.norm(across, axis=-1, keepdims=True)


def surface_normal(surface, u, v):
    """See `NurbsSurface.normal`; the surface is scaled to size and parameter ranges near one."""
    if surface.dim != 3:
        raise ValueError(f"only surfaces in 3-D have a normal, this one is in {surface.dim}-D")
    size, (du, dv) = _size(surface), (2.0 ** np.frexp(np.ptp(span))[1] for span in surface.domain)
    values = surface.derivatives(u, v, (1, 1)) / size * np.array([[1.0, dv], [du, du * dv]])[..., None]
    along_u, along_v, mixed = values[..., 1, 0, :], values[..., 0, 1, :], values[..., 1, 1, :]
    u, v = np.broadcast_arrays(u, v)
    (u0, u1), (v0, v1) = surface.domain
    flat_u, flat_v = (checks.lengths(x)[..., None] <= POLE for x in (along_u, along_v))
    # at a pole the vanishing tangent is replaced by its growth towards the inside
    inward_v = np.where(v < 0.5 * (v0 + v1), 1.0, -1.0)[..., None]
    inward_u = np.where(u < 0.5 * (u0 + u1), 1.0, -1.0)[..., None]
    along_u, along_v = (
        np.where(flat_u, inward_v * mixed, along_u),
        np.where(flat_v, inward_u * mixed, along_v),
    )
    sizes = [checks.lengths(x) for x in (along_u, along_v)]
    with np.errstate(invalid="ignore", divide="ignore"):
        across = np.cross(*(x / size[..., None] for x, size in zip((along_u, along_v), sizes, strict=True)))
    size = checks.lengths(across)
    if (bad := ~(size > PARALLEL)).any():
        u, v = (x[bad][0] for x in (u, v))
        raise ValueError(f"normal has no value at u = {u}, v = {v}: the tangents are parallel")
    return across / size[..., None]
