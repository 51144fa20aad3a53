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
from nurbs_lab.mesh.slicing import axis_frame, checked_heights, slice_mesh

_HEADER_BYTES = 84
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_CHUNK = 200_000
_NOT_FINITE = "the file holds a coordinate that is not finite; repair it first"


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
        If the file is no binary STL, a height in it or a crossed triangle is not finite, or one plane alone
        crosses more triangles than allowed.
    """
    heights = checked_heights(heights)
    normal = axis_frame(axis)[2]
    count = _triangle_count(path)
    rising, place = np.unique(heights, return_inverse=True)
    layers = []
    while len(layers) < len(rising):
        corners, numbers, planes = _crossed(path, count, rising[len(layers) :], normal, most_triangles)
        layers += [
            replace(layer, contours=tuple(replace(c, triangles=numbers[c.triangles]) for c in layer.contours))
            for layer in slice_mesh(_graph_of_soup(corners), planes, axis)
        ]
    return [layers[i] for i in place]


def _crossed(path, count, heights, normal, most):
    """Corners and numbers of the triangles crossed by the lowest planes, as many as fit, and these planes."""
    corners, numbers, held = [], [], 0
    with tqdm(
        total=count,
        unit=" triangles",
        unit_scale=True,
        desc="Slicing",
        leave=False,
        disable=os.environ.get("NURBS_LAB_PROGRESS") == "0",
    ) as progress:
        for start in range(0, count, _CHUNK):
            # a map of its own for every chunk, so that what was read is let go
            records = np.memmap(
                path, RECORD, "r", _HEADER_BYTES + start * RECORD.itemsize, (min(_CHUNK, count - start),)
            )
            crossing = _crossing(records, heights, normal)
            corners.append(records[crossing])
            numbers.append(start + crossing)
            held += len(crossing)
            while held > most:
                if len(heights) == 1:
                    raise ValueError(
                        f"the plane at {heights[0]} alone crosses more than {most} triangles; "
                        "raise most_triangles"
                    )
                heights = heights[: len(heights) // 2]
                chosen = [_crossing(part, heights, normal) for part in corners]
                corners = [part[rows] for part, rows in zip(corners, chosen, strict=True)]
                numbers = [part[rows] for part, rows in zip(numbers, chosen, strict=True)]
                held = sum(map(len, corners))
            progress.update(len(records))
    return np.concatenate(corners)["corners"], np.concatenate(numbers), heights


def _graph_of_soup(corners):
    vertices = corners.reshape(-1, 3).astype(np.float64)
    if not np.isfinite(vertices).all():
        raise ValueError(_NOT_FINITE)
    return graph_of(vertices, np.arange(len(vertices), dtype=np.int32).reshape(-1, 3))


def _crossing(records, heights, normal):
    """Which records a plane crosses."""
    kept = np.empty(len(records), dtype=np.int64)
    halves = np.asarray(records).view("<u2").reshape(-1, RECORD.itemsize // 2)
    count = _kernels.crossing_records(halves, normal, heights, kept)
    if count < 0:
        raise ValueError(_NOT_FINITE)
    return kept[:count]


def _triangle_count(path):
    path = Path(path)
    if not path.is_file():
        raise FileNotFoundError(f"mesh file {str(path)!r} does not exist")
    size = path.stat().st_size
    count = 0
    if size >= _HEADER_BYTES:
        with path.open("rb") as file:
            count = int(np.frombuffer(file.read(_HEADER_BYTES)[80:], "<u4")[0])
    if not count or size != _HEADER_BYTES + count * RECORD.itemsize:
        raise ValueError(
            f"{path.name} is {size} bytes long and no binary STL of {count} triangles; save it as binary STL"
        )
    return count
