"""A program that `_rhino` runs: the curves and surfaces of a 3dm file, as plain numbers on standard output.

A curve is ``(degree, knots, rows)``, a surface ``(degrees, (knots along u, along v), grid of rows)``, where a
row is ``(w x, w y, w z, w)``, in mm. The kinds of other objects are counted, and all objects. Only
rhino3dm is imported, so that the program starts at once.
"""

import collections
import pickle
import sys

import rhino3dm
from rhino3dm import UnitSystem

MM = {  # a file that names no unit is taken as it is
    UnitSystem.Unset: 1.0,
    getattr(UnitSystem, "None"): 1.0,
    UnitSystem.Microns: 1e-3,
    UnitSystem.Millimeters: 1.0,
    UnitSystem.Centimeters: 10.0,
    UnitSystem.Decimeters: 100.0,
    UnitSystem.Meters: 1000.0,
    UnitSystem.Mils: 0.0254,
    UnitSystem.Inches: 25.4,
    UnitSystem.Feet: 304.8,
    UnitSystem.Yards: 914.4,
}


def shapes_in(path):
    model = rhino3dm.File3dm.Read(path)
    if model is None:
        sys.exit("it is no 3dm file")
    unit = model.Settings.ModelUnitSystem
    if unit not in MM:
        sys.exit(f"its unit of length is {unit.name}; save it in millimetres")
    curves, surfaces, others = [], [], collections.Counter()
    for entry in model.Objects:
        geometry = entry.Geometry
        if isinstance(geometry, rhino3dm.Curve):
            curves.append(from_curve(geometry.ToNurbsCurve(), MM[unit]))
        elif isinstance(geometry, rhino3dm.Surface):
            surfaces.append(from_surface(geometry.ToNurbsSurface(), MM[unit]))
        elif isinstance(geometry, rhino3dm.Brep):
            faces = [face.UnderlyingSurface() for face in geometry.Faces]
            surfaces += [from_surface(face.ToNurbsSurface(), MM[unit]) for face in faces]
        else:
            others[type(geometry).__name__] += 1
    return curves, surfaces, dict(others), len(model.Objects)


def from_curve(curve, mm):
    rows = [row(curve.Points[i], mm) for i in range(len(curve.Points))]
    return curve.Degree, all_knots(curve.Knots), rows


def from_surface(surface, mm):
    points, columns = surface.Points, range(surface.Points.CountV)
    net = [[row(points.GetControlPoint(i, j), mm) for j in columns] for i in range(points.CountU)]
    degrees = surface.OrderU - 1, surface.OrderV - 1
    return degrees, (all_knots(surface.KnotsU), all_knots(surface.KnotsV)), net


def row(point, mm):
    return mm * point.X, mm * point.Y, mm * point.Z, point.W


def all_knots(knots):
    """openNURBS stores no knot before the first span or after the last."""
    inner = [knots[i] for i in range(len(knots))]
    return [inner[0], *inner, inner[-1]]


if __name__ == "__main__":
    pickle.dump(shapes_in(sys.argv[1]), sys.stdout.buffer)
