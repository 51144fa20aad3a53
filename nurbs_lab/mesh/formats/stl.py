"""STL: binary by its length, text by its grammar."""

import re
from dataclasses import replace

import numpy as np

from nurbs_lab.mesh._kernels_core import weld
from nurbs_lab.mesh.formats.shape import Shape, as_numbers, line_of

RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER_BYTES = 84  # of a binary file, which RECORDs follow
_TRIPLE = rb"\s+(\S+)\s+(\S+)\s+(\S+)"
_FACET = re.compile(
    rb"\s*facet\s+normal" + _TRIPLE + rb"\s+outer\s+loop" + 3 * (rb"\s+vertex" + _TRIPLE)
    + rb"\s+end\s*loop\s+end\s*facet(?=\s)",
    re.IGNORECASE,
)  # fmt: skip
_SOLID = re.compile(rb"\s*solid\b[^\r\n]*[\r\n]", re.IGNORECASE)
_END = re.compile(rb"\s*end\s*solid\b[^\r\n]*\s*", re.IGNORECASE)


def read(data):
    count = binary_stl_count(len(data), data[:HEADER_BYTES])
    if count >= 0:
        return _welded(np.frombuffer(data, RECORD, offset=HEADER_BYTES)["corners"])
    text = data.removeprefix(b"\xef\xbb\xbf").rstrip(b"\0")
    if not _SOLID.match(text) or b"\0" in text:
        what, begins = "it is neither text that begins with 'solid' nor binary", text[:HEADER_BYTES].split()
        if len(data) < HEADER_BYTES:
            raise ValueError(f"{what}: {len(data)} bytes")
        if b"".join(begins).decode("latin-1").isprintable():
            raise ValueError(f"{what}; it begins with {b' '.join(begins).decode('latin-1')[:40]!r}")
        count, fits = int.from_bytes(data[80:84], "little"), (len(data) - HEADER_BYTES) / RECORD.itemsize
        raise ValueError(f"its header counts {count} triangles, but its length is that of {fits:.6g}")
    data = text
    rows, starts, at = [], [], 0
    while solid := _SOLID.match(data, at):
        at = solid.end()
        while facet := _FACET.match(data, at):
            rows.append(facet.groups()[3:])
            starts.append(at)
            at = facet.end()
        if not (end := _END.match(data, at)):
            break
        at = end.end()
    if at < len(data):
        found = data[at:].split(maxsplit=1)[:1] or [b"its end"]
        raise ValueError(
            f"line {line_of(data, at)}: after it a whole facet or 'endsolid' is due, but there is "
            f"{found[0].decode(errors='replace')[:40]!r}; a part of it is missing"
        )
    corners = as_numbers(rows, starts, data=data).reshape(-1, 3, 3)
    shape = _welded(corners)
    lone = _lone_edges(shape.corners.reshape(-1, 3))
    why = f"{lone} of its edges have no second triangle; it is open, or triangles are missing"
    return replace(shape, notes=(why,) if lone else ())


def _lone_edges(triangles):
    """Edges with an odd number of triangles: text of STL, unlike all else, does not say how many it has."""
    ends = np.sort(np.stack([triangles, np.roll(triangles, 1, axis=1)]), axis=0)
    return np.count_nonzero(np.unique(ends[0] + 1j * ends[1], return_counts=True)[1] % 2)


def _welded(corners):
    """Triangles with common vertices, which the format does not know: equal places are one."""
    points = corners.reshape(-1, 3).astype(np.float64)
    triangles = np.arange(len(points), dtype=np.int32).reshape(-1, 3)
    count = weld(points, triangles, np.empty(len(triangles), dtype=bool))
    return Shape(points[:count], np.full(len(triangles), 3), triangles.ravel())


def binary_stl_count(size, header) -> int:
    """Triangles of a binary STL file of ``size`` bytes by its first 84; -1 if the length is not theirs."""
    count = int.from_bytes(header[80:84], "little") if size >= HEADER_BYTES else -1
    return count if size == HEADER_BYTES + count * RECORD.itemsize else -1
