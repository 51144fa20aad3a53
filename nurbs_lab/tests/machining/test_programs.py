"""Finished parts: nothing is gouged, nothing is left, and what is said about it is right."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

import nurbs_lab as nl
from nurbs_lab import machining
from nurbs_lab.machining.drop import contact
from nurbs_lab.machining.field import tip_field
from nurbs_lab.machining.passes import step_over
from nurbs_lab.machining.surface import sample_surface
from nurbs_lab.machining.waterlines import waterlines
from nurbs_lab.mesh import samples
from nurbs_lab.nurbs.along import spline_along
from nurbs_lab.tests.machining.shapes import CUTTERS, DOME, block, hills, lying_cylinder

SCALLOP, TOLERANCE = 0.05, 0.01


@pytest.fixture(scope="module")
def program():
    return nl.finish(hills(), CUTTERS["ball"], scallop=SCALLOP, tolerance=TOLERANCE)


PARTS = {
    "spleen": (lambda: samples.frog_organ("spleen"), 0.1),
    "small spleen": (lambda: samples.frog_organ("spleen").apply_scale(0.6), 0.03),
    "dome": (lambda: DOME, SCALLOP),
    "saddle": (lambda: block(lambda x, y: 6.0 + (x * x - y * y) / 24.0, 24.0), SCALLOP),
    "cylinder": (lying_cylinder, SCALLOP),
}


@pytest.mark.parametrize("name", PARTS)
def test_no_cusp_is_higher_than_asked(name):
    """By clouds of points: what a ball from above touches, and its distance from the nearest cutter."""
    mesh, scallop = PARTS[name][0](), PARTS[name][1]
    cutter = CUTTERS["ball"]
    program = nl.finish(mesh, cutter, scallop=scallop, tolerance=0.2 * scallop)
    assert nl.verify(program, mesh).gouge <= 0.02 * program.tolerance
    curves, r = [move.curve for move in program.moves if move.kind != "rapid"], cutter.radius
    balls = [curve(np.linspace(*curve.domain, int(curve.length() / 0.02) + 2)) for curve in curves]
    balls = np.concatenate(balls)
    balls[:, 2] += r
    upper = mesh.submesh([np.flatnonzero(mesh.face_normals[:, 2] > 1e-3)], append=True)
    points, face = trimesh.sample.sample_surface(upper, int(upper.area / 0.03), seed=1)
    centres = points + r * upper.face_normals[face]
    left = cKDTree(balls).query(points, distance_upper_bound=r + scallop)[0] - r
    cloud = trimesh.sample.sample_surface(mesh, int(mesh.area / 0.01), seed=2)[0]
    high = np.flatnonzero((left > scallop) & (centres[:, 2] - r > mesh.bounds[0, 2]))
    high = high[cKDTree(cloud).query(centres[high])[0] > r - 0.002]
    beside = cKDTree(balls[:, :2]).query_ball_point(points[high, :2], r + scallop)
    below = cKDTree(cloud[:, :2]).query_ball_point(centres[high, :2], r)
    for k, near, under in zip(high, beside, below, strict=True):
        gaps = points[k] - balls[near]
        gaps[:, 2] = np.minimum(gaps[:, 2], 0.0)  # above its ball the cutter is a cylinder
        across = np.linalg.norm(cloud[under, :2] - centres[k, :2], axis=1)
        top = (cloud[under, 2] + np.sqrt(np.maximum(r * r - across**2, 0.0))).max(initial=-np.inf)
        gap = np.linalg.norm(gaps, axis=1).min(initial=np.inf)
        assert gap - r <= scallop or top > centres[k, 2] + 0.002
    assert np.count_nonzero(left < scallop) > 0.2 * len(left)


@pytest.mark.parametrize(
    ("load", "kind", "scallop", "tolerance"),
    [(hills, "bull", 0.05, 0.01), (hills, "cone", 0.1, 0.02), (samples.nut, "ball", 0.1, 0.01)],
)
def test_neither_gouges_nor_leaves_more_than_asked(load, kind, scallop, tolerance):
    mesh = load()
    cutter = replace(CUTTERS[kind], length=60.0)
    found = nl.verify(nl.finish(mesh, cutter, scallop=scallop, tolerance=tolerance), mesh)
    assert found.gouge <= (0.1 if kind == "cone" else 0.02) * tolerance
    assert max(found.percentile(100), found.bridged.max(initial=0.0) - tolerance) <= scallop


def test_walls_of_a_part_that_is_narrower_below_are_passed_once():
    """At the lowest place that the cutter reaches: a pass at every height would be three times the way."""
    mesh = samples.nut()
    program = nl.finish(mesh, CUTTERS["ball"], scallop=0.1, tolerance=0.025)
    way = sum(move.curve.length() for move in program.moves if move.kind == "cut")
    area = mesh.area_faces[mesh.face_normals[:, 2] > -1e-3].sum()
    assert way * step_over(CUTTERS["ball"], 0.1) < 1.2 * area


def test_a_finer_tolerance_cuts_no_path_in_pieces(program):
    """Locations are inserted until they suffice: after five rounds it took a fifth more passes."""
    fine = nl.finish(hills(), CUTTERS["ball"], scallop=SCALLOP, tolerance=0.1 * TOLERANCE)
    assert len(fine.curves) <= len(program.curves)


def test_a_flat_cutter_finishes_floors_and_walls_with_few_passes():
    box = trimesh.creation.box((40.0, 30.0, 10.0))
    program = nl.finish(box, CUTTERS["flat"], scallop=0.1, tolerance=0.02)
    found = nl.verify(program, box)
    assert found.gouge <= 1e-6
    assert found.left.max() <= 0.02  # nothing but the tolerance
    assert sum(found.areas) == pytest.approx(40 * 30 + 2 * (40 + 30) * 10, rel=1e-3)
    assert sum(curve.length() for curve in program.curves) < 1000.0


def test_slivers_cost_what_their_area_costs():
    disc = trimesh.creation.cylinder(radius=20.0, height=2.0, sections=4000)  # two fans of 0.03 by 20 mm
    samples = sample_surface(machining.prepare_part(disc), 0.1)
    assert samples.share * len(samples.points) == pytest.approx(np.pi * 20**2 + 2 * np.pi * 20 * 2, rel=1e-4)
    assert len(samples.points) < 1.1e6
    assert np.abs(samples.points.mean(axis=0)[:2]).max() < 0.01


def test_nothing_fast_touches_material_and_a_program_says_so_if_it_does():
    """In a block around the part, on a grid finer than the one of the plan."""
    around, options = machining.stock_around(hills()), {"scallop": SCALLOP, "tolerance": TOLERANCE}
    program = nl.finish(hills(), CUTTERS["ball"], stock=around, **options)
    assert program.warnings == ()
    milled = nl.simulate(program, resolution=0.1)
    rapid = np.array([move.kind == "rapid" for move in program.moves])
    assert milled.volumes[rapid].sum() == 0.0
    assert rapid.sum() > 10
    first, second = program.moves[0].curve.control_points
    assert (first[:2] == second[:2]).all()  # down only: it comes up before it goes across
    plunges = [move for move in program.moves if move.kind == "plunge"]
    assert max(move.feed for move in plunges) < 20.0
    blind = nl.finish(hills(), CUTTERS["ball"], stock=hills(), **options)
    taller = hills().bounds + np.array([[0.0], [10.0]]) * (0.0, 0.0, 1.0)
    said = nl.verify(replace(blind, stock=taller), hills()).report()
    assert "rapid moves cut material" in said
    assert "left for a smaller cutter" in said.splitlines()[0]


def test_moves_follow_one_another(program):
    for before, after in pairwise(program.moves):
        assert np.abs(before.curve.control_points[-1] - after.curve.control_points[0]).max() < 1e-9


def test_all_moves_are_one_motion_within_the_limits_of_the_machine():
    """By third differences of the points at whole periods: corners are passed, none faster than allowed."""
    box = trimesh.creation.box(extents=(6.0, 4.0, 2.0))
    program = nl.finish(box, nl.Cutter("ball", 2.0), scallop=0.4, tolerance=0.05)
    machine, ends = program.machine, np.cumsum([feed.duration for feed in program.feeds])
    t = np.arange(0.0, ends[-1], machine.period_s)
    which = np.searchsorted(ends, t, side="right")
    points = np.empty((len(t), 3))
    for k in np.unique(which):
        curve, begun = program.moves[k].curve, ends[k] - program.feeds[k].duration
        length = program.feeds[k].displacement(t[which == k] - begun)
        points[which == k] = curve(curve.parameter_at(np.minimum(length, curve.length())))
    speeds = np.linalg.norm(np.diff(points, axis=0), axis=1) / machine.period_s
    accelerations = np.linalg.norm(np.diff(points, 2, axis=0), axis=1) / machine.period_s**2
    assert speeds.max() <= machine.speed * (1.0 + 1e-6)
    assert accelerations.max() <= machine.acceleration * (1.0 + 1e-3)
    stops = sum(feed.speed(feed.duration) == 0.0 for feed in program.feeds)
    assert stops < 0.5 * len(program.moves)
    assert program.time_s == pytest.approx(round(program.time_s / machine.period_s) * machine.period_s)


def test_links_of_a_scan_are_rarely_retracts_and_plunge_only_into_material():
    mesh = samples.frog_organ("spleen")
    program = nl.finish(mesh, nl.Cutter("ball", 6.0, length=60.0), scallop=0.1, tolerance=0.02)
    kinds = np.array([move.kind for move in program.moves])
    length = sum(move.curve.length() for move in program.moves if move.kind != "rapid")
    assert length / np.count_nonzero((kinds[1:] == "rapid") & (kinds[:-1] != "rapid")) >= 150.0
    volumes = nl.simulate(program, resolution=0.15).volumes
    assert (volumes[1:][(kinds[:-1] == "cut") & (kinds[1:] == "plunge")] > 0.0).all()


def test_no_ramp_leads_through_what_the_rim_alone_meets():
    """Into a gap narrower than the ball, beside walls: ramps through thin skins were a third of all moves."""

    def height(x, y):
        pocket = np.where((np.abs(x) < 8.0) & (np.abs(y) < 7.0), 0.0, 6.0)
        return np.where(np.hypot(x + 1.0, y) < 2.0, 4.0, pocket)

    program = nl.finish(block(height, 22.0, 66), CUTTERS["ball"], scallop=0.1, tolerance=0.02)
    assert sum(move.kind == "plunge" for move in program.moves) < 0.2 * len(program.moves)
    assert program.warnings == ()


def test_where_the_cutter_does_not_fit_beside_a_wall_it_goes_where_it_does():
    """Between a pocket's upright walls and a boss, tips that touch a wall were chased, by 30 retracts."""
    sides = {"height": 10.0, "sections": 96}
    rod, ring = trimesh.creation.cylinder(3.0, **sides), trimesh.creation.annulus(8.0, 12.0, **sides)
    rod.apply_translation((1.5, 0.0, -2.0))
    floor = trimesh.creation.cylinder(8.5, height=4.0, sections=96).apply_translation((0.0, 0.0, -3.0))
    program = nl.finish(rod + ring + floor, CUTTERS["ball"], scallop=0.1, tolerance=0.02)
    kinds = np.array([move.kind for move in program.moves])
    assert program.warnings == ()
    assert np.count_nonzero((kinds[1:] == "rapid") & (kinds[:-1] != "rapid")) < 20


