"""Out and back gives the same shape; other programs' libraries see the same points."""

import itertools
import re

import geomdl.exchange
import numpy as np
import pytest
import trimesh
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakePrism,
    BRepPrimAPI_MakeTorus,
)
from OCP.gp import gp_Trsf, gp_Vec
from OCP.IGESControl import IGESControl_Reader
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound
from scipy.spatial import cKDTree
from scipy.special import comb

import nurbs_lab as nl
from nurbs_lab.interchange._opencascade import edge_of
from nurbs_lab.nurbs import arc, cylinder
from nurbs_lab.tests.interchange.shapes import ASKED, MOVES, assert_same, curve, path, surface


def closed_curve(dim):
    angle = np.sort(np.random.default_rng(7).uniform(0, 2 * np.pi, 24))
    points = np.column_stack([20 * np.cos(angle), 12 * np.sin(angle), np.cos(3 * angle)])
    return nl.interpolate_curve(points[:, :dim], closed=True)


def closed_tube(closed, rational):
    u, v = np.meshgrid(np.arange(12) * np.pi / 6, np.arange(8) * np.pi / 4, indexing="ij")
    ring = np.stack([(9 + np.cos(v)) * np.cos(u), (9 + np.cos(v)) * np.sin(u), np.sin(v)], axis=-1)
    tube = nl.interpolate_surface(ring, closed=closed)
    if not rational:
        return tube
    turns = [n - 3 if c else n for n, c in zip(tube.weights.shape, closed, strict=True)]  # then they repeat
    i, j = np.indices(tube.weights.shape)
    weights = 1 + 0.3 * np.sin(i % turns[0]) * np.cos(j % turns[1])
    return nl.NurbsSurface(tube.degrees, tube.knots, tube.control_points, weights)


def closed_with_weights(degree):
    """A closed curve whose first and last weights differ."""
    one = curve(degree, degree + 5, rational=True, seed=degree)
    points = np.vstack([one.control_points[:-1], one.control_points[:1]])
    return nl.NurbsCurve(degree, one.knots, points, one.weights)


@pytest.mark.parametrize("suffix", [".step", ".igs", ".json"])
def test_curves_come_back(tmp_path, suffix):
    """A periodic curve is clamped on the way out."""
    ways = itertools.product((1, 2, 3, 5), (2, 3), (True, False))
    sent = [curve(p, p + 5, dim, rational, seed=p) for p, dim, rational in ways]
    weighted = [closed_with_weights(degree) for degree in (2, 3, 4, 5)]
    periodic = [closed_curve(2), closed_curve(3)]
    got = nl.read(nl.export(tmp_path / f"curves{suffix}", sent, weighted, periodic))
    for one, other in zip([*sent, *weighted, *periodic], got, strict=True):
        assert other.degree == one.degree
        assert other.closed == one.closed
        assert_same(one, other, within=1e-9 if one in sent else 1e-11)
    for other in got[-len(periodic) :]:
        np.testing.assert_array_equal(other.control_points[0], other.control_points[-1])
        assert other.knots[0] == other.knots[other.degree]


@pytest.mark.parametrize("suffix", [".stp", ".iges", ".json"])
def test_surfaces_come_back_after_a_curve(tmp_path, suffix):
    """Periodic surfaces are clamped on the way out. A file of geomdl's holds curves or surfaces."""
    sent = [cylinder(3.0, 10.0)]
    for rational in (True, False):
        sent += [surface((3, 2), (7, 5), rational), surface((1, 4), (4, 9), rational, seed=2)]
        sent += [closed_tube(closed, rational) for closed in [(True, False), (False, True), (True, True)]]
    first = [] if suffix == ".json" else [curve()]
    got = nl.read(nl.export(tmp_path / f"surfaces{suffix}", sent, first))
    for one in first:
        assert_same(one, got.pop(0))
    for one, other in zip(sent, got, strict=True):
        assert (other.degrees, other.closed) == (one.degrees, one.closed)
        assert_same(one, other)
        net = other.control_points
        for axis in np.flatnonzero(one.closed):
            np.testing.assert_array_equal(np.take(net, 0, axis), np.take(net, -1, axis))


def test_a_closed_surface_that_step_cannot_hold_is_refused(tmp_path):
    sheet = surface()
    net = np.concatenate([sheet.control_points[:-1], sheet.control_points[:1]])
    weights = np.concatenate([sheet.weights[:-1], 1.5 * sheet.weights[:1]])
    sheet = nl.NurbsSurface(sheet.degrees, sheet.knots, net, weights)
    with pytest.raises(ValueError, match=r"first and last weights differ; write it to \.igs"):
        nl.export(tmp_path / "tube.step", sheet)
    (other,) = nl.read(nl.export(tmp_path / "tube.igs", sheet))
    assert_same(sheet, other)


