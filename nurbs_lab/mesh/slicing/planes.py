"""Cut a mesh by parallel planes."""

import warnings
from pathlib import Path

import numpy as np

from nurbs_lab.common.checks import as_choice, as_floats
from nurbs_lab.common.executor import as_executor
from nurbs_lab.common.progress import interruptible
from nurbs_lab.mesh.core import mesh_graph
from nurbs_lab.mesh.slicing import stl_blocks
from nurbs_lab.mesh.slicing.contours import Layer, axis_frame, layers_of


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
        each other are kept whole under both rules, and `Layer.area` counts their overlap twice. A contour
        counts as inside another if less than a sixteenth of it, along eight lines across, is outside.
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

    Warns
    -----
    UserWarning
        If a contour is open, so that its area counts 0; `repair_mesh` closes small gaps.

    Notes
    -----
    A vertex on a plane counts as above it. So a plane through a flat top face gives its outline, and one
    through a flat bottom face nothing. Contours are open where triangles meet in no common edge, as where a
    vertex of one lies on an edge of the other.

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
    heights, frame = np.atleast_1d(as_floats("heights", heights)), axis_frame(axis)
    if heights.ndim != 1:
        raise ValueError(f"heights has shape {heights.shape}; give one number per plane")
    as_choice("fill", fill, ("even-odd", "nonzero"))
    as_executor(executor)
    levels, place = np.unique(heights, return_inverse=True)
    if stl_blocks.is_streamed(mesh, executor):
        layers = stl_blocks.layers_of_file(Path(mesh), levels, frame, fill, executor)
    else:
        graph = mesh_graph(mesh)
        layers = layers_of(graph, levels, frame, fill) if len(levels) else []
    if count := sum(layer.open_ends > 0 for layer in layers):
        said = f"mesh has gaps: contours of {count} of {len(layers)} layers are open, and their area counts 0"
        warnings.warn(f"{said}; close it with nurbs_lab.mesh.repair_mesh", stacklevel=3)
    return [layers[i] for i in place]
