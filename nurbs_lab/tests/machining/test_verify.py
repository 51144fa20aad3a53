"""What `verify` measures, by hand-made programs."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

import nurbs_lab as nl
from nurbs_lab import machining
from nurbs_lab.mesh import samples
from nurbs_lab.tests.machining.shapes import CUTTERS, WIDE, shallow_slot


def test_verify_measures_the_strip_that_the_ball_bridges_and_no_pass_goes_through():
    """By circles round the passes and round the places where the ball rests on the floor or on the rim."""
    across = [(y, 8.0) for y in np.linspace(-1.0, 1.0, 5)]
    across += [(side * y, 9.0) for side in (-1.0, 1.0) for y in np.linspace(WIDE, WIDE + 3.0, 7)]
    lines = [nl.NurbsCurve(1, [0, 0, 1, 1], [(x, y, z) for x in (-25.0, 25.0)]) for y, z in across]
    moves = [machining.Move("cut", line, 10.0) for line in lines]
    found = nl.verify(machining.Program(moves, CUTTERS["ball"], tolerance=0.02), shallow_slot(), spacing=0.1)
    y = np.linspace(0.0, WIDE, 10001)
    rest = np.where(y < WIDE - np.sqrt(5.0), 11.0, 9.0 + np.sqrt((9.0 - (WIDE - y) ** 2).clip(0.0)))
    inner = (np.abs(found.narrow_points) < (15.0, WIDE + 1e-9, 9.0)).all(axis=1)
    points = np.abs(found.narrow_points[inner, 1:])
    left, gap = (cKDTree(at).query(points)[0] - 3.0 for at in (np.add(across, (0, 3.0)), np.c_[y, rest]))
    less = (left - gap).clip(0.0) - found.bridged[inner]  # between the samples the ball comes a little closer
    assert -0.001 < less.min() <= less.max() < 0.05
    touched = (np.abs(found.points) < (15.0, WIDE + 2.0, 9.1)).all(axis=1) & (found.points[:, 2] > 7.9)
    assert found.left[touched].max() < 0.1
    assert found.bridged.max() > 0.3
    assert f"at most {found.bridged.max():.4g} mm on {len(found.bridged)} samples" in found.report()


def test_what_is_left_is_measured_however_far_it_reaches():
    """One groove in a block 3 mm above the part, 2 mm beside it: its distance, or that of the block."""
    box = trimesh.creation.box(bounds=[(-10, -10, 0), (10, 10, 4)])
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(-15.0, 0.0, 5.0), (15.0, 0.0, 5.0)])
    stock = np.array([(-12.0, -12.0, 0.0), (12.0, 12.0, 7.0)])
    moves = [machining.Move("cut", line, 10.0)]
    program = machining.Program(moves, nl.Cutter("ball", 4.0, length=20.0))
    for known, least in ((stock, 2.9), (None, 9.0)):
        found = nl.verify(replace(program, stock=known), box)
        x, y, z = found.points.T
        left = np.hypot(y, 7.0 - z) - 2.0
        faces = np.minimum(7.0 - z, 12.0 - np.maximum(abs(x), abs(y)))
        left = left if known is None else np.minimum(left, faces)
        np.testing.assert_allclose(found.left, left, rtol=0, atol=1e-3)
        assert least < found.percentile(100) == pytest.approx(left.max(), abs=1e-3)
        assert f"{found.percentile(100):.4g} mm on all" in found.report()
        assert np.mean(found.left > 2.0) == pytest.approx(np.mean(left > 2.0), abs=1e-3)
    elsewhere = box.copy().apply_translation((100.0, 0.0, 0.0))  # of which the stock says nothing
    assert nl.verify(replace(program, stock=stock), elsewhere).percentile(0) > 70.0


def test_no_pillar_stays_that_passes_come_near_on_all_sides():
    """By the lowest disc over places round the tip of a cone; without passes over it `verify` sees it."""
    cone = trimesh.creation.cone(radius=10.0, height=15.0, sections=64)
    cutter = nl.Cutter("flat", 6.0, length=40.0)
    rough = nl.rough(cone, machining.stock_around(cone), cutter, 2.0, 0.3)
    program = nl.finish(cone, cutter, scallop=0.5, tolerance=0.05, after=rough)
    moves = [move for move in (*rough.moves, *program.moves) if move.kind != "rapid"]
    tips = np.concatenate([move.curve(np.linspace(*move.curve.domain, 2000)) for move in moves])
    for place in np.random.default_rng(0).uniform(-0.5, 0.5, (200, 2)):
        assert tips[np.hypot(*(tips[:, :2] - place).T) < 3.0, 2].min() < 15.5
    assert nl.verify(program, cone).percentile(100) < 0.5
    beside = [move for move in program.moves if np.hypot(*move.curve.control_points[:, :2].T).min() > 2.5]
    assert 1.9 < nl.verify(replace(program, moves=beside), cone).percentile(100) < 2.1


def lowest_ball(tips, x, y, r):
    """Height at each ``x, y`` below which no ball with one of these tips reaches."""
    out, near = np.empty(x.shape), cKDTree(tips[:, :2])
    for i in np.ndindex(x.shape):
        some = tips[near.query_ball_point((x[i], y[i]), 0.999 * r)]
        square = ((some[:, :2] - (x[i], y[i])) ** 2).sum(axis=1)
        out[i] = (some[:, 2] + r - np.sqrt(r * r - square)).min()
    return out


def test_the_cutter_rests_between_edges_where_it_takes_most():
    """By a field of heights of what the ball can take, from a drop-cutter, and of what is cut."""
    mesh, ball = samples.frog_organ("eye_white"), nl.Cutter("ball", 6.0, length=60.0)
    moves = nl.finish(mesh, ball, scallop=0.1, tolerance=0.02).moves
    x, y = np.meshgrid(np.arange(398.0, 401.0, 0.1), np.arange(202.0, 206.0, 0.1), indexing="ij")
    wide = [np.arange(low - 3.1, high + 3.1, 0.1) for low, high in ((398.0, 401.0), (202.0, 206.0))]
    around = np.stack(np.meshgrid(*wide), axis=-1).reshape(-1, 2)
    resting = np.column_stack([around, nl.drop_cutter(mesh, ball, around).clip(mesh.bounds[0, 2])])
    curves = [move.curve for move in moves if move.kind != "rapid"]
    cut = np.concatenate([one(np.linspace(*one.domain, int(one.length() / 0.05) + 2)) for one in curves])
    possible = lowest_ball(resting, x, y, 3.0)
    slope = np.hypot(*np.gradient(possible, 0.1))
    left = (lowest_ball(cut, x, y, 3.0) - possible) / np.hypot(1.0, slope)
    assert left[slope < 1.5].max() < 0.12  # 1.2 scallops
