"""How time grows with the work, from tables of a few sizes each: one series for every way to ask for more."""

from __future__ import annotations

import numpy as np
import pyvista
from scipy.interpolate import make_interp_spline

import nurbs_lab as nl
from benchmarks.harness import Row, compare
from benchmarks.mesh import even_heights, vtk_loops, wavy_sphere
from benchmarks.motion import SPEED, chord_corrected_on_scipy
from benchmarks.nurbs import chord_parameters, ring
from nurbs_lab.mesh import mesh_graph, slice_mesh
from nurbs_lab.motion import Job
from nurbs_lab.motion.feed import constant_feed
from nurbs_lab.motion.prepared_curve import prepare

STEPPER = "chord-corrected"


def rows() -> list[Row]:
    """All series of the page but the traces, which `benchmarks.motion` measures with their memory."""
    return [
        *slicing_in_triangles(),
        *slicing_in_planes(),
        *fits_in_points(),
        *evaluation_in_points(),
        *steps_in_degree(),
        *steps_in_length(),
    ]


def point(series, size, contestants) -> Row:
    """One point of a series; a peer that needs seconds is timed less often."""
    return compare("growth", series, contestants, repeats=5, budget_s=3.0, series=series, size=size)


def slicers(mesh, heights, most_vtk, most_trimesh):
    """The graph at hand, as for any second cut; peers up to a number of triangles times planes."""
    graph, surface = mesh_graph(mesh), pyvista.wrap(mesh)
    surface["height"] = surface.points[:, 2]
    contestants = {"nurbs_lab": lambda: slice_mesh(graph, heights)}
    work = len(mesh.faces) * len(heights)
    if work <= most_vtk:
        contestants["vtk"] = lambda: vtk_loops(surface, heights)
    if work <= most_trimesh:
        contestants["trimesh"] = lambda: mesh.section_multiplane([0, 0, 0], [0, 0, 1], heights)
    return contestants


def slicing_in_triangles():
    """200 planes; segments grow as the root of the triangles."""
    for subdivisions in (5, 6, 7, 8, 9):
        mesh = wavy_sphere(subdivisions)
        contestants = slicers(mesh, even_heights(mesh, 200), 3e8, 7e7)
        yield point("slicing in triangles", len(mesh.faces), contestants)


def slicing_in_planes():
    """327,680 triangles."""
    mesh = wavy_sphere(7)
    for planes in (20, 60, 200, 600, 2000):
        contestants = slicers(mesh, even_heights(mesh, planes), 7e7, 2e7)
        yield point("slicing in planes", planes, contestants)


def fits_in_points():
    """Closed cubics."""
    for count in (100, 1000, 10_000, 100_000, 1_000_000):
        points = ring(count)
        closing = np.vstack([points, points[:1]])
        contestants = {
            "nurbs_lab": lambda points=points: nl.interpolate_curve(points, 3, closed=True),
            "scipy": lambda points=closing: make_interp_spline(
                chord_parameters(points), points, bc_type="periodic"
            ),
        }
        yield point("closed fits in points", count, contestants)


def evaluation_in_points():
    """One cubic of 100 points, parameters in order."""
    curve = nl.interpolate_curve(ring(100), 3)
    spline = curve.to_scipy()
    for count in (10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000):
        u = np.linspace(0, 1, count)
        contestants = {"nurbs_lab": lambda u=u: curve(u), "scipy": lambda u=u: spline(u)}
        yield point("evaluation in points", count, contestants)


def walkers(curve, steps, most_scipy):
    """Our stepper and the same rule on SciPy, about so many steps along the whole curve."""
    track = prepare(curve)
    period = track.length / SPEED / steps
    job = Job(track, constant_feed(track.length, SPEED, period), period)
    contestants = {"nurbs_lab": lambda: nl.STEPPERS[STEPPER].run(job)}
    if steps <= most_scipy:
        contestants["scipy"] = lambda: chord_corrected_on_scipy(curve, period)
    return contestants


def steps_in_degree():
    """10,000 steps along one cubic, written in higher and higher degrees."""
    cubic = nl.interpolate_curve(ring(100), 3)
    for degree in (3, 4, 6, 9, 12):
        curve = cubic.elevate_degree(degree - 3) if degree > 3 else cubic
        yield point("10,000 steps in degree", degree, walkers(curve, 10_000, 10_000))


def steps_in_length():
    """A longer and longer helix, 12 spans and 1000 steps a turn."""
    for turns in (1, 4, 16, 64, 256):
        angle = np.linspace(0, 2 * np.pi * turns, 12 * turns + 1)
        curve = nl.interpolate_curve(np.column_stack([np.cos(angle), np.sin(angle), 0.1 * angle]))
        yield point("steps in length / mm", round(curve.length(), 1), walkers(curve, 1000 * turns, 16_000))
