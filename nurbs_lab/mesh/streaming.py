"""Slicing a binary STL that is larger than memory.

A contour needs only the triangles that its plane crosses. So the file is read once, chunk by chunk, and the
crossed triangles are kept (the paper's prescreen); then the usual slicer cuts a band of planes at a time: the
contours are the same, bit for bit. When more triangles than allowed are crossed, the upper planes wait for
another reading.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
from tqdm.auto import tqdm

from nurbs_lab.common.checks import as_count, shown
from nurbs_lab.common.progress import heard, hidden
from nurbs_lab.mesh import _kernels
from nurbs_lab.mesh.graph import graph_of
from nurbs_lab.mesh.slicing import axis_frame, checked_heights, slice_mesh

_HEADER_BYTES = 84
RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
CROSSED = np.dtype([("corners", "f4", (3, 3)), ("first", "i4"), ("last", "i4"), ("number", "i8")], align=True)
_CHUNK = 20_000  # triangles read at once
_MOST_TRIANGLES = 2**31
_BAND = 250_000  # triangles cut at once, about 200 bytes each; a single plane may take more
_NOT_FINITE = "the file holds a coordinate that is not finite; repair it first"


@heard()
def slice_stl(path, heights, axis="z", *, most_triangles=6_000_000) -> list:
    """Cut a binary STL file of any size, as `slice_mesh` does.

    Parameters
    ----------
    path : str or Path
    heights, axis
        As for `slice_mesh`.
    most_triangles : int
        How many crossed triangles to hold in memory at once, about 60 bytes each. One plane must not cross
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
    as_count("most_triangles", most_triangles, 1, _MOST_TRIANGLES)
    count = _triangle_count(path)
    rising, place = np.unique(heights, return_inverse=True)
    layers = []
    while len(layers) < len(rising):
        crossed, planes = _crossed(path, count, rising[len(layers) :], normal, most_triangles)
        for start, stop in _bands(crossed, len(planes)):
            chosen = crossed[(crossed["first"] < stop) & (crossed["last"] >= start)]
            layers += [
                replace(
                    layer,
                    contours=tuple(
                        replace(c, triangles=chosen["number"][c.triangles]) for c in layer.contours
                    ),
                )
                for layer in slice_mesh(_graph_of_soup(chosen["corners"]), planes[start:stop], axis)
            ]
    return [layers[i] for i in place]


def _crossed(path, count, heights, normal, most):
    """The triangles crossed by the lowest planes, as many as fit, and these planes."""
    parts, held = [], 0
    with (
        Path(path).open("rb", buffering=0) as file,
        tqdm(
            total=count,
            unit=" triangles",
            unit_scale=True,
            desc="Slicing",
            leave=False,
            disable=hidden(),
        ) as progress,
    ):
        file.seek(_HEADER_BYTES)
        for start in range(0, count, _CHUNK):
            records = np.fromfile(file, RECORD, min(_CHUNK, count - start))
            parts.append(_crossing(records["corners"], start, heights, normal))
            held += len(parts[-1])
            while held > most:
                if len(heights) == 1:
                    raise ValueError(
                        f"the plane at {heights[0]} alone crosses more than {most} triangles; "
                        "raise most_triangles"
                    )
                heights = heights[: len(heights) // 2]
                parts = [part[part["first"] < len(heights)] for part in parts]
                held = sum(map(len, parts))
            progress.update(len(records))
    return np.concatenate(parts), heights


def _crossing(corners, start, heights, normal):
    """The crossed ones among the triangles ``corners``, numbered from ``start``."""
    kept, first, last = (np.empty(len(corners), np.int32) for _ in range(3))
    count = _kernels.crossing_triangles(corners, normal, heights, kept, first, last)
    if count < 0:
        raise ValueError(_NOT_FINITE)
    crossed = np.empty(count, CROSSED)
    crossed["corners"] = corners[kept[:count]]
    crossed["number"] = kept[:count]
    crossed["number"] += start
    crossed["first"], crossed["last"] = first[:count], last[:count]
    return crossed


def _bands(crossed, planes):
    """Ranges of planes that cross few enough triangles together to be cut at once."""
    begun = np.cumsum(np.bincount(crossed["first"], minlength=planes))
    ended = np.cumsum(np.bincount(np.minimum(crossed["last"], planes - 1), minlength=planes))
    start = 0
    while start < planes:
        over = ended[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(begun, over + _BAND, side="right")))
        yield start, stop
        start = stop


def _graph_of_soup(corners):
    vertices = corners.reshape(-1, 3).astype(np.float64)
    if not np.isfinite(vertices).all():
        raise ValueError(_NOT_FINITE)
    return graph_of(vertices, np.arange(len(vertices), dtype=np.int32).reshape(-1, 3))


def _triangle_count(path):
    try:
        path = Path(path)
    except TypeError:
        raise TypeError(f"path must be a file name, got {shown(path)}") from None
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
