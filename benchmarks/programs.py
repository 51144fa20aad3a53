"""Programs of machine tools: reading, writing, making smooth, and the time of the motion."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import nurbs_lab as nl
from benchmarks.harness import Row, compare

SEGMENTS = 150_000
ARCS = 260_000
STEP_MM = 0.12
TOLERANCE_MM = 0.01
LIMITS = {
    "speed": 60.0,
    "acceleration": 1000.0,
    "axis_acceleration": 1000.0,
    "jerk": 50_000.0,
    "chord_error": 1e-3,
    "period_s": 1e-3,
}


def facets(count, per_row=600, step=STEP_MM):
    """Rows to and fro over a wavy surface, in short segments, rounded to a micrometre: ``(count + 1, 3)``."""
    i = np.arange(count + 1)
    row, place = i // per_row, i % per_row
    x = step * np.where(row % 2 == 0, place, per_row - 1 - place)
    y = 0.3 * row
    z = 4 * np.sin(x / 7 + y / 11) + 2 * np.cos(y / 5) * np.sin(x / 3)
    return np.round(np.column_stack([x, y, z]), 3)


def rows() -> list[Row]:
    """All rows of this room."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lines = [f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f}" for x, y, z in facets(SEGMENTS)]
        straight = saved(folder / "facets.ngc", lines)
        radii = np.random.default_rng(0).uniform(1, 9, ARCS // 2)
        arcs = saved(folder / "arcs.ngc", (f"G2 X{2 * r:.4f} Y0 I{r:.4f}\nG3 X0 Y0 I-{r:.4f}" for r in radii))
        program = nl.read(straight)
        smooth = nl.smooth(program, tolerance=TOLERANCE_MM)
        return [
            reading(f"{SEGMENTS:,} segments", straight),
            reading(f"{ARCS:,} arcs", arcs),
            compare(
                "programs",
                f"make {SEGMENTS:,} segments smooth within {TOLERANCE_MM} mm",
                {"nurbs_lab": lambda: nl.smooth(program, tolerance=TOLERANCE_MM)},
                repeats=3,
                most={"seconds": 5.0},
            ),
            *(
                writing(folder / "again.ngc", smooth, dialect)
                for dialect in ("g1", "siemens", "fanuc", "heidenhain")
            ),
            motion(),
        ]


def saved(file, lines):
    """A program of these moves."""
    file.write_text("\n".join(["G21 G90", "G0 X0 Y0 Z0", "F3600", *lines, "M2", ""]))
    return file


def reading(what, file) -> Row:
    """The time to read a program."""
    return compare(
        "programs",
        f"read {what} ({file.stat().st_size / 1e6:.0f} MB)",
        {"nurbs_lab": lambda: nl.read(file)},
        repeats=3,
        most={"seconds": 5.0},
    )


def writing(file, smooth, dialect) -> Row:
    """The time to write the smooth program; how many blocks of facets there are for each one written."""

    def export():
        nl.export(file, smooth, dialect=dialect, tolerance=TOLERANCE_MM, units="mm", axes="XYZ")
        return SEGMENTS / len(file.read_text().splitlines())

    return compare(
        "programs",
        f"write it smooth in the dialect {dialect}",
        {"nurbs_lab": export},
        repeats=1,
        measure="lines of facets for one written",
        judges={"nurbs_lab": float},
    )


def motion() -> Row:
    """The time of the motion along facets of 0.03 mm: made smooth, and with blended corners as by G64.

    Only the smooth curve keeps a limit of jerk. Without one the blended motion is as short as any plan of it.
    """
    points = facets(1200, per_row=1300, step=0.03)
    curves = {
        "nurbs_lab": (nl.smooth(points, tolerance=TOLERANCE_MM), LIMITS),
        "G64": (nl.interchange.blend(points, tolerance=TOLERANCE_MM), LIMITS | {"jerk": None}),
    }
    calls = {
        name: (lambda curve=curve, limits=limits: nl.plan_feed(curve, **limits))
        for name, (curve, limits) in curves.items()
    }
    durations = {name: call().duration for name, call in calls.items()}
    ratio = "motion of the smooth curve, of that of G64"
    return compare(
        "programs",
        "plan the motion along 1,200 segments made smooth, and blended as by G64",
        calls,
        repeats=3,
        measure="time of the motion in s",
        judges=dict.fromkeys(calls, lambda plan: plan.duration),
        notes="G64 without the limit of jerk",
        figures={ratio: durations["nurbs_lab"] / durations["G64"]},
    )
