"""Reading and writing files, as calls with a good example of every argument; for `fuzz` alone."""

import tempfile
from pathlib import Path

import numpy as np
import trimesh

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls import CURVE, PATH, SURFACE

FLAT = nl.NurbsCurve(3, CURVE.knots, CURVE.control_points[:, :2], CURVE.weights)
ASKED = {"feed": 10.0, "tolerance": 0.01, "units": "mm", "axes": "XY"}
BALL = trimesh.creation.icosphere(subdivisions=1)


def content(suffix, *items, **options):
    """The bytes of an exported file."""
    with tempfile.TemporaryDirectory() as folder:
        return nl.export(Path(folder, f"part{suffix}"), *items, **options).read_bytes()


def reader(suffix, read=nl.read):
    """Reads a file of these bytes."""

    def read_bytes(content):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, f"part{suffix}")
            file.write_bytes(content)
            found = read(file)
        return list(found.moves.ends) if isinstance(found, nl.machining.Program) else found

    return read_bytes


def writer(suffix):
    """Writes a curve and reads it again."""

    def there_and_back(curve):
        with tempfile.TemporaryDirectory() as folder:
            return nl.read(nl.export(Path(folder, f"part{suffix}"), curve))

    return there_and_back


def program(curve, dialect, feed, tolerance, units, axes):
    """Writes a program and reads it again."""
    options = {"dialect": dialect, "feed": feed, "tolerance": tolerance, "units": units, "axes": axes}
    return reader(".ngc")(content(".ngc", curve, **options))


def export(items, path):
    """Writes to any name in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        nl.export(Path(folder) / path if isinstance(path, str) else path, items)


TABLE = b"\n".join(b"%d,%d,%d" % (i, i * i, 3 * i % 7) for i in range(12))
FILES = {
    "read .json": (reader(".json"), {"content": content(".json", CURVE)}),
    "read .step": (reader(".step"), {"content": content(".step", CURVE)}),
    "read .igs": (reader(".igs"), {"content": content(".igs", SURFACE)}),
    "read .3dm": (reader(".3dm"), {"content": content(".3dm", SURFACE)}),
    "read .csv": (reader(".csv"), {"content": content(".csv", PATH)}),
    "read_part .csv": (reader(".csv", nl.workbench.read_part), {"content": TABLE}),
    **{
        f"read .{kind}": (reader(f".{kind}"), {"content": BALL.export(file_type=kind)})
        if kind != "obj"
        else (reader(".obj"), {"content": BALL.export(file_type="obj").encode()})
        for kind in ("stl", "ply", "obj")
    },
    **{
        f"read {dialect}": (
            reader(".ngc"),
            {"content": content(".ngc", FLAT, dialect=dialect, **{**ASKED, "tolerance": 0.1})},
        )
        for dialect in nl.interchange.DIALECTS
    },
    **{
        f"there and back {suffix}": (writer(suffix), {"curve": CURVE})
        for suffix in (".json", ".step", ".igs", ".3dm")
    },
    "a program": (program, {"curve": FLAT, "dialect": "arcs", **ASKED}),
    "export": (export, {"items": CURVE, "path": "part.json"}),
    "work": (
        nl.workbench.work,
        {
            "part": FLAT,
            "speed": 20.0,
            "acceleration": 500.0,
            "chord_error": 1e-3,
            "period_s": 1e-3,
            "stepper": "adams",
        },
    ),
    "work of points": (nl.workbench.work, {"part": np.asarray(BALL.vertices), "layers": 5, "tolerance": 0.5}),
}
