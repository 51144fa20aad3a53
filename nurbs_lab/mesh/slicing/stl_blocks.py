"""Slicing a binary STL file that is larger than the memory, here or on many workers.

A contour needs only the triangles that its plane crosses. So the file is read once, block by block, and the
crossed triangles are kept (step 1 of the paper's method); then bands of planes are cut as usual, with the
same bits. When more triangles than `MOST_HELD` are crossed, the upper planes wait for another reading.
Numba's threads read and cut side by side. With an executor every worker reads only its runs of blocks and
sends what is crossed; the bands are cut here, because to send a triangle takes longer than to cut it.

Memory: about 60 bytes for every triangle held and 200 for every triangle of the bands that are being cut.
Measured for a file of 20 GB and 100 planes, which cross 6.7 million of its triangles: 1.2 GB here, and 204 MB
on a worker, nearly all of it the interpreter with its libraries.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from nurbs_lab.common.executor import map_items
from nurbs_lab.common.progress import bar
from nurbs_lab.common.threads import over_slices, single_thread
from nurbs_lab.mesh.core import graph_of
from nurbs_lab.mesh.formats.stl import HEADER_BYTES, RECORD, binary_stl_count
from nurbs_lab.mesh.slicing import _kernels
from nurbs_lab.mesh.slicing.contours import layers_of

MOST_HELD = 12_000_000  # crossed triangles
STREAMED = 300_000_000  # bytes; smaller files are read as a whole
CROSSED = np.dtype([("corners", "f4", (3, 3)), ("first", "i4"), ("last", "i4"), ("number", "u4")])
_BLOCK = 20_000  # triangles read at once, one megabyte, which stays in a core's cache
_RUN = 8 * _BLOCK  # triangles read by one call of a worker
_RUNS_TOGETHER = 64
_BAND = 250_000  # triangles cut at once; a single plane may take more


def is_streamed(mesh, executor) -> bool:
    """Whether a mesh is a binary STL file that is large, or that the workers of an executor are to read."""
    if not isinstance(mesh, (str, Path)) or Path(mesh).suffix.lower() != ".stl" or not Path(mesh).is_file():
        return False
    least = HEADER_BYTES if executor is not None else STREAMED
    return Path(mesh).stat().st_size > least and _triangle_count(Path(mesh)) > 0


def layers_of_file(path, heights, frame, fill, executor) -> list:
    """Layers of a binary STL file for planes in rising order; triangles are numbered as in the file."""
    count, layers = _triangle_count(path), []
    while len(layers) < len(heights):
        crossed, planes = _crossed(path, count, heights[len(layers) :], frame[2], executor)
        ends = crossed["first"].copy(), crossed["last"].copy()  # side by side in memory
        cut = partial(_cut, crossed, ends, planes, frame, fill)
        for some in over_slices(cut, list(_bands(*ends, len(planes))), "slicing"):
            layers += some
    return layers


def _crossed(path, count, heights, normal, executor):
    """The triangles crossed by the lowest planes, as many as fit, and these planes."""
    parts = []
    runs = [(start, min(start + _RUN, count)) for start in range(0, count, _RUN)]
    for some in _together(runs, _RUNS_TOGETHER, "reading"):
        read = partial(_crossing, path, heights, normal)
        if executor is None:
            parts += over_slices(read, some, "reading")
        else:
            parts += map_items(read, some, executor, what="run of triangles")
        while sum(map(len, parts)) > MOST_HELD and len(heights) > 1:
            heights = heights[: len(heights) // 2]
            parts = [part[part["first"] < len(heights)] for part in parts]
    return np.concatenate([np.empty(0, CROSSED), *parts]), heights


def _crossing(path, heights, normal, run):
    """The crossed ones among the triangles of one run of the file: ``(first, end)``."""
    crossed, found = np.empty(run[1] - run[0], CROSSED), 0  # memory is taken only for what is written
    block = np.empty(_BLOCK, RECORD)
    with path.open("rb", buffering=0) as file:
        file.seek(HEADER_BYTES + run[0] * RECORD.itemsize)
        for start in range(*run, _BLOCK):
            some = block[: run[1] - start]
            if file.readinto(some.view(np.uint8)) < some.nbytes:
                raise ValueError(f"mesh file {path.name!r} became shorter while it was read")
            found += _kernels.crossing_triangles(some["corners"], normal, heights, start, crossed[found:])
            if found < 0:
                raise ValueError(
                    f"mesh file {path.name!r} holds a coordinate that is not finite; repair it first"
                )
    return crossed[:found].copy()


def _together(items, count, what):
    """Runs of ``count`` items, behind a progress bar."""
    return bar((items[i : i + count] for i in range(0, len(items), count)), -(-len(items) // count), what)


def _bands(first, last, planes):
    """Ranges of planes that cross few enough triangles together to be cut at once."""
    begun = np.cumsum(np.bincount(first, minlength=planes))
    ended = np.cumsum(np.bincount(np.minimum(last, planes - 1), minlength=planes))
    start = 0
    while start < planes:
        over = ended[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(begun, over + _BAND, side="right")))
        yield slice(start, stop)
        start = stop


def _cut(crossed, ends, planes, frame, fill, band):
    """The layers of one band of planes, on one thread, because other bands keep the others busy."""
    first, last = ends
    mine = crossed[(first < band.stop) & (last >= band.start)]
    vertices = mine["corners"].reshape(-1, 3).astype(np.float64)
    with single_thread():
        graph = graph_of(vertices, np.arange(len(vertices), dtype=np.int32).reshape(-1, 3))
        layers = layers_of(graph, planes[band], frame, fill)
    numbers = mine["number"].astype(np.int64)
    return [
        replace(layer, contours=tuple(replace(c, triangles=numbers[c.triangles]) for c in layer.contours))
        for layer in layers
    ]


def _triangle_count(path):
    """Triangles that a binary STL file holds, -1 if it is none."""
    with path.open("rb") as file:
        return binary_stl_count(path.stat().st_size, file.read(HEADER_BYTES))
