"""The material around a part: what a program starts from, and what is left of it as it is planned."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh
from scipy.ndimage import maximum_filter

from nurbs_lab.common.checks import as_floats, as_not_negative, freeze, lengths
from nurbs_lab.machining import _kernels_sweep as kernels
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import NEEDLE, Contact, contact
from nurbs_lab.machining.field import TipField, empty_field
from nurbs_lab.machining.part import part_named, prepare_part
from nurbs_lab.nurbs.measure import samples_along

CELLS = 24  # along a diameter, of the grids of material and of passes while a program is planned
MOST_CELLS = 4e6
TIP_SPACING = 0.5  # cells: distance between tips along a curve
HALF = np.sqrt(0.5)  # steps of the grid: half the diagonal of a cell
INSIDE = 0.01  # cells: so far a part may be outside its stock, by rounding
RIM = 2.0  # tolerances from the rim of a cutter: what two passes along one wall scrape off it is no bite


@np.errstate(over="ignore")  # of trimesh, for blocks beyond 1e75 mm
def stock_around(part, margin=None) -> trimesh.Trimesh:
    """The block around a part.

    Parameters
    ----------
    part : as for `drop_cutter`
    margin : float
        Distance of the block's sides and top from the part, in mm; 2 by default, but no more than a third of
        the part's largest extent.
    """
    low, high = prepare_part(part).bounds.copy()
    margin = min(2.0, (high - low).max() / 3.0) if margin is None else as_not_negative("margin", margin)
    low[:2] -= margin
    high += margin
    return trimesh.creation.box(bounds=(low, high))


def needle(part, field) -> np.ndarray:
    """Heights ``(nx, ny)`` of the upper side of a part at the nodes of a field, -inf beside it."""
    return Contact(part, NEEDLE, 0.0).heights(field.places()).reshape(field.z.shape)


def stock_field(stock, step, wider=0.0) -> TipField:
    """Heights of a stock by `as_stock` at nodes ``step`` mm apart, or the highest ``wider`` mm around."""
    wrong = "resolution is too fine for this stock"
    if isinstance(stock, TipField):
        high = stock.origin + stock.step * (np.array(stock.z.shape) - 1)
        field = empty_field(stock.origin, high, step, stock.floor, wrong)
        z = maximum_filter(stock.z, size=2 * int(np.ceil(wider / stock.step)) + 3) if wider else stock.z
        return replace(field, z=z[stock.index(field.places())].reshape(field.z.shape))
    low, high = bounds_of(stock)
    field = empty_field(low[:2], high[:2], step, float(low[2]), wrong)
    if isinstance(stock, np.ndarray):
        return replace(field, z=np.full(field.z.shape, float(high[2])))
    held = field.places().clip(low[:2], high[:2])  # a node beside the stock stands for a strip at its side
    z = needle(stock, replace(field, at=held.reshape(*field.z.shape, 2)))
    if wider:
        wide = contact(stock, Cutter("flat", diameter=2.0 * wider)).heights(held)
        z = np.maximum(z, wide.reshape(z.shape))
    return replace(field, z=np.maximum(z, field.floor))


def as_stock(stock, part=None):
    """What an argument ``stock`` says: a block (2, 3), a field of heights, or a closed part.

    By default it is the box of the part.
    """
    if stock is None and part is not None:
        return part.bounds
    stock = getattr(stock, "field", stock)  # what `simulate` returns
    if isinstance(stock, TipField):
        return stock
    if isinstance(stock, (np.ndarray, list, tuple)):
        block = freeze(as_floats("stock", stock))
        if block.shape != (2, 3) or not (block[0] < block[1]).all():
            raise ValueError(f"stock as a block is its least and its largest corner, (2, 3), got {stock!r}")
        return block
    stock = part_named("stock", stock)
    stock.require_closed("stock")
    return stock


def require_inside(part, stock, cutter):
    """Refuse a part that is not inside its stock by `as_stock`."""
    step, (low, high), (least, most) = cell_of(stock, cutter), bounds_of(stock), part.bounds
    outside = max((low - least).max(), (most - high).max())
    if not isinstance(stock, np.ndarray):
        # A wall is as uncertain as a height.
        field = stock if isinstance(stock, TipField) else stock_field(stock, step, INSIDE * step)
        outside = max(outside, (needle(part, field) - field.z).max())
    if outside > INSIDE * step:
        raise ValueError(
            f"part is not inside its stock: up to {outside:.3g} mm of it are outside; give a larger stock, "
            "such as machining.stock_around(part)"
        )


def cell_of(stock, cutter, cells=CELLS):
    """Step of the grid that holds the material."""
    area = np.prod(np.ptp(bounds_of(stock), axis=0)[:2])
    return max(cutter.diameter / cells, float(np.sqrt(area / MOST_CELLS)))


def bounds_of(stock) -> np.ndarray:
    """Least and largest x, y, z of a stock by `as_stock`, ``(2, 3)``."""
    return stock if isinstance(stock, np.ndarray) else stock.bounds


def depths(stock, above, points) -> np.ndarray:
    """Depth of points ``(n, 3)`` in a stock, the distance from its nearest side or ``above (n,)`` if less."""
    low, high = bounds_of(stock)[:, :2]
    sides = np.minimum(points[:, :2] - low, high - points[:, :2]).min(axis=1).clip(0.0)
    return np.where(np.isfinite(above), np.minimum(above, sides), np.inf)


def material_of(stock, cutter, before=None, share=1.0):
    """Upper bounds of the stock for a cutter, after the moves of the program ``before``."""
    step = cell_of(stock, cutter, CELLS / share)
    field = stock_field(stock, step, HALF * step)  # upper bounds for the whole cell about each node
    if before is not None:
        material = Material(field, before.cutter)
        for move in before.moves:
            if move.kind != "rapid":
                material.cut(move.curve)
    return Material(field, cutter)


@dataclass(frozen=True, eq=False)
class Material:
    """Upper bounds of the heights of the material in the cells of a grid, which change as it is cut."""

    field: TipField
    cutter: Cutter

    def along(self, curve) -> np.ndarray:
        """Points of a curve, half a cell apart, ``(n, 3)``."""
        size = lengths(np.diff(curve.control_points, axis=0)).sum()
        return samples_along(curve, int(size / (TIP_SPACING * self.field.step)) + 2)[1]

    def above(self, points) -> np.ndarray:
        """Height of the material over points ``(n, 3)``, infinite where there is none."""
        field, xy = self.field, points[:, :2]
        (low, high), up = field.bounds[:, :2] + [[-field.step], [field.step]], field.z[field.index(xy)]
        inside = ((xy >= low) & (xy <= high)).all(axis=1) & (up >= points[:, 2] - field.step)
        return np.where(inside, np.maximum(up - points[:, 2], 0.0), np.inf)

    def cut(self, curve):
        """Remove what the cutter removes along a curve."""
        none, tips, grow, field = np.empty((0, 2)), self.along(curve), HALF * self.field.step, self.field
        grid = field.z, field.origin, field.step
        kernels.cut(grid, tips, self.cutter.shape, grow, none, field.z, 0.0, 0.0, np.ones(2), np.zeros(3))

    def rest(self, xy, wider=None) -> np.ndarray:
        """Height of the tip from which upwards the cutter certainly touches no material, at ``xy (n, 2)``.

        Material counts that is nearer to the cutter than ``wider``: half the diagonal of a cell and a quarter
        of its side by default, since points of a path are half a side apart. With less than minus the former
        that material does not count which the same cutter would leave beside it in the same place.
        """
        out, field = np.empty(len(xy)), self.field
        wider = (HALF + 0.5 * TIP_SPACING) * field.step if wider is None else wider
        grid, xy = (field.z, field.origin, field.step), np.ascontiguousarray(xy)
        kernels.rest(grid, xy, self.cutter.shape, wider, out)
        return out
