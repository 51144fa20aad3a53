"""OpenCASCADE's shapes: to and from NURBS, and solids of exact trimmed faces. Needs the extra ``cad``."""

import io

import numpy as np
import trimesh

from nurbs_lab.mesh.solid.faces import ALONG, KINDS, Face
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

try:
    from OCP import Geom, Geom2d, LProp, Standard, StdFail, gp
    from OCP.BinTools import BinTools
    from OCP.BRep import BRep_Builder, BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve2d, BRepAdaptor_Surface
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing, BRepBuilderAPI_Transform
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
    from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface
    from OCP.gp import gp_Pnt, gp_Trsf, gp_Vec
    from OCP.GProp import GProp_GProps
    from OCP.IMeshTools import IMeshTools_MeshAlgoType, IMeshTools_Parameters
    from OCP.Precision import Precision
    from OCP.ShapeAnalysis import ShapeAnalysis_FreeBounds
    from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
    from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_REVERSED, TopAbs_SHELL, TopAbs_WIRE
    from OCP.TopExp import TopExp
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS, TopoDS_Compound, TopoDS_Shape, TopoDS_Shell
    from OCP.TopTools import TopTools_IndexedDataMapOfShapeListOfShape

    from nurbs_lab.mesh.solid.opencascade_reader import from_edge, from_face, is_flat, parts
except ImportError as missing:
    raise ImportError(
        'STEP, IGES and exact faces need OpenCASCADE; get it by: pip install "cadquery-ocp-novtk==7.9.*"'
    ) from missing

CONFUSION = Precision.Confusion_s()  # 1e-7 units: OpenCASCADE's tolerance of vertices, edges and faces
#: What OpenCASCADE raises. In Python none of them is a kind of another, nor of `Standard_Failure`.
FAILURES = tuple(
    one
    for module in (Standard, StdFail, Geom, Geom2d, LProp, gp)
    for one in vars(module).values()
    if isinstance(one, type) and issubclass(one, Exception)
)


def curve_of(curve: NurbsCurve):
    """A clamped curve in space, or in the plane z = 0, as OpenCASCADE's geometry."""
    points = _fill(TColgp_Array1OfPnt(1, len(curve.weights)), _points(curve))
    weights = _fill(TColStd_Array1OfReal(1, len(curve.weights)), curve.weights.tolist())
    return Geom_BSplineCurve(points, weights, *_knots(curve.knots), curve.degree)


def surface_of(surface: NurbsSurface):
    """A clamped surface as OpenCASCADE's geometry."""
    shape = surface.weights.shape
    points = TColgp_Array2OfPnt(1, shape[0], 1, shape[1])
    weights = TColStd_Array2OfReal(1, shape[0], 1, shape[1])
    flat = _points(surface)
    for k, (i, j) in enumerate(np.ndindex(shape)):
        points.SetValue(i + 1, j + 1, flat[k])
        weights.SetValue(i + 1, j + 1, float(surface.weights[i, j]))
    (u, u_counts), (v, v_counts) = map(_knots, surface.knots)
    return Geom_BSplineSurface(points, weights, u, v, u_counts, v_counts, *surface.degrees)


def _points(shape):
    rows = shape.control_points.reshape(-1, shape.dim)
    return [gp_Pnt(*row) for row in np.pad(rows, ((0, 0), (0, 3 - shape.dim))).tolist()]


def _knots(knots):
    values, counts = np.unique(knots, return_counts=True)
    return (
        _fill(TColStd_Array1OfReal(1, len(values)), values.tolist()),
        _fill(TColStd_Array1OfInteger(1, len(values)), counts.tolist()),
    )


def _fill(array, values):
    for i, value in enumerate(values, start=1):
        array.SetValue(i, value)
    return array


def sewn(faces) -> list:
    """The shells that faces make which meet in equal edges."""
    sewing = BRepBuilderAPI_Sewing()
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    return list(parts(sewing.SewedShape(), TopAbs_SHELL))


