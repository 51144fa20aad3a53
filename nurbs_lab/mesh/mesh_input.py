"""Meshes of all accepted kinds as plain arrays."""

from pathlib import Path

import numpy as np

from nurbs_lab.common.checks import as_file, as_floats
from nurbs_lab.common.threads import equal_slices, over_slices
from nurbs_lab.mesh.mesh_files import require_whole

_MANY = 20_000  # triangles; fewer are not worth a second thread


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
    vertices = as_floats("mesh: vertices", vertices)
    if np.ma.isMaskedArray(triangles) or getattr(triangles, "dtype", np.dtype(float)).kind not in "iu":
        triangles = as_floats("mesh: triangles", triangles)
    if not triangles.size:
        raise ValueError("mesh has no triangles; there is nothing to slice")
    for name, rows in (("vertices", vertices), ("triangles", triangles)):
        if rows.ndim != 2 or rows.shape[1] != 3:
            raise ValueError(f"mesh: {name} must have shape (n, 3), got {rows.shape}")
    whole = np.empty(triangles.shape, np.int32)

    def convert(part):
        with np.errstate(invalid="ignore"):  # of numbers beyond int32, which are refused below
            whole[part] = triangles[part]
        return triangles[part].min(), triangles[part].max()

    low, high = np.transpose(over_slices(convert, equal_slices(len(triangles), _MANY), "reading triangles"))
    if low.min() < 0 or high.max() >= len(vertices):
        raise ValueError(
            f"mesh has corners numbered {low.min():g} to {high.max():g}, but {len(vertices)} vertices"
        )
    if triangles.dtype.kind == "f" and (whole != triangles).any():
        raise ValueError("mesh: triangles must hold whole numbers, the indices of vertices")
    return vertices, whole


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
