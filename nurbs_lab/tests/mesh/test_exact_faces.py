"""Solids made with OpenCASCADE and meshed come back with the faces that they had."""

from collections import Counter
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
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
    BRepPrimAPI_MakeCone,
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
from nurbs_lab.mesh.solid import regions
from nurbs_lab.mesh.solid.faces import kinds_of_faces


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
    """The largest distance of vertices from the other mesh, both ways, by VTK."""
    both = pv.wrap(closed), pv.wrap(mesh)
    ways = (one.compute_implicit_distance(other)["implicit_distance"] for one, other in (both, both[::-1]))
    return max(np.abs(gaps).max() for gaps in ways)


@pytest.mark.parametrize("name", PARTS)
def test_a_meshed_solid_gets_its_faces_back(tmp_path, name):
    shape = PARTS[name]()
    distance, angle = (0.02, 0.15) if name in ("plate", "bracket") else (0.3, 0.4)
    mesh = meshed(shape, distance, angle)
    tolerance = 0.01 * mesh.scale
    rebuilt = nl.reconstruct(mesh, tolerance=tolerance)
    found = stored(tmp_path, rebuilt)
    here, there = sizes(found), sizes(shape)
    assert [kind for kind, *_ in here] == [kind for kind, *_ in there]
    assert np.abs(np.array([s[1:] for s in here]) - [s[1:] for s in there]).max() < 1e-3 * tolerance
    assert volume(found) == pytest.approx(volume(shape), rel=1e-7)
    assert rebuilt.volume == pytest.approx(volume(shape), rel=1e-7)
    assert Counter(face.kind for face in rebuilt.shells[0].faces) == Counter(kind for kind, *_ in there)
    closed = rebuilt.to_mesh()
    assert closed.is_watertight
    assert apart(closed, mesh) <= tolerance
    assert rebuilt.within_tolerance
    assert rebuilt.seam_angle < 1e-4


def test_loops_lie_on_their_surfaces_and_close():
    rebuilt = nl.reconstruct(meshed(boss(), 0.05, 0.2), tolerance=0.3)
    for face in rebuilt.shells[0].faces:
        assert len(face.loops) == (2 if face.kind in ("cylinder", "torus") or len(face.loops) == 2 else 1)
        for loop in face.loops:
            for curve, following in zip(loop, (*loop[1:], loop[0]), strict=True):
                ends = curve(curve.domain[1]), following(following.domain[0])
                assert np.allclose(*ends, atol=1e-6)
                places = curve(np.linspace(*curve.domain, 9))
                assert face.surface.closest_point(places)[1].max() < 1e-6
    faces = nl.reconstruct(
        trimesh.Trimesh(*(lambda m: (m.vertices.astype(np.float32), m.faces))(meshed(plate(), 0.02, 0.15))),
        tolerance=0.3,
    ).faces
    assert len({face.radius for face in faces if face.kind == "cylinder"}) == 2  # equal to the last bit
    line = kinds_of_faces(rebuilt.shells[0].faces)
    assert line == "7 planes, 1 cylinder of 8 mm, 1 torus of 11 and 3 mm"


def test_patches_only_if_asked_for_and_where_the_shape_is_free():
    rod_ = trimesh.creation.cylinder(5.0, 20.0, sections=64)
    fitted = nl.reconstruct(rod_, tolerance=0.1, faces="patches")
    assert {face.kind for face in fitted.shells[0].faces} == {"patch"}
    angle = np.linspace(0.0, np.pi, 25)
    vase = trimesh.creation.revolve(  # whose rings lie on cones, which do not touch one another
        np.column_stack([np.sin(angle) * (10 + 3 * np.sin(3 * angle)), -20 * np.cos(angle)]), sections=48
    )
    vase.merge_vertices()
    assert {face.kind for face in nl.reconstruct(vase, tolerance=0.5).shells[0].faces} == {"patch"}
    with pytest.raises(ValueError, match="faces"):
        nl.reconstruct(rod_, tolerance=0.1, faces="some")


def test_a_report_names_no_value_that_only_rounding_makes():
    turned = trimesh.creation.box((40, 30, 20))
    turned.apply_transform(trimesh.transformations.rotation_matrix(0.6, (1, 2, 3)))
    told = nl.reconstruct(turned, tolerance=0.1).report()
    assert "largest below 1e-9 mm, mean below 1e-9 mm" in told
    assert "made equal" not in told