def test_links_along_one_line_and_back_have_no_cusp():
    part = trimesh.creation.cone(radius=6.0, height=9.0)
    program = nl.finish(part, nl.Cutter("ball", diameter=4.0), scallop=0.1, tolerance=0.02)
    assert 0.0 < program.time_s < 60.0  # a curve that stops on its way has no plan
    # No move dips below the floor, the lowest point of the part; so no lower place counts as reachable.
    curves = [move.curve for move in program.moves]
    assert min(curve(np.linspace(*curve.domain, 60))[:, 2].min() for curve in curves) > -1e-9
    assert nl.verify(program, part).percentile(99) < 0.1


def test_closed_waterlines_climb():
    cutter = CUTTERS["ball"]
    program = nl.finish(DOME, cutter, scallop=SCALLOP, tolerance=TOLERANCE)
    level = [c for c in program.curves if np.ptp(c.control_points[:, 2]) < 1e-9 and c.length() > 20.0]
    level = [c for c in level if np.linalg.norm(c(c.domain[1]) - c(c.domain[0])) < 1.0]
    assert len(level) > 10
    for curve in level:
        u = np.mean(curve.domain)
        along = curve.derivative(u)
        right = np.array([along[1], -along[0], 0.0]) / np.linalg.norm(along)
        assert contact(machining.prepare_part(DOME), cutter).collides((curve(u) + 0.1 * right)[None])[0]


