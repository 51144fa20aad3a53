"""Roughing: offset contours of the region to be cleared, level by level."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import ndimage

from nurbs_lab.common.checks import as_kind, as_not_negative, as_positive, lengths
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.progress import bar
from nurbs_lab.machining._kernels_order import spread
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import Contact, contact
from nurbs_lab.machining.field import TipField, require_size, tip_field
from nurbs_lab.machining.fit import Path
from nurbs_lab.machining.link import ways_over
from nurbs_lab.machining.part import prepare_part
from nurbs_lab.machining.program import MACHINE, Program
from nurbs_lab.machining.stock import HALF, RIM, Material, as_stock, bounds_of, material_of, require_inside
from nurbs_lab.machining.waterlines import runs, waterlines
from nurbs_lab.mesh.read import without_cache
from nurbs_lab.mesh.slicing.planes import slice_mesh

FLAT_STEP, BALL_STEP = 0.4, 0.25  # diameters between passes of a flat disc, of a ball; of a bull between
GRID = 12  # nodes of the grid along a diameter
MOST_LEVELS = 2e3  # largest number of levels
TOLERANCE = 0.1  # fraction of the grid step: tolerance of the curves through the contours
CELLS = 48  # along a diameter, of the grid that holds the material while it is cleared
SLACK = 0.02  # diameters: less material than this above a level counts as none
TILT = np.tan(np.radians(1.0))  # slope of a level face, at most
ABOVE = 1e-6  # diameters: height of levels above contact, so that rounding makes no contact


@one_or_many("stock", send=without_cache)
def rough(
    part,
    stock,
    cutter,
    step_down,
    stock_to_leave,
    *,
    feed=50.0,
    machine=MACHINE,
) -> Program:
    """Clear the stock around a part, level by level.

    Parameters
    ----------
    part, stock : trimesh.Trimesh, pyvista.PolyData, file name, Reconstruction or Part
        Both closed; the part lies inside the stock. A list of parts takes one stock or a list of as many.
    cutter : Cutter
    step_down : float
        Distance between levels, in mm.
    stock_to_leave : float
        Least thickness of the material left on the part, in mm, within 1/120 of the diameter. Level faces
        keep no more than it and cusps; slopes keep stairs too, up to ``step_down`` high.
    feed, machine
        As for `finish`.
    executor : concurrent.futures.Executor, optional
        Workers for a list; this process by default. The results are equal bit for bit.

    Returns
    -------
    Program
        A list of them for a list of parts.

    Raises
    ------
    TypeError, ValueError
        If an argument is invalid (the message names it) or the part is not inside its stock.

    Notes
    -----
    The cutter meets material up to ``step_down`` above its tip, and where walls end up to its corner radius
    more, which it left at their foot. Upper bounds of the material are kept in cells of 1/48 of the diameter,
    or larger ones on a wide stock; a pass that would meet more is cut in steps from above first. More may be
    met only within 1/20 of the diameter of the cutter's rim, where passes scrape one wall. A face is level up
    to a slope of one degree, and is left as one if it is wider than 1/6 of the diameter. Of two that are less
    than 1/50 of the diameter apart in height, the lower keeps as much more.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> from nurbs_lab import machining
    >>> ball = trimesh.creation.icosphere(subdivisions=3, radius=8.0)
    >>> stock = machining.stock_around(ball)
    >>> program = nl.machining.rough(ball, stock, nl.Cutter("flat", diameter=6.0), 2.0, 0.3)
    >>> bool((nl.simulate(program, stock).remaining(ball).min() > 0.29))
    True
    """
    part, stock = prepare_part(part), as_stock(stock)
    cutter, step_down = as_kind("cutter", cutter, Cutter), as_positive("step_down", step_down)
    leave = as_not_negative("stock_to_leave", stock_to_leave)
    part.require_closed()
    require_inside(part, stock, cutter)
    clearing = clearing_of(part, stock, cutter, leave, step_down)
    low, top, material = clearing.floor, clearing.material.top, material_of(stock, cutter)
    ways = ways_over(clearing.touch, material, low, top, feed, machine)
    paths, levels = [], clearing.levels(step_down)
    for level in bar(levels, len(levels), "clearing", " levels"):
        paths += clearing.passes(level, step_down, ways.ordered)
    if not paths:
        raise ValueError("stock holds nothing that this cutter can clear; use a smaller cutter")
    return ways.program(paths, clearing.tolerance, stock)


def clearing_of(part, stock, cutter, leave, step_down):
    """The state of a roughing before its first level."""
    step = cutter.diameter / GRID
    touch = contact(part, cutter, leave)
    (low, high), floor = bounds_of(stock), float(part.bounds[0, 2])
    require_size((high[2] - floor) / step_down, MOST_LEVELS, "step_down is too small", "levels")
    aside = np.array([part.bounds[0] - low, high - part.bounds[1]])[:, :2]
    margin = cutter.radius + 4.0 * step + max(float(aside.max()), 0.0)
    tips = tip_field(touch, step, floor, margin, "cutter is too small for this stock")
    return Clearing(touch, cutter, material_of(stock, cutter, cells=CELLS), tips, floor, leave)


@dataclass(frozen=True, eq=False)
class Clearing:
    """A part, the heights of the tip over it, and the material as it is cleared level by level."""

    touch: Contact
    cutter: Cutter
    material: Material
    tips: TipField
    floor: float
    leave: float

    @property
    def tolerance(self):
        """Of the curves, in mm."""
        return TOLERANCE * self.tips.step

    @property
    def step_over(self):
        """Distance between passes in mm."""
        share = self.cutter.flat_radius / self.cutter.radius
        return (share * FLAT_STEP + (1.0 - share) * BALL_STEP) * self.cutter.diameter

    @property
    def slack(self):
        """Height in mm that counts as cleared: that of cusps between passes, at least."""
        r, half = self.cutter.corner_radius, max(0.5 * self.step_over - self.cutter.flat_radius, 0.0)
        cusp = r - np.sqrt(r * r - half * half) if half < r else 0.0
        return max(cusp * 1.05, SLACK * self.cutter.diameter)

    def levels(self, step_down):
        """Heights from the top down, no farther apart than the step less the slack, on level faces too."""
        most, stops = max(step_down - self.slack, 0.5 * step_down), [self.material.top]
        for height in np.sort(self._level_faces())[::-1]:
            if self.floor + self.slack < height < stops[-1] - self.slack:
                stops.append(height)
        pairs = list(pairwise([*stops, self.floor]))
        counts = [int(np.ceil((a - b) / most - 1e-9)) for a, b in pairs]
        levels = [np.linspace(a, b, n + 1)[1:] for (a, b), n in zip(pairs, counts, strict=True)]
        return np.concatenate(levels) + ABOVE * self.cutter.diameter

    def _level_faces(self):
        """Greatest heights of the tip where it is level over more than where the cutter stands on a point."""
        high, step = ndimage.maximum_filter(self.tips.z, 2), self.tips.step
        faces, count = ndimage.label(high - ndimage.minimum_filter(self.tips.z, 2) <= TILT * step)
        areas = np.bincount(faces.ravel(), minlength=count + 1)[1:] * step**2
        large = areas > np.pi * (self.cutter.flat_radius + 0.5 * step) ** 2
        return ndimage.maximum(high, faces, 1 + np.flatnonzero(large))

    def passes(self, level, step_down, ordered):
        """Passes that clear a level, from where the cutter touches nothing; the material is cut by them.

        Each pass lies one step-over from those before, measured around the part, so that the cutter never
        meets more than about two of them. Passes along the part come last.
        """
        field = self.tips
        height = self._top(field.places()).reshape(field.z.shape)
        region = field.z <= level
        wanted = region & (height > level + self.slack)
        if not wanted.any():
            return []
        parts, _ = ndimage.label(region, np.ones((3, 3)))
        off = ndimage.distance_transform_edt(np.pad(region, 1))[1:-1, 1:-1]
        begun = region & ~wanted
        for number in np.setdiff1d(np.unique(parts[wanted]), np.unique(parts[begun])):
            begun[ndimage.maximum_position(off, parts, number)] = True
        along = spread(region, begun, field.step)
        depths = np.arange(self.step_over, along[region].max() + self.step_over, self.step_over)
        depths[-1] = max(along[region].max() - 0.5 * field.step, 0.5 * field.step)
        hill = TipField(field.origin, field.step, np.where(region, along, 0.0), 0.0)
        sets, anchor = {}, np.zeros(2)
        for ring, layer in enumerate(slice_mesh(hill.surface(), depths)):
            for contour in layer.contours:
                ring_points = contour.points
                if contour.closed:  # it begins beside the one before
                    ring_points = np.roll(ring_points, -int(lengths(ring_points - anchor).argmin()), axis=0)
                inside = self._inside(ring_points, off, level)
                for points, closed in runs(ring_points, inside, contour.closed):
                    if len(points) > 2:
                        anchor = points[0]
                        part = parts[field.index(points[:1])][0]
                        sets.setdefault((part, ring), []).append(self._path(points, closed, level))
        paths = []
        for key in sorted(sets):
            paths += self._cut(ordered(sets[key]), step_down)
        return paths + self._cut(ordered(self._walls(level)), step_down)

    def _top(self, xy):
        """Height of the tip at ``xy (n, 2)`` at which the cutter, but for its rim, meets no material."""
        return self.material.rest(xy, -HALF * self.material.field.step - RIM * self.tolerance)

    def _cut(self, paths, step_down):
        """The paths, each cut in steps where more than one step of material stands in its way."""
        out = []
        for path in paths:
            tips = self.material.sweep(path.curve)
            steps = (self._top(tips[:, :2]) - path.level - self.tolerance) / step_down
            wide = int(self.cutter.radius * len(tips) / path.curve.domain[1]) + 1
            for k in range(int(np.ceil(steps.max())) - 1, 0, -1):
                deep = ndimage.binary_dilation(steps > k, iterations=wide)
                for points, closed in runs(tips, deep, False):
                    out.append(self._path(points[:, :2], closed, path.level + k * step_down))
                    self.material.cut(out[-1].curve)
            out.append(path)
            self.material.cut(path.curve)
        return out

    def _inside(self, points, off, level):
        """Which points lie one step inside the region, and off the part."""
        near = off[self.tips.index(points)] > 1.5
        lifted = np.column_stack([points, np.full(len(points), level)])
        near[near] = ~self.touch.collides(lifted[near])
        return near

    def _walls(self, level):
        """Passes along the part where material is left there."""

        def engaged(points, *_):
            return self._top(points[:, :2]) > level + self.slack

        found = waterlines(self.touch, self.tips, np.array([level]), engaged)
        return [self._path(points[:, :2], closed, level) for points, closed in found if len(points) > 2]

    def _path(self, points, closed, level):
        """A contour as a path with the material on its left."""
        if closed:
            points = np.vstack([points, points[:1]])
        points = np.column_stack([points, np.full(len(points), level)])
        points = points[np.append(True, lengths(np.diff(points, axis=0)) > 1e-3 * self.tips.step)]
        return Path(points, level, closed).fitted(self.tolerance)
