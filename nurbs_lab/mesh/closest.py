"""Distance from points to a triangle mesh."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nurbs_lab.common.box_tree import box_tree, morton
from nurbs_lab.common.threads import over_blocks
from nurbs_lab.mesh import _kernels_closest

LEAF = _kernels_closest.LEAF  # triangles in a leaf
_ANY = np.empty((0, 3))  # directions, if any triangle counts


@dataclass(frozen=True, eq=False)
class TriangleTree:
    """Triangles in a tree of boxes, ready to be asked for distances; build it with `triangle_tree`.

    Attributes
    ----------
    corners : (m, 9) array
        In the order of the leaves.
    normals : (m, 3) array
        Twice the area of each triangle along its normal.
    boxes : (n, 6) array
        Least and largest x, y, z of the nodes of a full binary tree: the children of node i are 2 i + 1 and
        2 i + 2, the last (n + 1) / 2 nodes are leaves of `LEAF` triangles each.
    order : (m,) array
        Which of the triangles given comes where in ``corners``.
    """

    corners: np.ndarray
    normals: np.ndarray
    boxes: np.ndarray
    order: np.ndarray

    @cached_property
    def place(self) -> np.ndarray:
        """Where each of the triangles given is in ``corners``, the inverse of ``order``."""
        return np.argsort(self.order)

    def distances(self, points) -> np.ndarray:
        """Distance of every point ``(n, 3)`` to the nearest triangle, ``(n,)``."""
        return self.nearest(points)[0]

    def nearest(self, points, directions=None):
        """Distance to the nearest triangle, and which it is, ``(n,)`` each.

        With ``directions (n, 3)``, triangles that face away from a point's direction do not count; where
        that leaves none, the distance is infinite and the triangle -1.
        """
        points = np.ascontiguousarray(points, dtype=np.float64)
        gaps, which = np.empty(len(points)), np.empty(len(points), dtype=np.int64)

        def measure(part):
            along = _ANY if directions is None else directions[part]
            gaps[part] = _kernels_closest.nearest(
                points[part], along, self.corners, self.normals, self.boxes, which[part]
            )

        over_blocks(measure, len(points), "distances")
        return gaps, np.where(which < 0, -1, self.order[which])


def triangle_tree(corners) -> TriangleTree:
    """Sort the triangles ``corners (m, 3, 3)`` into a binary tree of boxes along the Morton curve."""
    centres = corners.mean(axis=1)
    extent = np.ptp(centres, axis=0).max()
    cells = (centres - centres.min(axis=0)) * ((2**20 - 1) / extent if extent > 0 else 0.0)
    order = np.argsort(morton(cells.astype(np.int64)), kind="stable")
    corners = np.ascontiguousarray(corners[order])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])

    starts = np.arange(0, len(corners), LEAF)
    lows, highs = corners.min(axis=1), corners.max(axis=1)
    leaves = np.hstack([np.minimum.reduceat(lows, starts), np.maximum.reduceat(highs, starts)])
    return TriangleTree(corners.reshape(-1, 9), normals, box_tree(leaves), order)
