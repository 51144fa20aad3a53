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
from nurbs_lab.machining.field import TipField, require_size, tip_field
from nurbs_lab.machining.fit import Fitting, Path, fit_paths
from nurbs_lab.machining.link import ways_over
from nurbs_lab.machining.part import SINGLE, prepare_part
from nurbs_lab.machining.passes import level_faces
from nurbs_lab.machining.program import MACHINE, Program
from nurbs_lab.machining.stock import HALF, RIM, Material, as_stock, bounds_of, material_of, require_inside
from nurbs_lab.machining.surface import Samples, deepened, reached, sample_surface
from nurbs_lab.machining.waterlines import runs, waterlines
from nurbs_lab.mesh.read import without_cache
from nurbs_lab.mesh.slicing.planes import slice_mesh

FLAT_STEP, BALL_STEP = 0.4, 0.25  # diameters between passes of a flat disc, of a ball; of a bull between
GRID = 12  # nodes of the grid along a diameter
MOST_LEVELS = 2e3  # largest number of levels
FINE = 120  # tolerances of the curves along a diameter
SKIN = 8  # times its thickness: where that is less than the diameter, it stands for the diameter in these
FINEST = 0.125  # diameters: but no less
SLACK = 0.05  # of the step down: less material than this above a level counts as none
TILT = np.tan(np.radians(1.0))  # slope of a level face, at most


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
        Least thickness of the material left on the part, in mm. Level faces keep no more than it and cusps;
        walls keep up to 1/120 of the diameter more, and slopes stairs, up to ``step_down`` high.
    feed, machine
        As for `finish`.

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
    more, which it left at their foot. Upper bounds of the material are kept in cells of 1/24 of the diameter,
    or larger ones on a wide stock; a pass that would meet more is cut in steps from above first. More may be
    met only within 1/20 of the diameter of the cutter's rim, where passes scrape one wall. Where the stock is
    less than 1/8 of the diameter thicker than what is left beside the part, all this is finer, and a warning
    says what is too thin. A slot is cleared if its width exceeds the cutter and what is left by 1/120 of the
    diameter; at its ends 1/12 of the diameter may stay. Where the cutter fits and more than ``step_down`` and
    the cusps stay above it, a warning says so. A face is level up to a slope of one degree, and is left as
    one if the tip has more room over it than 1/6 of the diameter, or if it is level exactly and larger than
    the square of the diameter. Of two that are less than 1/20 of ``step_down`` apart in height, the lower
    keeps as much more.

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
    low, top, material = clearing.tips.floor, clearing.material.field.z.max(), material_of(stock, cutter)
    ways = ways_over(clearing.fitting.touch(0.0), material, low, top, feed, machine)
    paths, levels = [], clearing.levels()
    for level in bar(levels, len(levels), "clearing", " levels"):
        paths += clearing.passes(level, ways.ordered)
    if not paths:
        raise ValueError(
            "stock holds nothing to clear: no room for this cutter beside the part, or hardly more than what "
            "is left; use a smaller cutter or a larger stock"
        )
    return ways.program(paths, clearing.fitting.tolerance, stock, clearing.said)


def clearing_of(part, stock, cutter, leave, step_down):
    """The state of a roughing before its first level."""
    step = cutter.diameter / GRID
    (low, high), floor = bounds_of(stock), float(part.bounds[0, 2])
    require_size((high[2] - floor) / step_down, MOST_LEVELS, "step_down is too small", "levels")
    step_down = min(step_down, high[2] - floor)  # some lengths are fractions of it
    aside = np.array([part.bounds[0] - low, high - part.bounds[1]])[:, :2]
    skin = float(aside[aside > leave + FINEST * cutter.diameter / FINE].min(initial=np.inf)) - leave
    share = np.clip(SKIN * skin / cutter.diameter, FINEST, 1.0)
    fitting = Fitting(part, cutter, share * cutter.diameter / FINE, leave)
    margin = cutter.radius + 4.0 * step + max(float(aside.max()), 0.0)
    tips = tip_field(fitting.touch(0.5), step, floor, margin, "cutter is too small for this stock")
    tips.z[[0, -1]] = tips.z[:, [0, -1]] = floor  # beyond the stock, so that every contour closes
    samples = sample_surface(part, step)
    tips = deepened(tips, fitting.touch(0.5), samples)
    material = material_of(stock, cutter, share=share)
    return Clearing(fitting, material, tips, step_down, skin, samples)


