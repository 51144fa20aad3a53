"""Further passes: gaps, pits, steps and cliffs leave no more than asked, or it is said."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

import nurbs_lab as nl
from nurbs_lab import machining
from nurbs_lab.machining.fit import Fitting, fit_paths
from nurbs_lab.machining.passes import layout
from nurbs_lab.tests.machining.shapes import CUTTERS, WIDE, block, shallow_slot

SCALLOP, TOLERANCE = 0.05, 0.01


def slotted(width, turn=0.4):
    """A block with a slot of this width, 5 mm deep, at an angle to the axes."""
    line = 0.5 * np.array([-20.0, -width, -width, width, width, 20.0])
    line[[0, -1]] *= 2.0
    z = np.array([8.0, 8.0, 3.0, 3.0, 8.0, 8.0])
    profile = np.column_stack([line, z])[::-1]
    profile = np.vstack([profile, [(-20.0, 0.0), (20.0, 0.0)]])
    ends = [np.insert(profile, 0, x, axis=1) for x in (-10.0, 10.0)]
    k, n = np.arange(8), 8
    after = (k + 1) % n
    walls = np.concatenate([np.column_stack([k, k + n, after]), np.column_stack([after, k + n, after + n])])
    cap = np.array([(6, 4, 5), (6, 3, 4), (6, 7, 3), (7, 2, 3), (7, 1, 2), (7, 0, 1)])
    faces = np.concatenate([walls, cap, cap[:, ::-1] + n])[:, ::-1]
    mesh = trimesh.Trimesh(np.concatenate(ends), faces, process=False)
    mesh.apply_transform(trimesh.transformations.rotation_matrix(turn, (0, 0, 1)))
    return mesh


@pytest.mark.parametrize(("kind", "width", "fits"), [("ball", 6.1, 1), ("bull", 6.1, 1), ("ball", 6.004, 0)])
def test_gaps_hardly_wider_than_the_cutter_are_finished_or_it_is_said(kind, width, fits):
    """By the tips on the floor of a slot at an angle to the axes."""
    program = nl.finish(slotted(width), replace(CUTTERS[kind], length=30.0), scallop=0.2, tolerance=0.04)
    assert len(program.warnings) == 1 - fits
    tips = np.concatenate([curve(np.linspace(*curve.domain, 400)) for curve in program.curves])
    tips = tips @ trimesh.transformations.rotation_matrix(0.4, (0, 0, 1))[:3, :3]
    deep = tips[(np.abs(tips[:, :2]) < (9.0, 0.2)).all(axis=1) & (tips[:, 2] < 3.0 + program.tolerance), 0]
    assert (len(deep) > 0) == fits
    assert not fits or np.diff(np.sort(np.append(deep, (-9.0, 9.0)))).max() < 1.0


def test_no_more_than_asked_is_left_where_the_ball_rests_between_a_rim_and_the_floor():
    """What the ball leaves there of a slot is a circle in closed form."""
    wide, scallop, tolerance, axis = WIDE, 0.1, 0.02, np.array([0.0, 0.0, 3.0])
    part = shallow_slot()
    program = nl.finish(part, nl.Cutter("ball", 6.0, length=20.0), scallop=scallop, tolerance=tolerance)
    tips = [curve(np.linspace(*curve.domain, int(curve.length() / 0.02) + 2)) for curve in program.curves]
    centre = wide - np.sqrt(3.0**2 - 2.0**2)  # of a ball that rests on the floor and on the edge of the rim
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-15, 15, 101), np.linspace(centre, wide, 201)[:-1]))
    bowl = np.column_stack([x, y, 11.0 - np.sqrt(3.0**2 - (y - centre) ** 2)])
    left = cKDTree(np.concatenate(tips) + axis).query(np.concatenate([bowl, bowl * (1, -1, 1)]))[0] - 3.0
    assert 0.0 < left.min() <= left.max() < scallop + tolerance
    assert np.mean(left > scallop) < 0.01


@pytest.mark.parametrize("x", [2.3, 3.5])
def test_a_further_pass_ends_at_a_cliff(x):
    """Beside the edge of a plateau, and at the foot of its wall, a pass goes neither down nor up the wall."""
    part = machining.prepare_part(block(lambda x, y: 20.0 * np.clip(0.5 - x, 0.0, 1.0), 24.0, 96))
    fitting = Fitting(part, CUTTERS["ball"], TOLERANCE)
    plan = layout(fitting.touch(0.5), CUTTERS["ball"], SCALLOP, part.bounds[0, 2])
    tip = np.array([[x, 0.0, plan.touch.heights(np.array([[x, 0.0]]))[0]]])
    paths = fit_paths(fitting, plan.paths_through(tip, np.ones(1)))
    tips = np.concatenate([path.curve(np.linspace(*path.curve.domain, 200)) for path in paths])
    assert cKDTree(tips).query(tip)[0] < 0.02
    assert np.ptp(tips[:, 2]) < 4.0  # as far as two passes of one path are apart, up and down


def test_no_pass_is_wasted_on_a_hole_deeper_than_the_ball_is_wide():
    """Where nothing at rest comes near its floor, and nothing is said of it either."""
    profile = [(0, 0), (14, 0), (14, 20), (2.5, 20), (2.5, 5), (0, 5)]
    part = trimesh.creation.revolve(profile, sections=64)
    program = nl.finish(part, replace(CUTTERS["ball"], length=30.0), scallop=0.2, tolerance=0.04)
    assert program.warnings == ()
    tips = np.concatenate([curve(np.linspace(*curve.domain, 400)) for curve in program.curves])
    inside = np.hypot(*tips[:, :2].T) < 2.5
    assert tips[inside, 2].min() > 18.5  # the ball sinks 1.34 mm


def test_a_floor_is_reached_where_the_disc_covers_it():
    """A slot of 9 mm and a flat cutter of 6: it reaches all of the floor and both walls."""
    mesh = slotted(9.0, 0.0)
    found = nl.verify(nl.finish(mesh, CUTTERS["flat"], scallop=0.2, tolerance=0.04), mesh)
    assert found.unreachable["narrow"] < 0.02 * 9.0 * 20.0


@pytest.mark.parametrize("angle", [90.0, 60.0])
def test_steps_lower_than_the_cells_of_the_grid_are_finished(angle):
    part = trimesh.creation.box((20.0, 20.0, 0.4))
    upper = part.vertices[:, 2] > 0.0
    part.vertices[upper, :2] *= 1.0 - 0.04 / np.tan(np.radians(angle))
    program = nl.finish(part, nl.Cutter("flat", 12.0), scallop=0.1, tolerance=0.01)
    assert program.warnings == ()
    assert len(program.moves) < 100
    assert nl.verify(program, part).percentile(100) < 0.1
