"""Slicing a binary STL that is larger than memory.

A contour needs only the triangles that its plane crosses. So the file is read once, chunk by chunk, the
crossing triangles are kept (the paper's prescreen), and the usual slicer does the rest: the contours are the
same, bit for bit. When more triangles than allowed are crossed, the upper planes wait for another reading.
"""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
from tqdm.auto import tqdm

from nurbs_lab.mesh import _kernels
from nurbs_lab.mesh.graph import graph_of
from nurbs_lab.mesh.slicing import axis_frame, checked_heights, in_frame, slice_mesh

_HEADER_BYTES = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_CHUNK = 200_000


def slice_stl(path, heights, axis="z", *, most_triangles=2_000_000) -> list:
    """Cut a binary STL file of any size, as `slice_mesh` does.

    Parameters
    ----------
    path : str or Path
    heights, axis
        As for `slice_mesh`.
    most_triangles : int
        How many crossed triangles to hold in memory at once, about 200 bytes each. One plane must not cross
        more.

    Returns
    -------
    list of Layer
        Those of `slice_mesh`; triangle numbers count the triangles of the file.

    Raises
    ------
    ValueError
        If the file is no binary STL, holds a coordinate that is not finite, or one plane alone crosses more
        triangles than allowed.
    """
    heights = checked_heights(heights)
    axis_frame(axis)
    records = _records(path)
    rising, place = np.unique(heights, return_inverse=True)
    layers = []
    while len(layers) < len(rising):
        layers += _one_reading(records, rising[len(layers) :], axis, most_triangles)
    return [layers[i] for i in place]


def _one_reading(records, heights, axis, most):
    """Layers of the lowest planes, as many as fit."""
    frame = axis_frame(axis)
    kept, numbers, held = [], [], 0
    with tqdm(
        total=len(records),
        unit=" triangles",
        unit_scale=True,
        desc="Slicing",
        leave=False,
        disable=os.environ.get("NURBS_LAB_PROGRESS") == "0",
    ) as progress:
        for start in range(0, len(records), _CHUNK):
            corners = np.ascontiguousarray(records[start : start + _CHUNK]["corners"])
            crossing = _crossing(corners, heights, frame)
            kept.append(corners[crossing])
            numbers.append(start + crossing)
            held += len(crossing)
            while held > most:
                if len(heights) == 1:
                    raise ValueError(
                        f"the plane at {heights[0]} alone crosses more than {most} triangles; "
                        "raise most_triangles"
                    )
                heights = heights[: len(heights) // 2]
                chosen = [_crossing(part, heights, frame) for part in kept]
                kept = [part[rows] for part, rows in zip(kept, chosen, strict=True)]
                numbers = [part[rows] for part, rows in zip(numbers, chosen, strict=True)]
                held = sum(map(len, kept))
            progress.update(len(corners))
    corners, numbers = np.concatenate(kept), np.concatenate(numbers)
    kept.clear()
    triangles = np.arange(3 * len(corners), dtype=np.int32).reshape(-1, 3)
    graph = graph_of(corners.reshape(-1, 3).astype(np.float64), triangles)
    del corners, triangles
    return [
        replace(layer, contours=tuple(replace(c, triangles=numbers[c.triangles]) for c in layer.contours))
        for layer in slice_mesh(graph, heights, axis)
    ]


def _crossing(corners, heights, frame):
    """Which triangles a plane crosses."""
    points = corners.reshape(-1, 3).astype(np.float64)
    if not np.isfinite(points).all():
        raise ValueError("the file holds a coordinate that is not finite; repair it first")
    level = _kernels.vertex_levels(in_frame(points, frame)[:, 2], heights).reshape(-1, 3)
    return np.flatnonzero(level.min(axis=1) < level.max(axis=1))


def _records(path):
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"mesh file {str(path)!r} does not exist")
    size = path.stat().st_size
    count = 0
    if size >= _HEADER_BYTES:
        with path.open("rb") as file:
            count = int(np.frombuffer(file.read(_HEADER_BYTES)[80:], "<u4")[0])
    if not count or size != _HEADER_BYTES + count * _RECORD.itemsize:
        raise ValueError(
            f"{path.name} is {size} bytes long and no binary STL of {count} triangles; save it as binary STL"
        )
    return np.memmap(path, dtype=_RECORD, mode="r", offset=_HEADER_BYTES, shape=(count,))