@dataclass(frozen=True, eq=False)
class Clearing:
    """A part, the heights of the tip over it, and the material as it is cleared level by level.

    ``skin`` is the thickness of the thinnest material beside the part, less what is left on it.
    """

    fitting: Fitting
    material: Material
    tips: TipField
    step_down: float
    skin: float
    samples: Samples

    @property
    def said(self):
        """Warnings of a skin too thin to be told from what passes leave on a wall, and of what is left."""
        least = (HALF + 0.5) * self.material.field.step + (RIM + 0.5) * self.fitting.tolerance
        found = ()
        if self.skin < least:
            found = (
                f"beside the part {self.skin:.3g} mm of stock more than is left may stay: this cutter surely "
                f"clears {least:.3g} mm; use a smaller one",
            )
        fits, tips = reached(self.fitting.touch(0.0), self.samples, self.tips.floor, self.fitting.tolerance)
        left = self._top(tips[fits, :2], -self.tips.step) - tips[fits, 2]
        if left.max(initial=0.0) <= self.step_down + self.slack:
            return found
        at = self.samples.points[fits][left.argmax()].round(3)
        return (
            *found,
            f"{left.max():.3g} mm are left where the cutter hardly fits, such as at {at}; use a smaller one",
        )

    @property
    def step_over(self):
        """Distance between passes in mm."""
        cutter = self.fitting.cutter
        share = cutter.flat_radius / cutter.radius
        return (share * FLAT_STEP + (1.0 - share) * BALL_STEP) * cutter.diameter

    @property
    def slack(self):
        """Height in mm that counts as cleared: that of cusps between passes, at least."""
        cutter = self.fitting.cutter
        r, half = cutter.corner_radius, max(0.5 * self.step_over - cutter.flat_radius, 0.0)
        cusp = r - np.sqrt(r * r - half * half) if half < r else 0.0
        return max(cusp * 1.05, SLACK * self.step_down)

    def levels(self):
        """Heights from the top down, no farther apart than the step, on level faces too."""
        stops = [self.material.field.z.max()]
        faces = level_faces(self.fitting.part, self.fitting.cutter) + self.fitting.leave
        for height in np.sort(np.append(self._level_faces(), faces))[::-1]:
            if self.tips.floor + self.slack < height < stops[-1] - self.slack:
                stops.append(height)
        pairs = list(pairwise([*stops, self.tips.floor]))
        counts = [int(np.ceil((a - b) / self.step_down - 1e-9)) for a, b in pairs]
        levels = [np.linspace(a, b, n + 1)[1:] for (a, b), n in zip(pairs, counts, strict=True)]
        return np.concatenate(levels) + SINGLE * self.fitting.cutter.diameter  # rounding makes no contact

    def _level_faces(self):
        """Greatest heights of the tip where it is level over more than where the cutter stands on a point."""
        high, step = ndimage.maximum_filter(self.tips.z, 2), self.tips.step
        faces, count = ndimage.label(high - ndimage.minimum_filter(self.tips.z, 2) <= TILT * step)
        areas = np.bincount(faces.ravel(), minlength=count + 1)[1:] * step**2
        large = areas > np.pi * (self.fitting.cutter.flat_radius + 0.5 * step) ** 2
        return ndimage.maximum(high, faces, 1 + np.flatnonzero(large))

    def passes(self, level, ordered):
        """Passes that clear a level, from where the cutter touches nothing; the material is cut by them.

        Each pass lies one step-over from those before, measured around the part, so that the cutter never
        meets more than about two of them. Passes along the part come last.
        """
        paths = []
        for rings in self._rings(level):
            paths += self._cut(ordered(rings))
        return paths + self._cut(ordered(self._walls(level)))

    def _rings(self, level):
        """Sets of passes where there is material, from without."""
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
        along = np.where(begun, 0.0, np.inf)
        spread(region, along, field.step)
        along[np.isinf(along)] = 0.0
        depths = np.arange(self.step_over, along[region].max() + self.step_over, self.step_over)
        hill = TipField(field.origin, field.step, along, 0.0)
        sets = {}
        for ring, layer in enumerate(slice_mesh(hill.surface(), depths)):
            for contour in layer.contours:
                inside = off[field.index(contour.points)] > 1.5  # steps: the rest is cut along walls
                for points, closed in runs(contour.points, inside, contour.closed):
                    part = parts[field.index(points[:1])][0]
                    sets.setdefault((part, ring), []).append((points, closed))
        return [self._fitted(sets[key], level) for key in sorted(sets)]

    def _top(self, xy, wider=0.0):
        """Height of the tip at ``xy (n, 2)`` at which the cutter, but for its rim, meets no material."""
        return self.material.rest(xy, wider - HALF * self.material.field.step - RIM * self.fitting.tolerance)

    def _cut(self, paths):
        """The paths that meet material, each cut in steps where more than one step of it is in its way."""
        out = []
        for path in paths:
            tips = self.material.along(path.curve)
            above = self._top(tips[:, :2]) - path.level
            if above.max() <= 0.0:
                continue
            steps = (above - self.fitting.tolerance) / self.step_down
            wide = int(self.fitting.cutter.radius * len(tips) / path.curve.domain[1]) + 1
            several = [path]
            for k in range(1, int(np.ceil(steps.max()))):
                deep = ndimage.binary_dilation(steps > k, iterations=wide)
                some = [(points[:, :2], closed) for points, closed in runs(tips, deep, False)]
                several = self._fitted(some, path.level + k * self.step_down) + several
            for one in several:
                self.material.cut(one.curve)
            out += several
        return out

    def _walls(self, level):
        """Passes along the part where material is left there."""

        def engaged(points, _, error):
            return self._top(points[:, :2], error) > level + self.slack

        found = waterlines(self.fitting.touch(0.5), self.tips, np.array([level]), engaged)
        return self._fitted([(points[:, :2], closed) for points, closed in found], level)

    def _fitted(self, contours, level):
        """Contours as paths with the material on their left, none of them nearer to the part than asked."""
        paths = []
        for points, closed in contours:
            if closed:
                points = np.vstack([points, points[:1]])
            points = np.column_stack([points, np.full(len(points), level)])
            points = points[np.append(True, lengths(np.diff(points, axis=0)) > 1e-3 * self.tips.step)]
            if len(points) > 1:
                paths.append(Path(points, level, closed))
        return fit_paths(self.fitting, paths)