def test_capped_sections_are_a_closed_solid(tmp_path):
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    rings = [np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + 3 * r]) for r in (2.0, 4.0)]
    solid = nl.skin(rings, capped=True)
    assert [face.kind for face in solid.faces] == ["patch", "plane", "plane"]
    assert solid.volume == pytest.approx(np.pi * 6 / 3 * (4 + 8 + 16), rel=1e-5)
    assert "2 exact, 1 smooth" in solid.report()
    assert "mesh" not in solid.report()
    assert volume(stored(tmp_path, solid)) == pytest.approx(solid.volume, rel=1e-6)
    eight, up = np.column_stack([np.sin(angle), np.sin(2 * angle), 0 * angle]), np.array([0, 0, 1])
    for wrong, said in (
        ([ring[:30] for ring in rings], "closed"),
        ([ring * (1, 1, 0) for ring in rings], "encloses no volume"),
        ([eight, eight + up], "passes through itself|no volume"),  # OpenCASCADE's volume of it never ended
        ([rings[0], rings[0] + 3 * up, rings[0] + up], "passes through itself"),
        ([rings[0], eight + 20 * up], "crosses itself"),  # a cap that OpenCASCADE fails to make
    ):
        with pytest.raises(ValueError, match=said):
            nl.skin(wrong, capped=True)


@pytest.mark.parametrize("radius", [2.0, 2.5, 3.0])
def test_fillets_of_half_the_radius_of_a_corner_and_more(radius):
    """Their tori are the outsides of horns and spindles, whose tubes cross their axes."""
    upright = rounded(box(0, 0, 0, 30, 20, 12), 4.0, lambda x, y, z: abs(z - 6) < 1e-3)
    part = rounded(upright, radius, lambda x, y, z: abs(z - 12) < 1e-3)
    faces = nl.reconstruct(meshed(part, 0.05, 0.2), tolerance=0.1).faces
    found = sorted((f.kind, f.radius or 0.0, f.major_radius or 0.0) for f in faces)
    assert [one[0] for one in found] == [one[0] for one in sizes(part)]
    np.testing.assert_allclose([one[1:] for one in found], [one[1:] for one in sizes(part)], atol=1e-6)


@pytest.mark.parametrize("phase", [0.5, 0.2])
def test_facets_parallel_to_the_plane_of_a_pipe_bend_are_no_planes(phase):
    """With half a facet of phase, strips of the torus and of both cylinders are coplanar."""
    turn, n = (np.arange(24) + phase) * np.pi / 12, 24
    z, rings = np.array([0.0, 0.0, 1.0]), []
    for angle, along in [(0, -15), *((t, 0) for t in np.linspace(0, np.pi / 2, 9)), (np.pi / 2, 15)]:
        (c, s), spoke = (np.cos(angle), np.sin(angle)), 20 + 5 * np.cos(turn)[:, None]
        rings.append(spoke * (c, s, 0) + 5 * np.sin(turn)[:, None] * z + along * np.array([-s, c, 0]))
    corners = np.arange(10 * n).reshape(10, n)
    a, b, c, d = corners, np.roll(corners, -1, 1), np.roll(corners, -1, 1) + n, corners + n
    sides = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    first, last = corners[0], np.arange(10 * n, 11 * n)
    ends = [
        np.column_stack([np.full(n, 11 * n), np.roll(first, -1), first]),
        np.column_stack([np.full(n, 11 * n + 1), last, np.roll(last, -1)]),
    ]
    points = np.concatenate([*rings, [rings[0].mean(axis=0), rings[-1].mean(axis=0)]])
    mesh = trimesh.Trimesh(points, np.concatenate([sides, *ends])[:, ::-1])
    assert mesh.is_volume
    faces = nl.reconstruct(mesh, tolerance=0.5).faces
    assert kinds_of_faces(faces) == "2 planes, 2 cylinders of 5 mm, 1 torus of 20 and 5 mm"


