"""Even grids of points on a mesh, one for every face of a layout.

They say which part of the mesh a face stands for.
"""

import numpy as np
from scipy.sparse import coo_matrix

from nurbs_lab.mesh.closest import triangle_tree
from nurbs_lab.mesh.patches import DEGREE, number_control_points
from nurbs_lab.mesh.surfels import unit

_DAMPING = 0.7  # of a step to the middle of the neighbours
_LEVELS = ((1, 5), (2, 10), (4, 15), (8, 10))  # cells of even grids, and how often each is relaxed


class Grid:
    """A grid of points on every face of a layout, common along edges: the linear counterpart of the net."""

    def __init__(self, layout, cells):
        self.net, self.count = number_control_points(layout, cells + 1 - DEGREE)
        pairs = [(self.net[:, 1:], self.net[:, :-1]), (self.net[:, :, 1:], self.net[:, :, :-1])]
        a = np.concatenate([p.ravel() for p, _ in pairs])
        b = np.concatenate([q.ravel() for _, q in pairs])
        links = coo_matrix((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(self.count,) * 2).tocsr()
        links.data[:] = 1.0
        self.mean = links.multiply(1.0 / links.sum(axis=1)).tocsr()
        side = layout.sides[layout.sharp, 0]
        round_faces = (self.net[:, :, 0], self.net[:, -1], self.net[:, ::-1, -1], self.net[:, 0, ::-1])
        self.on_creases = np.stack(round_faces, axis=1).reshape(-1, cells + 1)[side]
        self.free = np.ones(self.count, dtype=bool)
        self.free[self.on_creases] = False
        self.free[: len(layout.points)] &= ~layout.fixed

    def spacing(self, points):
        """Root mean square distance to the neighbours."""
        squares, mean = np.einsum("ij,ij->i", points, points), self.mean @ points
        between = self.mean @ squares + squares - 2 * np.einsum("ij,ij->i", points, mean)
        return np.sqrt(np.maximum(between, 0.0))

    def relax(self, points, normals, tree, times):
        """Even out the spacing of the nodes on the mesh, whose normals are given; fixed ones stay."""
        free = self.free
        points, normals = points.copy(), normals.copy()
        for k in range(times + 1):
            step = self.mean @ points - points
            along = step - np.einsum("ij,ij->i", step, normals)[:, None] * normals
            moved = points + (_DAMPING * along if k else 0.0)
            around = unit(normals + self.mean @ normals)
            feet, found = tree.feet(moved[free], around[free], self.spacing(points)[free])
            points[free], normals[free] = feet, found
        return points, normals


def relaxed_grid(layout, tree, spans):
    """Points of every face on an even grid, on the mesh and evenly spaced, coarse grids first."""
    values = None
    for cells, times in _LEVELS[: 3 if spans < 3 else 4]:
        grid = Grid(layout, cells)
        if values is None:
            points, normals = layout.points, layout.normals
        else:
            finer = np.empty((len(values), cells + 1, cells + 1, 6))
            finer[:, ::2, ::2] = values
            finer[:, 1::2, ::2] = (values[:, 1:] + values[:, :-1]) / 2
            finer[:, :, 1::2] = (finer[:, :, 2::2] + finer[:, :, :-2:2]) / 2
            both = np.empty((grid.count, 6))
            both[grid.net] = finer
            points, normals = both[:, :3], unit(both[:, 3:])
            points[grid.on_creases] = _evenly(layout.curves[layout.sharp], cells)
        points, normals = grid.relax(points, normals, tree, times)
        values = np.concatenate([points, normals], axis=1)[grid.net]
    return values[..., :3]


def _evenly(curves, cells):
    """Every curve's points at cells + 1 even places."""
    at = np.arange(cells + 1) * (curves.shape[1] - 1) / cells
    low = np.minimum(at.astype(int), curves.shape[1] - 2)
    rest = (at - low)[:, None]
    return curves[:, low] * (1.0 - rest) + curves[:, low + 1] * rest


def even_places(cells):
    t = np.arange(cells + 1) / cells
    return np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)


def places(values, points, normals):
    """Face and (u, v) of the nearest places on grids of points of all faces ``(faces, n + 1, n + 1, 3)``.

    Cells that face away from the normal of a point do not count. Returns the distances to the cells, too.
    """
    a, b, c, d = values[:, :-1, :-1], values[:, 1:, :-1], values[:, 1:, 1:], values[:, :-1, 1:]
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
    upper = (
        which % 2 == 1
    )  # its corners are (0, 0), (1, 1), (0, 1); those of the lower (0, 0), (1, 0), (1, 1)
    local = np.column_stack([np.where(upper, s, s + t), np.where(upper, s + t, t)]).clip(0.0, 1.0)
    cell, n = which // 2, values.shape[1] - 1
    corner = np.column_stack([cell // n % n, cell % n])
    return cell // n**2, np.clip((corner + local) / n, 0.0, 1.0), gaps
