"""A program that `_opencascade` runs: the curves and surfaces of a file, as plain numbers on standard output.

A curve is ``(degree, knots, points, weights)``; a surface has two degrees and two lists of knots, a grid of
points, and weights or None. The number of all faces follows, planes included, and what OpenCASCADE said of
the entities that it did not understand. Only OpenCASCADE is imported, so that the program starts soon.
"""

import os
import pickle
import sys

from OCP import Geom
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepTools import BRepTools
from OCP.GeomConvert import GeomConvert
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Reader
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SHAPE
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

WHOLE = 1.0 - 1e-10  # of the range of a parameter


def shapes_in(path, format):
    reader = {"STEP": STEPControl_Reader, "IGES": IGESControl_Reader}[format]()
    if format == "IGES":
        Interface_Static.SetIVal_s("read.iges.bspline.continuity", 0)  # keep corners; do not cut there
    if reader.ReadFile(path) != IFSelect_RetDone:
        sys.exit(f"it is no {format} file")
    model = reader.WS().Model()
    if broken := fails(model.GlobalCheck()):
        sys.exit(f"it is damaged: {broken[0]}")
    checks = (model.Check(i, True) for i in range(1, model.NbEntities() + 1))
    lost = [said for check in checks if check.HasFailed() for said in fails(check)]
    reader.TransferRoots()
    shape = reader.OneShape()
    if shape.IsNull():
        return [], [], 0, lost
    curves = [from_edge(TopoDS.Edge_s(e)) for e in parts(shape, TopAbs_EDGE, TopAbs_FACE)]
    faces = [TopoDS.Face_s(f) for f in parts(shape, TopAbs_FACE)]
    surfaces = [from_face(f) for f in faces if not is_flat(BRep_Tool.Surface_s(f))]
    return curves, surfaces, len(faces), lost


def fails(check):
    return [check.CFail(i) for i in range(1, check.NbFails() + 1)]


def parts(shape, kind, outside=TopAbs_SHAPE):
    """Faces, wires or edges of a shape, but not those inside of a kind of shapes."""
    explorer = TopExp_Explorer(shape, kind, outside)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def from_edge(edge):
    piece = BRepAdaptor_Curve(edge)
    curve = BRep_Tool.Curve_s(edge, 0.0, 0.0)
    if not isinstance(curve, Geom.Geom_BSplineCurve):
        curve = Geom.Geom_TrimmedCurve(curve, piece.FirstParameter(), piece.LastParameter())
    curve = GeomConvert.CurveToBSplineCurve_s(curve)
    curve.SetNotPeriodic()  # its knots then reach beyond the domain
    poles = range(1, curve.NbPoles() + 1)
    return (
        curve.Degree(),
        repeated(curve.NbKnots(), curve.Knot, curve.Multiplicity),
        [curve.Pole(i).Coord() for i in poles],
        [curve.Weight(i) for i in poles],
    )


def is_flat(surface):
    extruded = isinstance(surface, Geom.Geom_SurfaceOfLinearExtrusion)
    return isinstance(surface.BasisCurve() if extruded else surface, (Geom.Geom_Line, Geom.Geom_Plane))


def from_face(face):
    surface = BRep_Tool.Surface_s(face)
    if not isinstance(surface, Geom.Geom_BSplineSurface):
        if isinstance(surface, Geom.Geom_RectangularTrimmedSurface):
            surface = surface.BasisSurface()
        bounds = within(BRepTools.UVBounds_s(face), surface)
        surface = Geom.Geom_RectangularTrimmedSurface(surface, *bounds)
    surface = GeomConvert.SurfaceToBSplineSurface_s(surface)
    surface.SetUNotPeriodic()
    surface.SetVNotPeriodic()
    rows, columns = range(1, surface.NbUPoles() + 1), range(1, surface.NbVPoles() + 1)
    rational = surface.IsURational() or surface.IsVRational()  # if not, Weight() may answer 0
    return (
        (surface.UDegree(), surface.VDegree()),
        (
            repeated(surface.NbUKnots(), surface.UKnot, surface.UMultiplicity),
            repeated(surface.NbVKnots(), surface.VKnot, surface.VMultiplicity),
        ),
        [[surface.Pole(i, j).Coord() for j in columns] for i in rows],
        [[surface.Weight(i, j) for j in columns] for i in rows] if rational else None,
    )


def within(bounds, surface):
    """The bounds of a face without what rounding adds to a whole turn or beyond a pole."""
    u, v, whole = bounds[:2], bounds[2:], surface.Bounds()
    for periodic, (low, high) in ((surface.IsUPeriodic(), whole[:2]), (surface.IsVPeriodic(), whole[2:])):
        if u[1] - u[0] > WHOLE * (high - low):
            u = low, high
        elif not periodic:
            u = max(u[0], low), min(u[1], high)
        u, v = v, u
    return *u, *v


def repeated(count, knot, multiplicity):
    return [knot(i) for i in range(1, count + 1) for _ in range(multiplicity(i))]


if __name__ == "__main__":
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_AS, 2 * (int(sys.argv.pop(1)),))
    except (ImportError, ValueError, OSError):
        pass  # a system without such limits
    with os.fdopen(os.dup(1), "wb") as answer:
        os.dup2(2, 1)  # OpenCASCADE prints to standard output
        pickle.dump(shapes_in(*sys.argv[1:]), answer)
