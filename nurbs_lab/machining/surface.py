"""Samples of a part's surface: which of them a cutter reaches, and how much a program leaves there."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.threads import over_blocks
from nurbs_lab.machining import _kernels_sweep as kernels
from nurbs_lab.machining.drop import contact
from nurbs_lab.machining.field import require_size

BESIDE = 1e-6  # mm: distance from vertical walls, so that rounding does not lift the cutter onto them
MOST_SAMPLES = 1e7
UNDERCUT = 1e-6  # a unit normal that points down by more belongs to an undercut


@dataclass(frozen=True, eq=False)
class Samples:
    """Points ``(n, 3)`` on the part outside its undercuts, and the area of the undercuts.

    Each point has a normal, ``normals (n, 3)``, and represents an area, ``areas (n,)``.
    """

    points: np.ndarray
    normals: np.ndarray
    areas: np.ndarray
    undercut: float

    def __getitem__(self, chosen):
        return Samples(self.points[chosen], self.normals[chosen], self.areas[chosen], self.undercut)


def sample_surface(part, spacing, wrong, most=MOST_SAMPLES) -> Samples:
    """Centroids of equal parts of every triangle outside undercuts, about ``spacing`` mm apart.

    ``wrong`` is the beginning of the error message if there are more than ``most`` of them.
    """
    outward = part.normals * np.where(part.volume < 0.0, -1.0, 1.0)
    up = outward[:, 2] >= -UNDERCUT
    areas = 0.5 * np.linalg.norm(part.tree.normals, axis=1)
    undercut, areas, outward = float(areas[~up].sum()), areas[up], outward[up]
    corners = part.tree.corners.reshape(-1, 3, 3)[up]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    cuts = np.maximum(np.ceil(sides.max(axis=1) / spacing / 1.5), 1)
    require_size(np.sum(cuts**2), most, wrong, "samples of the surface")
    cuts = cuts.astype(int)
    points, normals, parts = [], [], []
    for cut in np.unique(cuts):
        chosen = cuts == cut
        i, j = (k.ravel() for k in np.mgrid[:cut, :cut])
        low, high = i + j < cut, i + j < cut - 1
        weights = np.concatenate(
            [
                np.column_stack([i, j])[low] + 1 / 3,
                np.column_stack([i, j])[high] + 2 / 3,
            ]
        )
        weights = np.column_stack([cut - weights.sum(axis=1), weights]) / cut
        points.append(np.einsum("wk,tkd->twd", weights, corners[chosen]).reshape(-1, 3))
        normals.append(np.repeat(outward[chosen], len(weights), axis=0))
        parts.append(np.repeat(areas[chosen] / cut**2, len(weights)))
    return Samples(*map(np.concatenate, (points, normals, parts)), undercut)


def reached(part, cutter, samples, floor, tolerance):
    """Which samples the cutter reaches within the tolerance, and the tip at each of them.

    The tip is that of a cutter in contact with the sample, lifted until its distance from the sample is the
    tolerance. It must neither gouge the part nor lie below the floor.
    """
    a, r, n = cutter.flat_radius, cutter.corner_radius, samples.normals
    across = np.linalg.norm(n[:, :2], axis=1, keepdims=True)
    rim = np.divide(n[:, :2], across, out=np.zeros_like(n[:, :2]), where=across > 1e-9)
    tips = samples.points + np.column_stack([a * rim + (r + BESIDE) * n[:, :2], r * n[:, 2] - r])
    up = r * np.maximum(n[:, 2], 0.0)
    tips[:, 2] += np.sqrt(up * up + tolerance * (2.0 * r + tolerance)) - up
    found = tips[:, 2] >= floor
    found[found] = ~contact(part, cutter).collides(tips[found])
    return found, tips


def left_over(cutter, tips, points, reach):
    """Distance ``(n,)`` of each point to the nearest of the cutters with tips ``tips``; negative inside.

    Larger distances than ``reach`` are returned as ``reach``.
    """
    out = np.full(len(points), float(reach))
    if not len(tips) or not len(points):
        return out
    low, high = tips.min(axis=0)[:2], tips.max(axis=0)[:2]
    size = max(cutter.radius / 4, float((high - low).max()) / 2000)
    nx, ny = (((high - low) / size).astype(int) + 1).tolist()
    first, lowest, order = kernels.cells(tips, low, size, nx, ny)
    tips, shape = tips[order], (cutter.flat_radius, cutter.corner_radius)

    def kernel(block):
        kernels.left(points[block], tips, first, lowest, low, size, nx, ny, *shape, reach, out[block])

    over_blocks(kernel, len(points), "measuring what is left")
    return out
