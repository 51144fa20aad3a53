"""To and from OpenCASCADE's shapes, for STEP and IGES."""

import warnings
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from nurbs_lab.interchange._export_items import clamped, in_space
from nurbs_lab.interchange._subprocess_reader import shapes_in
from nurbs_lab.mesh import solid
from nurbs_lab.mesh.solid.opencascade import curve_of, surface_of
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace  # isort: skip
from OCP.Message import Message, Message_Gravity

READER = Path(solid.__file__).with_name("opencascade_reader.py")
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


def face_of(surface):
    """The whole surface as a face."""
    _check_size("surface", surface)
    return BRepBuilderAPI_MakeFace(surface_of(clamped(surface)), 1e-7).Face()


def _check_size(name, item):
    points = in_space(item.control_points).reshape(-1, 3)
    if np.ptp(points, axis=0).max() <= SAME_POINT:
        raise ValueError(
            f"items: a {name} is at most {SAME_POINT:g} mm large, and STEP and IGES would keep one point "
            "of it; give it in a smaller unit or leave it out"
        )
