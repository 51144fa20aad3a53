"""Whatever a person calls a mesh, as plain arrays."""

from pathlib import Path

import numpy as np

_BY_VISUALIZATION_TOOLKIT = {".vtk", ".vtp", ".vtu"}


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
    vertices = np.array(vertices, dtype=np.float64, order="C").reshape(-1, 3)
    triangles = np.array(triangles, dtype=np.int32, order="C").reshape(-1, 3)
    if not len(triangles):
        raise ValueError("mesh has no triangles; there is nothing to slice")
    lost = np.count_nonzero(~np.isfinite(vertices).all(axis=1))
    if lost:
        raise ValueError(
            f"mesh has {lost} vertices that are not finite; remove them and their triangles first"
        )
    if triangles.min() < 0 or triangles.max() >= len(vertices):
        raise ValueError(
            f"mesh has corners numbered {triangles.min()} to {triangles.max()}, but {len(vertices)} vertices"
        )
    return vertices, triangles


def _of_file(path):
    if not path.is_file():
        raise FileNotFoundError(f"mesh file {str(path)!r} does not exist")
    try:
        return arrays_of(_read(path))
    except OSError:
        raise
    except Exception as error:  # whatever a damaged file makes its reader say
        raise ValueError(f"mesh file {str(path)!r} cannot be read: {error}") from error


def _read(path):
    if path.suffix.lower() in _BY_VISUALIZATION_TOOLKIT:
        import pyvista

        return pyvista.read(path)
    import trimesh

    return trimesh.load_mesh(path, process=False)
