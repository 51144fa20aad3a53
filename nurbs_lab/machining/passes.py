"""Where the passes of a finishing program go, as polylines of cutter locations."""

import numpy as np
from scipy.ndimage import binary_dilation

from nurbs_lab.machining.field import tip_field
from nurbs_lab.machining.waterlines import runs, waterlines

FLAT_ANGLES = np.radians(np.arange(30.0, 71.0, 5.0))
CLIFF = np.radians(75.0)  # steeper than this no raster goes
FIRST_LEVEL = 1e-3  # above the floor, in mm
GAP_MM = 3.0  # a path that is not needed for less than this goes on


def step_over(cutter, scallop):
    """Distance in space between two passes of the corner that leave a cusp of height ``scallop`` on a plane."""
    r = cutter.corner_radius
    if scallop < r:
        return 2.0 * np.sqrt(scallop * (2.0 * r - scallop))
    return 2.0 * r


def split_angle(field):
    """The slope that parts raster from waterlines so that both together are shortest."""
    on = field.z > field.floor
    slope = np.minimum(field.slope[on], np.radians(85.0))
    rise = np.tan(slope)
    total = [
        np.sum(slope < angle) / np.cos(angle) + np.sum(rise[slope >= angle]) / np.sin(angle)
        for angle in FLAT_ANGLES
    ]
    return float(FLAT_ANGLES[np.argmin(total)])


def lay_out(touch, cutter, scallop, floor, angle=None):
    """Paths ``(points (n, 3), closed, kind)`` that leave no more than ``scallop`` between them."""
    step = step_over(cutter, scallop)
    field = tip_field(touch, step, floor, cutter.radius + touch.allowance + 2 * step)
    angle = split_angle(field) if angle is None else angle
    levels = np.arange(floor + FIRST_LEVEL, field.z.max(), step * np.sin(angle))
    near = cutter.corner_radius + scallop * 8

    def steep(points, inward, slack):
        keep = field.slope[field.index(points[:, :2])] > angle
        chosen = np.flatnonzero(keep)[::3]
        corner = points[chosen] + np.column_stack(
            [cutter.flat_radius * inward[chosen], np.full(len(chosen), cutter.corner_radius)]
        )
        touching = touch.part.tree.distances(corner) <= near + slack
        keep[np.flatnonzero(keep)] = np.repeat(touching, 3)[: keep.sum()]
        return _joined(keep, step)

    lines = [(*path, "waterline") for path in waterlines(touch, field, levels, steep)]
    return field, lines + [(*path, "raster") for path in raster(touch, field, angle, step * np.cos(angle))]


def _joined(keep, step):
    size = max(int(GAP_MM / step / 2), 1)
    return ~binary_dilation(~binary_dilation(keep, iterations=size), iterations=max(size - 2, 1))


def raster(touch, field, angle, spacing):
    """Straight passes over what is not steep, along the longer side of the part."""
    shallow = (field.slope <= angle) & (field.z > field.floor)
    wanted = binary_dilation(shallow, np.ones((3, 3)), iterations=2) & (field.slope < CLIFF) & (field.z > field.floor)
    if not wanted.any():
        return []
    along = int(np.argmax(field.z.shape))
    nodes = field.nodes
    across = np.flatnonzero(wanted.any(axis=along))
    low, high = nodes[1 - along][across[[0, -1]]]
    count = int(np.ceil((high - low) / spacing)) + 1
    rows = np.linspace(low, high, count)
    xy = np.empty((count, len(nodes[along]), 2))
    xy[..., along], xy[..., 1 - along] = nodes[along], rows[:, None]
    points = np.dstack([xy, touch.heights(xy.reshape(-1, 2)).reshape(xy.shape[:2])])
    keep = wanted[field.index(xy.reshape(-1, 2))].reshape(xy.shape[:2]) & (points[..., 2] > field.floor)
    paths = []
    for line, kept in zip(points, keep, strict=True):
        paths += runs(line, kept, False)
    return paths
