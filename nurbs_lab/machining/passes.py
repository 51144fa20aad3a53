"""Where the passes of a finishing program go, as polylines of cutter locations."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import binary_closing, binary_dilation, minimum_filter
from scipy.spatial import cKDTree

from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.field import TipField, tip_field
from nurbs_lab.machining.fit import Path
from nurbs_lab.machining.waterlines import runs, waterlines

SPLIT = np.radians(45.0)  # slope between raster (below) and waterlines (above)
CLIFF = np.radians(75.0)  # the raster leaves out steeper slopes
FIRST_LEVEL = 0.45  # tolerances: rise of waterlines from contact with the level face along which they go
GAP = 1.0  # diameters: shorter gaps in a waterline are cut too, so that the tool stays down
LEVEL = 1e-7  # relative: a face whose heights, or whose normal's height from 1, differ by less is level
LEVEL_STEP = 1.2  # radii of the flat disc: distance of passes over level faces
GRID = 24  # nodes of the grid along a diameter, at most
WIDTH = 0.5  # step-overs: distance of its nodes
HIDDEN = 0.5  # of the part's slope: where the grid shows less, it hides a step lower than its cells are wide
NEAR = 0.25  # fraction of the step-over: a waterline farther from the part than this is dropped
APART = 0.5  # step-overs: least distance between the middles of short passes
SAME = 0.1  # tolerances: a waterline this close above a lower one, as on an upright wall, is left out


def step_over(cutter, scallop):
    """Distance in space between two passes that leave cusps of height ``scallop`` on a plane of any slope.

    Two arcs of the corner leave the cusp of a ball. Passes farther apart leave stairs, highest on a slope of
    45 degrees: their sharp corner, half the distance high, less what the rounding of the corner takes.
    """
    r, slope = cutter.corner_radius, cutter.shape[2]
    if slope < np.inf:  # on a level face the sides leave ridges, on steep ones the edge below the cylinder
        ridge = 2.0 * scallop / max(slope, 1.0)
        smooth = scallop < r * (1.0 - 1.0 / np.sqrt(1.0 + slope * slope))
        return max(ridge, 2.0 * np.sqrt(scallop * (2.0 * r - scallop))) if smooth else ridge
    if scallop <= (1.0 - np.sqrt(0.5)) * r or (cutter.flat_radius == 0.0 and scallop < r):
        return 2.0 * np.sqrt(scallop * (2.0 * r - scallop))
    if cutter.flat_radius == 0.0:
        return 2.0 * r
    return min(2.0 * scallop + (2.0 * np.sqrt(2.0) - 2.0) * r, max(LEVEL_STEP * cutter.flat_radius, r))


def level_faces(part, cutter):
    """Heights of the level faces of a part that face up and are no smaller than the square of the cutter."""
    up = part.normals[:, 2] * np.sign(part.volume) > 1.0 - LEVEL
    digits = np.abs(part.bounds).max() * LEVEL
    keys, place = np.unique(np.rint(part.tree.corners[up, 2] / digits), return_inverse=True)
    areas = np.bincount(place, 0.5 * np.linalg.norm(part.tree.normals[up], axis=1), len(keys))
    return keys[areas > cutter.diameter**2] * digits


@dataclass(frozen=True, eq=False)
class Layout:
    """Heights and slopes of the tip's surface over the part, and the step-over."""

    touch: Contact
    cutter: Cutter
    field: TipField
    slope: np.ndarray
    step: float

    @property
    def level_step(self):
        """Distance of passes over level faces: the flat disc of the cutter covers what is between them."""
        return max(self.step, LEVEL_STEP * self.cutter.flat_radius)

    def with_steps(self, tips, normals):
        """This layout with the slope of the part at its ``tips (n, 3)`` where the grid hides it.

        It makes a gentle ramp of a step that is lower than its cells are wide. The least slope near a node
        counts, and at nodes near no tip that of the nodes beside them.
        """
        steep = np.full(self.slope.shape, np.inf)
        np.minimum.at(steep, self.field.index(tips[:, :2]), np.arccos(normals[:, 2].clip(0.0, 1.0)))
        steep = np.where(np.isinf(steep), minimum_filter(steep, 3), steep)
        low = np.isfinite(steep) & (steep > SPLIT) & (self.slope > LEVEL) & (self.slope < HIDDEN * steep)
        return replace(self, slope=np.where(low, steep, self.slope))

    def paths(self, tips):
        """The first passes near the tips ``(n, 3)``, enough on surfaces of small curvature."""
        slope, wanted = self.slope, self._near(tips)
        paths = self._waterlines(wanted & self._steep, 0.0)
        level = (slope <= LEVEL) & (self.level_step > self.step)
        for some, spacing in ((level, self.level_step), ((slope <= SPLIT) & ~level, None)):
            size = max(2, int(np.ceil(self.cutter.flat_radius / self.field.step))) if spacing else 2
            some = binary_dilation(some & wanted, np.ones((3, 3)), iterations=size)
            paths += self._raster(some, 0.0, spacing)
        return paths

    @property
    def _steep(self):
        """The nodes on steep slopes and next to them, so that waterlines follow their feet."""
        return binary_dilation(self.slope > SPLIT, np.ones((3, 3)))

    def _near(self, tips):
        """The nodes next to a tip."""
        near = np.zeros(self.field.z.shape, bool)
        near[self.field.index(tips[:, :2])] = True
        return binary_dilation(near, np.ones((3, 3)))

    def paths_between(self, tips):
        """Passes near the tips ``(n, 3)``, half-way between the first ones."""
        near = self._near(tips)
        return self._waterlines(near & self._steep, 0.5) + self._raster(near & (self.slope <= SPLIT), 0.5)

    def short_paths(self, tips, left):
        """Short passes along the raster through those of the tips ``(n, 3)`` where most is left."""
        near, free, chosen = cKDTree(tips), np.ones(len(tips), bool), []
        for i in np.argsort(-left):
            if free[i]:
                chosen.append(i)
                free[near.query_ball_point(tips[i], APART * self.step)] = False
        along = np.eye(3)[np.argmax(self.field.z.shape)] * self.field.step
        points = tips[chosen, None] + np.array([[-1.0], [0.0], [1.0]]) * along
        points[..., 2] = self.touch.heights(points[..., :2].reshape(-1, 2)).reshape(-1, 3)
        return [Path(some, None) for some in points if some[:, 2].min() > self.field.floor]

    def _levels(self, shift):
        """Heights of the waterlines: evenly spaced, and without a shift those along level faces too."""
        field, spacing = self.field, self.step * np.sin(SPLIT)
        above = 2.0 * FIRST_LEVEL * self.touch.allowance
        levels = np.arange(field.floor + above + shift * spacing, field.z.max(), spacing)
        if shift == 0.0:
            faces = level_faces(self.touch.part, self.cutter) + self.touch.allowance + above
            levels = np.concatenate([levels, faces[(faces > field.floor) & (faces < field.z.max())]])
        return np.unique(levels)

    def _lowest(self, points, inward, levels):
        """Whether no lower waterline comes as close to the part: on an upright wall the lowest is enough."""
        below = levels[np.maximum(np.searchsorted(levels, points[:, 2] - 1e-12) - 1, 0)]
        aside = points[:, :2] - 2.0 * SAME * self.touch.allowance * inward
        return (self.touch.heights(aside) > below) | (below >= points[:, 2])

    def _waterlines(self, wanted, shift):
        field, levels = self.field, self._levels(shift)
        size = int(GAP * self.cutter.diameter / field.step / 2)

        def needed(points, inward, slack):
            keep = wanted[field.index(points[:, :2])]
            corner = points[keep]
            corner[:, :2] += self.cutter.flat_radius * inward[keep]
            corner[:, 2] += self.cutter.corner_radius
            near = self.cutter.corner_radius + NEAR * self.step + slack
            if self.cutter.kind == "cone":  # its side may be what touches
                near = self.cutter.radius + self.cutter.length
            keep[keep] = self.touch.part.tree.distances(corner) <= near
            if shift == 0.0:
                if not slack:
                    keep[keep] = self._lowest(points[keep], inward[keep], levels)
                    keep = binary_dilation(keep)  # into the corner between a slope and an upright wall
                keep = binary_closing(np.pad(keep, size), iterations=size)[size : size + len(keep)]
            return keep

        found = waterlines(self.touch, field, levels, needed)
        return [Path(np.vstack([p, p[:2]]) if closed else p, p[0, 2], closed) for p, closed in found]

    def _raster(self, wanted, shift, spacing=None):
        """Straight passes along the longer side of the part, interrupted where the part is too steep."""
        field, spacing = self.field, spacing or self.step * np.cos(SPLIT)
        wanted = wanted & (self.slope < CLIFF) & (field.z > field.floor)
        along = int(np.argmax(field.z.shape))
        rows = np.flatnonzero(wanted.any(axis=along))
        if not len(rows):
            return []
        nodes = field.nodes
        low, high = nodes[1 - along][rows[[0, -1]]]
        origin = field.origin[1 - along]
        first, last = np.floor((low - origin) / spacing), np.ceil((high - origin) / spacing)
        rows = origin + spacing * (np.arange(first, last + 1) + shift)
        xy = np.empty((len(rows), len(nodes[along]), 2))
        xy[..., along], xy[..., 1 - along] = nodes[along], rows[:, None]
        keep = wanted[field.index(xy.reshape(-1, 2))].reshape(xy.shape[:2])
        points = np.dstack([xy, np.full(keep.shape, field.floor)])
        points[keep, 2] = np.maximum(self.touch.heights(xy[keep]), field.floor)
        keep &= points[..., 2] > field.floor
        paths = []
        for line, kept in zip(points, keep, strict=True):
            cliffs = np.flatnonzero(np.abs(np.diff(line[:, 2])) > np.tan(CLIFF) * field.step) + 1
            for part, k in zip(np.split(line, cliffs), np.split(kept, cliffs), strict=True):
                paths += [Path(run, None) for run, _ in runs(part, k, False)]
        return paths


def layout(touch, cutter, scallop, floor) -> Layout:
    """The layout for a part, from a grid of tips half a step-over apart."""
    step = step_over(cutter, scallop)
    grid = max(WIDTH * step, cutter.diameter / GRID)
    field = tip_field(touch, grid, floor, cutter.radius + touch.allowance + 2 * grid)
    return Layout(touch, cutter, field, field.slope, step)
