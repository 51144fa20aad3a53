"""STEP (ISO 10303, AP214), the common tongue of CAD programs."""

from nurbs_lab.interchange._opencascade import nurbs_of
from nurbs_lab.interchange._solids import shapes_of

from OCP.IFSelect import IFSelect_RetDone  # isort: skip  (after the check that it is there)
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer

HOLDS = ("curves", "surfaces", "solids")


def write(path, parts):
    writer = STEPControl_Writer()
    for shape in shapes_of(parts):
        writer.Transfer(shape, STEPControl_AsIs)
    if writer.Write(str(path)) != IFSelect_RetDone:
        raise OSError(f"OpenCASCADE could not write {path}")


def read(path):
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise ValueError(f"path: {str(path)!r} is no STEP file")
    reader.TransferRoots()
    return nurbs_of(reader.OneShape())
