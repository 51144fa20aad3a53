"""Distance from points to a triangle mesh."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.box_tree import box_tree, morton
from nurbs_lab.common.threads import over_blocks
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
        out = np.empty(len(points))

        def measure(part):
            out[part] = _kernels_closest.distances(points[part], self.corners, self.boxes)

        over_blocks(measure, len(points), "distances")
        return out


def triangle_tree(corners) -> TriangleTree:
    """Sort the triangles ``corners (m, 3, 3)`` into a binary tree of boxes along the Morton curve."""
    centres = corners.mean(axis=1)
    extent = np.ptp(centres, axis=0).max()
    cells = (centres - centres.min(axis=0)) * ((2**20 - 1) / extent if extent > 0 else 0.0)
    order = np.argsort(morton(cells.astype(np.int64)), kind="stable")
    corners = np.ascontiguousarray(corners[order])

    starts = np.arange(0, len(corners), LEAF)
    lows, highs = corners.min(axis=1), corners.max(axis=1)
    leaves = np.hstack([np.minimum.reduceat(lows, starts), np.maximum.reduceat(highs, starts)])
    return TriangleTree(corners.reshape(-1, 9), box_tree(leaves), order)
