"""STEP (ISO 10303, AP214), the format that all CAD programs share."""

import re

import numpy as np

from nurbs_lab.interchange._export_items import clamped
from nurbs_lab.interchange._opencascade import nurbs_in, shapes_of, without_greetings

from OCP.APIHeaderSection import APIHeaderSection_MakeHeader  # isort: skip  (after the check that it is there)
from OCP.IFSelect import IFSelect_RetDone
from OCP.StepBasic import StepBasic_Product
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.StepData import StepData_Logical
from OCP.StepGeom import StepGeom_BSplineCurveWithKnotsAndRationalBSplineCurve
from OCP.TCollection import TCollection_HAsciiString

NO_DATE, NAME = "1970-01-01T00:00:00", "nurbs_lab"
#: What begins as a number does, and is neither one nor a word between points.
BROKEN = re.compile(r"[(,]\s*(?=[-+.\d])(?!(?:[-+]?\d+(?:\.\d*)?(?:[Ee][-+]?\d+)?|\.\w+\.)\s*[,)])([^\s,)]*)")


@without_greetings()
def write(path, parts):
    for surface in parts.surfaces:
        _require_equal_end_weights(surface)
    writer = STEPControl_Writer()
    for shape in shapes_of(parts):
        writer.Transfer(shape, STEPControl_AsIs)
    _mend(writer.Model())
    if writer.Write(str(path)) != IFSelect_RetDone:
        raise OSError(f"OpenCASCADE could not write {path}")


def _mend(model):
    """Replace the date and the running number: the same shapes then make the same file, byte for byte.

    Nor call a curve closed whose first and last weights differ: the flag is for information only, but
    OpenCASCADE, reading it, joins the ends and drops the last weight.
    """
    APIHeaderSection_MakeHeader(model).SetTimeStamp(TCollection_HAsciiString(NO_DATE))
    for i in range(1, model.NbEntities() + 1):
        entity = model.Value(i)
        if isinstance(entity, StepBasic_Product):
            entity.SetId(TCollection_HAsciiString(NAME))
            entity.SetName(TCollection_HAsciiString(NAME))
        elif isinstance(entity, StepGeom_BSplineCurveWithKnotsAndRationalBSplineCurve):
            weights = entity.WeightsData()
            if weights.First() != weights.Last():
                entity.SetClosedCurve(StepData_Logical.StepData_LFalse)


def _require_equal_end_weights(surface):
    """OpenCASCADE makes a closed surface periodic when it reads one, and drops the last row of weights."""
    for axis, closed in enumerate(surface.closed):
        weights = np.moveaxis(clamped(surface).weights, axis, 0)
        if closed and (weights[0] != weights[-1]).any():
            raise ValueError(
                "items: a .step file cannot hold a closed surface whose first and last weights differ; "
                "write it to .igs .json, or as two halves (surface.split)"
            )


def read(path):
    return nurbs_in(path, "STEP", _promised(path.read_text(encoding="latin-1")))


def _promised(text):
    """The numbers of curves and faces that the text names; refused if a part of it is missing.

    OpenCASCADE itself says where it does not understand a statement or what a statement refers to, but it
    reads numbers as far as they go, and does not ask for the product of a shape.
    """
    if not re.fullmatch(r"(\xef\xbb\xbf)?\s*ISO-10303-21;[^\0]*END-ISO-10303-21;\s*", text):
        raise ValueError("it does not begin and end as a STEP file does; a part of it is missing or damaged")
    plain = re.sub(r"'[^']*'|/\*.*?\*/", "", text, flags=re.DOTALL)
    if found := BROKEN.search(plain):
        raise ValueError(f"its {found[1]!r} is no number; it is damaged")
    entities = dict(re.findall(r"#(\d+)\s*=[\s(]*(\w+)", plain))
    referred = set(re.findall(r"#(\d+)(?!\d|\s*=)", plain))
    # CONTEXT_DEPENDENT_SHAPE_REPRESENTATION is no shape: it places a part in an assembly
    shape = re.compile(r"(?!CONTEXT_DEPENDENT)\w*SHAPE_REPRESENTATION$")
    if loose := [n for n, kind in entities.items() if shape.match(kind) and n not in referred]:
        raise ValueError(f"its shape #{loose[0]} belongs to no product; a part of the file is missing")
    sets = re.findall(r"GEOMETRIC_(?:CURVE_)?SET\s*\(\s*,\s*\(([^)]*)\)", plain)
    curves = sum("CURVE" in entities.get(n, "") for one in sets for n in re.findall(r"#(\d+)", one))
    return curves, len(re.findall(r"\b(?:ADVANCED_FACE|FACE_SURFACE)\s*\(", plain))
