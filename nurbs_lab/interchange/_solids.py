"""A reconstruction as solids, for STEP and IGES.

A tube ends at its last contour, and the mesh goes on for part of a layer: to the tip of a cap, or through the
slab where tubes branch. So every tube is carried on, straight along the axis, for half of that slab before it
is closed by a plane: two tubes that meet at a branch then touch in its middle, and the volumes add up to that
of the mesh with an error of second order. Tubes that bound a hollow are cut out of the others.
"""

import warnings

from nurbs_lab.interchange._opencascade import edge_of, explore, face_of, vector_of

from OCP.BRep import BRep_Builder, BRep_Tool  # isort: skip  (after the check that it is there)
from OCP.Bnd import Bnd_Box
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepBuilderAPI import (
    BRepBuilderAPI_MakeFace,
    BRepBuilderAPI_MakePolygon,
    BRepBuilderAPI_MakeSolid,
    BRepBuilderAPI_MakeWire,
    BRepBuilderAPI_Sewing,
)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepLib import BRepLib
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeFilling
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.GeomAbs import GeomAbs_C0
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS, TopoDS_Shell

SEWING_MM = 1e-6  # faces nearer than this are sewn together


def shapes_of(parts):
    """One OpenCASCADE shape for every curve, surface and tube."""
    solids = [shape for reconstruction in parts.solids for shape in solids_of(reconstruction)]
    return [*map(edge_of, parts.curves), *map(face_of, parts.surfaces), *solids]


def solids_of(reconstruction):
    """One OpenCASCADE solid for every tube, hollows cut out; a face where a tube does not close."""
    tubes = getattr(reconstruction, "tubes", None)
    if tubes is None:
        return [_solid(surface) for surface in reconstruction.surfaces]
    carry = _carry_on(reconstruction)
    made = [(t.is_hole, _solid(t.surface, carry(t.contours[0], -1), carry(t.contours[-1], 1))) for t in tubes]
    made += [(c.is_hole, _plate(c, carry(c, -1), carry(c, 1))) for c in reconstruction.unskinned if c.closed]
    hollows = [shape for is_hole, shape in made if is_hole]
    return [_without(shape, hollows) for is_hole, shape in made if not is_hole]


def _carry_on(reconstruction):
    """How far the tube that ends in a contour goes on, as a vector: half of the slab it ends in."""
    normal = reconstruction.frame[2]
    z = reconstruction.mesh.vertices @ normal
    planes = [z.min(), *(layer.height for layer in reconstruction.layers), z.max()]
    lengths = {}
    for junction in reconstruction.junctions:
        slab = junction.slab
        inner_cap = junction.kind == "cap" and 0 < slab < len(planes) - 2  # its tip may be near: add nothing
        half = 0.0 if inner_cap else (planes[slab + 1] - planes[slab]) / 2
        lengths |= {(id(contour), 1): half for contour in junction.below}
        lengths |= {(id(contour), -1): half for contour in junction.above}
    return lambda contour, side: side * lengths.get((id(contour), side), 0.0) * normal


def _solid(surface, down=None, up=None):
    """A tube carried on at its ends and filled there; the surface alone, with a warning, if that fails."""
    face = face_of(surface)
    first = gp_Pnt(*surface(*(span[0] for span in surface.domain)).tolist())
    sewing = BRepBuilderAPI_Sewing(SEWING_MM)
    sewing.Add(face)
    for rim in _rims(face):
        at_first = BRep_Tool.Pnt_s(TopExp.FirstVertex_s(rim)).Distance(first) < SEWING_MM
        step = down if at_first else up
        if step is not None and step.any():
            band = BRepPrimAPI_MakePrism(rim, vector_of(step))
            sewing.Add(band.Shape())
            rim = TopoDS.Edge_s(band.LastShape())
        sewing.Add(_cap(rim))
    sewing.Perform()
    shell, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(shell)
    for part in explore(sewing.SewedShape(), TopAbs_FACE):
        builder.Add(shell, part)
    solid = BRepBuilderAPI_MakeSolid(shell).Solid()
    if BRepLib.OrientClosedSolid_s(solid) and BRepCheck_Analyzer(solid).IsValid():
        return solid
    warnings.warn(f"{surface} does not close into a valid solid; written as an open surface", stacklevel=6)
    return face


def _plate(contour, down, up):
    """A contour that no tube goes through: the slice of the mesh around it, with upright walls."""
    outline = BRepBuilderAPI_MakePolygon()
    for point in contour.points_3d + down:
        outline.Add(gp_Pnt(*point.tolist()))
    outline.Close()
    base = BRepBuilderAPI_MakeFace(outline.Wire(), True).Face()
    return BRepPrimAPI_MakePrism(base, vector_of(up - down)).Shape()


def _rims(face):
    """The edges that end a tube: closed, no seam, not shrunk to a pole."""
    for edge in map(TopoDS.Edge_s, explore(face, TopAbs_EDGE)):
        seam = BRep_Tool.IsClosed_s(edge, face)
        if BRep_Tool.IsClosed_s(edge) and not seam and not BRep_Tool.Degenerated_s(edge):
            yield edge


def _cap(rim):
    """A plane face inside the rim, or, where the rim is not plane, the smoothest patch through it."""
    plane = BRepBuilderAPI_MakeFace(BRepBuilderAPI_MakeWire(rim).Wire(), True)
    if plane.IsDone():
        return plane.Face()
    patch = BRepOffsetAPI_MakeFilling()
    patch.Add(rim, GeomAbs_C0)
    patch.Build()
    return patch.Shape()


def _without(solid, hollows):
    """The solid less the hollows whose boxes meet its box."""
    for hollow in hollows:
        if _box(solid).IsOut(_box(hollow)):
            continue
        rest = BRepAlgoAPI_Cut(solid, hollow).Shape()
        whole = list(explore(rest, TopAbs_SOLID))
        if len(whole) == 1 and BRepCheck_Analyzer(whole[0]).IsValid():
            solid = whole[0]
        else:
            warnings.warn("a hollow could not be cut out of its solid; it is left filled", stacklevel=6)
    return solid


def _box(shape):
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    return box
