"""Roughing: it keeps its step, and leaves what it is told to leave."""

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab import machining
from nurbs_lab.mesh import samples
from nurbs_lab.tests.machining.shapes import hills


def test_roughing_a_pocket_leaves_what_it_was_told_to():
    walls = [((0, 0, 0), (30, 20, 5)), ((0, 0, 5), (30, 4, 10)), ((0, 16, 5), (30, 20, 10))]
    walls += [((0, 4, 5), (16, 16, 10)), ((26, 4, 5), (30, 16, 10))]
    part = trimesh.util.concatenate([trimesh.creation.box(bounds=wall) for wall in walls])
    program = nl.rough(
        part, machining.stock_around(part), nl.Cutter("flat", diameter=5.0, length=30.0), 2.0, 0.3
    )
    surface = machining.prepare_part(part)
    for move in program.moves:
        tips = move.curve(np.linspace(*move.curve.domain, 50))
        assert (tips[:, 2] >= nl.drop_cutter(surface, program.cutter, tips[:, :2]) - 1e-9).all()


def test_roughing_keeps_its_step_where_slivers_would_stand():
    """Contours of a scan change from level to level; slivers between them stood 9 mm high."""
    mesh = samples.frog_organ("spleen")
    program = nl.rough(mesh, machining.stock_around(mesh), nl.Cutter("flat", 8.0), 2.0, 0.3)
    milled = nl.simulate(program, resolution=0.13)
    assert milled.bites.max() <= 2.0 + program.tolerance
    assert milled.contacts.max() == 0.0


def test_more_may_be_left_than_the_stock_has_beside_the_part():
    """There is a millimetre beside the box, and 8 above it: the lowest tip is 3 above."""
    part = trimesh.creation.box(bounds=[(-3, -2, -1), (3, 2, 1)])
    stock = trimesh.creation.box(bounds=[(-4, -3, -1), (4, 3, 9)])
    program = nl.rough(part, stock, nl.Cutter("ball", diameter=2.0), 1.0, 3.0)
    lowest = min(curve.control_points[:, 2].min() for curve in program.curves)
    assert lowest == pytest.approx(4.0, abs=1e-3)
    assert nl.simulate(program, stock).remaining(part).min() == pytest.approx(3.0, abs=1e-3)


def test_a_step_down_of_more_than_the_stock_is_one_of_the_stock():
    ball = trimesh.creation.icosphere(2, 8.0)
    stock, cutter = machining.stock_around(ball), nl.Cutter("ball", diameter=6.0)
    one, same = (nl.rough(ball, stock, cutter, down, 0.3) for down in (18.0, 1e3))
    assert [move.kind for move in one.moves] == [move.kind for move in same.moves]


@pytest.mark.parametrize("kind", ["ball", "flat", "bull"])
def test_roughing_leaves_what_it_should_and_clears_the_rest(kind):
    mesh, leave = hills(), 0.4
    stock = machining.stock_around(mesh)
    cutter = nl.Cutter(kind, 4.0, 0.5 if kind == "bull" else None)
    program = nl.rough(mesh, stock, cutter, 1.5, leave)
    milled = nl.simulate(program, stock, 0.2)
    left = milled.remaining(mesh)
    assert left.min() >= leave - 1e-3
    assert np.median(left[np.isfinite(left)]) < leave + 1.5 + 1.0
    rapid = [move.kind == "rapid" for move in program.moves]
    assert milled.volumes[rapid].sum() == 0.0
    assert np.median(milled.bites[milled.bites > 1.0]) > 1.2
    assert milled.bites.max() <= 1.5 + cutter.corner_radius  # which stays at the foot of walls


@pytest.mark.parametrize("kind", ["ball", "flat", "bull"])
def test_roughing_leaves_level_faces_as_told_at_any_height(kind):
    """By the lowest cutter over places in the middle of faces, one of them tilted by half a degree."""
    cutter, leave = nl.Cutter(kind, 6.0, 1.2 if kind == "bull" else None), 0.3
    heights, tilts, origin = (3.0, 5.1, 4.45, 6.2, 4.0), (0.0, 0.0, 0.0, 0.0, 0.009), (0.1, 1000.3, 77.77)
    boxes = []
    for k, (h, tilt) in enumerate(zip(heights, tilts, strict=True)):
        boxes.append(trimesh.creation.box(bounds=[(14 * k, -10, 0), (14 * k + 14, 10, h)]))
        boxes[k].vertices[:, 2] += tilt * boxes[k].vertices[:, 1] * (boxes[k].vertices[:, 2] > 1.0)
    part = trimesh.util.concatenate(boxes).apply_translation(origin)
    program = nl.rough(part, machining.stock_around(part), cutter, 2.0, leave)
    tips = np.concatenate([curve(np.linspace(*curve.domain, 500)) for curve in program.curves]) - origin
    a, r = cutter.flat_radius, cutter.corner_radius
    cusp = r - np.sqrt(r * r - 2.0 * 0.75**2) if a == 0.0 else 0.0  # at corners of passes 1.5 mm apart
    for k, (h, tilt) in enumerate(zip(heights, tilts, strict=True)):
        for x, y in np.random.default_rng(k).uniform((14 * k + 5, -6), (14 * k + 9, 6), (20, 2)):
            off = np.hypot(tips[:, 0] - x, tips[:, 1] - y)
            under, off = tips[off < cutter.radius, 2], np.maximum(off[off < cutter.radius] - a, 0.0)
            left = (under + r - np.sqrt(r * r - off * off)).min() - (h + tilt * y)
            assert leave - 1e-6 <= left <= leave + 20.0 * tilt + cusp + 1e-4
    assert nl.simulate(program).bites.max() <= 2.0 + r + program.tolerance


