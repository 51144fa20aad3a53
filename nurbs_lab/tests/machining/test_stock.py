"""What programs know of their stock, and of the programs that were cut before them."""

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

import nurbs_lab as nl
from nurbs_lab import machining
from nurbs_lab.machining.stock import require_inside
from nurbs_lab.tests.machining.shapes import CUTTERS, DOME, block, hills


def test_a_short_cutter_says_that_its_shank_and_holder_touch_the_stock():
    block = trimesh.creation.box((30.0, 20.0, 4.0))
    stock = block.bounds + np.array([[-5, -5, 0], [5, 5, 10.0]])
    cutter = nl.Cutter("flat", 6.0, length=8.0, shank=8.0, holder=20.0, reach=9.0)
    program = nl.finish(block, cutter, scallop=0.1, tolerance=0.02, stock=stock)
    assert ["shank" in said for said in program.warnings] == [True, False]
    assert ["holder" in said for said in program.warnings] == [False, True]
    assert nl.verify(program, block).contacts == program.warnings


def test_a_rest_pass_cuts_only_what_the_larger_cutter_left():
    part = hills()
    first = nl.finish(part, nl.Cutter("ball", 6.0), scallop=0.1, tolerance=0.02)
    rest = nl.finish(part, nl.Cutter("ball", 2.0, length=20.0), scallop=0.1, tolerance=0.02, after=first)
    alone = nl.finish(part, nl.Cutter("ball", 2.0, length=20.0), scallop=0.1, tolerance=0.02)
    size, whole = (sum(curve.length() for curve in one.curves) for one in (rest, alone))
    assert 0.0 < size < 0.8 * whole
    rapid = [move.kind == "rapid" for move in rest.moves]
    assert nl.simulate(rest, rest.stock, 0.1).volumes[rapid].sum() == 0.0


@pytest.mark.parametrize("roughed", [True, False])
def test_only_what_the_stock_had_is_finished(roughed):
    """Sides and top of a block with a pocket that is cut from just that block need no pass."""
    part = block(lambda x, y: np.where((abs(x) < 7.2) & (abs(y) < 6.2), -3.0, 0.0), 24.0, 48)
    rough = nl.rough(part, part.bounds, nl.Cutter("flat", 6.0, length=20.0), 2.0, 0.3) if roughed else None
    ball, options = nl.Cutter("ball", 4.0, length=20.0), {"scallop": 0.1, "tolerance": 0.02}
    program = nl.finish(part, ball, after=rough, **options)
    tips = np.concatenate([curve(np.linspace(*curve.domain, 50)) for curve in program.curves])
    assert (np.abs(tips[:, :2]) < (7.7, 6.7)).all()
    found = nl.verify(program, part)
    assert found.percentile(99) < 0.1
    assert found.gouge < 0.02


def test_a_rest_program_is_judged_together_with_those_before_it():
    """By the balls of all three; after the roughing and the rest there is nothing left to do."""
    part, small, options = hills(), nl.Cutter("ball", 2.0, length=20.0), {"scallop": 0.1, "tolerance": 0.02}
    rough = nl.rough(part, machining.stock_around(part), nl.Cutter("flat", 6.0, length=20.0), 3.0, 0.3)
    first = nl.finish(part, nl.Cutter("ball", 6.0), after=rough, **options)
    rest = nl.finish(part, small, after=first, **options)
    before, found = nl.verify(first, part), nl.verify(rest, part)
    low, high = part.bounds[:, :2]
    inner = ((found.points[:, :2] > low + 0.01) & (found.points[:, :2] < high - 0.01)).all(axis=1)
    some, gaps = np.flatnonzero(inner)[::5], []  # without the upright sides
    for program in (first, rest):
        curves = [move.curve for move in program.moves if move.kind != "rapid"]
        tips = [curve(np.linspace(*curve.domain, int(curve.length() / 0.03) + 2)) for curve in curves]
        r = program.cutter.radius
        centres = np.concatenate(tips) + np.array([0.0, 0.0, r])
        gaps.append(cKDTree(centres).query(found.points[some])[0] - r)
    assert np.percentile(np.abs(np.min(gaps, axis=0) - found.left[some]), 99) < 1e-3
    assert found.percentile(99) < 0.1
    assert before.areas.sum() < found.areas.sum()
    assert found.unreachable["narrow"] < before.unreachable["narrow"]
    assert nl.verify(rough, part).percentile(1) > 0.3 - rough.tolerance
    with pytest.raises(ValueError, match="there is nothing"):
        nl.finish(part, small, after=rest, scallop=0.15, tolerance=0.02)


@pytest.mark.parametrize("face", range(6))
def test_a_part_outside_its_stock_is_refused(face):
    """By blocks that miss a layer of the part on one side."""
    short = DOME.bounds.copy()
    short[face // 3, face % 3] *= 0.99
    with pytest.raises(ValueError, match=r"part is not inside its stock: up to 0.08 mm"):
        nl.finish(DOME, CUTTERS["ball"], scallop=0.5, tolerance=0.1, stock=short)
    with pytest.raises(ValueError, match="part is not inside its stock"):
        nl.rough(DOME, short, CUTTERS["flat"], 2.0, 0.3)


def test_a_stock_that_is_the_part_but_for_rounding_holds_it():
    """Walls that rounding moves past nodes of the grid leave no height there."""
    part = trimesh.creation.box((30.0, 20.0, 10.0))
    for angle in (0.3, 0.7, 1.1, 1.9):
        there = trimesh.transformations.rotation_matrix(angle, (1.0, 2.0, 3.0))
        stock = part.copy().apply_transform(there).apply_transform(np.linalg.inv(there))
        require_inside(machining.prepare_part(part), machining.prepare_part(stock), nl.Cutter("ball", 6.0))
