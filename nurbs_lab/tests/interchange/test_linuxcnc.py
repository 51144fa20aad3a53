"""LinuxCNC's own interpreter takes what we write, and moves where we say; it reads as we read."""

import json
import random
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange.shapes import MOVES, PLANE, curve, milling, text_of, wave

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


def test_it_knows_no_g6_2(tmp_path):
    file = nl.export(tmp_path / "a.ngc", nl.paper.CURVE, dialect="fanuc", **PLANE)
    assert "nknown g code" in run(["rs274", "-t", "tool.tbl", "-v", "x.var", "-g"], file).stderr


def ordinary(seed):
    """A random program in the plane XY of all words that both know."""
    rng = random.Random(seed)
    lines, absolute = ["G21 G17 G90 G94", "G0 X0 Y0 Z0", "F600"], True
    lines += ["o<leg> sub", "#5=[#1 * cos[#2]]", "G1 X#5 Y[#1 * sin[#2] + #<_lift>]", "o<leg> endsub"]
    lines += ["#<_lift>=0.5", "#31=7"]
    for i in range(60):
        x, y = (round(rng.uniform(-20, 20), 3) for _ in range(2))
        kind = rng.randrange(14)
        if kind < 3:
            lines.append(f"G{rng.choice('01')} X{x} " + rng.choice([f"Y{y}", f"Z{y}", ""]))
        elif kind < 6:
            i, j = (round(rng.uniform(1, 9), 3) for _ in range(2))
            around = rng.choice(["", "P2", f"Z{x}"])
            start = "G91" if absolute else ""
            turn = rng.choice([f"X{2 * i} Y{2 * j} I{i} J{j}", f"X{i} R{i}", f"X{i} Y{j} R-{i + j}"])
            lines.append(f"{start} G{rng.choice('23')} {turn} {around if 'I' in turn else ''}")
            absolute = False if absolute else absolute
        elif kind == 6:
            lines.append(rng.choice(["G90", "G91"]))
            absolute = lines[-1] == "G90"
        elif kind == 7:
            lines.append(
                rng.choice(["G20", "G21", f"G92 X{x}", "G92.1", f"G10 L2 P2 X{x} Y{y}", "G55", "G54"])
            )
            lines.append("F600")
        elif kind == 8:
            lines.append(f"G90 G0 X{x} Y{y}")
            absolute = True
        elif kind == 9:
            lines.append(f"o<leg> call [{x}] [atan[{y}]/[{x}]]")
        elif kind == 10:
            lines += [
                f"#31=[#31 + [{x} GT {y}] * 2 - 3 ** 2 mod 4]",
                f"G1 X[-#31 / 2] Y-[abs[{y}] + fix[{x}]]",
            ]
        elif kind == 11:
            lines += [f"#7=0\no{i} while [#7 lt {rng.randrange(4)}]", f"G0 X[{x} + #7] Z#7", "#7=[#7 + 1]"]
            lines += [
                f"o{100 + i} if [#7 eq 2 or {x} gt 5]",
                f"o{i} break",
                f"o{100 + i} endif",
                f"o{i} endwhile",
            ]
        elif kind == 12:
            lines += [f"o{i} if [{x} lt -5]", "G1 X1", f"o{i} elseif [{x} lt 5]", "G1 X2", f"o{i} else"]
            lines += ["G1 X3", f"o{i} endif"]
        else:
            lines += [
                f"o{i} repeat [2]",
                f"G1 X[{x} + #31] Y{y} (some) M62 P0",
                "G64 P0.05",
                f"o{i} endrepeat",
            ]
    return "\n".join([*lines, "M2", ""])


@pytest.mark.parametrize("seed", range(20))
def test_ordinary_programs_are_read_as_it_reads_them(tmp_path, seed):
    file = tmp_path / "a.ngc"
    file.write_text(ordinary(seed))
    ours = nl.read(file).moves
    ends = [move.curve(move.curve.domain[1]) for move in ours]
    theirs, at = [], np.zeros(3)
    for _, _, points in moves_of(file):
        if np.abs(np.subtract(points[-1], at)).max() > 1e-9 or len(points) > 1:
            theirs.append(points[-1])
        at = points[-1]
    theirs = [theirs[i] for i in range(len(theirs)) if i >= len(theirs) - len(ends)]
    assert len(ends) > 30
    np.testing.assert_allclose(ends, theirs, atol=1e-6, err_msg=file.read_text())
    lengths = {move.line: move.curve.length() for move in ours}
    at = np.zeros(3)
    for line, kind, points in moves_of(file):
        if kind == "arc":
            chords = np.linalg.norm(np.diff([at, *points], axis=0), axis=1).sum()
            assert lengths[line] == pytest.approx(chords, rel=0.03)
        at = points[-1]