def test_tables_and_clouds_come_back(tmp_path):
    table = nl.read(nl.export(tmp_path / "path.csv", path(3)))
    assert len(nl.read(nl.export(tmp_path / "again.csv", table)).v) == len(table.v)
    for name, head in (("cloud.csv", "x,y,z\n"), ("bare.csv", "")):
        (tmp_path / name).write_text(head + "0,0,1\n2,3,4\n")
        np.testing.assert_array_equal(nl.read(tmp_path / name), [[0, 0, 1], [2, 3, 4]])
    points = np.random.default_rng(0).normal(size=(30, 3))
    trimesh.PointCloud(points).export(tmp_path / "cloud.ply")
    rows = "".join(f"{x} {y} {z}\n" for x, y, z in points)
    (tmp_path / "cloud.off").write_text("OFF\n30 0 0\n" + rows)
    rows = "".join(f"v {row}\n" for row in rows.splitlines())
    (tmp_path / "cloud.obj").write_text(rows + "p " + " ".join(map(str, range(1, 31))) + "\n")
    for suffix in ("ply", "off", "obj"):
        np.testing.assert_allclose(nl.read(tmp_path / f"cloud.{suffix}"), points, atol=1e-6)
    (tmp_path / "cloud.obj").write_text(rows)
    with pytest.warns(UserWarning, match="30 of its 30 vertices belong to no face; it may be cut off"):
        assert len(nl.read(tmp_path / "cloud.obj")) == 30


@pytest.mark.parametrize(("suffix", "reader"), [(".step", STEPControl_Reader), (".igs", IGESControl_Reader)])
def test_opencascade_sees_the_same_points(tmp_path, suffix, reader):
    one, sheet = curve(), surface()
    reader = reader()
    reader.ReadFile(str(nl.export(tmp_path / f"both{suffix}", one, sheet)))
    reader.TransferRoots()
    shape = reader.OneShape()
    edge = BRepAdaptor_Curve(TopoDS.Edge_s(TopExp_Explorer(shape, TopAbs_EDGE, TopAbs_FACE).Current()))
    face = BRepAdaptor_Surface(TopoDS.Face_s(TopExp_Explorer(shape, TopAbs_FACE).Current()))
    for u in np.linspace(0, 1, 11):
        np.testing.assert_allclose(edge.Value(u).Coord(), one(u), atol=1e-9)
        np.testing.assert_allclose(face.Value(u, u**2).Coord(), sheet(u, u**2), atol=1e-9)
    assert BRep_Tool.Surface_s(face.Face()).IsURational()


def test_geomdl_sees_the_same_points(tmp_path):
    one, sheet = curve(), surface()
    (line,) = geomdl.exchange.import_json(str(nl.export(tmp_path / "curve.json", one)))
    (face,) = geomdl.exchange.import_json(str(nl.export(tmp_path / "surface.json", sheet)))
    for u in np.linspace(0, 1, 11):
        np.testing.assert_allclose(line.evaluate_single(u), one(u), atol=1e-9)
        np.testing.assert_allclose(face.evaluate_single((u, u**2)), sheet(u, u**2), atol=1e-9)


def test_what_geomdl_writes_can_be_read(tmp_path):
    (line,) = geomdl.exchange.import_json(str(nl.export(tmp_path / "curve.json", curve())))
    geomdl.exchange.export_json(line, str(tmp_path / "geomdl.json"))
    (got,) = nl.read(tmp_path / "geomdl.json")
    assert_same(curve(), got)


def cad_file(shape, file):
    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(file))
    return file


@pytest.mark.parametrize(
    ("shape", "radius"),
    [
        (BRepPrimAPI_MakeTorus(6.0, 2.0), lambda x, y, z: np.hypot(np.hypot(x, y) - 6.0, z)),
        (BRepPrimAPI_MakeTorus(6.0, 2.0, -1.0, 1.0), lambda x, y, z: np.hypot(np.hypot(x, y) - 6.0, z)),
        (BRepPrimAPI_MakeCone(3.0, 1.0, 4.0), lambda x, y, z: np.hypot(x, y) + z / 2.0 - 1.0),
    ],
)
def test_the_round_faces_of_a_cad_program_can_be_read(tmp_path, shape, radius):
    """A whole turn comes out of a STEP file as a little more than 2 pi."""
    (face,) = nl.read(cad_file(shape.Shape(), tmp_path / "round.step"))
    x, y, z = face.grid(*(np.linspace(*ends, 20) for ends in face.domain)).T
    np.testing.assert_allclose(radius(x, y, z), 2.0, atol=1e-12)


