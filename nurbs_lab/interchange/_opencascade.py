"""To and from OpenCASCADE's shapes, for STEP and IGES."""

import numpy as np

from nurbs_lab.interchange._parts import clamped, in_space
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

try:
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace
    from OCP.BRepTools import BRepTools
    from OCP.Geom import (
        Geom_BSplineCurve,
        Geom_BSplineSurface,
        Geom_Plane,
        Geom_RectangularTrimmedSurface,
        Geom_SurfaceOfLinearExtrusion,
        Geom_TrimmedCurve,
    )
    from OCP.GeomConvert import GeomConvert
    from OCP.gp import gp_Pnt, gp_Vec
    from OCP.Message import Message, Message_Gravity
    from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS
except ImportError as missing:
    raise ImportError(
        'STEP and IGES need OpenCASCADE; install it with: pip install "cadquery-ocp-novtk==7.9.*"'
    ) from missing

for _printer in Message.DefaultMessenger_s().Printers():  # it would greet on the terminal at every file
    _printer.SetTraceLevel(Message_Gravity.Message_Fail)


def nurbs_of(shape):
    """The curves and then the surfaces of an OpenCASCADE shape; planes and straight bands are left out."""
    curves = [_to_curve(TopoDS.Edge_s(e)) for e in explore(shape, TopAbs_EDGE, TopAbs_FACE)]
    faces = [TopoDS.Face_s(f) for f in explore(shape, TopAbs_FACE)]
    flat = Geom_Plane, Geom_SurfaceOfLinearExtrusion
    return curves + [_to_surface(f) for f in faces if not isinstance(BRep_Tool.Surface_s(f), flat)]


def explore(shape, kind, *outside):
    """All parts of a kind, those inside of ``outside`` left out."""
    explorer = TopExp_Explorer(shape, kind, *outside)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


# ---- out


def edge_of(curve):
    """The whole curve as an edge."""
    curve = clamped(curve)
    points = _fill(TColgp_Array1OfPnt(1, len(curve.weights)), _points(curve))
    weights = _fill(TColStd_Array1OfReal(1, len(curve.weights)), curve.weights.tolist())
    knots, counts = _knots(curve.knots)
    return BRepBuilderAPI_MakeEdge(Geom_BSplineCurve(points, weights, knots, counts, curve.degree)).Edge()


def face_of(surface):
    """The whole surface as a face."""
    surface = clamped(surface)
    shape = surface.weights.shape
    points = TColgp_Array2OfPnt(1, shape[0], 1, shape[1])
    weights = TColStd_Array2OfReal(1, shape[0], 1, shape[1])
    flat = _points(surface)
    for k, (i, j) in enumerate(np.ndindex(shape)):
        points.SetValue(i + 1, j + 1, flat[k])
        weights.SetValue(i + 1, j + 1, float(surface.weights[i, j]))
    (u, u_counts), (v, v_counts) = map(_knots, surface.knots)
    geometry = Geom_BSplineSurface(points, weights, u, v, u_counts, v_counts, *surface.degrees)
    return BRepBuilderAPI_MakeFace(geometry, 1e-7).Face()


def vector_of(step):
    """A displacement of three numbers."""
    return gp_Vec(*step.tolist())


def _points(shape):
    return [gp_Pnt(*row) for row in in_space(shape.control_points).reshape(-1, 3).tolist()]


def _knots(knots):
    values, counts = np.unique(knots, return_counts=True)
    return (
        _fill(TColStd_Array1OfReal(1, len(values)), values.tolist()),
        _fill(TColStd_Array1OfInteger(1, len(values)), counts.tolist()),
    )


def _fill(array, values):
    for i, value in enumerate(values, start=1):
        array.SetValue(i, value)
    return array


# ---- in


def _to_curve(edge):
    piece = BRepAdaptor_Curve(edge)
    curve = BRep_Tool.Curve_s(edge, 0.0, 0.0)
    if not isinstance(curve, Geom_BSplineCurve):
        curve = Geom_TrimmedCurve(curve, piece.FirstParameter(), piece.LastParameter())
    curve = GeomConvert.CurveToBSplineCurve_s(curve)
    curve.SetNotPeriodic()  # its knots then reach beyond the domain: hence clamped()
    poles = range(1, curve.NbPoles() + 1)
    return NurbsCurve(
        curve.Degree(),
        _repeat(curve.NbKnots(), curve.Knot, curve.Multiplicity),
        [curve.Pole(i).Coord() for i in poles],
        [curve.Weight(i) for i in poles],
    ).clamped()


def _to_surface(face):
    surface = BRep_Tool.Surface_s(face)
    if not isinstance(surface, Geom_BSplineSurface):
        surface = Geom_RectangularTrimmedSurface(surface, *BRepTools.UVBounds_s(face))
    surface = GeomConvert.SurfaceToBSplineSurface_s(surface)
    surface.SetUNotPeriodic()
    surface.SetVNotPeriodic()
    rows, columns = range(1, surface.NbUPoles() + 1), range(1, surface.NbVPoles() + 1)
    rational = surface.IsURational() or surface.IsVRational()  # if not, Weight() may answer 0
    return NurbsSurface(
        (surface.UDegree(), surface.VDegree()),
        (
            _repeat(surface.NbUKnots(), surface.UKnot, surface.UMultiplicity),
            _repeat(surface.NbVKnots(), surface.VKnot, surface.VMultiplicity),
        ),
        [[surface.Pole(i, j).Coord() for j in columns] for i in rows],
        [[surface.Weight(i, j) for j in columns] for i in rows] if rational else None,
    ).clamped()


def _repeat(count, knot, multiplicity):
    return [knot(i) for i in range(1, count + 1) for _ in range(multiplicity(i))]
