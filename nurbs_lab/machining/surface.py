"""Samples of a part's surface: which of them a cutter reaches, and how much a program leaves there."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.threads import over_blocks
from nurbs_lab.machining import _kernels_sweep as kernels
from nurbs_lab.machining.drop import NEEDLE, Contact, contact
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

    def thinned(self, spacing):
        """One sample in each cube of this size, and all whose area is at least a quarter of its face."""
        small = self.areas < 0.25 * spacing**2
        if not small.any():
            return self
        cells = ((self.points[small] - self.points.min(axis=0)) / spacing).astype(int)
        cells = np.ravel_multi_index(cells.T, cells.max(axis=0) + 1)
        keep = ~small
        keep[np.flatnonzero(small)[np.unique(cells, return_index=True)[1]]] = True
        return self[keep]


def sample_surface(part, spacing, wrong, most=MOST_SAMPLES) -> Samples:
    """Samples of every triangle outside undercuts, about ``spacing`` mm apart.

    ``wrong`` is the beginning of the error message if there are more than ``most`` of them.
    """
    outward = part.normals * np.where(part.volume < 0.0, -1.0, 1.0)
    up = outward[:, 2] >= -UNDERCUT
    areas = 0.5 * np.linalg.norm(part.tree.normals, axis=1)
    undercut, areas, outward = float(areas[~up].sum()), areas[up], outward[up]
    corners = part.tree.corners[up].reshape(-1, 3, 3)
    sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    first = (sides.argmax(axis=1)[:, None] + np.arange(3)) % 3  # the longest side comes first
    corners, base = np.take_along_axis(corners, first[..., None], axis=1).reshape(-1, 9), sides.max(axis=1)
    height = np.divide(2.0 * areas, base, out=np.zeros_like(areas), where=base > 0.0)
    require_size(np.sum((base / spacing + 1) * (height / spacing + 1)), most, wrong, "samples of the surface")
    points, triangle, shares = kernels.divided(corners, base, height, spacing)
    return Samples(points, outward[triangle], shares, undercut)


def reached(part, cutter, samples, floor, tolerance):
    """Which samples the cutter reaches within the tolerance, and the tip at each of them.

    The tip is that of a cutter in contact with the sample, lifted until its distance from the sample is the
    tolerance. It must neither gouge the part nor lie below the floor.
    """
    tips = kernels.touching(samples.points, samples.normals, cutter.shape, BESIDE, tolerance)
    found = tips[:, 2] >= floor
    found[found] = ~contact(part, cutter).collides(tips[found])
    return found, tips


def visible(part, samples, floor, tolerance):
    """Which samples are seen from above and lie above the floor: a thin enough cutter reaches them."""
    above = samples.points + BESIDE * samples.normals + (0.0, 0.0, tolerance)
    return (samples.points[:, 2] >= floor - tolerance) & ~Contact(part, NEEDLE, 0.0).collides(above)


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
    first, lowest, order = kernels.into_cells(tips, low, size, nx, ny)
    tips, cells = tips[order], (first, lowest, low, size, nx, ny)

    def kernel(block):
        kernels.left(points[block], tips, cells, cutter.shape, reach, out[block])

    over_blocks(kernel, len(points), "measuring what is left")
    return out