def capped_tube(tube):
    """The closed shell, whose normals point out, of a surface that is closed along u and plane faces."""
    rest, faces = tube.clamped(), []
    values, counts = np.unique(rest.knots[0], return_counts=True)
    for crease in values[1:-1][counts[1:-1] >= rest.degrees[0]]:
        piece, rest = rest.split(crease)
        faces.append(piece)
    faces = [BRepBuilderAPI_MakeFace(surface_of(one), CONFUSION).Face() for one in (*faces, rest)]
    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    for wire in parts(ShapeAnalysis_FreeBounds(shell, CONFUSION).GetClosedWires(), TopAbs_WIRE):
        try:
            faces.append(BRepBuilderAPI_MakeFace(TopoDS.Wire_s(wire), True).Face())
        except FAILURES:
            raise ValueError(
                "capped: an end section is no plane curve, or crosses itself; add a plane and simple one, or "
                "a single point"
            ) from None
    shells = sewn(faces)
    valid = len(shells) == 1 and BRepCheck_Analyzer(shells[0]).IsValid()
    if not valid or BRep_Tool.IsClosed_s(shells[0]) is False:
        raise ValueError("capped: the tube and its caps make no valid solid; give simple sections")
    rough = GProp_GProps()
    BRepGProp.VolumeProperties_s(shells[0], rough, True)  # its sign tells where the normals point
    return shells[0] if rough.Mass() > 0.0 else shells[0].Reversed()


def faces_of(shape) -> tuple[Face, ...]:
    """All faces of a shape as values."""
    return tuple(_face(TopoDS.Face_s(one)) for one in parts(shape, TopAbs_FACE))


def _face(face):
    adaptor, loops = BRepAdaptor_Surface(face), []
    for wire in parts(face, TopAbs_WIRE):
        loops += _loops(TopoDS.Wire_s(wire), face)
    kind = adaptor.GetType().name.removeprefix("GeomAbs_").lower()
    kind = kind if kind in KINDS else "patch"
    size = [max(np.ptp(np.concatenate([c.control_points for c in loop]), axis=0)) for loop in loops]
    loops = tuple(loops[k] for k in np.argsort(size)[::-1])
    outward = face.Orientation() != TopAbs_REVERSED
    return Face(kind, NurbsSurface(*from_face(face)), loops, outward, **_dimensions(adaptor, kind))


def _loops(wire, face):
    """The edges of a wire, parted where it goes along a seam or around a pole."""
    explorer, loops, cut = BRepTools_WireExplorer(wire, face), [[]], False
    while explorer.More():
        edge = explorer.Current()
        if BRep_Tool.Degenerated_s(edge) or BRep_Tool.IsClosed_s(edge, face):
            loops, cut = [*loops, []], True
        else:
            curve = NurbsCurve(*from_edge(edge))
            loops[-1].append(curve.reverse() if edge.Orientation() == TopAbs_REVERSED else curve)
        explorer.Next()
    if cut:
        loops = [loops[-1] + loops[0], *loops[1:-1]]
    return [tuple(loop) for loop in loops if loop]


def _dimensions(adaptor, kind):
    if kind == "patch":
        return {}
    shape = getattr(adaptor, kind.capitalize())()
    axis = shape.Axis().Direction() if kind != "sphere" else None
    place = shape.Apex() if kind == "cone" else shape.Location()
    out = {"point": np.array(place.Coord()), "axis": None if axis is None else np.array(axis.Coord())}
    if kind in ("cylinder", "sphere"):
        out["radius"] = shape.Radius()
    if kind == "torus":
        out |= {"radius": shape.MinorRadius(), "major_radius": shape.MajorRadius()}
    if kind == "cone":
        out["half_angle"] = float(np.degrees(abs(shape.SemiAngle())))
    return out


def to_bytes(shape) -> bytes:
    """A shape in OpenCASCADE's binary format, the same for the same shape."""
    stream = io.BytesIO()
    BinTools.Write_s(shape, stream)
    return stream.getvalue()


def scaled(shape, size):
    """A shape, larger by a factor about the origin."""
    change = gp_Trsf()
    change.SetScaleFactor(size)
    return shape if size == 1.0 else BRepBuilderAPI_Transform(shape, change, True).Shape()


def from_bytes(data):
    """The shape that `to_bytes` wrote."""
    shape = TopoDS_Shape()
    BinTools.Read_s(shape, io.BytesIO(data))
    return shape