def test_a_box_with_rounded_edges_can_be_read(tmp_path):
    block = BRepFilletAPI_MakeFillet(box := BRepPrimAPI_MakeBox(20.0, 20.0, 10.0).Shape())
    edges = TopExp_Explorer(box, TopAbs_EDGE)
    while edges.More():
        block.Add(1.0, TopoDS.Edge_s(edges.Current()))
        edges.Next()
    faces = nl.read(cad_file(block.Shape(), tmp_path / "block.step"))
    assert len(faces) == 12 + 8  # quarters of cylinders, eighths of spheres
    for face in faces:
        points = face.grid(*(np.linspace(*ends, 9) for ends in face.domain))
        beyond = np.clip(np.abs(points - [10.0, 10.0, 5.0]) - [9.0, 9.0, 4.0], 0.0, None)
        np.testing.assert_allclose(np.linalg.norm(beyond, axis=-1), 1.0, atol=1e-9)


def test_the_wall_of_an_extruded_profile_can_be_read(tmp_path):
    profile = curve(3, 7, dim=3)
    wall = BRepPrimAPI_MakePrism(edge_of(profile), gp_Vec(0.0, 0.0, 5.0)).Shape()
    (face,) = nl.read(cad_file(wall, tmp_path / "wall.step"))
    points = profile(np.linspace(*profile.domain, 50))
    for lift in (0.0, 2.0, 5.0):
        assert face.closest_point(points + np.array([0.0, 0.0, lift]))[1].max() < 1e-9


def test_an_assembly_can_be_read(tmp_path):
    builder, assembly, one = BRep_Builder(), TopoDS_Compound(), curve(rational=False)
    builder.MakeCompound(assembly)
    move = gp_Trsf()
    move.SetTranslation(gp_Vec(0.0, 0.0, 7.0))
    for place in (TopLoc_Location(), TopLoc_Location(move)):
        builder.Add(assembly, edge_of(one).Located(place))
    first, second = nl.read(cad_file(assembly, tmp_path / "assembly.step"))
    assert_same(one, first)
    assert_same(one.translate([0.0, 0.0, 7.0]), second)


@pytest.mark.parametrize("dialect", ["arcs", "siemens", "fanuc", "heidenhain"])
@pytest.mark.parametrize("gap", [5e-9, 2e-7, 1e-5, 1e-3, 0.0112, 0.3])
@pytest.mark.parametrize(
    "setup", [None, nl.Setup(tool=1, spindle_rpm=900, safe_z_mm=20.0006, number=1, digits=3)]
)
def test_a_circle_that_almost_closes_stays_whole(tmp_path, dialect, gap, setup):
    """An arc that ends beside its start is neither a short straight move nor moved by rounding its ends."""
    for radius, start in itertools.product((0.02, 0.2, 9.7, 300.0), (0.0, 0.9, 2.6)):
        if gap >= 2 * np.pi * radius:
            continue
        one = arc(radius, start, start + 2 * np.pi - gap / radius, (1.0, 2.0))
        one = one.transform(np.eye(3)[:, :2])
        name = "a.h" if dialect == "heidenhain" else "a.nc"
        file = nl.export(tmp_path / name, one, dialect=dialect, setup=setup, **ASKED)
        moves = [move.curve for move in nl.read(file).moves if move.curve.degree > 1]
        assert sum(move.length() for move in moves) == pytest.approx(one.length(), rel=1e-3, abs=3e-3)
        points = np.vstack([move(np.linspace(0, 1, 99)) for move in moves])
        away = np.hypot(points[:, 0] - 1, points[:, 1] - 2) - radius
        assert np.abs(away).max() <= (3e-3 if setup else 1e-6)
        again = nl.export(tmp_path / f"again-{name}", nl.read(file), dialect=dialect, setup=setup, **MOVES)
        assert len(nl.read(again).moves) <= len(nl.read(file).moves) + 2 * bool(setup)


