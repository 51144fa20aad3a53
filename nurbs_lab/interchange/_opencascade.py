"""To and from OpenCASCADE's shapes, for STEP and IGES."""

import pickle
import subprocess
import sys
import tempfile
import warnings
from contextlib import contextmanager
from pathlib import Path

from nurbs_lab.interchange._export_items import clamped
from nurbs_lab.mesh import TrimmedShell, solid
from nurbs_lab.mesh.solid.opencascade import curve_of, sewn, surface_of
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

from OCP.BRep import BRep_Builder  # isort: skip
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace
from OCP.Message import Message, Message_Gravity
from OCP.TopoDS import TopoDS_Solid

READER = Path(solid.__file__).with_name("opencascade_reader.py")
PATIENCE_S = 60  # for any file, and
PATIENCE_S_PER_MB = 2.0  # more for a large one
MEMORY_BYTES = 4 * 2**30  # of addresses; the libraries alone take a quarter of it
MEMORY_PER_BYTE = 100  # more for every byte of the file


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


def shapes_of(parts):
    """One OpenCASCADE shape for every curve and surface, and a solid for every body of a reconstruction."""
    solids = [_solid_of(body) for reconstruction in parts.solids for body in reconstruction.bodies]
    return [*map(edge_of, parts.curves), *map(_face_of, parts.surfaces), *solids]


def edge_of(curve):
    """The whole curve as an edge."""
    return BRepBuilderAPI_MakeEdge(curve_of(clamped(curve))).Edge()


def _face_of(surface):
    return BRepBuilderAPI_MakeFace(surface_of(clamped(surface)), 1e-7).Face()


def _solid_of(shells):
    """A solid bounded by shells: its outer boundary and its voids.

    Fitted faces that meet have equal control points along their edge, so OpenCASCADE sews them exactly.
    """
    builder, made = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(made)
    for shell in shells:
        if isinstance(shell, TrimmedShell):
            builder.Add(made, shell.shape())
            continue
        found = sewn(map(_face_of, shell.surfaces))
        if len(found) != 1:
            raise ValueError(f"items: the faces of a shell make {len(found)} shells; give a larger tolerance")
        builder.Add(made, found[0])
    return made


def nurbs_in(path, format, promised):
    """The curves and then the surfaces of a file; flat faces are left out.

    ``promised`` holds the numbers of curves and of faces that the text of the file names.
    """
    curves, surfaces, faces, lost = found_by_reader(path, format)
    said = [f"has {len(lost)} parts that OpenCASCADE does not know, such as {lost[0]!r}"] if lost else []
    for kind, named, found in zip(("curves", "faces"), promised, (len(curves), faces), strict=True):
        if found < named:
            said.append(f"names {named} {kind}, and OpenCASCADE reads only {found} of them")
    for what in said:
        unusual = "the file may be damaged, or they are of an unusual kind"
        warnings.warn(f"path: {path.name} {what}; {unusual}", stacklevel=5)
    return [
        *(NurbsCurve(*curve).clamped() for curve in curves),
        *(NurbsSurface(*surface).clamped() for surface in surfaces),
    ]


def found_by_reader(path, format):
    """What READER finds in a file, in a process of its own: it may crash, hang or fill the memory.

    ValueError has the last words of the program, or says that it crashed or was stopped.
    """
    size = path.stat().st_size
    patience, memory = PATIENCE_S + PATIENCE_S_PER_MB * size / 1e6, MEMORY_BYTES + MEMORY_PER_BYTE * size
    command = [sys.executable, "-P", READER, str(memory), path, format]
    with tempfile.TemporaryFile() as found, tempfile.TemporaryFile() as said:
        try:
            ran = subprocess.run(
                command, stdin=subprocess.DEVNULL, stdout=found, stderr=said, timeout=patience
            )
        except subprocess.TimeoutExpired:
            raise ValueError(f"OpenCASCADE found no end of it in {patience:.3g} s; it is damaged") from None
        said.seek(0)
        last = (said.read().decode(errors="replace").splitlines() or [""])[-1]
        if any(word in last for word in ("MemoryError", "bad_alloc", "OutOfMemory")):
            raise ValueError(f"OpenCASCADE asked for more than {memory / 2**30:.1f} GB; it is damaged")
        if ran.returncode:
            raise ValueError(last if ran.returncode > 0 else "OpenCASCADE crashed on it; it is damaged")
        found.seek(0)
        return pickle.load(found)
