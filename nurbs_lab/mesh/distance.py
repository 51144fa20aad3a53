"""Distance from points to a triangle mesh, and how far a reconstruction and its mesh lie apart."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.box_tree import order_along, tree_along
from nurbs_lab.common.checks import as_number
from nurbs_lab.common.threads import over_blocks
from nurbs_lab.common.values import Value
from nurbs_lab.mesh import _kernels_distance


@dataclass(frozen=True, eq=False, repr=False)
class TriangleTree(Value):
    """Triangles in a tree of boxes, ready to be asked for distances; build it with `triangle_tree`.

    Attributes
    ----------
    corners : (m, 9) array
        In the order of the leaves.
    normals : (m, 3) array
        Twice the area of each triangle along its normal.
    boxes : (n, 6) array
        Least and largest x, y, z of the nodes, as in `box_tree`, with leaves of `box_tree.LEAF` triangles.
    order : (m,) array
        Which of the triangles given comes where in ``corners``.
    """

    corners: np.ndarray
    normals: np.ndarray
    boxes: np.ndarray
    order: np.ndarray

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
        order = order_along(points) if len(points) else np.empty(0, dtype=np.int64)

        def measure(part):
            some = order[part]
            along = np.empty((0, 3)) if directions is None else directions[some]  # of none: any counts
            found = np.empty(len(some), dtype=np.int64)
            gaps[some] = _kernels_distance.nearest(
                points[some], along, self.corners, self.normals, self.boxes, self.order, found
            )
            which[some] = found

        over_blocks(measure, len(points), "distances")
        return gaps, which


def triangle_tree(corners, order=None) -> TriangleTree:
    """Sort triangles ``corners (m, 3, 3)`` into a box tree, or take the ``order`` of others near them."""
    a, b, c = np.moveaxis(corners, 1, 0)
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    order, boxes = tree_along((a + b + c) / 3.0, low, high, order)
    corners = np.ascontiguousarray(corners[order])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return TriangleTree(corners.reshape(-1, 9), normals, boxes, order)


def crossing_triangles(vertices, triangles) -> np.ndarray:
    """For every triangle one that an edge of it passes through, if they share no corner; -1 for none.

    Vertices are moved by a billionth of the size at random, so that no edge meets just an edge.
    """
    places, size = vertices - vertices.mean(axis=0), np.ptp(vertices, axis=0).max()
    places += 1e-9 * size * np.random.default_rng(0).uniform(-1.0, 1.0, places.shape)
    tree = triangle_tree(places[triangles])
    names, found = triangles[tree.order], np.empty(len(triangles), dtype=np.int64)
    over_blocks(
        lambda part: _kernels_distance.crossed_by(tree.corners, names, tree.boxes, part.start, found[part]),
        len(found),
        "crossings",
    )
    partner = np.empty_like(found)
    partner[tree.order] = np.where(found < 0, -1, tree.order[found])
    return partner


@dataclass(frozen=True, eq=False, repr=False)
class Deviation(Value):
    """Two-sided deviation between a mesh and the faces made from it, in mm.

    Attributes
    ----------
    values : (k,) array
        Distances from points all over the mesh to the nearest face, and from points all over the faces to the
        mesh.
    vertices : (n,) array
        Distance of every vertex of ``Reconstruction.mesh`` to the nearest face, for a picture.
    points : (k, 3) array
        Where ``values`` were measured.
    """

    values: np.ndarray
    vertices: np.ndarray
    points: np.ndarray

    @property
    def count(self) -> int:
        """Number of samples."""
        return len(self.values)

    @property
    def max(self) -> float:
        """Largest distance; 0 if there is no sample."""
        return float(self.values.max(initial=0.0))

    @property
    def mean(self) -> float:
        """Mean distance; 0 if there is no sample."""
        return float(self.values.mean()) if self.count else 0.0

    @property
    def rms(self) -> float:
        """Root of the mean square; 0 if there is no sample."""
        return float(np.sqrt(np.mean(self.values**2))) if self.count else 0.0

    def percentile(self, percent) -> float:
        """Distance that ``percent`` % of the samples do not exceed."""
        percent = as_number("percent", percent)
        if not 0.0 <= percent <= 100.0:
            raise ValueError(f"percent is {percent}; give a number from 0 to 100")
        return float(np.percentile(self.values, percent)) if self.count else 0.0

    def fraction_within(self, tolerance) -> float:
        """Fraction of the samples that do not exceed a tolerance in mm."""
        return float(np.mean(self.values <= as_number("tolerance", tolerance))) if self.count else 1.0

    @property
    def worst_place(self) -> np.ndarray:
        """The point where the distance is largest, ``(3,)``."""
        return self.points[int(self.values.argmax())]


def triangle_samples(vertices, triangles, spacing):
    """Points inside the edges and the triangles of a closed mesh, more in those larger than ``spacing``.

    The middle of every triangle is among them, and that of every edge that is cut in two: a smooth surface
    that meets a flat triangle at its corners is farthest from it there. An edge is cut like the triangle in
    which it leads to the vertex of larger number.
    """
    corners, heads = vertices[triangles], np.roll(triangles, -1, axis=1)
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.clip(np.ceil(longest / spacing), 2, 60).astype(int)
    points = []
    for n in np.unique(parts):
        chosen = np.flatnonzero(parts == n)
        face, side = np.nonzero((triangles < heads)[chosen])
        tail, head = (vertices[ends[chosen][face, side]][:, None] for ends in (triangles, heads))
        t = np.arange(1, n)[:, None] / n
        points.append((tail * (1.0 - t) + head * t).reshape(-1, 3))
        i, j = (axis.ravel() for axis in np.meshgrid(np.arange(1, n), np.arange(1, n), indexing="ij"))
        weights = np.column_stack([n - i - j, i, j])[i + j < n] / n
        weights = np.concatenate([weights, np.full((1, 3), 1 / 3)])
        points.append(np.einsum("kc,fcd->fkd", weights, corners[chosen]).reshape(-1, 3))
    return np.concatenate(points)
