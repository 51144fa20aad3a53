"""The cutter at rest: closed forms, OpenCAMLib, a search along edges, and what must not matter."""

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab import machining
from nurbs_lab.mesh import samples
from nurbs_lab.mesh.solid import shell_triangles
from nurbs_lab.tests.machining.shapes import CUTTERS, hills


def places(mesh, count, margin=2.0):
    low, high = mesh.bounds[:, :2] + [[-margin] * 2, [margin] * 2]
    return np.random.default_rng(0).uniform(low, high, (count, 2))


@pytest.mark.parametrize("kind", ["ball", "flat", "bull"])  # its cone misses contacts with edges
@pytest.mark.parametrize("load", [hills, samples.nut, lambda: samples.frog_organ("spleen")])
def test_equals_opencamlib(kind, load):
    pytest.importorskip("opencamlib")  # there is none for Python 3.12 and later
    from benchmarks.machining import PEERS, dropped, stl_surface

    mesh = load()
    xy = places(mesh, 300)
    ours = nl.drop_cutter(mesh, CUTTERS[kind], xy)
    theirs = dropped(stl_surface(mesh), PEERS[kind](CUTTERS[kind]), xy, -1e3)
    theirs[theirs == -1e3] = -np.inf
    assert np.array_equal(np.isfinite(ours), np.isfinite(theirs))
    met = np.isfinite(ours)
    assert met.sum() > 100
    assert np.abs(ours[met] - theirs[met]).max() < 1e-9


def over_points(points, cutter):
    """Height of the tip at the origin over each point, from the circle of the corner."""
    d = np.hypot(points[:, 0], points[:, 1])
    over = np.maximum(d - cutter.flat_radius, 0.0)
    inside = over <= cutter.corner_radius if cutter.corner_radius else d <= cutter.radius
    rise = cutter.corner_radius - np.sqrt(np.maximum(cutter.corner_radius**2 - over**2, 0.0))
    if cutter.kind == "cone":  # of 90 degrees, and sharp
        inside, rise = d <= cutter.radius, d
    return np.where(inside, points[:, 2] - rise, -np.inf)


@pytest.mark.parametrize("kind", CUTTERS)
def test_rests_on_edges_as_a_search_finds(kind):
    """Many points of an edge, then more and more of them about the best one."""
    cutter, rng = CUTTERS[kind], np.random.default_rng(1)
    for ends in rng.uniform(-2.0, 2.0, (60, 2, 3)):
        low, high = 0.0, 1.0
        for _ in range(8):
            t = np.linspace(low, high, 1001)
            found = over_points(ends[0] + t[:, None] * (ends[1] - ends[0]), cutter)
            best = found.argmax()
            low, high = t[max(best - 1, 0)], t[min(best + 1, 1000)]
        wedge = trimesh.Trimesh([*ends, ends.mean(axis=0) - (0, 0, 50)], [(0, 1, 2)], process=False)
        assert nl.drop_cutter(wedge, cutter, (0.0, 0.0)) == pytest.approx(found[best], abs=1e-9)


@pytest.mark.parametrize(("angle", "corner", "tip"), [(20.0, 0.5, 0.0), (140.0, 0.3, 0.2), (30.0, 0.0, 1.0)])
def test_cones_rest_on_the_highest_of_many_points(angle, corner, tip):
    """The side is the tangent of the corner; the profile is written down anew."""
    cutter = nl.Cutter("cone", 6.0, corner, angle=angle, tip_diameter=tip)
    mesh, half = hills(8), np.radians(angle / 2)
    t = np.linspace(0.0, 1.0, 150)[:, None, None]
    edges = t * mesh.vertices[mesh.edges_unique[:, 0]] + (1 - t) * mesh.vertices[mesh.edges_unique[:, 1]]
    points = np.concatenate([trimesh.sample.sample_surface(mesh, 60_000, seed=1)[0], edges.reshape(-1, 3)])
    for x, y in places(mesh, 40):
        d = np.hypot(points[:, 0] - x, points[:, 1] - y)
        u = np.clip(d - tip / 2, 0.0, corner * np.cos(half))
        rise = corner - np.sqrt(corner**2 - u**2) + np.maximum(d - tip / 2 - u, 0.0) / np.tan(half)
        over = np.where(d <= 3.0, points[:, 2] - rise, -np.inf).max()
        assert over - 1e-9 <= nl.drop_cutter(mesh, cutter, (x, y)) < over + 0.12


