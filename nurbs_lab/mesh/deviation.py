"""How far a reconstruction and its mesh lie apart, measured both ways."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_number
from nurbs_lab.common.values import Value


@dataclass(frozen=True, eq=False, repr=False)
class Spread(Value):
    """Distances of many samples, in mm."""

    values: np.ndarray

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


@dataclass(frozen=True, eq=False, repr=False)
class Deviation(Spread):
    """Two-sided deviation between a mesh and the faces made from it; ``values`` are those of both directions.

    Attributes
    ----------
    mesh_to_surface, surface_to_mesh : Spread
        From points all over the mesh to the nearest face, and from points all over the faces to the mesh.
    vertices : (n, 3) array
        Distance of every vertex of ``Reconstruction.mesh`` to the nearest face, for a picture.
    points : (k, 3) array
        Where ``values`` were measured.
    """

    mesh_to_surface: Spread
    surface_to_mesh: Spread
    vertices: np.ndarray
    points: np.ndarray

    @property
    def worst_place(self) -> np.ndarray:
        """The point where the distance is largest, ``(3,)``."""
        return self.points[int(self.values.argmax())]


def triangle_samples(vertices, triangles, spacing, most):
    """Points inside the edges and the triangles of a closed mesh, more in those larger than ``spacing``.

    The middle of every triangle is among them, and that of every edge that is cut in two: a smooth surface
    that meets a flat triangle at its corners is farthest from it there. An edge is cut like the triangle in
    which it leads to the vertex of larger number.
    """
    corners, heads = vertices[triangles], np.roll(triangles, -1, axis=1)
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    spacing = max(spacing, np.sqrt(area.sum() / most))
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
