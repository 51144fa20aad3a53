"""Programs of machine tools: reading, making smooth, and the time of the motion."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import nurbs_lab as nl
from benchmarks.harness import Row, compare

SEGMENTS = 150_000
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


def facets(count, per_row=600):
    """Rows to and fro over a wavy surface, in short segments, rounded to a micrometre: ``(count + 1, 3)``."""
    i = np.arange(count + 1)
    row, place = i // per_row, i % per_row
    x = STEP_MM * np.where(row % 2 == 0, place, per_row - 1 - place)
    y = 0.3 * row
    z = 4 * np.sin(x / 7 + y / 11) + 2 * np.cos(y / 5) * np.sin(x / 3)
    return np.round(np.column_stack([x, y, z]), 3)


def rows() -> list[Row]:
    """All rows of this room."""
    points = facets(SEGMENTS)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "facets.ngc"
        blocks = "\n".join(f"G1 X{x:.3f} Y{y:.3f} Z{z:.3f}" for x, y, z in points)
        file.write_text(f"G21 G90\nF3600\n{blocks}\nM2\n")
        program = nl.read(file)
        smooth = nl.smooth(program, tolerance=TOLERANCE_MM)
        written = nl.export(Path(folder) / "a.ngc", smooth, dialect="fanuc", units="mm", axes="XYZ")
        fewer = len(program.moves) / len(written.read_text().splitlines())
        reading = compare(
            "programs",
            f"read {SEGMENTS:,} segments ({file.stat().st_size / 1e6:.0f} MB)",
            {"nurbs_lab": lambda: nl.read(file)},
            repeats=3,
        )
    making = compare(
        "programs",
        f"make {SEGMENTS:,} segments smooth within {TOLERANCE_MM} mm",
        {"nurbs_lab": lambda: nl.smooth(program, tolerance=TOLERANCE_MM)},
        repeats=3,
        figures={"blocks of the facets for one of G06.2": fewer},
        most={"seconds": 5.0},
    )
    return [reading, making, motion()]


def motion() -> Row:
    """One row of the surface: time of the motion along the curve, as part of that along blended facets."""
    points = facets(598)
    curves = {
        "nurbs_lab": nl.smooth(points, tolerance=TOLERANCE_MM),
        "G64": nl.interchange.blend(points, tolerance=TOLERANCE_MM),
    }
    plans = {name: nl.plan_feed(curve, **LIMITS) for name, curve in curves.items()}
    return compare(
        "programs",
        "plan the motion along 598 segments made smooth, and blended as by G64",
        {name: (lambda curve=curve: nl.plan_feed(curve, **LIMITS)) for name, curve in curves.items()},
        repeats=3,
        measure="time of the motion in s",
        judges={name: (lambda plan: plan.duration) for name in plans},
        figures={
            "motion of the smooth curve, of that of G64": plans["nurbs_lab"].duration / plans["G64"].duration
        },
        most={"motion of the smooth curve, of that of G64": 0.85},
    )
