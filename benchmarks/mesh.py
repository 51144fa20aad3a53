"""The mesh room beside trimesh and VTK: slicing, streaming, reconstruction."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyvista
import trimesh
from distributed import Client, LocalCluster

from benchmarks.harness import Bar, Row, compare, medians
from nurbs_lab.common.executor import map_chunks
from nurbs_lab.mesh import mesh_from_points, mesh_graph, reconstruct, samples, slice_mesh, streaming
from nurbs_lab.nurbs import approximate_curve

ROOM = "mesh"
PLANES = 200
STREAM_BYTES = int(float(os.environ.get("STREAM_GB", "2")) * 1e9)
STREAM_PLANES = 100
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
        *_slicing("wavy sphere", wavy_sphere(8), trimesh_bars=(100, 15), vtk_bars=(40, 6)),
        *_slicing("whole frog", samples.whole_frog(), trimesh_bars=(50, 12), vtk_bars=()),
        *map(_streaming, (STREAM_BYTES // 4, STREAM_BYTES)),
        _cloud(),
        _workers(),
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
    seconds, first = medians(contestants, repeats=3)
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
        (("nurbs_lab", "graph at hand"), ("nurbs_lab with graph", "graph built each time"))
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


def _streaming(size):
    """A large file cut in this process and by two workers, each in a process that did nothing before."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "large.stl"
        count = _write_large(path, size)
        _forget(path)
        start = time.perf_counter()
        with path.open("rb", buffering=0) as file:
            while file.read(1 << 24):
                pass
        seconds, figures = {"reading the file": time.perf_counter() - start}, {"triangles": count}
        for name, workers in (("nurbs_lab", 0), ("two workers", 2)):
            _forget(path)
            command = [sys.executable, "-m", "benchmarks.mesh", str(path), str(workers)]
            run = subprocess.run(command, capture_output=True, text=True, check=True)
            seconds[name], cpu, here, worker, loops = map(float, run.stdout.split())
            figures |= {f"{name}, processor s": cpu, f"{name}, peak memory MB": here}
            figures |= {"loops": loops} | ({"a worker's peak memory MB": worker} if workers else {})
    return Row(
        ROOM,
        f"streaming {size / 1e9:.2g} GB of binary STL, {STREAM_PLANES} planes",
        seconds,
        (Bar("reading the file", 0.8),),
        notes="the file leaves the page cache before each reading",
        figures=figures,
        most={"a worker's peak memory MB": 400.0},
    )


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


def _workers():
    """One study in this process, on two processes of a pool and on two of a Dask cluster."""
    organ = samples.frog_organ("liver")
    contours = [c.points for layer in slice_mesh(organ, even_heights(organ)) for c in layer.contours]
    contours = [points for points in contours if len(points) > 8]
    study = partial(approximate_curve, tolerance=0.05, closed=True)
    seconds = {}
    with (
        ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool,
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        for name, executor in (("one process", None), ("nurbs_lab", pool), ("dask", client.get_executor())):
            map_chunks(study, contours[:8], executor)  # workers are up, kernels are loaded
            start = time.perf_counter()
            map_chunks(study, contours, executor, cost=list(map(len, contours)))
            seconds[name] = time.perf_counter() - start
    return Row(
        ROOM,
        f"curves through {len(contours)} contours, two workers",
        seconds,
        (Bar("one process", 1.7),),
        notes="a pool of two processes; dask is a local cluster of two",
        figures={"speed-up on dask": seconds["one process"] / seconds["dask"]},
    )


def _write_large(path, size):
    """A wavy torus, strip by strip."""
    n = round((size / streaming.RECORD.itemsize / 2) ** 0.5)
    around = np.arange(n + 1) % n * (2 * np.pi / n)
    record = np.zeros(2 * n, dtype=streaming.RECORD)
    with path.open("wb") as file:
        file.write(bytes(80) + np.uint32(2 * n * n).tobytes())
        two = _torus_ring(around[0], around)
        for angle in around[1:]:
            one, two = two, _torus_ring(angle, around)
            for c, (even, odd) in enumerate(((one[:-1], one[:-1]), (two[:-1], two[1:]), (two[1:], one[1:]))):
                record["corners"][0::2, c], record["corners"][1::2, c] = even, odd
            file.write(record.tobytes())
        file.flush()
        os.fsync(file.fileno())
    return 2 * n * n


def _torus_ring(angle, around):
    minor = 1.0 + 0.1 * np.sin(9 * angle) * np.cos(7 * around)
    reach = 3.0 + minor * np.cos(around)
    return np.column_stack([reach * np.cos(angle), reach * np.sin(angle), minor * np.sin(around)])


def _forget(path):
    """Drop the file from the page cache."""
    with path.open("rb") as file:
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


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
            "seconds": float(np.clip(len(mesh.faces) / 2000, 5.0, 20.0)),  # 5 s for 10,000 triangles
            "largest deviation, of the tolerance": 1.0,
            "volume off %": 0.3,
            "largest angle across seams, degrees": 0.5,
        },
    )
    result = found["result"]
    row.figures.update(
        {
            "faces": len(result.surfaces),
            "control points a triangle": result.control_points / len(mesh.faces),
            "largest deviation, of the tolerance": result.deviation().max / tolerance,
            "volume off %": 100 * abs(result.to_mesh(tolerance / 100).volume / mesh.volume - 1),
            "largest angle across seams, degrees": result.seam_angle,
        }
    )
    return row


def _stream_once(path, workers):
    """Seconds, processor seconds, peak memory here and on a worker in MB, loops; in a process of its own."""
    warm_file = Path(path).with_name("warm.stl")
    wavy_sphere(1).export(warm_file)
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn")) if workers else None
    slice_mesh(warm_file, [0.0] * 2, executor=pool)
    start = time.perf_counter()
    layers = slice_mesh(path, np.linspace(-0.99, 0.99, STREAM_PLANES), executor=pool)
    seconds = time.perf_counter() - start
    ends = list(pool.map(_cpu_and_peak, range(4 * workers))) if pool else []
    cpu = sum({pid: cpu for pid, cpu, _ in [*ends, _cpu_and_peak()]}.values())
    worker = max((peak for *_, peak in ends), default=0.0)
    return seconds, cpu, _cpu_and_peak()[2], worker, sum(len(layer.contours) for layer in layers)


def _cpu_and_peak(_=None):
    """Number, processor seconds and peak memory in MB of this process."""
    status = Path("/proc/self/status").read_text()  # ru_maxrss would include the parent's, from before exec
    return os.getpid(), time.process_time(), int(re.search(r"VmHWM:\s+(\d+) kB", status)[1]) / 1024


if __name__ == "__main__":
    print(*_stream_once(sys.argv[1], int(sys.argv[2])))