def volume(shape):
    """Volume inside closed faces, in the units of the shape; of trimmed splines within 1e-6 of itself."""
    found = GProp_GProps()
    BRepGProp.VolumePropertiesGK_s(shape, found, 1e-6, True)
    return found.Mass()


def area(shape):
    """Area of faces, in the units of the shape; of trimmed splines within 1e-6 of itself."""
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found, 1e-6)
    return found.Mass()


def angles_of(shape):
    """Largest angle between the outward normals of both faces along every edge, degrees; no seams."""
    sides, t, out = TopTools_IndexedDataMapOfShapeListOfShape(), np.linspace(0.0, 1.0, ALONG), []
    TopExp.MapShapesAndAncestors_s(shape, TopAbs_EDGE, TopAbs_FACE, sides)
    for k in range(1, sides.Extent() + 1):
        edge, faces = TopoDS.Edge_s(sides.FindKey(k)), [TopoDS.Face_s(f) for f in sides.FindFromIndex(k)]
        if BRep_Tool.Degenerated_s(edge) or len(faces) != 2 or faces[0].IsSame(faces[1]):
            continue
        normals = [_normals_along(edge, face, t) for face in faces]
        sine = np.linalg.norm(np.cross(*normals), axis=1)
        out.append(np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", *normals))).max())
    return np.array(out)


def _normals_along(edge, face, t):
    curve, surface = BRepAdaptor_Curve2d(edge, face), BRepAdaptor_Surface(face)
    first, last = curve.FirstParameter(), curve.LastParameter()
    normals, place, along, across = [], gp_Pnt(), gp_Vec(), gp_Vec()
    for at in first + (last - first) * t:
        uv = curve.Value(float(at))
        surface.D1(uv.X(), uv.Y(), place, along, across)
        normals.append(along.Crossed(across).Coord())
    normals = np.array(normals) * (-1.0 if face.Orientation() == TopAbs_REVERSED else 1.0)
    return normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]


def triangles_of(shape, tolerance) -> trimesh.Trimesh:
    """Closed triangles within ``tolerance`` of a closed shape; attribute ``face`` numbers its faces."""
    BRepTools.Clean_s(shape)
    how, by_delabella = IMeshTools_Parameters(), TopoDS_Compound()
    how.Deflection, how.Angle = tolerance, 0.5
    BRep_Builder().MakeCompound(by_delabella)
    for face in map(TopoDS.Face_s, parts(shape, TopAbs_FACE)):
        if not is_flat(BRep_Tool.Surface_s(face)) or len(list(parts(face, TopAbs_WIRE))) > 1:
            BRep_Builder().Add(by_delabella, face)
    # Watson's algorithm is quadratic; Delabella's can crash at a plane within an arc and its centre.
    how.MeshAlgo = IMeshTools_MeshAlgoType.IMeshTools_MeshAlgoType_Delabella
    BRepMesh_IncrementalMesh(by_delabella, how)
    how.MeshAlgo = IMeshTools_MeshAlgoType.IMeshTools_MeshAlgoType_Watson
    BRepMesh_IncrementalMesh(shape, how)
    vertices, faces, count = [], [], 0
    for one in parts(shape, TopAbs_FACE):
        face, place = TopoDS.Face_s(one), TopLoc_Location()
        found = BRep_Tool.Triangulation_s(face, place)
        if found is None:
            raise ValueError("tolerance: OpenCASCADE leaves a face without triangles there; give another one")
        vertices += [found.Node(i + 1).Coord() for i in range(found.NbNodes())]
        corners = np.array([found.Triangle(i + 1).Get() for i in range(found.NbTriangles())]).reshape(-1, 3)
        order = corners[:, ::-1] if face.Orientation() == TopAbs_REVERSED else corners
        faces.append(order - 1 + count)
        count = len(vertices)
    face = np.repeat(np.arange(len(faces)), [len(part) for part in faces])
    mesh = trimesh.Trimesh(vertices, np.concatenate(faces), process=False, face_attributes={"face": face})
    mesh.merge_vertices(digits_vertex=8)
    mesh.update_faces((np.diff(np.sort(mesh.faces, axis=1), axis=1) > 0).all(axis=1))  # flat ones close it
    return mesh
