"""Whether a mesh file is complete: trimesh reads a truncated file without a warning."""

import re
import warnings

import numpy as np

from nurbs_lab.mesh._kernels_read import unused_vertices

_ELEMENT = b"element "


def require_whole(path):
    """Compare the bytes of an OFF or a text STL, OBJ or PLY file with what the file itself promises.

    Raises
    ------
    ValueError
        If a part of the file is missing, or it is of another format.

    Warns
    -----
    UserWarning
        If the end looks cut off, but the file may be whole all the same.
    """
    suffix = path.suffix.lower()
    if suffix not in _CHECKS:
        raise ValueError(
            f"{suffix!r} is none of the formats {', '.join(_CHECKS)}; read it with pyvista or trimesh, "
            "and give the mesh"
        )
    _CHECKS[suffix](path.name, path.read_bytes())


def ply_counts(data):
    """The numbers of the elements that the header of a PLY file names, in its order, by name."""
    header = data[: data.find(b"end_header")]
    words = [line.split() for line in header.splitlines() if line.startswith(_ELEMENT)]
    return {name.decode("latin-1"): int(count) for _, name, count in words}


def _require_ply(name, data):
    header, _, body = data.partition(b"end_header")
    if b"format ascii" not in header:
        return  # trimesh compares the length of a binary one
    lines = [line for line in body.splitlines()[1:] if line.strip()]
    _require_lines(name, data, lines, sum(ply_counts(data).values()))


def _require_lines(name, data, lines, promised):
    if len(lines) != promised:
        raise ValueError(f"its header promises {promised} lines, but {len(lines)} follow; it is damaged")
    if not data.endswith(b"\n"):
        _warn(name, "its last line has no end")


def _require_off(name, data):
    body = re.sub(rb"#.*", b"", data).partition(b"OFF")[2]
    counts, *lines = [line.split() for line in body.splitlines() if line.strip()] or [[]]
    vertices, faces = map(int, counts[:2])
    _require_lines(name, data, lines, vertices + faces)
    short = [line for line in lines[vertices:] if len(line) <= int(line[0])]
    if short or any(len(line) < 3 for line in lines[:vertices]):
        raise ValueError("one of its lines has fewer numbers than it needs; a part of it is missing")


def _require_stl(name, data):
    if not data[:200].lstrip().startswith(b"solid") or b"facet" not in data:
        return  # binary: trimesh compares the length
    text = data.lower()
    ends, corners = text.count(b"endfacet"), text.count(b"vertex")
    facets = text.count(b"facet") - ends
    if not facets == ends == corners / 3 or b"endsolid" not in text[-200:]:
        raise ValueError(
            f"it begins {facets} facets, ends {ends} and has {corners} vertices; a part of it is missing"
        )


def _require_obj(name, data):
    vertices, unused = unused_vertices(np.frombuffer(data, np.uint8))
    if vertices < 0:
        raise ValueError("a corner of one of its faces is no number of a vertex; it is damaged")
    cut = not data.endswith(b"\n")
    if unused > 0 and cut:
        raise ValueError(f"its last line has no end and {unused} vertices belong to no face; it was cut off")
    if unused > 0:
        _warn(name, f"{unused} of its {vertices} vertices belong to no face")
    elif cut:
        _warn(name, "its last line has no end")


def _warn(name, what):
    warnings.warn(f"mesh file {name!r}: {what}; it may be cut off", stacklevel=7)


_CHECKS = {".ply": _require_ply, ".off": _require_off, ".stl": _require_stl, ".obj": _require_obj}
