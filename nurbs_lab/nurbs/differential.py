"""Tangents, normals, curvatures and torsion from derivatives (do Carmo, *Differential Geometry*, 1 and 3)."""

from typing import NamedTuple

import numpy as np

from nurbs_lab.common import checks

VANISHES = 1e-14  # of the size over the parameter range: a derivative this small has no direction
PARALLEL = 1e-13  # of the product of their lengths: tangents this near to parallel span no plane
NO_PLANE = "the tangents are parallel or vanish"
POLE = 1e-11  # of the size over the parameter range: a tangent this short belongs to a pole


class SurfaceCurvature(NamedTuple):
    """Curvatures of a surface, in 1 / length, with the sign of the normal S_u x S_v."""

    #: Product of the principal curvatures, in 1 / length².
    gaussian: np.ndarray
    #: Mean of the principal curvatures.
    mean: np.ndarray
    #: The principal curvatures, the larger one first, on a last axis of length 2.
    principal: np.ndarray


def _jet(shape, places, order):
    """Derivatives of a shape scaled to size and parameter ranges near one, and the size.

    No square overflows or vanishes then.
    """
    points = shape.control_points.reshape(-1, shape.dim)
    size = 2.0 ** np.frexp(np.abs(points - points[0]).max())[1]
    values, spans = shape.derivatives(*places, order) / size, np.reshape(shape.domain, (-1, 2))
    for axis, span in enumerate(spans, -1 - len(spans)):
        powers = (2.0 ** np.frexp(np.ptp(span))[1]) ** np.arange(values.shape[axis])
        values = values * np.expand_dims(powers, tuple(range(axis + 1, 0)))
    return values, size


def _refuse(what, bad, why, *places):
    if bad.any():
        first = tuple(np.argwhere(bad)[0])
        at = (f"{name} = {x[first]}" for name, x in zip("uv", np.broadcast_arrays(*places), strict=False))
        raise ValueError(f"{what} has no value at {', '.join(at)}: {why}")


def _tangent(u, first, what):
    size = checks.lengths(first)
    _refuse(what, size <= VANISHES, "the derivative vanishes there", u)
    return first / size[..., None], size


def tangent(curve, u):
    """Unit tangents: ``(..., dim)``; ValueError where C' vanishes."""
    return _tangent(u, _jet(curve, (u,), 1)[0][..., 1, :], "tangent")[0]


def _across(curve, u, what):
    """Unit tangent, the part of C'' across it and |C'|, and the size they are scaled by."""
    values, size = _jet(curve, (u,), 2)
    first, second = values[..., 1, :], values[..., 2, :]
    along, speed = _tangent(u, first, what)
    return along, second - (along * second).sum(axis=-1, keepdims=True) * along, speed, size


def curvature(curve, u):
    """Curvature |C' x C''| / |C'|³ (unsigned, 1 / length) at u, shape of u."""
    _, across, speed, size = _across(curve, u, "curvature")
    return np.linalg.norm(across, axis=-1) / speed / speed / size


def normal(curve, u):
    """Unit normals ``(..., dim)`` to the centre of curvature; ValueError where the curve is straight."""
    along, across, speed, _ = _across(curve, u, "normal")
    size = np.linalg.norm(across, axis=-1)
    _refuse("normal", size <= PARALLEL * speed, "the curve is straight there", u)
    across = across / size[..., None]
    across -= (along * across).sum(axis=-1, keepdims=True) * along
    return across / np.linalg.norm(across, axis=-1, keepdims=True)


def binormal(curve, u):
    """Unit binormals of a curve in 3-D, tangent x normal: ``(..., 3)``."""
    _require_space("binormal", curve)
    return np.cross(tangent(curve, u), normal(curve, u))


def torsion(curve, u):
    """Torsion of a curve in 3-D (1 / length), positive for a right-handed helix, shape of u."""
    _require_space("torsion", curve)
    values, scale = _jet(curve, (u,), 3)
    _, first, second, third = np.moveaxis(values, -2, 0)
    across = np.cross(first, second)
    size = np.linalg.norm(across, axis=-1)
    flat = size <= PARALLEL * np.linalg.norm(first, axis=-1) * np.linalg.norm(second, axis=-1)
    _refuse("torsion", flat, "the curve is straight there", u)
    return ((across / size[..., None]) * third).sum(axis=-1) / size / scale


def _require_space(what, shape):
    if shape.dim != 3:
        raise ValueError(f"only shapes in 3-D have a {what}, this one is in {shape.dim}-D")


def surface_normal(surface, u, v):
    """Unit normals S_u x S_v: ``(..., 3)``; at a pole their limit from inside."""
    _require_space("normal", surface)
    return _normal(surface, _jet(surface, (u, v), (1, 1))[0], u, v)


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
    _refuse("normal", ~(size > PARALLEL), NO_PLANE, u, v)
    return across / size[..., None]


def surface_curvature(surface, u, v):
    """Gaussian, mean and principal curvatures at (u, v), as a `SurfaceCurvature`.

    Mean and principal curvatures have the sign of the normal: a sphere whose normals point outwards has
    negative ones. ValueError where the tangents are parallel or vanish.

    Examples
    --------
    >>> from nurbs_lab.nurbs import sphere
    >>> curvature = sphere(2.0).curvature(0.3, 0.4)
    >>> round(float(curvature.gaussian), 12), round(float(curvature.mean), 12)
    (0.25, -0.5)
    """
    _require_space("normal", surface)
    values, size = _jet(surface, (u, v), (2, 2))
    normal = _normal(surface, values, u, v)
    along_u, along_v = values[..., 1, 0, :], values[..., 0, 1, :]
    e, f, g = ((a * b).sum(axis=-1) for a, b in ((along_u,) * 2, (along_u, along_v), (along_v,) * 2))
    second = [(values[..., i, j, :] * normal).sum(axis=-1) for i, j in ((2, 0), (1, 1), (0, 2))]
    area = e * g - f * f
    # near a pole the second derivatives are rounded by more than the shorter tangent's square
    _refuse("curvature", ~(area > PARALLEL * np.maximum(e, g) ** 2), NO_PLANE, u, v)
    gaussian = (second[0] * second[2] - second[1] ** 2) / area / size**2
    mean = 0.5 * (second[0] * g - 2.0 * second[1] * f + second[2] * e) / area / size
    spread = np.sqrt(np.maximum(mean * mean - gaussian, 0.0))
    return SurfaceCurvature(gaussian, mean, np.stack([mean + spread, mean - spread], axis=-1))
