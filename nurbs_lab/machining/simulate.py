"""The virtual machine: a program cuts a block of stock, represented by a field of heights."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.checks import as_kind, as_positive, lengths
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.progress import bar
from nurbs_lab.common.values import Value
from nurbs_lab.machining import _kernels_sweep as kernels
from nurbs_lab.machining.field import TipField
from nurbs_lab.machining.part import prepare_part
from nurbs_lab.machining.program import Program
from nurbs_lab.machining.stock import RIM, TIP_SPACING, as_stock, bounds_of, cell_of, needle, stock_field
from nurbs_lab.mesh.read import without_cache
from nurbs_lab.nurbs.measure import samples_along

CONTACTS = (
    ("rapid moves cut", "plan the program for this stock"),
    ("the shank touches", "a longer cutter, or roughing first, avoids it"),
    ("the holder touches", "a longer cutter, or roughing first, avoids it"),
)
WARN_CELLS = 16  # along a diameter, of the simulation that warns


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
    bites : (n,) array
        Height above the tip of the highest material that each move cut off and that came deeper into its
        cutter than twice the tolerance of the program, in mm; two paths along one wall, each within the
        tolerance, scrape off less. Moves shorter than the cutter's diameter count together with those
        before them, up to that length.
    contacts : (n, 3) array
        How deep material was met in each move by rapid motion, by the shank and by the holder, in mm.
    """

    field: TipField
    stock: np.ndarray
    volumes: np.ndarray
    bites: np.ndarray
    contacts: np.ndarray

    def warnings(self) -> tuple[str, ...]:
        """A sentence for each kind of contact that there is."""
        counts, deep = np.count_nonzero(self.contacts, axis=0), self.contacts.max(axis=0, initial=0.0)
        return tuple(
            f"{what} material in {counts[k]} moves, up to {deep[k]:.3g} mm deep; {cure}"
            for k, (what, cure) in enumerate(CONTACTS)
            if counts[k]
        )

    def remaining(self, part) -> np.ndarray:
        """Height of the material left on the part at each node, ``(nx, ny)``; negative in a gouge.

        It is measured vertically, and is infinite beside the part.
        """
        return self.field.z - needle(prepare_part(part), self.field)


@one_or_many("stock", send=without_cache)
def simulate(program, stock=None, resolution=0.2) -> Simulation:
    """Run a program on a block.

    Parameters
    ----------
    program : Program or list of Program
        Every move cuts, rapid moves included, so that collisions show.
    stock : trimesh.Trimesh, pyvista.PolyData, file name, Part, block (2, 3) or Simulation, optional
        For a list of programs, one stock or a list of as many; by default the one of the program.
    resolution : float
        Distance between nodes of the field, in mm. Sampled tips are half as far apart.

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
    program.require_cutter()
    if stock is None and program.stock is None:
        raise ValueError("program does not know its stock; give it, such as machining.stock_around(part)")
    cutter = program.cutter
    stock = as_stock(program.stock if stock is None else stock)
    field = stock_field(stock, resolution)
    edges = 0.5 - np.ptp(field.bounds - bounds_of(stock), axis=0)[:2] / (2.0 * resolution)
    counts = [lengths(np.diff(move.curve.control_points, axis=0)).sum() for move in program.moves]
    counts = np.ceil(np.array(counts) / (TIP_SPACING * resolution)) + 1
    bodies, heights = np.array([sizes for _, *sizes in cutter.bodies]), field.z.copy()
    grid, found = (heights, field.origin, resolution), np.zeros((len(program.moves), 3 + len(bodies)))
    before, since, kind, rim = heights.copy(), 0.0, "", RIM * program.tolerance
    rounding = 16.0 * np.spacing(np.abs(field.bounds).max())  # of tips above and beside what they cut
    for i, move in enumerate(bar(program.moves, len(program.moves), "milling", " moves")):
        if move.kind != kind or since > cutter.diameter:
            before[:], since, kind = heights, 0.0, move.kind
            top = before.max() - bodies[:, 1].min()
        since += TIP_SPACING * resolution * counts[i]
        tips = samples_along(move.curve, int(counts[i]))[1]
        grow = rounding if move.kind == "rapid" else 0.0
        kernels.cut(grid, tips, cutter.shape, grow, bodies, before, top, rim, edges, found[i])
    contacts = np.zeros((len(found), len(CONTACTS)))
    contacts[:, 1 : 1 + len(bodies)] = np.maximum(found[:, 3:], 0.0)
    rapid = [move.kind == "rapid" for move in program.moves]
    contacts[rapid, 0] = found[rapid, 1]
    contacts[contacts < rounding] = 0.0
    return Simulation(replace(field, z=heights), field.z, found[:, 0], found[:, 2], contacts)


def coarse(program) -> Simulation:
    """The program on its stock, on a grid that is fine enough to find contacts."""
    stock = as_stock(program.stock)
    return simulate(program, stock, cell_of(stock, program.cutter, WARN_CELLS))


def warned(program, floor) -> Program:
    """A new program, of tips above a floor, with its warnings: shank and holder may touch material."""
    lowest = max(floor, min(move.curve.control_points[:, 2].min() for move in program.moves))
    if lowest + min(height for *_, height in program.cutter.bodies) >= bounds_of(program.stock)[1, 2]:
        return program
    return replace(program, warnings=(*program.warnings, *coarse(program).warnings()))
