"""The virtual machine: a program cuts a block of stock, represented by a field of heights."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh

from nurbs_lab.common.checks import as_kind, as_not_negative, as_positive, lengths
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.progress import bar
from nurbs_lab.common.values import Value
from nurbs_lab.machining import _kernels_sweep as kernels
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.field import TipField, empty_field, require_size
from nurbs_lab.machining.part import part_named, prepare_part
from nurbs_lab.machining.program import Program
from nurbs_lab.mesh.read import without_cache

TIP_SPACING = 0.5  # fraction of the resolution: distance between tips
MOST_UPDATES = 1.5e10
TOO_FINE = "resolution is too fine for this stock and program"


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Value):
    """The milled block and the volume that each move removed.

    Attributes
    ----------
    field : TipField
        Heights of the milled block; the floor is its lowest point.
    stock : (nx, ny) array
        Heights before milling.
    volumes : (n,) array
        Volume removed by each move, in mm³: the engagement of the cutter over the program.
    """

    field: TipField
    stock: np.ndarray
    volumes: np.ndarray

    def remaining(self, part) -> np.ndarray:
        """Height of the material left on the part at each node, ``(nx, ny)``; negative in a gouge.

        It is measured vertically, and is infinite beside the part.
        """
        return self.field.z - needle(prepare_part(part), self.field)

    def surface(self) -> trimesh.Trimesh:
        """The upper side of the milled block."""
        return self.field.surface()


def stock_around(part, margin=2.0) -> trimesh.Trimesh:
    """The block around a part.

    Parameters
    ----------
    part : as for `drop_cutter`
    margin : float
        Distance of the block's sides and top from the part, in mm.
    """
    low, high = prepare_part(part).bounds.copy()
    margin = as_not_negative("margin", margin)
    low[:2] -= margin
    high += margin
    return trimesh.creation.box(bounds=(low, high))


@one_or_many("stock", send=without_cache)
def simulate(program, stock, resolution=0.2) -> Simulation:
    """Run a program on a block.

    Parameters
    ----------
    program : Program or list of Program
        Every move cuts, rapid moves included, so that collisions show.
    stock : trimesh.Trimesh, pyvista.PolyData, file name or Part
        For a list of programs, one stock or a list of as many.
    resolution : float
        Distance between nodes of the field, in mm. Sampled tips are half as far apart.
    executor : concurrent.futures.Executor, optional
        Workers for a list; this process by default. The results are equal bit for bit.

    Raises
    ------
    TypeError, ValueError
        Naming the argument.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> from nurbs_lab import machining
    >>> ball = trimesh.creation.icosphere(subdivisions=3, radius=8.0)
    >>> program = nl.finish(ball, nl.Cutter("ball", diameter=6.0), scallop=0.1, tolerance=0.02)
    >>> milled = nl.simulate(program, machining.stock_around(ball), resolution=0.25)
    >>> bool(abs(milled.remaining(ball)[44, 44]) < 0.1)
    True
    """
    program, resolution = as_kind("program", program, Program), as_positive("resolution", resolution)
    if program.cutter is None:
        raise ValueError("program names no cutter; give it one: dataclasses.replace(program, cutter=...)")
    stock = part_named("stock", stock)
    low, high = stock.bounds
    field = empty_field(low[:2], high[:2], resolution, float(low[2]), TOO_FINE)
    cutter = program.cutter
    sizes = [lengths(np.diff(move.curve.control_points, axis=0)).sum() for move in program.moves]
    counts = np.ceil(np.array(sizes) / (TIP_SPACING * resolution)) + 1
    wide = min(cutter.diameter, float(np.linalg.norm((high - low)[:2])))
    updates = counts.sum() * (wide / resolution) ** 2
    require_size(updates, MOST_UPDATES, TOO_FINE, "comparisons of a node with the cutter")
    field = replace(field, z=np.maximum(needle(stock, field), low[2]))
    shape = cutter.flat_radius, cutter.corner_radius
    heights, volumes = field.z.copy(), np.empty(len(program.moves))
    for i, move in enumerate(bar(program.moves, len(program.moves), "milling", " moves")):
        tips = move.curve(np.linspace(*move.curve.domain, int(counts[i])))
        volumes[i] = kernels.cut(heights, field.origin, resolution, tips, *shape)
    return Simulation(replace(field, z=heights), field.z, volumes)


def needle(part, field) -> np.ndarray:
    """Heights ``(nx, ny)`` of the upper side of a part at the nodes of a field, -inf beside it."""
    return Contact(part, 0.0, 0.0, 0.0).heights(field.places()).reshape(field.z.shape)
