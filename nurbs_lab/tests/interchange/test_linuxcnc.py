"""LinuxCNC's own interpreter takes what we write, and moves where we say; it reads as we read."""

import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange.shapes import MOVES, PLANE, curve, milling, text_of, wave
from nurbs_lab.tests.interchange.simulated import Machine

pytestmark = pytest.mark.linuxcnc

DEBIANS_PYTHON = "/usr/bin/python3"
POINTS = Path(__file__).with_name("linuxcnc_points.py")
CURVES = [
    nl.paper.CURVE,
    nl.nurbs.circle(30.0, (5, 5)),
    curve(2, 9, 2, seed=3),
    curve(3, 12, 2, seed=4),
    curve(5, 9, 2, seed=5),
    nl.interpolate_curve(30 * np.random.default_rng(6).normal(size=(12, 2)), closed=True),
]


def run(command, file):
    (file.parent / "tool.tbl").touch()
    (file.parent / "x.var").touch()
    return subprocess.run(
        [*command, file.name], cwd=file.parent, env={"HOME": str(file.parent)}, capture_output=True, text=True
    )


def interpreted(file):
    """What the interpreter calls of its machine, as text; its own words if it refuses."""
    ran = run(["rs274", "-t", "tool.tbl", "-v", "x.var", "-g"], file)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def moves_of(file):
    ran = run([DEBIANS_PYTHON, POINTS], file)
    assert ran.returncode == 0, ran.stderr
    return json.loads(ran.stdout)


def points_of(moves):
    return np.array([point for _, kind, points in moves for point in points])


@pytest.mark.parametrize("one", CURVES)
@pytest.mark.parametrize("units", ["mm", "inch"])
def test_its_splines_are_our_curves(tmp_path, one, units):
    file = nl.export(tmp_path / "a.ngc", one, dialect="linuxcnc", **{**PLANE, "units": units})
    assert interpreted(file).count("NURBS_FEED") == file.read_text().count("G5.3")
    away = one.closest_point(points_of(moves_of(file))[:, :2])[1].max()
    assert away < (1e-6 if one.degree <= 3 else PLANE["tolerance"])


@pytest.mark.parametrize("dialect", ["g1", "arcs"])
@pytest.mark.parametrize("one", CURVES)
def test_its_lines_and_arcs_keep_the_tolerance(tmp_path, dialect, one):
    file = nl.export(tmp_path / "a.ngc", one, dialect=dialect, **PLANE)
    assert "FEED" in interpreted(file)
    assert one.closest_point(points_of(moves_of(file))[:, :2])[1].max() <= PLANE["tolerance"]


@pytest.mark.parametrize("dialect", ["g1", "arcs", "linuxcnc"])
def test_programs_of_several_curves(tmp_path, dialect):
    file = nl.export(tmp_path / "a.ngc", milling(), dialect=dialect, **MOVES)
    assert interpreted(file).count("STRAIGHT_TRAVERSE") == 4
    end = milling().moves[-1].curve
    np.testing.assert_allclose(moves_of(file)[-1][2][-1], end(end.domain[1]), atol=1e-6)


@pytest.mark.parametrize("dialect", ["g1", "arcs", "linuxcnc"])
def test_a_setup_starts_its_machine(tmp_path, dialect):
    setup = nl.interchange.Setup(tool=3, spindle_rpm=8000, safe_z_mm=50.0, coolant="flood", offset=55)
    file = nl.export(tmp_path / "a.ngc", milling(), dialect=dialect, setup=setup, **MOVES)
    (tmp_path / "tool.tbl").write_text("T3 P3 Z0.5 D0.2\n")
    called = interpreted(file)
    words = [
        "CHANGE_TOOL",
        "SET_SPINDLE_SPEED(0, 8000.",
        "SPINDLE_CLOCKWISE",
        "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 12.7",
    ]
    places = [called.index(word) for word in [*words, "FLOOD_ON", "FEED(", "FLOOD_OFF", "PROGRAM_END"]]
    assert places == sorted(places)
    heights = re.findall(r"STRAIGHT_TRAVERSE\([^,]*, [^,]*, ([^,]*),", called)
    assert float(heights[0]) == float(heights[1]) == float(heights[-1]) == 50.0


def test_a_tool_path_and_a_smoothed_program(tmp_path):
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    path = nl.trace(nl.paper.CURVE, feed, period_s=1e-3)
    points = points_of(moves_of(nl.export(tmp_path / "a.ngc", path)))
    np.testing.assert_allclose(points[-1, :2], path.points[-1], atol=1e-6)
    facets = wave(400, rows=2)
    (tmp_path / "facets.ngc").write_text(text_of(facets))
    smooth = nl.smooth(nl.read(tmp_path / "facets.ngc"), tolerance=0.01)
    file = nl.export(tmp_path / "b.ngc", smooth, dialect="g1", tolerance=0.01, units="mm", axes="XYZ")
    found = points_of(moves_of(file))
    near = np.linalg.norm(found[:, None, :] - facets[None, ::7], axis=-1).min(axis=0)
    assert near.max() < 2.0  # the whole way, not a part of it
    assert "FEED" in interpreted(file)


@pytest.mark.parametrize("seed", range(20))
def test_it_goes_where_the_simulator_goes(tmp_path, seed):
    """And the reader goes there too, see `test_gcode_reader`: three programs that share nothing."""
    machine = Machine(seed)
    (tmp_path / "a.ngc").write_text(machine.text)
    theirs, at = points_of(moves_of(tmp_path / "a.ngc")), 0
    for _, points, _ in machine.moves:
        (found,) = np.nonzero(np.abs(theirs[at:] - points[-1]).max(axis=1) < 2e-6)
        at += found[0]
