"""Distance from points to a triangle mesh."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.mesh import _kernels_closest

LEAF = _kernels_closest.LEAF  # triangles in a leaf


@dataclass(frozen=True, eq=False)
class TriangleTree:
    """Triangles in a tree of boxes, ready to be asked for distances; build it with `triangle_tree`.

    Attributes
    ----------
    corners : (m, 9) array
        In the order of the leaves.
    boxes : (n, 6) array
        Least and largest x, y, z of the nodes of a full binary tree: the children of node i are 2 i + 1 and
        2 i + 2, the last (n + 1) / 2 nodes are leaves of `LEAF` triangles each.
    order : (m,) array
        Which of the triangles given comes where in ``corners``.
    """

    corners: np.ndarray
    boxes: np.ndarray
    order: np.ndarray

    def distances(self, points) -> np.ndarray:
        """Distance of every point ``(n, 3)`` to the nearest triangle, ``(n,)``."""
        points = np.ascontiguousarray(points, dtype=np.float64)
        return _kernels_closest.distances(points, self.corners, self.boxes)


def triangle_tree(corners) -> TriangleTree:
    """Sort the triangles ``corners (m, 3, 3)`` into a binary tree of boxes along the Morton curve."""
    centres = corners.mean(axis=1)
    extent = np.ptp(centres, axis=0).max()
    cells = (centres - centres.min(axis=0)) * ((2**20 - 1) / extent if extent > 0 else 0.0)
    order = np.argsort(_kernels_closest.morton(cells.astype(np.int64)), kind="stable")
    corners = np.ascontiguousarray(corners[order])

    starts = np.arange(0, len(corners), LEAF)
    leaves = 1 << int(np.ceil(np.log2(len(starts))))
    boxes = np.empty((2 * leaves - 1, 6))
    boxes[leaves - 1 :] = [np.inf] * 3 + [-np.inf] * 3  # a leaf without triangles is infinitely far
    boxes[leaves - 1 : leaves - 1 + len(starts), :3] = np.minimum.reduceat(corners.min(axis=1), starts)
    boxes[leaves - 1 : leaves - 1 + len(starts), 3:] = np.maximum.reduceat(corners.max(axis=1), starts)
    while leaves > 1:
        children = boxes[leaves - 1 : 2 * leaves - 1].reshape(-1, 2, 6)
        leaves //= 2
        boxes[leaves - 1 : 2 * leaves - 1, :3] = children[:, :, :3].min(axis=1)
        boxes[leaves - 1 : 2 * leaves - 1, 3:] = children[:, :, 3:].max(axis=1)
    return TriangleTree(corners.reshape(-1, 9), boxes, order)
