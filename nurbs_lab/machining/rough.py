"""Roughing: offset contours of the region to be cleared, level by level."""

import numpy as np
from scipy.ndimage import distance_transform_edt

from nurbs_lab.common.checks import as_choice, as_kind, as_not_negative, as_positive, lengths
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.progress import bar
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import contact
from nurbs_lab.machining.field import TipField, require_size, tip_field
from nurbs_lab.machining.fit import Path
from nurbs_lab.machining.link import link
from nurbs_lab.machining.part import part_named, prepare_part
from nurbs_lab.machining.program import Machine, Program
from nurbs_lab.machining.simulate import needle
from nurbs_lab.mesh.read import without_cache
from nurbs_lab.mesh.slicing.planes import slice_mesh

STEP_OVER = 0.5  # fraction of the diameter: distance between contours
GRID = 12  # nodes of the grid along a diameter
MOST_LEVELS = 2e3  # largest number of levels
PLACES = 4  # at which a curve is compared with each segment of its contour
TOLERANCE = 0.1  # fraction of the grid step: tolerance of the curves through the contours


@one_or_many("stock", send=without_cache)
def rough(
    part,
    stock,
    cutter,
    step_down,
    stock_to_leave,
    *,
    feed=50.0,
    clearance=5.0,
    direction="climb",
    machine=None,
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
        Thickness of the material left on the part all round, in mm.
    feed, clearance, direction, machine
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
    part, stock = prepare_part(part), part_named("stock", stock)
    cutter, step_down = as_kind("cutter", cutter, Cutter), as_positive("step_down", step_down)
    leave, feed = as_not_negative("stock_to_leave", stock_to_leave), as_positive("feed", feed)
    clearance = as_positive("clearance", clearance)
    as_choice("direction", direction, ("climb", "conventional"))
    machine = Machine() if machine is None else as_kind("machine", machine, Machine)
    part.require_closed()
    stock.require_closed("stock")
    low, high = stock.bounds
    step = cutter.diameter / GRID
    touch = contact(part, cutter, leave)
    floor = float(max(low[2], part.bounds[0, 2]))
    require_size((high[2] - floor) / step_down, MOST_LEVELS, "step_down is too small", "levels")
    field = tip_field(
        contact(stock, cutter), step, float(low[2]), step, wrong="cutter is too small for this stock"
    )
    outside = needle(part, field) > needle(stock, field) + 1e-6
    if outside.any() or (part.bounds[0, :2] < low[:2] - 1e-6).any() or (part.bounds[1] > high + 1e-6).any():
        raise ValueError("part is above its stock; give a larger stock, such as machining.stock_around(part)")
    tip, paths = touch.heights(field.places()).reshape(field.z.shape), []
    levels = [*np.arange(high[2] - step_down, floor, -step_down), floor]
    for level in bar(levels, len(levels), "clearing", " levels"):
        inside = np.pad((tip <= level) & (field.z > level), 1)
        off = distance_transform_edt(inside)[1:-1, 1:-1] * step
        depths = np.arange(step, off.max(), STEP_OVER * cutter.diameter)
        hill = TipField(field.origin, step, off, 0.0).surface()
        for layer in reversed(slice_mesh(hill, depths)):  # from the middle outwards, nearest to the part last
            paths += [_path(ring, level, step) for ring in layer.contours if len(ring.points) > 3]
    if not paths:
        raise ValueError("stock holds nothing that this cutter can clear; use a smaller cutter")
    top = high[2] + clearance
    moves = link(paths, touch, floor, top, feed, machine, direction, through_stock=True)
    return Program(moves, cutter, machine, TOLERANCE * step)


def _path(ring, level, step):
    """A contour as a path with the material on its left; the cleared region is inside."""
    points = ring.points[::-1]
    if ring.closed:
        points = np.vstack([points, points[:1]])
    points = np.column_stack([points, np.full(len(points), level)])
    points = points[np.append(True, lengths(np.diff(points, axis=0)) > 1e-3 * step)]
    part = np.arange(PLACES)[:, None] / PLACES
    dense = (points[:-1, None] + part * np.diff(points, axis=0)[:, None]).reshape(-1, 3)
    return Path(np.vstack([dense, points[-1:]]), level).fitted(TOLERANCE * step)