@pytest.mark.parametrize("scale", [1e-4, 1e-2, 1e3, 1e6])
def test_exact_faces_of_any_size(scale):
    part = without(box(-10, -10, 0, 20, 20, 8), rod(0, 0, -1, 4, 10))
    mesh = meshed(part, 0.05, 0.5).apply_scale(scale)
    solid = nl.reconstruct(mesh, tolerance=0.1 * scale)
    assert Counter(face.kind for face in solid.faces) == {"plane": 6, "cylinder": 1}
    assert max(face.radius or 0.0 for face in solid.faces) == pytest.approx(4.0 * scale, rel=1e-6)
    assert kinds_of_faces(solid.faces) == f"6 planes, 1 cylinder of {4 * scale:g} mm"
    assert solid.volume == pytest.approx((3200 - 128 * np.pi) * scale**3, rel=1e-9)
    assert volume(solid.shells[0].shape()) == pytest.approx(solid.volume, rel=1e-9)
    assert solid.to_mesh().volume == pytest.approx(solid.volume, rel=1e-3)
    ring = np.column_stack([np.cos(t := np.linspace(0, 2 * np.pi, 65)), np.sin(t), 0 * t])
    tube = nl.skin([scale * (ring + np.array([0, 0, z])) for z in range(3)], capped=True)
    assert tube.volume == pytest.approx(2 * np.pi * scale**3, rel=1e-5)


@pytest.mark.parametrize("radii", [(2, 0), (0, 1, 2)])
@pytest.mark.parametrize("tolerance", [0.02, 0.005])
def test_capped_sections_that_end_in_a_point_are_watertight(radii, tolerance):
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    rings = [
        np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + z]) for z, r in enumerate(radii)
    ]
    mesh = nl.skin([ring if np.ptp(ring[:, 0]) else ring[:1] for ring in rings], capped=True).to_mesh(
        tolerance
    )
    assert mesh.is_watertight


def test_the_largest_deviation_is_known_whatever_the_tolerance():
    mesh = trimesh.creation.torus(20, 6, major_sections=48, minor_sections=24)
    rebuilt = nl.reconstruct(mesh, tolerance=1.5)
    assert rebuilt.faces[0].kind == "torus"
    places = np.concatenate([mesh.triangles_center, mesh.vertices[mesh.edges].mean(axis=1)])
    x, y, z = places.T
    gaps = 6.0 - np.hypot(np.hypot(x, y) - 20.0, z)
    assert rebuilt.deviation.max == pytest.approx(np.abs(gaps).max(), rel=0.05)


def test_layers_of_a_box_keep_its_corners():
    layers = nl.slice_mesh(trimesh.creation.box((4, 6, 10)).subdivide(), np.linspace(-4.5, 4.5, 7))
    solid = nl.skin(layers, capped=True)
    assert solid.volume == pytest.approx(4 * 6 * 9, rel=1e-12)
    assert [face.kind for face in solid.faces] == ["patch"] * 4 + ["plane"] * 2
    rough = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid.shells[0].shape(), rough)  # its Gauss points see no crease in a face
    assert rough.Mass() == pytest.approx(4 * 6 * 9, rel=1e-9)
    layers[3] = replace(layers[3], contours=layers[3].contours * 2)
    with pytest.raises(ValueError, match="has 2 contours"):
        nl.skin(layers)


def test_sections_in_a_ring_meet_smoothly():
    angle = np.linspace(0.0, 2.0 * np.pi, 33)
    x, z = 10 + 3 * np.cos(angle), 3 * np.sin(angle)
    turns = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    ring = nl.skin([np.column_stack([x * np.cos(t), x * np.sin(t), z]) for t in turns], closed=True)
    assert ring.closed == (True, True)
    first, last = (ring.derivative(0.3, v, (0, 1)) for v in ring.domain[1])
    assert np.allclose(first, last, atol=1e-9)


def test_a_cone_that_meets_a_cylinder_at_14_degrees_is_exact():
    """The sharp angle is 30 degrees, and the mesh turns by less."""
    bottle = trimesh.creation.revolve([(0, 0), (20, 0), (20, 50), (18, 58), (0, 58)], sections=72)
    faces = Counter(face.kind for face in nl.reconstruct(bottle, tolerance=0.1).shells[0].faces)
    assert faces == {"plane": 2, "cylinder": 1, "cone": 1}


@pytest.mark.parametrize("sections", [48, 100, 1000])
def test_a_cone_of_single_precision_is_exact(sections):
    """All facets end in the apex, and five of them lie on a cylinder almost as well."""
    cone = trimesh.creation.cone(10.0, 10.0, sections=sections)
    cone.apply_transform(trimesh.transformations.rotation_matrix(0.9, (3, 5, 7), (30, -20, 5)))
    cone.vertices = cone.vertices.astype(np.float32)
    result = nl.reconstruct(cone, tolerance=0.1)
    assert Counter(face.kind for face in result.faces) == {"plane": 1, "cone": 1}
    assert result.volume == pytest.approx(np.pi * 1000.0 / 3.0, rel=1e-5)


