"""Compile every kernel once, at set-up: ``python -m nurbs_lab.warm``."""

import tempfile
from concurrent.futures import ThreadPoolExecutor
from multiprocessing import Process
from pathlib import Path

import numpy as np
import trimesh

import nurbs_lab as nl


def splines() -> None:
    """The kernels of curves and surfaces."""
    curve = nl.paper.CURVE
    curve(np.linspace(0.0, 1.0, 3))
    curve(np.linspace(0.0, 1.0, 300))
    curve.parameter_at(curve.length() / 2)
    curve.closest_point(curve.elevate_degree(2).control_points)
    turn = np.linspace(0.0, 2 * np.pi, 13)
    ring = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    for closed in (False, True):
        nl.interpolate_curve(ring, closed=closed)
        nl.approximate_curve(ring, tolerance=0.1, closed=closed)
    nl.interpolate_curve(ring, parametrization="universal")
    surface = nl.skin([np.add(ring, (0, 0, height)) for height in range(4)])
    surface.closest_point(surface(0.5, 0.5))
    surface.normal(0.5, 0.5)
    surface.grid(np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 3))


def slices() -> None:
    """The kernels that slice meshes and files."""
    box = trimesh.creation.box()
    for axis in "xyz":
        nl.slice_mesh(box, [0.0], axis=axis)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "box.stl")
        box.export(file)
        with ThreadPoolExecutor(1) as one:
            nl.slice_mesh(file, [0.0], executor=one)
        box.export(file.with_suffix(".obj"))
        nl.slice_mesh(file.with_suffix(".obj"), [0.0])


def surfaces() -> None:
    """The kernels that rebuild meshes."""
    box = trimesh.creation.box()
    nl.mesh_from_points(trimesh.creation.icosphere(subdivisions=2).vertices)
    triangles = np.delete(np.vstack([box.faces[:1, ::-1], box.faces[1:]]), 5, axis=0)  # to be mended
    nl.reconstruct(trimesh.Trimesh(box.vertices, triangles, process=False), tolerance=0.1)
    nl.reconstruct(trimesh.creation.icosphere(subdivisions=2), tolerance=0.1)
    nl.reconstruct(trimesh.creation.cylinder(1.0, 2.0), tolerance=0.1)


def paths() -> None:
    """The kernels of motion."""
    curve = nl.paper.CURVE
    limits = {"speed": 4.0, "acceleration": 40.0, "chord_error": 1e-3, "axis_acceleration": 40.0}
    feed = nl.plan_feed(curve, period_s=1e-2, **limits)
    nl.plan_feed(curve, period_s=1e-2, jerk=400.0, axis_jerk=400.0, **limits).time_at(1.0)
    for one in (curve, nl.NurbsCurve(1, [0, 0, 1, 2, 2], [(0, 0), (1, 0), (1, 1)])):
        nl.plan_feed(one, nl.Limits(4.0, 40.0))
    nl.motion.apply_override(feed, [(0.5, 0.5)])
    for name in nl.motion.software_steppers():
        nl.trace(curve, feed, stepper=name)
    path = nl.trace(curve, 4.0, stepper="paper", period_s=1e-2)
    nl.hardware.serial_parameters(path)


def milling() -> None:
    """The kernels of machining."""
    box = trimesh.creation.box(extents=(6.0, 4.0, 2.0))
    cutter = nl.Cutter("ball", diameter=2.0)
    nl.drop_cutter(box, cutter, [(0.0, 0.0)])
    program = nl.finish(box, cutter, scallop=0.2, tolerance=0.05)
    nl.verify(program, trimesh.creation.box(extents=(6.0, 4.0, 2.1)))  # which the program gouges
    nl.simulate(program, box, 0.5)
    with tempfile.TemporaryDirectory() as folder:
        options = {"dialect": "g1", "tolerance": 0.1, "units": "mm", "axes": "XYZ"}
        nl.export(Path(folder, "box.ngc"), program, **options)
    nl.rough(box, nl.machining.stock_around(box), cutter, 1.0, 0.1)


#: Of about equal cost where nothing is compiled yet.
HALVES = (splines, surfaces), (paths, milling, slices)


def warm(steps=(*HALVES[0], *HALVES[1])) -> None:
    """Call each kernel on a tiny input of the types that the faces pass."""
    for step in steps:
        step()


def main() -> None:
    """Compile in two processes, then once more here: each may overwrite files of the other's cache."""
    work = [Process(target=warm, args=(half,)) for half in HALVES]
    for process in work:
        process.start()
    for process in work:
        process.join()
    warm()


if __name__ == "__main__":
    main()
