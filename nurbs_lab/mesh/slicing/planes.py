"""Cut a mesh by parallel planes, and where to put them."""

from pathlib import Path

import numpy as np

from nurbs_lab.common.checks import as_choice, as_count, as_floats, as_positive
from nurbs_lab.common.executor import as_executor
from nurbs_lab.common.progress import interruptible
from nurbs_lab.mesh.core import mesh_graph
from nurbs_lab.mesh.slicing import stl_blocks
from nurbs_lab.mesh.slicing.contours import Layer, axis_frame, in_frame, layers_of

_MOST_LAYERS = 100_000


@interruptible()
def slice_mesh(mesh, heights, axis="z", *, fill="even-odd", executor=None) -> list[Layer]:
    """Cut a mesh by parallel planes into ordered contours.

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph
        A `MeshGraph` saves building the graph again. A binary STL file of more than 300 MB is read in blocks,
        so that it may be larger than the memory: see `nurbs_lab.mesh.slicing.stl_blocks`.
    heights : float or sequence of float
        Positions of the planes along the axis, in any order.
    axis : 'x', 'y', 'z' or (3,) array
        Normal of the planes. Contours of 'z' or (0, 0, 1) are in (x, y), of 'x' in (y, z), of 'y' in (z, x);
        those of other normals are in the directions that `Contour.frame` holds.
    fill : 'even-odd' or 'nonzero'
        What is material. With 'even-odd' a contour inside another is a hole, whatever the winding of the
        triangles. With 'nonzero' it is a hole only if it runs the other way round, so a body inside another
        body makes no hole: contours with material on both sides are left out. Contours of bodies that cross
        each other are kept whole under both rules, and `Layer.area` counts their overlap twice.
    executor : concurrent.futures.Executor, optional
        Workers that read a binary STL file of any size and find what the planes cross. They need to see the
        file by the same name.

    Returns
    -------
    list of Layer
        One for every height, in the order given.

    Raises
    ------
    ValueError
        If a height is not finite, the axis has no direction, or the mesh has no triangles.

    Notes
    -----
    Time is linear in the number of vertices, triangles and segments, times the logarithm of the number of
    planes for the vertices. Planes are divided among Numba's threads; the bits do not depend on their number.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> (layer,) = nl.slice_mesh(trimesh.creation.box(extents=(3, 2, 1)), [0.0])
    >>> len(layer.contours), layer.area, layer.contours[0].length
    (1, 6.0, 10.0)
    """
    heights, frame = _checked(heights), axis_frame(axis)
    as_choice("fill", fill, ("even-odd", "nonzero"))
    as_executor(executor)
    levels, place = np.unique(heights, return_inverse=True)
    if stl_blocks.is_streamed(mesh, executor):
        layers = stl_blocks.layers_of_file(Path(mesh), levels, frame, fill, executor)
    else:
        graph = mesh_graph(mesh)
        layers = layers_of(graph, levels, frame, fill) if len(levels) else []
    return [layers[i] for i in place]


def _checked(heights) -> np.ndarray:
    """Heights as a flat array of finite numbers."""
    heights = np.atleast_1d(as_floats("heights", heights))
    if heights.ndim != 1:
        raise ValueError(f"heights has shape {heights.shape}; give one number per plane")
    return heights


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


def _corner_heights(mesh, axis):
    graph = mesh_graph(mesh)
    if graph.junk.all():
        raise ValueError("mesh has no triangle of three different corners; there is nothing to slice")
    return in_frame(graph.vertices, axis_frame(axis))[graph.triangles[~graph.junk], 2]
