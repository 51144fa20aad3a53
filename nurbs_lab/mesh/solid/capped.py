"""A tube and plane faces in its ends, sewn by OpenCASCADE."""

from nurbs_lab.mesh.solid import opencascade as oc

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire, BRepBuilderAPI_Sewing  # isort: skip
from OCP.BRep import BRep_Tool
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepLib import BRepLib
from OCP.TopAbs import TopAbs_EDGE, TopAbs_SHELL
from OCP.TopoDS import TopoDS, TopoDS_Solid

from OCP.BRep import BRep_Builder  # isort: skip


def capped_tube(tube):
    """The closed shell, whose normals point out, of a surface that is closed along u."""
    face = BRepBuilderAPI_MakeFace(oc.surface_of(tube.clamped()), 1e-7).Face()
    sewing = BRepBuilderAPI_Sewing(1e-6)
    sewing.Add(face)
    for edge in map(TopoDS.Edge_s, oc.parts(face, TopAbs_EDGE)):
        if BRep_Tool.IsClosed_s(edge, face) or BRep_Tool.Degenerated_s(edge):
            continue
        cap = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(edge).Wire(), True)
        if not cap.IsDone():
            raise ValueError("capped: an end section is no plane curve; add a plane one, or a single point")
        sewing.Add(cap.Face())
    sewing.Perform()
    shells = list(oc.parts(sewing.SewedShape(), TopAbs_SHELL))
    if len(shells) != 1:
        raise ValueError("capped: the tube and its caps do not make one closed shell; give simple sections")
    builder, solid = BRep_Builder(), TopoDS_Solid()
    builder.MakeSolid(solid)
    builder.Add(solid, shells[0])
    BRepLib.OrientClosedSolid_s(solid)
    if not BRepCheck_Analyzer(solid).IsValid():
        raise ValueError("capped: the solid between the sections is not valid; do they cross themselves?")
    return next(oc.parts(solid, TopAbs_SHELL))
