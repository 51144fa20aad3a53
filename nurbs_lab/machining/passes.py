"""Where the passes of a finishing program go, as polylines of cutter locations."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import binary_closing, binary_dilation, maximum_filter, minimum_filter
from scipy.spatial import cKDTree

from nurbs_lab.common.checks import lengths
from nurbs_lab.machining._kernels_order import nearest_first
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.field import TipField, tip_field
from nurbs_lab.machining.fit import Path
from nurbs_lab.machining.part import SINGLE
from nurbs_lab.machining.stock import CELLS
from nurbs_lab.machining.waterlines import runs, waterlines

SPLIT = np.radians(45.0)  # slope between raster (below) and waterlines (above)
CLIFF = np.radians(75.0)  # the raster leaves out steeper slopes
RISE = 0.45  # tolerances: of waterlines from contact with level faces, and from lower ones left out for them
GAP = 1.0  # diameters: shorter gaps in a waterline are cut too, so that the tool stays down
LEVEL_STEP = 1.2  # radii of the flat disc: distance of passes over level faces
WIDTH = 0.5  # step-overs: distance of its nodes
NEAR = 0.25  # step-overs: a waterline farther from the part is dropped, a tip farther from it is not at rest
JOIN = 2.0  # step-overs: farther apart, two of them are on two passes
SUBDIVISIONS = 8  # of the way between two of them, which is led over the part


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
    if cutter.flat_radius == 0.0 or scallop <= (1.0 - np.sqrt(0.5)) * r:
        return 2.0 * np.sqrt(min(scallop, r) * (2.0 * r - min(scallop, r)))
    return min(2.0 * scallop + (2.0 * np.sqrt(2.0) - 2.0) * r, max(LEVEL_STEP * cutter.flat_radius, r))


def level_faces(part, cutter):
    """Heights of the level faces of a part that face up and are no smaller than the square of the cutter."""
    up = part.normals[:, 2] * np.sign(part.volume) > 1.0 - SINGLE
    heights, digits = part.tree.corners[up, 2], np.abs(part.bounds).max() * SINGLE
    _, first, place = np.unique(np.rint(heights / digits), return_index=True, return_inverse=True)
    areas = np.bincount(place, 0.5 * lengths(part.tree.normals[up]), len(first))
    return heights[first][areas > cutter.diameter**2]


@dataclass(frozen=True, eq=False)
class Layout:
    """Heights and slopes of the tip's surface over the part, and the step-over."""

    touch: Contact
    cutter: Cutter
    field: TipField
    slope: np.ndarray
    step_over: float

    def with_steps(self, tips, normals):
        """This layout with the slope of the part at its ``tips (n, 3)`` where the grid hides it.

        It makes a gentle ramp of a step that is lower than its cells are wide. The least slope near a node
        counts, and at nodes near no tip that of the nodes beside them.
        """
        steep = np.full(self.slope.shape, np.inf)
        np.minimum.at(steep, self.field.index(tips[:, :2]), np.arccos(normals[:, 2].clip(0.0, 1.0)))
        steep = np.where(np.isinf(steep), minimum_filter(steep, 3), steep)
        steep[np.isinf(steep) | (steep <= SPLIT) | (self.slope <= SINGLE)] = 0.0
        return replace(self, slope=np.maximum(self.slope, steep))

    def paths(self, tips, spared):
        """The first passes near the tips ``(n, 3)``, enough on surfaces of small curvature.

        There is nothing to cut at the tips ``spared (m, 3)``: no waterline passes near them alone.
        """
        slope, near = self.slope, self._near(tips)
        wanted = near[0] < np.inf
        paths = self._waterlines(wanted & (slope > SPLIT), self._levels(), (near, self._near(spared)))
        disc, far = self.cutter.flat_radius, LEVEL_STEP * self.cutter.flat_radius
        level = (slope <= SINGLE) & (far > self.step_over)  # the disc covers what is between passes
        gentle = (slope <= SPLIT) & ~level
        for some, apart, wide in ((level, far, disc), (gentle, self.step_over * np.cos(SPLIT), 0.0)):
            size = 1 + int(wide / self.field.step)
            paths += self._raster(binary_dilation(some & wanted, np.ones((3, 3)), iterations=size), apart)
        return paths

    def _near(self, tips):
        """Heights of the lowest and the highest tip next to each node; at others they are infinite."""
        low, at = np.full(self.field.z.shape, np.inf), self.field.index(tips[:, :2])
        high = -low
        np.minimum.at(low, at, tips[:, 2])
        np.maximum.at(high, at, tips[:, 2])
        return minimum_filter(low, 3) - self.step_over, maximum_filter(high, 3) + self.step_over

    def paths_through(self, tips, left):
        """Passes through those of the tips ``(n, 3)`` where most is ``left``, from each to the nearest one.

        Where the cutter does not come to rest at a tip, as on a wall, a waterline passes near the lowest one.
        """
        tips, off = tips[_spaced(tips, -left, self.field.step)], NEAR * self.step_over
        rests = np.abs(self.touch.heights(tips[:, :2]) - tips[:, 2]) <= off
        paths = self._chains(tips[rests]) if rests.any() else []
        if not rests.all():
            tips = tips[~rests]
            levels = tips[_spaced(tips[:, :2], tips[:, 2], GAP * self.cutter.diameter), 2]
            _, some = np.unique(np.floor(levels / off), return_index=True)
            near = self._near(tips)[0] < np.inf
            paths += self._waterlines(near, np.unique(levels[some] + self._above))
        return paths

    def _chains(self, tips):
        """Paths over the part from each tip to the nearest one, and short ones along the raster elsewhere.

        A path ends where the part is far above or below the straight way, as at a wall, a cliff or a pit.
        """
        order, _ = nearest_first(np.stack([tips, tips], axis=1), np.zeros(len(tips), bool))
        tips, paths, most = tips[order], [], JOIN * self.step_over
        along = np.eye(3)[np.argmax(self.field.z.shape)] * self.field.step
        for chain in np.split(tips, 1 + np.flatnonzero(lengths(np.diff(tips, axis=0)) > most)):
            if len(chain) == 1:
                chain = chain + np.array([[-1.0], [1.0]]) * along
            at = np.arange(SUBDIVISIONS * (len(chain) - 1) + 1) / SUBDIVISIONS
            chain = np.column_stack([np.interp(at, np.arange(len(chain)), one) for one in chain.T])
            over = self.touch.heights(chain[:, :2])
            keep = (over > self.field.floor) & (np.abs(over - chain[:, 2]) <= most)
            chain[:, 2] = over
            paths += [Path(some, None) for some, _ in runs(chain, keep, False)]
        return paths

    @property
    def _above(self):
        """Rise of a waterline from contact with a level face."""
        return 2.0 * RISE * self.touch.allowance

    def _levels(self):
        """Heights of the first waterlines: evenly spaced, and along level faces."""
        field, spacing = self.field, self.step_over * np.sin(SPLIT)
        levels = np.arange(field.floor + self._above, field.z.max(), spacing)
        faces = level_faces(self.touch.part, self.cutter) + self.touch.allowance + self._above
        return np.unique([*levels, *faces[(faces > field.floor) & (faces < field.z.max())]])

    def _lowest(self, points, inward, levels):
        """Whether no lower waterline comes as close to the part: on an upright wall the lowest is enough."""
        below = levels[np.maximum(np.searchsorted(levels, points[:, 2] - 1e-12) - 1, 0)]
        aside = points[:, :2] - self._above * inward
        return (self.touch.heights(aside) > below) | (below >= points[:, 2])

    def _waterlines(self, wanted, levels, heights=None):
        field, size = self.field, int(GAP * self.cutter.diameter / self.field.step / 2)

        def needed(points, inward, slack):
            at, z = field.index(points[:, :2]), points[:, 2]
            keep = wanted[at]
            if heights:  # of the tips wanted near each node, and of those spared, in the first passes
                near, spared = ((low[at] <= z) & (z <= high[at]) for low, high in heights)
                keep &= near | ~spared
                corner = points[keep]
                corner[:, :2] += self.cutter.flat_radius * inward[keep]
                corner[:, 2] += self.cutter.corner_radius
                near = self.cutter.corner_radius + NEAR * self.step_over + slack
                if self.cutter.kind == "cone":  # its side may be what touches
                    near = self.cutter.radius + self.cutter.length
                keep[keep] = self.touch.part.tree.distances(corner) <= near
                if not slack:
                    keep[keep] = self._lowest(points[keep], inward[keep], levels)
                    keep = binary_dilation(keep)  # into the corner between a slope and an upright wall
                keep = binary_closing(np.pad(keep, size), iterations=size)[size : size + len(keep)]
            return keep

        found = waterlines(self.touch, field, levels, needed)
        return [Path(np.vstack([p, p[:2]]) if closed else p, p[0, 2], closed) for p, closed in found]

    def _raster(self, wanted, spacing):
        """Straight passes along the longer side of the part, interrupted where the part is too steep."""
        field = self.field
        wanted = wanted & (self.slope < CLIFF) & (field.z > field.floor)
        along = int(np.argmax(field.z.shape))
        rows = np.flatnonzero(wanted.any(axis=along))
        if not len(rows):
            return []
        nodes = field.nodes
        low, high = nodes[1 - along][rows[[0, -1]]]
        origin = field.origin[1 - along]
        first, last = np.floor((low - origin) / spacing), np.ceil((high - origin) / spacing)
        rows = origin + spacing * np.arange(first, last + 1)
        xy = np.empty((len(rows), len(nodes[along]), 2))
        xy[..., along], xy[..., 1 - along] = nodes[along], rows[:, None]
        keep = wanted[field.index(xy.reshape(-1, 2))].reshape(xy.shape[:2])
        points = np.dstack([xy, np.full(keep.shape, field.floor)])
        points[keep, 2] = self.touch.heights(xy[keep], field.floor)
        keep &= points[..., 2] > field.floor
        paths = []
        for line, kept in zip(points, keep, strict=True):
            paths += [Path(run, None) for run, _ in runs(line, kept, False)]
        return paths


def _spaced(places, order, distance):
    """Numbers of places ``(n, d)`` in this order, each farther than ``distance`` from those before it."""
    near, free, chosen = cKDTree(places), np.ones(len(places), bool), []
    for i in np.argsort(order):
        if free[i]:
            chosen.append(i)
            free[near.query_ball_point(places[i], distance)] = False
    return chosen


def layout(touch, cutter, scallop, floor) -> Layout:
    """The layout for a part, from a grid of tips half a step-over apart."""
    step = step_over(cutter, scallop)
    grid = max(WIDTH * step, cutter.diameter / CELLS)
    field = tip_field(touch, grid, floor, cutter.radius + touch.allowance + 2 * grid)
    return Layout(touch, cutter, field, field.slope, step)
