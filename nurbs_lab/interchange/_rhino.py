"""Rhino's 3dm, through McNeel's own library.

Its archives hold the time of writing and the temporary name, each with a checksum; all other bytes are the
same whenever the same items are written.

The faces of a solid are stored as separate surfaces. rhino3dm makes a joined object (a ``Brep``) of one
surface or of a primitive only; it has no function that joins several faces. In Rhino the command ``Join``
makes one solid of them, because neighbours share their edges exactly.
"""

import itertools
import uuid
import warnings
from pathlib import Path

import numpy as np

from nurbs_lab.interchange._export_items import clamped, in_space
from nurbs_lab.interchange._rhino_archive import objects_promised
from nurbs_lab.interchange._subprocess_reader import shapes_in
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface
from nurbs_lab.nurbs.refinement import lift

try:
    import rhino3dm
except ImportError as missing:
    raise ImportError('.3dm files need rhino3dm; install it with: pip install "rhino3dm>=8"') from missing

VERSION = 7  # of the archive: Rhino 7 and later read it
READER = Path(__file__).with_name("_rhino_reader.py")
NUMBERED = uuid.UUID("6e757262-735f-6c61-625f-2e33646d0000")  # where identifiers are derived from


def write(path, parts):
    model = rhino3dm.File3dm()
    model.Settings.ModelUnitSystem = rhino3dm.UnitSystem.Millimeters
    numbers = itertools.count()
    layer = _numbered(rhino3dm.Layer(), numbers)
    layer.Name = "Default"
    model.Layers.Add(layer)
    for curve in parts.curves:
        model.Objects.AddCurve(_curve(clamped(curve)), _numbered(rhino3dm.ObjectAttributes(), numbers))
    for surface in parts.all_surfaces:
        model.Objects.AddSurface(_surface(clamped(surface)), _numbered(rhino3dm.ObjectAttributes(), numbers))
    if not model.Write(str(path), VERSION):
        raise OSError(f"rhino3dm could not write {path}")


def _numbered(thing, numbers):
    """With an identifier of its own; the library would draw another one in every run."""
    thing.Id = uuid.uuid5(NUMBERED, str(next(numbers)))
    return thing


def read(path):
    promised = objects_promised(path.read_bytes())
    curves, surfaces, others, found = shapes_in(READER, "rhino3dm", path)
    if found < promised:
        warnings.warn(
            f"path: {path.name} holds {promised} objects, and rhino3dm reads only {found} of them; "
            "the file may be damaged",
            stacklevel=3,
        )
    if others:
        kinds = ", ".join(f"{count} x {kind}" for kind, count in sorted(others.items()))
        warnings.warn(f"path: {path.name} also holds what is no curve and no surface: {kinds}", stacklevel=3)
    return [
        *(NurbsCurve.from_homogeneous(*curve) for curve in curves),
        *(NurbsSurface.from_homogeneous(*surface) for surface in surfaces),
    ]


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


def _homogeneous(part):
    rows = lift(in_space(part.control_points), part.weights)
    return [rhino3dm.Point4d(*row) for row in rows.reshape(-1, 4).tolist()]


def _set_knots(out, knots):
    for i, value in enumerate(knots[1:-1].tolist()):
        out[i] = value