def test_waterlines_of_a_ball_are_circles():
    part = machining.prepare_part(DOME)
    touch = contact(part, CUTTERS["ball"])
    field = tip_field(touch, 0.5, -8.0, 4.0)
    levels = np.array([-3.0, 0.0, 3.0])
    found = waterlines(touch, field, levels)
    assert len(found) == 3
    for points, closed in found:
        radius = np.sqrt(11.0**2 - (points[:, 2] + 3.0) ** 2)
        assert closed
        assert np.abs(np.hypot(points[:, 0], points[:, 1]) - radius).max() < 0.02  # of the facets


def test_a_spline_along_a_helix_has_few_knots_and_keeps_its_points():
    t = np.linspace(0.0, 6.0, 200)
    points = np.column_stack([np.cos(t), np.sin(t), 0.1 * t])
    curve = spline_along(points, 1e-3)
    assert len(curve.control_points) < 25
    assert cKDTree(curve(np.linspace(*curve.domain, 100_000))).query(points)[0].max() < 1e-3
    assert np.abs(curve(np.array(curve.domain)) - points[[0, -1]]).max() < 1e-12


def test_a_spline_along_two_points_is_the_line_between_them():
    for points in np.random.default_rng(0).normal((20.0, 7.0, 10.0), 0.02, (50, 2, 3)):
        curve = spline_along(points, 0.005)
        assert curve.length() == pytest.approx(np.linalg.norm(points[1] - points[0]), rel=1e-9)
        places = curve(np.linspace(*curve.domain, 5))
        np.testing.assert_allclose(places, np.linspace(*points, 5), rtol=0, atol=1e-12)


