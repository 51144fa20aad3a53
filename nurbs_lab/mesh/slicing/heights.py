"""Where to put the planes."""

import numpy as np

from nurbs_lab.common.checks import as_count, as_positive
from nurbs_lab.mesh.core import mesh_graph
from nurbs_lab.mesh.slicing import _kernels
from nurbs_lab.mesh.slicing.contours import axis_frame, in_frame

_MOST_LAYERS = 100_000


def uniform_heights(mesh, *, layers=None, layer_height=None, axis="z") -> np.ndarray:
    """Heights in the middle of equal layers that fill the mesh from end to end.

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph
    layers : int
        Number of layers, at most 100,000.
    layer_height : float
        Or their height in mm, rounded so that a whole number fits.
    axis : 'x', 'y', 'z' or (3,) array

    Raises
    ------
    TypeError
        If not exactly one of ``layers`` and ``layer_height`` is given.
    ValueError
        If it is not positive, or makes too many layers.
    """
    if (layers is None) == (layer_height is None):
        raise TypeError("give either layers (how many) or layer_height (mm), not both and not neither")
    z = _corner_heights(mesh, axis)
    low, high = z.min(), z.max()
    if layers is None:
        thickness = as_positive("layer_height", layer_height)
        if high - low > _MOST_LAYERS * thickness:
            raise ValueError(f"layer_height is {layer_height}: more than {_MOST_LAYERS} layers; raise it")
        layers = max(1, round((high - low) / thickness))
    layers = as_count("layers", layers, most=_MOST_LAYERS)
    return low + (high - low) * (np.arange(layers) + 0.5) / layers


def adaptive_heights(mesh, *, cusp, thinnest, thickest, axis="z") -> np.ndarray:
    """Heights in the middle of layers as thick as the cusp allows.

    A layer of thickness t, seen as a step, misses a wall whose normal has the component n along the axis by
    the cusp t |n| (Dolenc and Mäkelä 1994). Every layer is the thickest one whose cusp stays within bounds
    wherever it meets the mesh, but not thinner than ``thinnest`` and not thicker than ``thickest``.

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph
    cusp, thinnest, thickest : float
        In mm.
    axis : 'x', 'y', 'z' or (3,) array
    """
    cusp, thinnest, thickest = (
        as_positive(name, value)
        for name, value in (("cusp", cusp), ("thinnest", thinnest), ("thickest", thickest))
    )
    if thinnest > thickest:
        raise ValueError(f"thinnest is {thinnest}, more than thickest, {thickest}")
    z = _corner_heights(mesh, axis)
    if np.ptp(z) > _MOST_LAYERS * thinnest:
        raise ValueError(f"thinnest is {thinnest}: there could be more than {_MOST_LAYERS} layers; raise it")
    graph = mesh_graph(mesh)
    corners = graph.vertices[graph.triangles[~graph.junk]]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    tilt = np.abs(normals @ axis_frame(axis)[2]) / np.where(lengths > 0.0, lengths, 1.0)
    return _kernels.adaptive_layers(z.min(axis=1), z.max(axis=1), tilt, cusp, thinnest, thickest)


def _corner_heights(mesh, axis):
    graph = mesh_graph(mesh)
    if graph.junk.all():
        raise ValueError("mesh has no triangle of three different corners; there is nothing to slice")
    return in_frame(graph.vertices, axis_frame(axis))[graph.triangles[~graph.junk], 2]
