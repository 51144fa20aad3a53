"""IGES 5.3, for programs that know no STEP."""

import io

from nurbs_lab.interchange._opencascade import nurbs_of
from nurbs_lab.interchange._solids import shapes_of

from OCP.IFSelect import IFSelect_RetDone  # isort: skip  (after the check that it is there)
from OCP.IGESControl import IGESControl_Reader, IGESControl_Writer
from OCP.IGESData import IGESData_IGESWriter
from OCP.IGESSelect import IGESSelect_WorkLibrary
from OCP.Interface import Interface_Static
from OCP.TCollection import TCollection_HAsciiString

NO_DATE = "19700101.000000"
HOLDS = ("curves", "surfaces", "solids")


def write(path, parts):
    writer = IGESControl_Writer()
    for shape in shapes_of(parts):
        writer.AddShape(shape)
    writer.ComputeModel()
    _leave_out_the_date(writer.Model())
    lines = IGESData_IGESWriter(writer.Model())
    lines.FloatWriter().SetFormat("%.15E")  # the usual nine digits would lose a nanometre on a metre
    lines.FloatWriter().SetZeroSuppress(False)
    lines.SendModel(IGESSelect_WorkLibrary.DefineProtocol_s())
    text = io.BytesIO()
    lines.Print(text)
    path.write_bytes(text.getvalue())


def _leave_out_the_date(model):
    """So that the same shapes make the same file, to the byte, on any day."""
    header = model.GlobalSection()
    header.SetDate(TCollection_HAsciiString(NO_DATE))
    header.SetLastChangeDate(TCollection_HAsciiString(NO_DATE))
    model.SetGlobalSection(header)


def read(path):
    reader = IGESControl_Reader()
    Interface_Static.SetIVal_s("read.iges.bspline.continuity", 0)  # keep corners; do not cut there
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise ValueError(f"path: {str(path)!r} is no IGES file")
    reader.TransferRoots()
    return nurbs_of(reader.OneShape())
