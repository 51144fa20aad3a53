"""The mesh room beside trimesh and VTK: slicing and reconstruction."""

from __future__ import annotations

from functools import partial

import numpy as np
import pyvista
import trimesh

from benchmarks.harness import Bar, Row, compare, medians
from nurbs_lab.mesh import mesh_from_points, mesh_graph, reconstruct, samples, slice_mesh

ROOM = "mesh"
PLANES = 200
SOLIDS = {
    "frog's thigh bone": samples.frog_thigh_bone,
    "frog's eye": lambda: samples.frog_organ("eye_white", blur_mm=2.0),
    **{
        f"frog's {name}": partial(samples.frog_organ, name, blur_mm=2.0)
        for name in ("spleen", "heart", "kidney", "ileum", "liver")
    },
    "nut": samples.nut,
    "ant": samples.ant,
}


def rows() -> list[Row]:
    """Every row of the room's table."""
    return [
        *_slicing("wavy sphere", wavy_sphere(8), trimesh_bars=(100, 40), vtk_bars=(40, 15)),
        *_slicing("whole frog", samples.whole_frog(), trimesh_bars=(50, 40), vtk_bars=()),
        _cloud(),
        *(_solid(name, 0.005) for name in SOLIDS),
        *(_solid("frog's eye", fraction) for fraction in (0.002, 0.001)),
    ]


def wavy_sphere(subdivisions: int) -> trimesh.Trimesh:
    """20 * 4**subdivisions triangles."""
    ball = trimesh.creation.icosphere(subdivisions=subdivisions)
    x, y, z = ball.vertices.T
    radius = 1.0 + 0.1 * np.sin(7 * x) * np.cos(5 * y) * np.sin(6 * z)
    return trimesh.Trimesh(ball.vertices * radius[:, None], ball.faces, process=False)


def even_heights(mesh, planes=PLANES):
    """Planes that divide a mesh evenly, clear of its ends."""
    low, high = mesh.bounds[:, 2]
    return low + (high - low) * (np.arange(planes) + 0.5) / planes


def _slicing(name, mesh, trimesh_bars, vtk_bars):
    heights = even_heights(mesh)
    graph = mesh_graph(mesh)
    surface = pyvista.wrap(mesh)
    surface["height"] = surface.points[:, 2]
    found = {}
    contestants = {
        "nurbs_lab": lambda: found.update(layers=slice_mesh(graph, heights)),
        "nurbs_lab with graph": lambda: slice_mesh(mesh, heights),
        "trimesh": lambda: found.update(sections=mesh.section_multiplane([0, 0, 0], [0, 0, 1], heights)),
        "vtk": lambda: found.update(strips=vtk_loops(surface, heights)),
    }
    seconds, first = medians(contestants)
    contours = [contour for layer in found["layers"] for contour in layer.contours]
    paths = [path for section in found["sections"] if section for path in section.entities]
    strips = [found["strips"].get_cell(i).point_ids for i in range(found["strips"].n_cells)]
    closed = {
        "nurbs_lab": sum(contour.closed for contour in contours),
        "trimesh": sum(bool(path.closed) for path in paths),
        "vtk": sum(ids[0] == ids[-1] for ids in strips),
        "a separate count": sum(_count_loops(mesh, height) for height in heights),
    }
    figures = {
        "segments": sum(len(contour.triangles) for contour in contours),
        "left open by nurbs_lab": len(contours) - closed["nurbs_lab"],
        "left open by trimesh": len(paths) - closed["trimesh"],
        "left open by vtk": len(strips) - closed["vtk"],
    }
    result = []
    for i, (ours, what) in enumerate(
        (("nurbs_lab", "graph at hand"), ("nurbs_lab with graph", "first slice of a new mesh"))
    ):
        bars = [Bar("trimesh", trimesh_bars[i])] + [Bar("vtk", bar) for bar in vtk_bars[i : i + 1]]
        times = {"nurbs_lab": seconds[ours], "trimesh": seconds["trimesh"], "vtk": seconds["vtk"]}
        work = f"{name}, {len(mesh.faces):,} triangles, {PLANES} planes, {what}"
        result.append(
            Row(
                ROOM,
                work,
                times,
                tuple(bars),
                first[ours],
                notes="trimesh's open pieces have no length: two equal points where a plane meets a vertex",
                measure="closed loops",
                answers=closed,
                figures=figures,
            )
        )
    return result


def vtk_loops(surface, heights):
    """Contours joined to loops of any length: VTK's own limit of 1000 segments would leave them in pieces."""
    return surface.contour(heights, scalars="height").strip(join=True, max_length=surface.n_cells)


def _count_loops(mesh, height):
    """Components of the crossed triangles over their shared edges, by SciPy."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    above = mesh.vertices[:, 2] >= height
    crossed = np.ptp(above[mesh.faces].view(np.int8), axis=1) > 0
    number = np.cumsum(crossed) - 1
    pairs, edges = mesh.face_adjacency, mesh.face_adjacency_edges
    through = above[edges[:, 0]] != above[edges[:, 1]]
    a, b = number[pairs[through]].T
    count = int(crossed.sum())
    return connected_components(coo_array((np.ones(len(a), bool), (a, b)), shape=(count, count)))[0]


def _cloud():
    organ = samples.frog_organ("eye_white")
    points = np.array(trimesh.sample.sample_surface(organ, 20_000, seed=0)[0])
    random = np.random.default_rng(0)
    points += random.normal(size=points.shape) * 0.002 * np.ptp(points, axis=0).max()
    points[:200] = random.uniform(*organ.bounds, (200, 3))
    found = {}
    row = compare(
        ROOM,
        "mesh of 20,000 random points, noise 0.2 %, 1 % outliers",
        {"nurbs_lab": lambda: found.update(mesh=mesh_from_points(points))},
        repeats=3,
        notes="no normals given",
        most={"seconds": 5.0, "volume off %": 1.0},
    )
    row.figures["volume off %"] = 100.0 * abs(found["mesh"].volume / organ.volume - 1.0)
    return row


def _solid(name, fraction):
    """A part as one closed solid, to a fraction of its size."""
    mesh, found = SOLIDS[name](), {}
    tolerance = fraction * float(np.ptp(mesh.bounds, axis=0).max())
    row = compare(
        ROOM,
        f"{name}, {len(mesh.faces):,} triangles: a solid within {100 * fraction:g} % of its size",
        {"nurbs_lab": lambda: found.update(result=reconstruct(mesh, tolerance=tolerance))},
        repeats=1,
        notes="closed shells of NURBS faces with their measured deviation",
        most={
            "seconds": 20.0 if fraction < 0.005 else float(np.clip(len(mesh.faces) / 2000, 5.0, 15.0)),
            "largest deviation, of the tolerance": 1.0,
            "volume off %": 0.3,
            "largest angle across seams, degrees": 0.01,
        },
    )
    result = found["result"]
    row.figures.update(
        {
            "faces": len(result.surfaces),
            "control points a triangle": result.control_point_count / len(mesh.faces),
            "largest deviation, of the tolerance": result.deviation.max / tolerance,
            "volume off %": 100 * abs(result.volume / mesh.volume - 1),
            "largest angle across seams, degrees": result.seam_angle,
        }
    )
    return row