@pytest.mark.parametrize("dialect", ["g1", "arcs"])
@pytest.mark.parametrize(
    ("points", "weights"),
    [
        ([(0, 0), (20, 0), (-10, 0), (5, 0)], None),  # along a line, beyond its end and back
        ([(0, 0), (20, 10), (-10, -5), (5, 2.5)], [1, 2, 0.5, 1]),
        ([(0, 0), (-1, 0), (2, 0), (1, 0)], None),  # backward at both ends
        ([(0, 0), (-1, 0), (20, 0), (30, 0)], None),  # backward for a moment
        ([(0, 0), (-1e-3, 0), (2e-3, 0), (1e-3, 0)], None),  # shorter than the tolerance
        ([(-4, 0), (6, 7), (-6, 7), (4, 0)], None),  # a cusp
        ([(-7, 7), (-7, -1), (8, -3), (-15, 9)], None),
    ],
)
def test_a_curve_that_turns_back_is_followed_to_its_end(tmp_path, dialect, points, weights):
    """No point of it is farther than the tolerance from the points of the file, and the reverse."""
    points = np.column_stack([points, np.zeros(4)])
    one = nl.NurbsCurve(3, np.repeat([0, 1], 4), points, weights)
    file = nl.export(tmp_path / "a.ngc", one, dialect=dialect, **ASKED)
    t, w = np.linspace(0, 1, 40_001)[:, None], np.ones(4) if weights is None else np.array(weights)
    basis = np.hstack([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3]) * w
    wanted = basis @ points / basis.sum(axis=1)[:, None]
    moves = [move.curve for move in nl.read(file).moves if move.kind != "rapid"]
    found = np.vstack([move(np.linspace(*move.domain, 2 + int(move.length() / 1e-3))) for move in moves])
    for some, others in ((wanted, found), (found, wanted)):
        gaps = cKDTree(others).query(some)[0]
        assert gaps.max() <= ASKED["tolerance"] + np.linalg.norm(np.diff(others, axis=0), axis=1).max()


def test_what_is_written_as_one_arc_is_within_the_tolerance_of_it(tmp_path):
    """Polynomials of degree 7 that wave about an arc; the distance from a circle is a closed form."""
    rng, t, arcs = np.random.default_rng(0), np.linspace(0, 1, 1000)[:, None], 0
    basis = np.hstack([comb(7, i) * t**i * (1 - t) ** (7 - i) for i in range(8)])
    for turn in rng.uniform(4, 6, 300):
        angle = (turn * (t + rng.uniform(-0.3, 0.3) * t * (1 - t)))[:, 0]
        around = 10 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
        net = np.linalg.lstsq(basis, around, rcond=None)[0]
        net[:, :2] += rng.normal(size=(8, 2)) * 0.01 * rng.choice([0.3, 1, 3])
        one = nl.NurbsCurve(7, np.repeat([0, 1], 8), net)
        file = nl.export(tmp_path / "a.nc", one, dialect="fanuc", **ASKED)
        moves = [move.curve for move in nl.read(file).moves if move.kind != "rapid"]
        if len(moves) == 1 and moves[0].rational:
            ring, arcs = moves[0](np.linspace(0, 1, 4)), arcs + 1
            centre = np.linalg.solve(2 * np.diff(ring[:3, :2], axis=0), np.diff((ring[:3] ** 2).sum(axis=1)))
            away = np.hypot(*(basis @ net)[:, :2].T - centre[:, None]) - np.hypot(*ring[0, :2] - centre)
            assert np.abs(away).max() <= ASKED["tolerance"]
    assert arcs > 30


@pytest.mark.parametrize(("digits", "units", "within"), [(2, "mm", 0.02), (3, "mm", 2e-3), (3, "inch", 5e-3)])
def test_the_digits_of_a_controller_count_within_the_tolerance(tmp_path, digits, units, within):
    """The ends and the middles of the chords of a circle; and tolerances that the digits cannot keep."""
    setup = nl.Setup(tool=1, spindle_rpm=900, safe_z_mm=20.0, digits=digits)
    one = arc(13.7, 0.3, 3.9, (1.0, 2.0)).transform(np.eye(3)[:, :2])
    asked = {"dialect": "g1", "feed": 9.0, "units": units, "axes": "XYZ", "setup": setup}
    file = nl.export(tmp_path / "a.nc", one, tolerance=within, **asked)
    scale = 25.4 if units == "inch" else 1.0
    words = re.findall(r"^G1 X(\S+) Y(\S+) Z0(?: |$)", file.read_text(), re.MULTILINE)
    ends = scale * np.array(words, float) - (1.0, 2.0)
    places = np.vstack([ends, (ends[1:] + ends[:-1]) / 2])
    assert np.abs(np.hypot(*places.T) - 13.7).max() <= within
    with pytest.raises(ValueError, match=f"digits = {digits} rounds {units} by up to .*; give more digits"):
        nl.export(tmp_path / "a.nc", one, tolerance=0.5 * within, **asked)