def test_ball_on_a_ball_touches_on_the_line_of_centres():
    """The tessellated surface of a sphere: centres at distance R + r, less the stated error."""
    ball, stated = nl.nurbs.sphere(10.0), 1e-3
    part = machining.prepare_part(ball, tessellation=stated)
    d = np.linspace(0.0, 12.5, 60)
    z = nl.drop_cutter(part, CUTTERS["ball"], np.column_stack([d, 0 * d]))
    error = z - (np.sqrt(13.0**2 - d**2) - 3.0)
    assert (error <= 1e-9).all()
    assert (error >= -stated * 13.0 / np.sqrt(13.0**2 - d**2)).all()


def test_a_solid_too_large_for_the_usual_triangles_has_the_finest_possible(monkeypatch):
    ball = nl.reconstruct(trimesh.creation.icosphere(3, 8.0), tolerance=0.1, faces="patches")
    monkeypatch.setattr(shell_triangles, "_MOST_TRIANGLES", 20_000)
    assert ball.shells[0].finest > 1e-3
    part = machining.prepare_part(ball)
    assert 5_000 < len(part.normals) < 40_000
    with pytest.raises(ValueError, match=r"tessellation is 0\.001 mm; give"):
        machining.prepare_part(ball, tessellation=1e-3)


def test_a_step_is_met_with_the_side_the_rim_or_the_corner():
    box = trimesh.creation.box(extents=(20, 20, 10))
    d = np.array([0.0, 9.9, 10.5, 12.0, 12.9, 13.1])
    over = d - 10.0
    expected = {
        "flat": np.where(d < 13.0, 5.0, -np.inf),
        "ball": [5 - (3 - np.sqrt(max(9 - max(x, 0) ** 2, 0))) if x < 3 else -np.inf for x in over],
        "bull": [5 - (1 - np.sqrt(max(1 - max(x - 2, 0) ** 2, 0))) if x < 3 else -np.inf for x in over],
        "cone": [5 - max(x, 0) if x < 3 else -np.inf for x in over],
    }
    for kind, cutter in CUTTERS.items():
        found = nl.drop_cutter(box, cutter, np.column_stack([d, 0 * d]))
        np.testing.assert_allclose(found, expected[kind], atol=1e-12)


def test_no_node_of_a_stock_falls_between_two_triangles():
    """On the diagonals of level faces, where rounding puts a node beside both triangles."""
    for wide in range(20, 60, 3):
        stock = trimesh.creation.box(bounds=[(-5, -5, 0), (wide, 35, 14)])
        moves = [machining.Move("rapid", nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0, 20), (1, 0, 20)]), 10.0)]
        program = machining.Program(moves, nl.Cutter("flat", 6.0))
        for resolution in (0.1, 0.3, 0.7):
            assert (nl.simulate(program, stock, resolution=resolution).stock[1:-1, 1:-1] == 14.0).all()


def test_turning_triangles_inside_out_or_cutting_them_finer_changes_nothing():
    mesh = hills()
    xy = places(mesh, 500)
    inside_out = trimesh.Trimesh(mesh.vertices, mesh.faces[:, ::-1], process=False)
    finer = trimesh.Trimesh(*trimesh.remesh.subdivide(mesh.vertices, mesh.faces), process=False)
    for cutter in CUTTERS.values():
        z = nl.drop_cutter(mesh, cutter, xy)
        met = np.isfinite(z)
        for same in (inside_out, finer):
            assert np.abs(nl.drop_cutter(same, cutter, xy)[met] - z[met]).max() < 1e-9


@pytest.mark.parametrize(
    ("name", "sizes"),
    [
        ("length", {"kind": "cone", "angle": 30.0, "length": 11.0}),  # the cone is 3 / tan 15 degrees high
        ("length", {"kind": "ball", "length": 2.9}),
        ("reach", {"kind": "flat", "length": 20.0, "holder": 30.0, "reach": 19.0}),
    ],
)
def test_cutters_that_cannot_be_are_refused(name, sizes):
    with pytest.raises(ValueError, match=f"^{name} must be at least"):
        nl.Cutter(diameter=6.0, **sizes)
    assert nl.Cutter("cone", 6.0, angle=10.0).length == pytest.approx(3.0 / np.tan(np.radians(5.0)))
    assert nl.Cutter("flat", 6.0, holder=30.0, reach=19.0).length == 19.0
