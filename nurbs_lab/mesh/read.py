"""Meshes of all accepted kinds as plain arrays."""

from pathlib import Path

import numpy as np

from nurbs_lab.common.checks import LARGEST, as_file, as_floats, require_finite
from nurbs_lab.common.threads import over_slices
from nurbs_lab.mesh.mesh_files import require_whole

_BLOCK = 65_536  # rows, which stay in a processor's cache until their extremes are known


def arrays_of(mesh) -> tuple[np.ndarray, np.ndarray]:
    """Vertices ``(n, 3)`` float64 and triangles ``(m, 3)`` int32 of a trimesh, a PyVista surface or a file.

    Raises
    ------
    TypeError
        If ``mesh`` is none of these.
    ValueError
        If it holds no triangle, a coordinate that is not finite, or a corner that does not exist.
    """
    if isinstance(mesh, (str, Path)):
        return _of_file(Path(mesh))
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        vertices, triangles = mesh.vertices, mesh.faces
    elif hasattr(mesh, "points") and hasattr(mesh, "regular_faces"):
        surface = mesh if mesh.is_all_triangles else mesh.triangulate()
        vertices, triangles = surface.points, surface.regular_faces
    else:
        raise TypeError(
            f"mesh is a {type(mesh).__name__}; give a trimesh.Trimesh, a pyvista.PolyData or a file name"
        )
    vertices = _numbers("mesh: vertices", vertices, "iuf")
    triangles = _numbers("mesh: triangles", triangles, "iu")
    if not triangles.size:
        raise ValueError("mesh has no triangles; there is nothing to slice")
    for name, rows in (("vertices", vertices), ("triangles", triangles)):
        if rows.ndim != 2 or rows.shape[1] != 3:
            raise ValueError(f"mesh: {name} must have shape (n, 3), got {rows.shape}")
    whole, low, high = _copied(triangles, np.int32)
    if low < 0 or high >= len(vertices):
        raise ValueError(f"mesh has corners numbered {low:g} to {high:g}, but {len(vertices)} vertices")
    if triangles.dtype.kind == "f" and (whole != triangles).any():
        raise ValueError("mesh: triangles must hold whole numbers, the indices of vertices")
    vertices, low, high = _copied(vertices, np.float64)
    if not -LARGEST <= float(low) <= float(high) <= LARGEST:
        require_finite("mesh: vertices", vertices)
    return vertices, whole


def _numbers(name, rows, kinds):
    """Rows as they are if they are an array of one of the ``kinds`` of numbers, else as floats."""
    plain = isinstance(rows, np.ndarray) and not np.ma.isMaskedArray(rows) and rows.dtype.kind in kinds
    return np.asarray(rows) if plain else as_floats(name, rows)


def _copied(rows, kind):
    """A copy of rows as numbers of another kind, and the least and the greatest of the rows."""
    copy = np.empty(rows.shape, kind)

    def convert(part):
        with np.errstate(all="ignore"):  # of numbers beyond the other kind, which the extremes show
            copy[part] = rows[part]
        return rows[part].min(), rows[part].max()

    blocks = [slice(start, start + _BLOCK) for start in range(0, len(rows), _BLOCK)]
    low, high = np.transpose(over_slices(convert, blocks, "reading the mesh"))
    return copy, low.min(), high.max()


def without_cache(mesh):
    """A mesh as it is sent to a worker: trimesh remembers four times as much as it needs."""
    import trimesh

    return mesh.copy(include_cache=False) if isinstance(mesh, trimesh.Trimesh) else mesh


def _of_file(path):
    import trimesh

    as_file("mesh", path)
    try:
        with np.errstate(all="ignore"):  # of readers that compute with damaged numbers
            require_whole(path)
            scene = trimesh.load_scene(path, process=False)
        meshes = [shape for shape in scene.geometry.values() if isinstance(shape, trimesh.Trimesh)]
        mesh = meshes[0] if len(meshes) == 1 else scene.to_mesh()  # which copies, and hashes each array
        return arrays_of(mesh)
    except Exception as error:  # a damaged file can make its reader raise anything
        raise ValueError(f"mesh file {str(path)!r} cannot be read: {error}") from error