def test_verify_finds_a_gouge_and_what_was_left_out(program):
    mesh = hills()
    deep = [
        machining.Move(m.kind, m.curve.transform(np.eye(3), (0.0, 0.0, -0.03)), m.feed) for m in program.moves
    ]
    assert nl.verify(machining.Program(deep, program.cutter), mesh).gouge == pytest.approx(0.03, abs=0.006)
    some = machining.Program(program.moves[: len(program.moves) // 4], program.cutter)
    assert np.mean(nl.verify(some, mesh).left > SCALLOP) > 0.05


@pytest.mark.parametrize(
    ("knots", "weights"),
    [([0, 0, 1e-4, 1, 1], None), ([0, 0, 1 - 1e-7, 1, 1], None), ([0, 0, 0.5, 1, 1], [1e-4, 1, 1])],
)
def test_a_move_of_uneven_speed_is_seen_from_end_to_end(knots, weights):
    """A polyline that is half a millimetre too deep: nearly all of it lies between two parameters."""
    points = [(-2.0, 5.0, 3.5), (20.0, 5.0, 3.5), (42.0, 5.0, 3.5)]
    move = machining.Move("cut", nl.NurbsCurve(1, knots, points, weights), 10.0)
    program = machining.Program([move], CUTTERS["ball"])
    part = trimesh.creation.box(bounds=[(0, 0, 0), (40, 10, 4)])
    milled = nl.simulate(program, [(0, 0, 0), (40, 10, 5)], 0.2)
    np.testing.assert_allclose(milled.remaining(part)[1:-1, 25], -0.5, rtol=0, atol=0.01)
    found = nl.verify(program, part)
    assert found.gouge == pytest.approx(0.5)
    assert np.ptp(found.gouges[:, 0]) > 39.0


@pytest.mark.parametrize("resolution", [0.05, 0.2, 1 / 3, 1.1, 4.0])
@pytest.mark.parametrize("kind", [list, lambda corners: trimesh.creation.box(bounds=corners)])
def test_facing_removes_the_volume_of_the_layer_whatever_the_resolution(resolution, kind):
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(-20.0, 1.0, 1.5), (20.0, 1.0, 1.5)])
    program = machining.Program([machining.Move("cut", line, 10.0)], nl.Cutter("flat", diameter=12.0))
    milled = nl.simulate(program, kind([(0, 0, 0), (3, 2, 2)]), resolution)
    assert milled.volumes.sum() == pytest.approx(3.0)


