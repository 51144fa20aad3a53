"""Cutter locations: how far a cutter falls."""

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind
from nurbs_lab.machining import _kernels_contact
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.part import prepare_part
from nurbs_lab.machining.threads import over_blocks
from nurbs_lab.mesh.closest import LEAF


def drop_cutter(part, cutter, xy):
    """Height of the tip of a cutter that comes down on a part.

    Parameters
    ----------
    part : trimesh.Trimesh, pyvista.PolyData, file name, Reconstruction, NurbsSurface or Part
        NURBS are tessellated within 1 µm; `machining.prepare_part` states another tolerance and saves
        preparing the part again.
    cutter : Cutter
        As long as needed: `finish` is who refuses a cutter that is too short.
    xy : array_like, shape (..., 2)
        Places of the axis, in mm.

    Returns
    -------
    ndarray, shape (...,)
        Height of the tip in mm, -inf where the cutter meets nothing.

    Notes
    -----
    Exact for facets, edges and vertices, to rounding. The tree of boxes is searched on all cores.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> box = trimesh.creation.box(extents=(20, 20, 10))
    >>> nl.drop_cutter(box, nl.Cutter("ball", diameter=6.0), [(0, 0), (11, 0), (14, 0)]).round(3)
    array([ 5.   ,  4.828,   -inf])
    """
    part, cutter = prepare_part(part), as_kind("cutter", cutter, Cutter)
    xy = as_floats("xy", xy)
    if xy.ndim < 1 or xy.shape[-1] != 2:
        raise ValueError(f"xy must have shape (..., 2), got {xy.shape}")
    return heights(part, cutter.flat_radius, cutter.corner_radius, xy.reshape(-1, 2)).reshape(xy.shape[:-1])


def heights(part, flat_radius, corner_radius, xy):
    """Heights ``(n,)`` of the tip of a cutter of any flat radius and corner radius at ``xy (n, 2)``."""
    z = np.empty(len(xy))

    def kernel(block):
        _kernels_contact.drop(
            xy[block],
            part.tree.corners,
            part.normals,
            part.edges,
            part.tree.boxes,
            LEAF,
            flat_radius,
            corner_radius,
            z[block],
        )

    over_blocks(kernel, len(xy), "dropping the cutter")
    return z
