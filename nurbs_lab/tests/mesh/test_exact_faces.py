"""Solids made with OpenCASCADE and meshed come back with the faces that they had."""

from collections import Counter

import numpy as np
import pytest
import trimesh
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeCone,
)
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

import nurbs_lab as nl
from nurbs_lab.mesh.solid import regions
from nurbs_lab.mesh.solid.faces import kinds_of_faces
from nurbs_lab.tests.mesh.cad import (
    PARTS,
    apart,
    boss,
    box,
    meshed,
    plate,
    rod,
    rounded,
    sizes,
    stored,
    volume,
    without,
)


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


def test_the_largest_deviation_is_known_whatever_the_tolerance():
    mesh = trimesh.creation.torus(20, 6, major_sections=48, minor_sections=24)
    rebuilt = nl.reconstruct(mesh, tolerance=1.5)
    assert rebuilt.faces[0].kind == "torus"
    places = np.concatenate([mesh.triangles_center, mesh.vertices[mesh.edges].mean(axis=1)])
    x, y, z = places.T
    gaps = 6.0 - np.hypot(np.hypot(x, y) - 20.0, z)
    assert rebuilt.deviation.max == pytest.approx(np.abs(gaps).max(), rel=0.05)


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


def test_a_quarter_of_a_fine_cone_ends_no_process():
    """OpenCASCADE's Delabella algorithm crashed at the base, points of an arc and its centre."""
    mesh = meshed(BRepPrimAPI_MakeCone(10.0, 0.0, 20.0, np.pi / 2).Shape(), 0.1, 0.1)
    rebuilt = nl.reconstruct(mesh, tolerance=0.01)
    assert rebuilt.volume == pytest.approx(mesh.volume, rel=1e-3)
    assert apart(rebuilt.to_mesh(0.01), mesh) < 0.01
