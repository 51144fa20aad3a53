"""What every reader of a mesh file returns, and what they share."""

import re
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

_FOLDED = 1.5  # area of the triangles of a polygon over that of the polygon, which is 1 if it is plane
_MOST_CORNERS = 30_000  # of a face: about 2 s
_NO_AREA = 1e-12  # of the largest triangle


@dataclass(frozen=True)
class Shape:
    """Points ``(n, 3)``; the number of corners of each polygon, and all their corners.

    ``unit`` is None if the file states none; ``notes`` are what a reader should be warned of.
    """

    points: np.ndarray
    sizes: np.ndarray
    corners: np.ndarray
    unit: str | None = None
    notes: tuple[str, ...] = ()


def triangles_in(shape) -> tuple[np.ndarray, tuple[str, ...]]:
    """The polygons of a shape as triangles ``(m, 3)``, concave ones by VTK's ear cutting; notes on them."""
    import pyvista

    if (shape.sizes == 3).all():
        return shape.corners.reshape(-1, 3), ()
    if not 0 <= shape.corners.min() <= shape.corners.max() < len(shape.points):
        raise ValueError(f"a corner of a face is no number of one of the {len(shape.points)} vertices")
    if shape.sizes.max() > _MOST_CORNERS:  # the time grows with their square
        raise ValueError(f"a face has {shape.sizes.max()} corners; divide faces of more than {_MOST_CORNERS}")
    begins = np.concatenate([[0], np.cumsum(shape.sizes)])
    surface = pyvista.PolyData(shape.points, np.insert(shape.corners, begins[:-1], shape.sizes))
    surface.cell_data["polygon"] = np.arange(len(shape.sizes))
    cut = surface.triangulate()
    triangles, polygon = cut.regular_faces, cut.cell_data["polygon"]
    bad = np.flatnonzero(np.bincount(polygon, minlength=len(shape.sizes)) != shape.sizes - 2)
    if len(bad):
        fans = [shape.corners[begins[k] : begins[k + 1]].tolist() for k in bad]
        fans = [(k, fan[0], b, c) for k, fan in zip(bad, fans, strict=True) for b, c in pairwise(fan[1:])]
        kept = ~np.isin(polygon, bad)
        fans = np.array(fans, dtype=np.int64)
        triangles, polygon = np.vstack([triangles[kept], fans[:, 1:]]), np.append(polygon[kept], fans[:, 0])
    a, b, c = shape.points[triangles].swapaxes(0, 1)
    vectors = np.cross(b - a, c - a)
    net = np.column_stack([np.bincount(polygon, column) for column in vectors.T])
    sizes, least = np.linalg.norm(vectors, axis=1), _NO_AREA * np.linalg.norm(vectors, axis=1).max()
    crossing = np.bincount(polygon, sizes) > _FOLDED * np.linalg.norm(net, axis=1) + least
    many = np.count_nonzero(crossing & (shape.sizes > 3))
    return triangles, (f"{many} of its faces cross themselves",) if many else ()


def lines_of(data, first=1):
    """Number and words of every line that has some, without its comment; lines that end in a \\ go on."""
    lines, words = [], []
    for number, line in enumerate(data.removeprefix(b"\xef\xbb\xbf").splitlines(), first):
        words += line.removesuffix(b"\\").partition(b"#")[0].split()
        if words and not line.endswith(b"\\"):
            lines.append((number, words))
            words = []
    return lines


def as_numbers(rows, lines, kind=float, data=None):
    """Rows of words as numbers; ``lines`` are theirs, or with ``data`` the bytes where they begin."""
    try:
        return np.array(rows, dtype=kind)
    except (ValueError, OverflowError):
        for line, row in zip(lines, rows, strict=True):
            for word in row:
                try:
                    kind(word)
                except ValueError:
                    comma = "; numbers need a point, not a comma" * (b"," in word)
                    text = word.decode(errors="replace")
                    line = line if data is None else line_of(data, line)
                    raise ValueError(f"line {line}: {text[:40]!r} is no number{comma}") from None
        raise ValueError("its lines hold numbers that are too large or differ in count") from None


def line_of(data, at):
    """Number of the line of the first word from a byte on."""
    return len(data[: re.compile(rb"\s*").match(data, at).end() + 1].splitlines())


def as_utf8(data):
    """The bytes of a text, also of one in UTF-16, which its first two bytes say."""
    return data.decode("utf-16").encode() if data[:2] in (b"\xff\xfe", b"\xfe\xff") else data


def unended(data):
    return () if data.endswith((b"\n", b"\r")) else ("its last line has no end; it may be cut off",)


def lists_of(rows, lines):
    """Number of corners of each face and all of its corners; a row may go on with colours."""
    for i, row in zip(lines, rows, strict=True):
        if not row[0].isdigit() or not 3 <= int(row[0]) < len(row):
            raise ValueError(f"line {i}: a face of {row[0].decode(errors='replace')[:20]} corners with "
                             f"{len(row) - 1} numbers; a part of it is missing or damaged")  # fmt: skip
    sizes = np.array([int(row[0]) for row in rows], dtype=np.int64)
    flat = [word for row, size in zip(rows, sizes.tolist(), strict=True) for word in row[1 : 1 + size]]
    corners = as_numbers([[word] for word in flat], np.repeat(lines, sizes), int)
    return sizes, corners.reshape(-1).astype(np.int64)


def require_lines(count, promised):
    if count != promised:
        raise ValueError(f"its header promises {promised} lines, but {count} follow; it is damaged")
