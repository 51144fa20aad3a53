"""Grids of points on a mesh, one for every face of a layout, and the nearest places on such grids."""

import numpy as np
from trimesh.triangles import points_to_barycentric

from nurbs_lab.mesh.distance import triangle_tree
from nurbs_lab.mesh.solid import _kernels_feet as kernels
from nurbs_lab.mesh.solid.net import cells_of, number_nodes

CELLS = 4  # of the even grid on a face where the fit begins
_HALVES = np.array([[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]])  # of a cell


def even_grid(mesh, layout, chart):
    """Points of the mesh for every face of a layout, on a grid of `CELLS` squared cells, from its chart.

    And the triangle in which the middle of the face lies.
    """
    net, count = number_nodes(layout, CELLS + 1)
    triangle, weights = np.empty(count, dtype=np.int64), np.empty((count, 3))
    triangle[net], weights[net] = chart.places(CELLS)
    kernels.trace_back(chart.log, len(mesh.triangles), triangle, weights)
    middle = triangle[net[:, CELLS // 2, CELLS // 2]]
    return np.einsum("nk,nkd->nd", weights, mesh.vertices[mesh.triangles[triangle]])[net], middle


def even_places(cells):
    """The (u, v) of an even grid on a patch, ``((cells + 1)**2, 2)``."""
    t = np.arange(cells + 1) / cells
    return np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)


def places(values, points, normals=None, order=None):
    """Face and (u, v) of the nearest places on grids of points of all faces ``(faces, n + 1, n + 1, 3)``.

    Cells that face away from the normal of a point do not count, if there are others. The last result is the
    ``order`` of a tree of cells, which will do for grids that are near these too.
    """
    a, b, c, d = cells_of(values)
    corners = np.stack([np.stack([a, b, c], -2), np.stack([a, c, d], -2)], -3).reshape(-1, 3, 3)
    tree = triangle_tree(corners, order)
    which = tree.nearest(points, normals)[1]
    lost = which < 0
    which[lost] = tree.nearest(points[lost])[1]
    with np.errstate(divide="ignore", invalid="ignore"):  # in triangles without an area
        weights = np.nan_to_num(points_to_barycentric(corners[which], points))
    local = np.einsum("nk,nkd->nd", weights, _HALVES[which % 2]).clip(0.0, 1.0)
    cell, n = which // 2, values.shape[1] - 1
    corner = np.column_stack([cell // n % n, cell % n])
    return cell // n**2, np.clip((corner + local) / n, 0.0, 1.0), tree.order