def test_the_virtual_machine_agrees_with_closed_forms():
    """A ball along a line through a block: the groove's cross-section times its length."""
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(-30.0, 0.05, -1.0), (30.0, 0.05, -1.0)])
    block = trimesh.creation.box(bounds=[(-10, -6, -5), (10, 6, 0)])
    milled = nl.simulate(machining.Program([machining.Move("cut", line, 10.0)], CUTTERS["ball"]), block, 0.05)
    angle = np.arccos(2.0 / 3.0)
    area = 9.0 * angle - 2.0 * np.sqrt(5.0)
    assert milled.volumes.sum() == pytest.approx(area * 20.0, rel=5e-3)
    assert milled.field.z.min() == pytest.approx(-1.0, abs=1e-3)
    assert (milled.field.z[:, 0] == 0.0).all()
    ways = [nl.NurbsCurve(1, [0, 0, 1, 1], [(a, 0, -4.9), (b, 0, -4.9)]) for a, b in ((0, 10), (10, 1.3))]
    slot = [machining.Move("cut", ways[0], 10.0), machining.Move("rapid", ways[1], None)]
    assert not nl.simulate(machining.Program(slot, CUTTERS["flat"]), block, 0.25).warnings()  # of rounding


@pytest.mark.parametrize("pieces", [1, 60])  # one move, and short moves as of a file
@pytest.mark.parametrize(
    ("kind", "edge", "depth", "bite"),
    [
        ("flat", -4.0, 2.0, 2.0),  # a slot
        ("flat", 4.0, 5.0, 5.0),  # a step-over of half the cutter, at full depth
        ("flat", 7.99, 5.0, 0.0),  # 0.01 mm off a wall
        ("flat", 7.95, 5.0, 5.0),  # 0.05 mm, more than twice the tolerance
        ("flat", -4.0, 0.03, 0.0),  # and downwards
        ("ball", -4.0, 7.0, 7.0),
        ("ball", 7.99, 7.0, 0.0),
    ],
)
def test_bites_are_the_depth_at_which_a_cutter_advances(kind, edge, depth, bite, pieces):
    """A cutter of 8 mm at y = 4 along a block that begins at ``y = edge``."""
    block = trimesh.creation.box(bounds=[(-2, edge, -8), (2, 8.2, 0)])
    ends = np.tile([0.0, 4.0, -depth], (pieces + 1, 1))
    ends[:, 0] = np.linspace(-12.0, 12.0, pieces + 1)
    lines = [nl.NurbsCurve(1, [0, 0, 1, 1], line) for line in pairwise(ends)]
    moves = [machining.Move("cut", line, 10.0) for line in lines]
    program = machining.Program(moves, nl.Cutter(kind, 8.0, length=20.0), tolerance=0.02)
    milled = nl.simulate(program, block, 0.01 if edge > 7.0 else 0.1)
    assert milled.volumes.sum() > 0.0
    assert milled.bites.max() == pytest.approx(bite, abs=1e-9)
