"""Slicing a binary STL file that is larger than the memory, here or on many workers.

A contour needs only the triangles that its plane crosses. So the file is read once, block by block, and the
crossed triangles are kept (step 1 of the paper's method); then they are cut as a mesh of their own, with the
same bits. When more triangles than `MOST_HELD` are crossed, the upper planes wait for another reading.
Numba's threads read side by side. With an executor every worker reads only its blocks and sends what is
crossed; it is cut here, because to send a triangle takes longer than to cut it.

Memory: about 300 bytes for every triangle held; on a worker nearly all of it is the interpreter with its
libraries.
"""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from nurbs_lab.common.executor import map_items
from nurbs_lab.common.progress import bar
from nurbs_lab.common.threads import over_slices
from nurbs_lab.mesh.core import graph_of
from nurbs_lab.mesh.formats.stl import HEADER_BYTES, RECORD, binary_stl_count
from nurbs_lab.mesh.slicing import _kernels
from nurbs_lab.mesh.slicing.contours import layers_of

MOST_HELD = 8_000_000  # crossed triangles
STREAMED = 300_000_000  # bytes; smaller files are read as a whole
CROSSED = np.dtype([("corners", "f4", (3, 3)), ("first", "i4"), ("number", "u4")])
_BLOCK = 40_000  # triangles read at once, two megabytes


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
        crossed, planes = _crossed(path, count, heights[len(layers) :], frame, executor)
        vertices = crossed["corners"].reshape(-1, 3).astype(np.float64)
        graph = graph_of(vertices, np.arange(len(vertices), dtype=np.int32).reshape(-1, 3))
        numbers = crossed["number"].astype(np.int64)
        layers += [
            replace(one, contours=tuple(replace(c, triangles=numbers[c.triangles]) for c in one.contours))
            for one in layers_of(graph, planes, frame, fill)
        ]
    return layers


def _crossed(path, count, heights, frame, executor):
    """The triangles crossed by the lowest planes, as many as fit, and these planes."""
    parts, starts = [], range(0, count, _BLOCK)
    many = -(-MOST_HELD // _BLOCK)
    together = [starts[i : i + many] for i in range(0, len(starts), many)]
    for some in bar(together, len(together), "reading"):
        read = partial(_crossing, path, heights, frame[2], count)
        if executor is None:
            parts += over_slices(read, some, "reading")
        else:
            parts += map_items(read, some, executor, what="block of triangles")
        while sum(map(len, parts)) > MOST_HELD and len(heights) > 1:
            heights = heights[: len(heights) // 2]
            parts = [part[part["first"] < len(heights)] for part in parts]
    return np.concatenate([np.empty(0, CROSSED), *parts]), heights


def _crossing(path, heights, normal, count, start):
    """The crossed ones among the triangles of one block of the file."""
    block = np.fromfile(
        path, RECORD, min(_BLOCK, count - start), offset=HEADER_BYTES + start * RECORD.itemsize
    )
    if len(block) < min(_BLOCK, count - start):
        raise ValueError(f"mesh file {path.name!r} became shorter while it was read")
    mine, first, total = _kernels.crossed_in_block(block["corners"], normal, heights)
    if not np.isfinite(total):
        raise ValueError(f"mesh file {path.name!r} holds a coordinate that is not finite; repair it first")
    crossed = np.empty(len(mine), CROSSED)
    crossed["corners"], crossed["first"], crossed["number"] = block["corners"][mine], first, start + mine
    return crossed


def _triangle_count(path):
    """Triangles that a binary STL file holds, -1 if it is none."""
    with path.open("rb") as file:
        return binary_stl_count(path.stat().st_size, file.read(HEADER_BYTES))
