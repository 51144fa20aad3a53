"""STEP (ISO 10303, AP214), the common tongue of CAD programs."""

from nurbs_lab.interchange._opencascade import nurbs_in
from nurbs_lab.interchange._solids import shapes_of

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader  # isort: skip  (after the check that it is there)
from OCP.IFSelect import IFSelect_RetDone
from OCP.StepBasic import StepBasic_Product
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TCollection import TCollection_HAsciiString

NO_DATE, NAME = "1970-01-01T00:00:00", "nurbs_lab"
HOLDS = ("curves", "surfaces", "solids")


def write(path, parts):
    writer = STEPControl_Writer()
    for shape in shapes_of(parts):
        writer.Transfer(shape, STEPControl_AsIs)
    _leave_out_date_and_count(writer.Model())
    if writer.Write(str(path)) != IFSelect_RetDone:
        raise OSError(f"OpenCASCADE could not write {path}")


def _leave_out_date_and_count(model):
    """So that the same shapes make the same file, to the byte, on any day and however many were written."""
    APIHeaderSection_MakeHeader(model).SetTimeStamp(TCollection_HAsciiString(NO_DATE))
    for i in range(1, model.NbEntities() + 1):
        if isinstance(entity := model.Value(i), StepBasic_Product):
            entity.SetId(TCollection_HAsciiString(NAME))
            entity.SetName(TCollection_HAsciiString(NAME))


def read(path):
    return nurbs_in(path, "STEP")
