"""A program that `_rhino` runs: the curves and surfaces of a 3dm file, as plain numbers on standard output.

A curve is ``(degree, knots, rows)``, a surface ``(degrees, (knots along u, along v), grid of rows)``, where a
row is ``(w x, w y, w z, w)``. The kinds of other objects are counted, and all objects. Only rhino3dm is
imported, so that the program starts at once.
"""

import collections
import pickle
import sys

import rhino3dm


def shapes_in(path):
    model = rhino3dm.File3dm.Read(path)
    if model is None:
        sys.exit("it is no 3dm file")
    curves, surfaces, others = [], [], collections.Counter()
    for entry in model.Objects:
        geometry = entry.Geometry
        if isinstance(geometry, rhino3dm.Curve):
            curves.append(from_curve(geometry.ToNurbsCurve()))
        elif isinstance(geometry, rhino3dm.Surface):
            surfaces.append(from_surface(geometry.ToNurbsSurface()))
        elif isinstance(geometry, rhino3dm.Brep):
            surfaces += [from_surface(face.UnderlyingSurface().ToNurbsSurface()) for face in geometry.Faces]
        else:
            others[type(geometry).__name__] += 1
    return curves, surfaces, dict(others), len(model.Objects)


def from_curve(curve):
    rows = [row(curve.Points[i]) for i in range(len(curve.Points))]
    return curve.Degree, all_knots(curve.Knots), rows


def from_surface(surface):
    points = surface.Points
    net = [[row(points.GetControlPoint(i, j)) for j in range(points.CountV)] for i in range(points.CountU)]
    degrees = surface.OrderU - 1, surface.OrderV - 1
    return degrees, (all_knots(surface.KnotsU), all_knots(surface.KnotsV)), net


def row(point):
    return point.X, point.Y, point.Z, point.W


def all_knots(knots):
    """openNURBS stores no knot before the first span or after the last."""
    inner = [knots[i] for i in range(len(knots))]
    return [inner[0], *inner, inner[-1]]


if __name__ == "__main__":
    pickle.dump(shapes_in(sys.argv[1]), sys.stdout.buffer)
