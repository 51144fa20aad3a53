"""Tangents, normals, curvatures and torsion from derivatives (do Carmo, *Differential Geometry*, 1 and 3)."""

from typing import NamedTuple

import numpy as np

from nurbs_lab.common import checks

VANISHES = 1e-14  # of the size over the parameter range: a derivative this small has no direction
PARALLEL = 1e-13  # of the product of their lengths: tangents this near to parallel span no plane
POLE = 1e-11  # of the size over the parameter range: a tangent this short belongs to a pole


class SurfaceCurvature(NamedTuple):
    """Curvatures of a surface, in 1 / length, with the sign of the normal S_u x S_v."""

    #: Product of the principal curvatures, in 1 / length².
    gaussian: np.ndarray
    #: Mean of the principal curvatures.
    mean: np.ndarray
    #: The principal curvatures, the larger one first, on a last axis of length 2.
    principal: np.ndarray


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


def binormal(curve, u):
    """See `NurbsCurve.binormal`."""
    _require_space("binormal", curve)
    return np.cross(tangent(curve, u), normal(curve, u))


def torsion(curve, u):
    """See `NurbsCurve.torsion`."""
    _require_space("torsion", curve)
    (first, second, third), scale = _scaled(curve, u, 3)
    across = np.cross(first, second)
    size = np.linalg.norm(across, axis=-1)
    flat = size <= PARALLEL * np.linalg.norm(first, axis=-1) * np.linalg.norm(second, axis=-1)
    _refuse("torsion", flat, u, "the curve is straight")
    return ((across / size[..., None]) * third).sum(axis=-1) / size / scale


def _require_space(what, shape):
    if shape.dim != 3:
        raise ValueError(f"only shapes in 3-D have a {what}, this one is in {shape.dim}-D")


def _surface_jet(surface, u, v, order):
    """Derivatives of the surface scaled to size and parameter ranges near one, and the size."""
    _require_space("normal", surface)
    size = _size(surface)
    values = surface.derivatives(u, v, (order, order)) / size
    for axis, span in zip((-3, -2), surface.domain, strict=True):
        powers = (2.0 ** np.frexp(np.ptp(span))[1]) ** np.arange(order + 1)
        values = values * np.expand_dims(powers, tuple(range(axis + 1, 0)))
    return values, size


def surface_normal(surface, u, v):
    """See `NurbsSurface.normal`."""
    return _normal(surface, _surface_jet(surface, u, v, 1)[0], u, v)


def _normal(surface, values, u, v):
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
    _refuse_places("normal", ~(size > PARALLEL), u, v)
    return across / size[..., None]


def _refuse_places(what, bad, u, v):
    if bad.any():
        u, v = (x[tuple(np.argwhere(bad)[0])] for x in np.broadcast_arrays(u, v))
        raise ValueError(f"{what} has no value at u = {u}, v = {v}: the tangents are parallel or vanish")


def surface_curvature(surface, u, v):
    """See `NurbsSurface.curvature`."""
    values, size = _surface_jet(surface, u, v, 2)
    normal = _normal(surface, values, u, v)
    along_u, along_v = values[..., 1, 0, :], values[..., 0, 1, :]
    e, f, g = ((a * b).sum(axis=-1) for a, b in ((along_u,) * 2, (along_u, along_v), (along_v,) * 2))
    second = [(values[..., i, j, :] * normal).sum(axis=-1) for i, j in ((2, 0), (1, 1), (0, 2))]
    area = e * g - f * f
    # near a pole the second derivatives are rounded by more than the shorter tangent's square
    _refuse_places("curvature", ~(area > PARALLEL * np.maximum(e, g) ** 2), u, v)
    gaussian = (second[0] * second[2] - second[1] ** 2) / area / size**2
    mean = 0.5 * (second[0] * g - 2.0 * second[1] * f + second[2] * e) / area / size
    spread = np.sqrt(np.maximum(mean * mean - gaussian, 0.0))
    return SurfaceCurvature(gaussian, mean, np.stack([mean + spread, mean - spread], axis=-1))
