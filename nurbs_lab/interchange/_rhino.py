"""Rhino's 3dm, through McNeel's own library."""

import numpy as np

from nurbs_lab.interchange._parts import clamped, in_space
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

try:
    import rhino3dm
except ImportError as missing:
    raise ImportError('.3dm files need rhino3dm; install it with: pip install "rhino3dm>=8"') from missing

HOLDS = ("curves", "surfaces", "solids")
VERSION = 7  # of the archive: Rhino 7 and later read it


def write(path, parts):
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Millimeters
    for curve in parts.curves:
        model.Objects.AddCurve(_curve(clamped(curve)))
    for surface in parts.all_surfaces:
        model.Objects.AddSurface(_surface(clamped(surface)))
    if not model.Write(str(path), VERSION):
        raise OSError(f"rhino3dm could not write {path}")


def read(path):
    model = rhino3dm.File3dm.Read(str(path))
    if model is None:
        raise ValueError(f"path: {str(path)!r} is no 3dm file")
    curves, surfaces = [], []
    for entry in model.Objects:
        geometry = entry.Geometry
        if isinstance(geometry, rhino3dm.Curve):
            curves.append(_to_curve(geometry.ToNurbsCurve()))
        elif isinstance(geometry, rhino3dm.Surface):
            surfaces.append(_to_surface(geometry.ToNurbsSurface()))
        elif isinstance(geometry, rhino3dm.Brep):
            surfaces.extend(_to_surface(face.UnderlyingSurface().ToNurbsSurface()) for face in geometry.Faces)
    return curves + surfaces


# openNURBS stores homogeneous control points, and no knot before the first span or after the last:
# its knot vectors are ours without the first and the last entry.


def _curve(curve):
    out = rhino3dm.NurbsCurve(3, curve.rational, curve.degree + 1, len(curve.weights))
    for i, point in enumerate(_homogeneous(curve)):
        out.Points[i] = point
    _set_knots(out.Knots, curve.knots)
    return out


def _surface(surface):
    size = surface.weights.shape
    out = rhino3dm.NurbsSurface.Create(3, surface.rational, *(p + 1 for p in surface.degrees), *size)
    for index, point in zip(np.ndindex(size), _homogeneous(surface), strict=True):
        out.Points[index] = point
    _set_knots(out.KnotsU, surface.knots[0])
    _set_knots(out.KnotsV, surface.knots[1])
    return out


def _homogeneous(shape):
    weights = shape.weights[..., None]
    rows = np.concatenate([in_space(shape.control_points) * weights, weights], axis=-1)
    return [rhino3dm.Point4d(*row) for row in rows.reshape(-1, 4).tolist()]


def _set_knots(out, knots):
    for i, value in enumerate(knots[1:-1].tolist()):
        out[i] = value


def _to_curve(curve):
    points, weights = _affine([curve.Points[i] for i in range(len(curve.Points))])
    return NurbsCurve(curve.Degree, _all_knots(curve.Knots), points, weights)


def _to_surface(surface):
    size = surface.Points.CountU, surface.Points.CountV
    points, weights = _affine([surface.Points.GetControlPoint(*index) for index in np.ndindex(size)])
    knots = _all_knots(surface.KnotsU), _all_knots(surface.KnotsV)
    return NurbsSurface(
        (surface.OrderU - 1, surface.OrderV - 1), knots, points.reshape(*size, 3), weights.reshape(size)
    )


def _affine(points):
    rows = np.array([(p.X, p.Y, p.Z, p.W) for p in points])
    return rows[:, :3] / rows[:, 3:], rows[:, 3]


def _all_knots(knots):
    inner = [knots[i] for i in range(len(knots))]
    return [inner[0], *inner, inner[-1]]
