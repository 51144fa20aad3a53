"""To and from OpenCASCADE's shapes, for STEP and IGES."""

import warnings
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from nurbs_lab.interchange._export_items import clamped, in_space
from nurbs_lab.interchange._subprocess_reader import shapes_in
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

try:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace
    from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface
    from OCP.gp import gp_Pnt
    from OCP.Message import Message, Message_Gravity
    from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
except ImportError as missing:
    raise ImportError(
        'STEP and IGES need OpenCASCADE; install it with: pip install "cadquery-ocp-novtk==7.9.*"'
    ) from missing

READER = Path(__file__).with_name("_opencascade_reader.py")
SAME_POINT = 1e-7  # mm: OpenCASCADE takes nearer points for one


@contextmanager
def without_greetings():
    """Keep OpenCASCADE from printing on the terminal; its message settings are restored afterwards."""
    printers = list(Message.DefaultMessenger_s().Printers())
    levels = [printer.GetTraceLevel() for printer in printers]
    for printer in printers:
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    try:
        yield
    finally:
        for printer, level in zip(printers, levels, strict=True):
            printer.SetTraceLevel(level)


def nurbs_in(path, format, promised):
    """The curves and then the surfaces of a file; flat faces are left out.

    ``promised`` holds the numbers of curves and of faces that the text of the file names.
    """
    curves, surfaces, faces = shapes_in(READER, "OpenCASCADE", path, format)
    for kind, named, found in zip(("curves", "faces"), promised, (len(curves), faces), strict=True):
        if found < named:
            warnings.warn(
                f"path: {path.name} names {named} {kind}, and OpenCASCADE reads only {found} of them; "
                "the file may be damaged, or they are of an unusual kind",
                stacklevel=5,
            )
    return [
        *(NurbsCurve(*curve).clamped() for curve in curves),
        *(NurbsSurface(*surface).clamped() for surface in surfaces),
    ]


def edge_of(curve):
    """The whole curve as an edge."""
    curve = clamped(curve)
    _check_size("curve", curve)
    return BRepBuilderAPI_MakeEdge(curve_of(curve)).Edge()


def curve_of(curve):
    """A clamped curve as OpenCASCADE's geometry."""
    points = _fill(TColgp_Array1OfPnt(1, len(curve.weights)), _points(curve))
    weights = _fill(TColStd_Array1OfReal(1, len(curve.weights)), curve.weights.tolist())
    return Geom_BSplineCurve(points, weights, *_knots(curve.knots), curve.degree)


def face_of(surface):
    """The whole surface as a face."""
    _check_size("surface", surface)
    return BRepBuilderAPI_MakeFace(surface_of(clamped(surface)), 1e-7).Face()


def surface_of(surface):
    """A clamped surface as OpenCASCADE's geometry."""
    shape = surface.weights.shape
    points = TColgp_Array2OfPnt(1, shape[0], 1, shape[1])
    weights = TColStd_Array2OfReal(1, shape[0], 1, shape[1])
    flat = _points(surface)
    for k, (i, j) in enumerate(np.ndindex(shape)):
        points.SetValue(i + 1, j + 1, flat[k])
        weights.SetValue(i + 1, j + 1, float(surface.weights[i, j]))
    (u, u_counts), (v, v_counts) = map(_knots, surface.knots)
    return Geom_BSplineSurface(points, weights, u, v, u_counts, v_counts, *surface.degrees)


def _check_size(name, item):
    points = item.control_points.reshape(-1, item.dim)
    if np.ptp(points, axis=0).max() <= SAME_POINT:
        raise ValueError(
            f"items: a {name} is at most {SAME_POINT:g} mm large, and STEP and IGES would keep one point "
            "of it; give it in a smaller unit or leave it out"
        )


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
