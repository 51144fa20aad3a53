"""Even grids of points on a mesh, one for every face of a layout.

They say which part of the mesh a face stands for.
"""

import numpy as np
from scipy.sparse import coo_array

from nurbs_lab.mesh.core import face_normals, unit
from nurbs_lab.mesh.distance import triangle_tree
from nurbs_lab.mesh.solid import _kernels_feet as kernels
from nurbs_lab.mesh.solid.net import cells_of, number_nodes, sides_of

CELLS = 4  # of the even grid on a face where the fit begins
SWEEPS, STEP = 10, 0.5  # in which every node goes a part of its way
NARROW = 0.3  # sine of a corner of a cell, below which no step makes it smaller


def even_grid(mesh, surface, layout, chart, cells=CELLS):
    """Points of every face on a grid of ``cells`` squared cells, spread over the mesh.

    Each node starts where the chart of its face has it, and moves to the mean of its neighbours and back to
    the nearest place of the mesh that faces the same way; those on sharp edges stay.
    """
    net, count = number_nodes(layout, cells + 1)
    triangle, weights = np.empty(count, dtype=np.int64), np.empty((count, 3))
    triangle[net], weights[net] = chart.places(cells)
    kernels.trace_back(chart.log, len(mesh.triangles), triangle, weights)
    points = np.einsum("nk,nkd->nd", weights, mesh.vertices[mesh.triangles[triangle]])
    normals = face_normals(mesh.vertices, mesh.triangles)
    side = layout.sides[layout.sharp, 0]
    on_creases = np.stack(sides_of(net), axis=1).reshape(-1, cells + 1)[side]
    points[on_creases] = _evenly(layout.curves[layout.sharp], cells)
    free = np.ones(count, dtype=bool)
    free[on_creases] = False
    free[: len(layout.points)] &= ~layout.fixed
    squares = np.stack(cells_of(net), -1).reshape(-1, 4)
    a, b = squares.ravel(), np.roll(squares, -1, axis=1).ravel()
    links = coo_array((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(count, count)).tocsr()[free]
    share = 1.0 / links.sum(axis=1)[:, None]
    along = normals[triangle]
    along[~free] = 0.0
    for _ in range(SWEEPS):
        trial, sides = points.copy(), along.copy()
        trial[free] += STEP * (share * (links @ points) - points[free])
        own = surface.tree.nearest(trial[free], sides[free])[1]
        trial[free], sides[free] = surface.feet_in(trial[free], own), normals[own]
        least = np.minimum(_narrowest(points, along, squares), NARROW)
        while (over := _narrowest(trial, sides, squares) < least).any():
            back = squares[over]
            trial[back], sides[back] = points[back], along[back]
        points, along = trial, sides
    return points[net]


def _narrowest(points, normals, squares):
    """The least sine of a corner of every cell, negative where it has turned over."""
    ahead = unit(np.roll(points[squares], -1, axis=1) - points[squares])
    side = unit(normals[squares].sum(axis=1))
    return np.einsum("nkx,nx->nk", np.cross(np.roll(ahead, 1, axis=1), ahead), side).min(axis=1)


def _evenly(curves, cells):
    """Every curve's points at cells + 1 even places."""
    at = np.arange(cells + 1) * (curves.shape[1] - 1) / cells
    low = np.minimum(at.astype(int), curves.shape[1] - 2)
    rest = (at - low)[:, None]
    return curves[:, low] * (1.0 - rest) + curves[:, low + 1] * rest


def even_places(cells):
    """The (u, v) of an even grid on a patch, ``((cells + 1)**2, 2)``."""
    t = np.arange(cells + 1) / cells
    return np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)


def places(values, points, normals):
    """Face and (u, v) of the nearest places on grids of points of all faces ``(faces, n + 1, n + 1, 3)``.

    Cells that face away from the normal of a point do not count. Returns the distances to the cells, too.
    """
    a, b, c, d = cells_of(values)
    corners = np.stack([np.stack([a, b, c], -2), np.stack([a, c, d], -2)], -3).reshape(-1, 3, 3)
    tree = triangle_tree(corners)
    gaps, which = tree.nearest(points, normals)
    lost = which < 0
    if lost.any():
        gaps[lost], which[lost] = tree.nearest(points[lost])
    origin = corners[which, 0]
    first, second, w = corners[which, 1] - origin, corners[which, 2] - origin, points - origin
    pairs = (first, first), (first, second), (second, second), (w, first), (w, second)
    uu, uv, vv, wu, wv = (np.einsum("ij,ij->i", x, y) for x, y in pairs)
    det = np.maximum(uu * vv - uv * uv, 1e-300)
    s, t = (vv * wu - uv * wv) / det, (uu * wv - uv * wu) / det
    upper = which % 2 == 1  # corners (0, 0), (1, 1), (0, 1); the lower ones have (0, 0), (1, 0), (1, 1)
    local = np.column_stack([np.where(upper, s, s + t), np.where(upper, s + t, t)]).clip(0.0, 1.0)
    cell, n = which // 2, values.shape[1] - 1
    corner = np.column_stack([cell // n % n, cell % n])
    return cell // n**2, np.clip((corner + local) / n, 0.0, 1.0), gaps