@pytest.mark.parametrize("distance", [0.2, 0.02])
def test_a_pointed_hole_is_exact_however_fine_its_mesh(distance):
    """OpenCASCADE puts more facets around the wide end, so that neighbours are no halves of trapezoids."""
    tip = BRepPrimAPI_MakeCone(gp_Ax2(gp_Pnt(20, 15, 6), gp_Dir(0, 0, 1)), 0.0, 9.0, 9.0 * np.sqrt(3.0))
    part = meshed(without(box(0, 0, 0, 40, 30, 20), tip.Shape()), distance, 0.1)
    result = nl.reconstruct(part, tolerance=0.25)
    assert Counter(face.kind for face in result.faces) == {"plane": 6, "cone": 1}
    assert result.volume == pytest.approx(24_000.0 - np.pi * 14.0**3 / 9.0, rel=1e-5)


@pytest.mark.parametrize("sides", [4, 5])
def test_facets_lie_on_no_cylinder_only_because_they_are_symmetric(sides):
    """Any six vertices that half a turn maps onto themselves lie on one: twisted limbs were 5 % too large."""
    radii = np.concatenate([[0.0], np.tile([0.02, 0.8, 1.2, 0.7], 2), [0.02, 0.0]]) * 1.5
    heights = np.concatenate([[0.0], 5.0 * np.arange(9) + 1.0, [42.0]])
    limb = trimesh.creation.revolve(np.column_stack([radii, heights]), sections=sides)
    x, y, z = limb.vertices.T
    turn = np.exp(0.01j * z) * (x + 1j * y)
    limb.vertices = np.column_stack([turn.real, turn.imag, z])
    made = nl.reconstruct(limb, tolerance=0.21)
    assert made.within_tolerance
    assert made.volume == pytest.approx(limb.volume, rel=0.003)
    assert made.to_mesh(0.005).volume == pytest.approx(limb.volume, rel=0.003)  # by the divergence theorem


def test_a_quarter_of_a_rod_is_exact_of_four_facets():
    beside = box(-30, -30, -1, 30, 60, 14), box(-30, -30, -1, 60, 30, 14)
    made = nl.reconstruct(meshed(without(rod(0, 0, 0, 10, 12), *beside), 1.0, 0.8), tolerance=0.5)
    assert kinds_of_faces(made.faces) == "4 planes, 1 cylinder of 10 mm"


@pytest.mark.parametrize("triangle", range(12))
@pytest.mark.parametrize("at", [0.5, 0.3])
def test_a_triangle_without_area_takes_no_face_of_its_own(triangle, at):
    """An edge divided on one side only, as exporters leave it, with a triangle of no area in the gap."""
    solid = trimesh.creation.box((4, 3, 2))
    a, b, c = solid.faces[triangle]
    vertices = np.concatenate([solid.vertices, [(1 - at) * solid.vertices[a] + at * solid.vertices[b]]])
    rest = np.delete(solid.faces, triangle, axis=0)
    torn = trimesh.Trimesh(vertices, np.concatenate([rest, [[a, 8, c], [8, b, c], [a, b, 8]]]), process=False)
    assert torn.is_watertight
    made = nl.reconstruct(torn, tolerance=0.02)
    assert kinds_of_faces(made.faces) == "6 planes"
    assert made.volume == pytest.approx(24.0)


def test_no_facets_are_searched_twice(monkeypatch):
    seen, fit = [], regions.fit

    def watched(kind, points, *others):
        assert kind == "plane" or (kind, points.tobytes()) not in seen
        seen.append((kind, points.tobytes()))
        return fit(kind, points, *others)

    monkeypatch.setattr(regions, "fit", watched)
    ball = trimesh.creation.icosphere(subdivisions=3)
    ball.vertices *= (3, 2, 1)
    assert {face.kind for face in nl.reconstruct(ball, tolerance=0.05).faces} == {"patch"}
    assert seen


def test_exact_faces_that_cannot_be_drawn_become_patches(monkeypatch):
    def without_triangles(shell, tolerance):
        raise ValueError("OpenCASCADE leaves a face without triangles")

    monkeypatch.setattr(nl.mesh.TrimmedShell, "to_mesh", without_triangles)
    solid = nl.reconstruct(trimesh.creation.box(), tolerance=0.01)
    assert {face.kind for face in solid.faces} == {"patch"}
    assert solid.within_tolerance


def test_no_library_prints_that_a_guess_is_no_number(capfd):
    nl.reconstruct(trimesh.creation.cylinder(5, 20), tolerance=0.05)
    assert "illegal" not in "".join(capfd.readouterr())
