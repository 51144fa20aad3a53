"""Meshes of all accepted kinds as plain arrays."""

import warnings
from pathlib import Path

import numpy as np
import trimesh

from nurbs_lab.common.checks import as_choice, as_file, as_floats, extent, require_finite
from nurbs_lab.mesh.formats import shape_in
from nurbs_lab.mesh.formats.shape import triangles_in

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1e3, "um": 1e-3, "inch": 25.4, "ft": 304.8, "mil": 0.0254}  # in mm
_SPELT = {"mm": "millimeter millimetre", "cm": "centimeter centimetre", "m": "meter metre"}
_SPELT |= {"um": "micron micrometer micrometre", "mil": "mil thou"}
_SPELT = {word + s: unit for unit, words in _SPELT.items() for word in words.split() for s in ("", "s")}
_SPELT |= {"in": "inch", "inches": "inch", "foot": "ft", "feet": "ft", "\u00b5m": "um", "\u03bcm": "um"}
_USUAL_SIZE = 1.0, 1e4  # mm, of a part whose file states no unit; others are warned of


def arrays_of(mesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices ``(n, 3)`` float64 and triangles ``(m, 3)`` int32 of a mesh or scene, or of a file of one.

    Raises
    ------
    TypeError
        If ``mesh`` is no trimesh, no trimesh scene, no PyVista surface and no file name.
    ValueError
        If it holds no triangle, a coordinate that is not finite, or a corner that does not exist.
    """
    if isinstance(mesh, (str, Path)):
        vertices, triangles = read_file(Path(mesh))
        if not len(triangles):
            raise ValueError(f"mesh file {str(mesh)!r} cannot be read: it has no triangles, only points")
        return vertices, triangles
    if hasattr(mesh, "geometry") and hasattr(mesh, "to_mesh"):
        mesh = mesh.to_mesh()
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        vertices, triangles = mesh.vertices, mesh.faces
    elif hasattr(mesh, "points") and hasattr(mesh, "is_all_triangles"):
        surface = mesh if mesh.is_all_triangles else mesh.triangulate()
        vertices, triangles = surface.points, surface.regular_faces
    else:
        kinds = "a trimesh.Trimesh or trimesh.Scene, a pyvista.PolyData or a file name"
        raise TypeError(f"mesh is a {type(mesh).__name__}; give {kinds}")
    return _checked(vertices, triangles)


def short_unit(unit):
    """The name in `UNITS` of a unit of length in an ordinary spelling, such as Inches or \u00b5m."""
    word = str(unit).strip().lower()
    return _SPELT.get(word, word)


def read_file(path, unit=None):
    """Points ``(n, 3)`` of a mesh file, in mm, and its triangles ``(m, 3)``; m is 0 for a cloud.

    Parameters
    ----------
    path : Path
    unit : str, optional
        What the numbers of the file are, as `short_unit` reads it: mm unless the file states another.

    Raises
    ------
    ValueError
        If the file is damaged or empty.

    Warns
    -----
    UserWarning
        If the file may be cut off; if nothing states the unit and the part is smaller than 1 mm or larger
        than 10 m; and of a GLB file, which is in metres by its format, if no ``unit`` is given.
    """
    as_file("mesh", path)
    if unit is not None:
        unit = as_choice("unit", short_unit(unit), tuple(UNITS))
    try:
        with np.errstate(all="ignore"):  # of damaged numbers
            shape = shape_in(path)
            require_finite("points", shape.points)
            triangles, notes = triangles_in(shape)
            points = shape.points * UNITS[short_unit(unit or shape.unit or "mm")]
        if len(triangles) or path.suffix.lower() not in (".ply", ".obj", ".off") or not len(points):
            points, triangles = _checked(points, triangles)
    except Exception as error:  # a damaged file can make a library raise anything
        raise ValueError(f"mesh file {str(path)!r} cannot be read: {error}") from error
    for note in (*shape.notes, *notes, *_about_size(path, shape, points, unit)):
        warnings.warn(f"mesh file {path.name!r}: {note}", stacklevel=5)
    return points, triangles


def _about_size(path, shape, points, unit):
    size = extent(points)
    if unit is None and path.suffix.lower() == ".glb":
        yield (
            "a GLB is in metres, so its numbers are taken times 1000; read it with unit='mm' if they are mm. "
            "Its y axis points upwards by its format, and is kept"
        )
    elif unit is None and shape.unit is None and not _USUAL_SIZE[0] <= size <= _USUAL_SIZE[1]:
        yield f"it is {size:.3g} mm across and states no unit; read it with unit= if its numbers are not mm"


def _checked(vertices, triangles):
    vertices, triangles = as_floats("mesh: vertices", vertices), np.asarray(triangles)
    if not triangles.size:
        raise ValueError("mesh has no triangles; give one that has faces")
    for name, rows in (("vertices", vertices), ("triangles", triangles)):
        if rows.ndim != 2 or rows.shape[1] != 3:
            raise ValueError(f"mesh: {name} must have shape (n, 3), got {rows.shape}")
    low, high = triangles.min(), triangles.max()
    if low < 0 or high >= len(vertices):
        raise ValueError(f"mesh has corners numbered {low:g} to {high:g}, but {len(vertices)} vertices")
    whole = triangles.astype(np.int32, order="C")
    if triangles.dtype.kind not in "iu" and (whole != triangles).any():
        raise ValueError("mesh: triangles must hold whole numbers, the indices of vertices")
    return vertices, whole


def without_cache(mesh):
    """A mesh as it is sent to a worker: trimesh remembers four times as much as it needs."""
    return mesh.copy(include_cache=False) if isinstance(mesh, trimesh.Trimesh) else mesh
