"""The virtual machine: a program cuts a block of stock, kept as a field of heights."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh

from nurbs_lab.common.checks import as_kind, as_not_negative, as_positive
from nurbs_lab.common.progress import bar, heard
from nurbs_lab.common.values import Value
from nurbs_lab.machining import _kernels_sweep as kernels
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.field import MOST_NODES, TipField
from nurbs_lab.machining.part import part_named, prepare_part
from nurbs_lab.machining.program import Program

TIP_SPACING = 0.5  # of the resolution


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Value):
    """The milled block and how it came about.

    Attributes
    ----------
    field : TipField
        Heights of the milled block; the floor is its lowest point.
    stock : (nx, ny) array
        Heights before.
    volumes : (n,) array
        What each move took away, in mm³: the engagement of the cutter over the program.
    """

    field: TipField
    stock: np.ndarray
    volumes: np.ndarray

    def remaining(self, part) -> np.ndarray:
        """Height of what is left on the part at each node, ``(nx, ny)``; negative where it is gouged.

        Measured upright; infinite beside the part.
        """
        return self.field.z - needle(prepare_part(part), self.field)

    def surface(self) -> trimesh.Trimesh:
        """The upper side of the milled block."""
        return self.field.surface()


def stock_around(part, margin=2.0) -> trimesh.Trimesh:
    """The upright block around a part.

    Parameters
    ----------
    part : as for `drop_cutter`
    margin : float
        Beside the part and above it, in mm.
    """
    low, high = prepare_part(part).bounds.copy()
    margin = as_not_negative("margin", margin)
    low[:2] -= margin
    high += margin
    return trimesh.creation.box(bounds=(low, high))


@heard()
def simulate(program, stock, resolution=0.2) -> Simulation:
    """Run a program on a block.

    Parameters
    ----------
    program : Program
        Every move cuts, the rapid ones too: so a collision shows.
    stock : trimesh.Trimesh, pyvista.PolyData, file name or Part
    resolution : float
        Distance of the nodes of the field, in mm. Places of the tip are half as far apart.

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
    field = _field(stock, resolution)
    before, heights = field.z, field.z.copy()
    shape = (program.cutter.flat_radius, program.cutter.corner_radius)
    volumes = np.empty(len(program.moves))
    for i, move in enumerate(bar(program.moves, len(program.moves), "milling", " moves")):
        control = move.curve.control_points
        size = np.linalg.norm(np.diff(control, axis=0), axis=1).sum()
        u = np.linspace(*move.curve.domain, int(size / (TIP_SPACING * resolution)) + 2)
        volumes[i] = kernels.cut(heights, field.origin, resolution, move.curve(u), *shape)
    return Simulation(TipField(field.origin, resolution, heights, field.floor), before, volumes)


def _field(stock, step):
    low, high = stock.bounds
    counts = np.ceil((high - low)[:2] / step).astype(int) + 1
    if counts.prod() > MOST_NODES:
        raise ValueError(f"resolution is too fine for this stock: {counts.prod():.3g} nodes; give more mm")
    origin = 0.5 * (low + high)[:2] - 0.5 * step * (counts - 1)
    field = TipField(origin, step, np.full(counts, low[2]), float(low[2]))
    return replace(field, z=np.maximum(needle(stock, field), low[2]))


def needle(part, field) -> np.ndarray:
    """Heights ``(nx, ny)`` of the upper side of a part at the nodes of a field, -inf beside it."""
    xy = np.stack(np.meshgrid(*field.nodes, indexing="ij"), axis=-1).reshape(-1, 2)
    return Contact(part, 0.0, 0.0, 0.0).heights(xy).reshape(field.z.shape)