@pytest.mark.parametrize(("diameter", "margin"), [(12.0, 0.75), (50.0, 4.0), (100.0, 2.0)])
def test_roughing_clears_thin_skins_and_leaves_no_less_than_told(diameter, margin):
    """By the distance of the axis from a rectangle."""
    part, leave = trimesh.creation.box((20.0, 12.0, 4.0)), 0.3
    program = nl.rough(part, machining.stock_around(part, margin), nl.Cutter("flat", diameter), 2.0, leave)
    tips = np.concatenate([curve(np.linspace(*curve.domain, 2000)) for curve in program.curves])
    for z in (2.0, -1.9):
        xy = tips[tips[:, 2] < z, :2]
        beside = np.hypot(*np.maximum(np.abs(xy) - (10.0, 6.0), 0.0).T) - diameter / 2
        assert leave <= beside.min()
        for place in [(10, 6), (10, 0), (0, 6), (-10, 3), (4, -6)]:
            assert np.hypot(*(xy - place).T).min() - diameter / 2 < leave + diameter / 120
    assert program.warnings == ()


@pytest.mark.parametrize(
    ("room", "turn", "end", "fits"),
    [(0.06, 0.4, 20.0, 1), (1.2, 0.0, 15.0, 1), (0.02, 0.8, 15.0, 0)],
)
def test_slots_hardly_wider_than_the_cutter_are_cleared_or_it_is_said(room, turn, end, fits):
    """By the tips on the floor of a slot from -``end`` to ``end`` in a block, turned from the axes."""
    leave, y = 0.1, 3.1 + room / 2.0
    walls = [((-20, -12, 0), (20, 12, 4)), ((-20, -12, 4), (20, -y, 9)), ((-20, y, 4), (20, 12, 9))]
    if end < 20.0:
        walls += [((-20, -y, 4), (-end, y, 9)), ((end, -y, 4), (20, y, 9))]
    part = trimesh.util.concatenate([trimesh.creation.box(bounds=wall) for wall in walls])
    part.apply_transform(trimesh.transformations.rotation_matrix(turn, (0, 0, 1)))
    cutter = nl.Cutter("flat", 6.0, length=40.0)
    program = nl.rough(part, machining.stock_around(part, 1.0), cutter, 2.0, leave)
    assert len(program.warnings) == 1 - fits
    tips = np.concatenate([curve(np.linspace(*curve.domain, 2000)) for curve in program.curves])
    tips = tips @ trimesh.transformations.rotation_matrix(turn, (0, 0, 1))[:3, :3]
    deep = tips[(np.abs(tips[:, :2]) < (11.0, room)).all(axis=1) & (tips[:, 2] < 4.001 + leave), 0]
    assert (len(deep) > 0) == fits
    assert not fits or np.diff(np.sort(np.append(deep, (-11.0, 11.0)))).max() < 1.0


@pytest.mark.parametrize("radius", [3.08, 3.4, 3.44])
def test_round_holes_hardly_wider_than_the_cutter_are_cut_by_paths_that_can_be_planned(radius):
    """Rings of which two points were left became ways to and fro that stop in a cusp."""
    part = trimesh.creation.annulus(radius, 8.0, 6.0, sections=48).apply_translation((0.13, 0.065, 0.0))
    machine = nl.Limits(speed=200.0, acceleration=2000.0, chord_error=1e-3)
    if radius < 3.3:
        ball = nl.Cutter("ball", diameter=6.0)
        program = nl.finish(part, ball, scallop=0.1, tolerance=0.02, machine=machine)
    else:
        flat = nl.Cutter("flat", diameter=6.0)
        program = nl.rough(part, machining.stock_around(part), flat, 2.0, 0.3, machine=machine)
    points = np.concatenate([curve(np.linspace(*curve.domain, 9)) for curve in program.curves])
    inside = np.hypot(points[:, 0] - 0.13, points[:, 1] - 0.065) < radius - 3.0
    assert points[inside, 2].min() < -2.9  # the hole is milled to its end
    assert 0.0 < program.time_s < 300.0


def test_sizes_and_speeds_that_are_too_small_or_large_are_told_early():
    """The default stock of a part of 1 mm is not one of 5 mm, and no machine moves 1 nm in a second."""
    small = trimesh.creation.box((1.0, 0.75, 0.5))
    np.testing.assert_allclose(np.ptp(machining.stock_around(small).bounds, axis=0), (5 / 3, 17 / 12, 5 / 6))
    with pytest.raises(ValueError, match=r"^feed must be at least 0\.0002 mm/s"):
        nl.finish(small, nl.Cutter("ball", 0.2), scallop=0.02, tolerance=0.004, feed=1e-6)
