"""Solids made with OpenCASCADE, their meshes, and what OpenCASCADE says of a reconstruction."""

from functools import partial

import numpy as np
import pyvista as pv
import trimesh
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer, BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeSphere,
)
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS

import nurbs_lab as nl


def parts(shape, kind):
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def box(x, y, z, a, b, c):
    return BRepPrimAPI_MakeBox(gp_Pnt(x, y, z), a, b, c).Shape()


def rod(x, y, z, radius, height, along=(0, 0, 1)):
    return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(x, y, z), gp_Dir(*along)), radius, height).Shape()


def joined(one, other):
    union = ShapeUpgrade_UnifySameDomain(BRepAlgoAPI_Fuse(one, other).Shape(), True, True, False)
    union.Build()
    return union.Shape()


def without(one, *others):
    for other in others:
        one = BRepAlgoAPI_Cut(one, other).Shape()
    return one


def rounded(shape, radius, chosen, tool=BRepFilletAPI_MakeFillet):
    maker, seen = tool(shape), set()
    for edge in map(TopoDS.Edge_s, parts(shape, TopAbs_EDGE)):
        curve = BRepAdaptor_Curve(edge)
        middle = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2)
        place = tuple(round(x, 4) for x in (middle.X(), middle.Y(), middle.Z()))
        if place not in seen and chosen(*place):
            maker.Add(radius, edge)
        seen.add(place)
    return maker.Shape()


def meshed(shape, distance, angle):
    BRepMesh_IncrementalMesh(shape, distance, False, angle, False)
    vertices, triangles = [], []
    for face in map(TopoDS.Face_s, parts(shape, TopAbs_FACE)):
        found = BRep_Tool.Triangulation_s(face, TopLoc_Location())
        nodes = [found.Node(i + 1) for i in range(found.NbNodes())]
        corners = np.array([found.Triangle(i + 1).Get() for i in range(found.NbTriangles())])
        order = corners[:, ::-1] if face.Orientation() == TopAbs_REVERSED else corners
        triangles.append(order - 1 + len(vertices))
        vertices += [(p.X(), p.Y(), p.Z()) for p in nodes]
    return trimesh.Trimesh(vertices, np.concatenate(triangles))


def sizes(shape):
    """Kind and radii of every face, by OpenCASCADE."""
    out = []
    for face in map(TopoDS.Face_s, parts(shape, TopAbs_FACE)):
        surface = BRepAdaptor_Surface(face)
        kind = str(surface.GetType()).split("_")[-1].lower()
        if kind == "torus":
            out.append((kind, surface.Torus().MinorRadius(), surface.Torus().MajorRadius()))
        elif kind == "cone":
            out.append((kind, np.degrees(abs(surface.Cone().SemiAngle())), 0.0))
        elif kind in ("cylinder", "sphere"):
            out.append((kind, getattr(surface, kind.capitalize())().Radius(), 0.0))
        else:
            out.append((kind, 0.0, 0.0))
    return sorted(out)


def volume(shape):
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, 1e-9)
    return properties.Mass()


def plate():
    places = ((10, 10, 4), (50, 10, 4), (50, 30, 4), (10, 30, 4), (30, 20, 9))
    return without(box(0, 0, 0, 60, 40, 6), *(rod(x, y, -1, r, 8) for x, y, r in places))


def bracket():
    part = joined(box(0, 0, 0, 40, 30, 6), box(0, 0, 0, 6, 30, 35))
    part = rounded(part, 5.0, lambda x, y, z: abs(x - 6) < 1e-3 and abs(z - 6) < 1e-3)
    return without(part, rod(26, 15, -1, 5, 8), rod(-1, 15, 23, 5, 8, (1, 0, 0)))


def boss():
    part = joined(box(0, 0, 0, 40, 40, 8), rod(20, 20, 0, 8, 25))
    return rounded(part, 3.0, lambda x, y, z: abs(z - 8) < 1e-3 and max(abs(x - 20), abs(y - 20)) < 9)


def made(seed):
    """A block with two round edges, crossing holes of random sizes, and a boss."""
    rng = np.random.default_rng(seed)
    a, b, c = rng.uniform(20, 60, 3)
    r, s, t = rng.uniform(0.05, 0.18, 3) * min(a, b, c)
    part = rounded(box(0, 0, 0, a, b, c), 2 * r, lambda x, y, z: abs(z - c / 2) < 1e-3 and x < 1e-3)
    part = without(part, rod(a / 3, b / 2, -1, s, c + 2), rod(-1, b / 2, c / 2, t, a + 2, (1, 0, 0)))
    return joined(part, rod(2 * a / 3, b / 2, c - 1, r, 10))


PARTS = {f"made {seed}": partial(made, seed) for seed in range(5)} | {
    "cylinder": lambda: rod(0, 0, 0, 10, 30),
    "plate": plate,
    "cube with fillets": lambda: rounded(box(0, 0, 0, 30, 20, 12), 4.0, lambda *_: True),
    "chamfers": lambda: rounded(rod(0, 0, 0, 10, 30), 2.0, lambda *_: True, BRepFilletAPI_MakeChamfer),
    "fillets of a rod": lambda: rounded(rod(0, 0, 0, 10, 30), 3.0, lambda *_: True),
    "bracket": bracket,
    "boss": boss,
    "drilled ball": lambda: without(BRepPrimAPI_MakeSphere(10.0).Shape(), rod(0, 0, -20, 3, 40)),
    "tee": lambda: joined(rod(0, 0, 0, 6, 40), rod(0, 0, 20, 4, 25, (1, 0, 0))),
}


def stored(folder, rebuilt):
    """What OpenCASCADE reads from the STEP file of a reconstruction, a valid shape."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(nl.export(folder / "part.step", rebuilt)))
    reader.TransferRoots()
    found = reader.OneShape()
    assert BRepCheck_Analyzer(found).IsValid()
    return found


def apart(closed, mesh):
    """The largest distance of vertices from the other mesh, both ways, by VTK.

    Triangles of no area are left out: VTK reads past the end of its memory there.
    """
    both = [pv.wrap(part.submesh([part.nondegenerate_faces()], append=True)) for part in (closed, mesh)]
    ways = (one.compute_implicit_distance(other)["implicit_distance"] for one, other in (both, both[::-1]))
    return max(np.abs(gaps).max() for gaps in ways)
