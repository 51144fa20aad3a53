"""Pictures of milling: programs coloured by kind, milled parts, remaining material, the moving cutter."""

import itertools
from dataclasses import replace

import numpy as np
import pyvista as pv
from scipy.spatial import cKDTree

from nurbs_lab.machining import prepare_part, simulate
from nurbs_lab.machining.stock import as_stock
from nurbs_lab.plotting.general import animation
from nurbs_lab.plotting.solids import MATERIAL, triangles
from nurbs_lab.plotting.stage import CLAY, frame, polylines, scene, takes_stage
from nurbs_lab.plotting.style import BLUE, GREEN, GREY, ORANGE, PINK, SIGNED, canvas, takes_axes

KINDS = {"cut": (BLUE, 2.0), "link": (ORANGE, 5.0), "plunge": (GREEN, 5.0), "rapid": (PINK, 5.0)}  # , width
SPACING = 0.4  # mm between the points that are drawn
MOST_NODES = 500_000  # of a block that are drawn


@takes_stage
def program(program, *, part=None, stage=None, title=None):
    """The moves of a program in space: cuts blue and thin, links orange, plunges green, rapids pink.

    Parameters
    ----------
    program : Program
    part : as for `drop_cutter`, optional
        Drawn under the moves.
    """
    if part is not None:
        stage.add_mesh(_surface(part), color=CLAY, **MATERIAL)
    for kind, (colour, width) in KINDS.items():
        curves = [move.curve for move in program.moves if move.kind == kind]
        lines = [c(np.linspace(*c.domain, max(2, int(c.length() / SPACING) + 1))) for c in curves]
        if lines:
            stage.add_mesh(polylines(lines), color=colour, line_width=width)
    return frame(stage, title=title)


@takes_stage
def milled(simulation, *, stage=None, title=None):
    """The block after milling, in space.

    Parameters
    ----------
    simulation : Simulation
    """
    stage.add_mesh(_block(simulation), color=CLAY, smooth_shading=False, **MATERIAL)
    return frame(stage, title=title)


@takes_stage
def reached(verification, part, *, stage=None, title=None):
    """What a program reaches of a part, from above and from below.

    Blue is reached, orange left for a smaller cutter, grey out of reach on three axes.

    Parameters
    ----------
    verification : Verification
    part : as for `drop_cutter`
    """
    sets = verification.points, verification.narrow_points, verification.hidden_points
    part = prepare_part(part)
    surface = _surface(part)
    nearest = cKDTree(np.concatenate(sets)).query(surface.cell_centers().points)[1]
    kinds = np.repeat(np.arange(3), [len(points) for points in sets])[nearest]
    kinds[part.tree.normals[:, 2] * np.sign(part.volume) < 0.0] = 2
    colours = np.array([pv.Color(colour).int_rgb for colour in (BLUE, ORANGE, GREY)], np.uint8)
    surface["reach"] = colours[kinds]
    stage.add_mesh(surface, scalars="reach", rgb=True, **MATERIAL)
    aside = 1.2 * np.ptp(part.bounds[:, 0])
    under = surface.rotate_x(180.0, inplace=False).translate((aside, 0.0, 0.0), inplace=False)
    stage.add_mesh(under, scalars="reach", rgb=True, **MATERIAL)
    return frame(stage, title=title)


@takes_axes
def remaining(simulation, part, *, limit, ax=None):
    """Map of the material left on a part, seen from above.

    Where the part is gouged, the colours meet at zero: gouges are blue, remaining material is red.

    Parameters
    ----------
    simulation : Simulation
    part : as for `drop_cutter`
    limit : float
        End of the scale in mm, such as the scallop.
    """
    left = simulation.remaining(part)
    left[np.isinf(left)] = np.nan
    x, y = simulation.field.nodes
    least, cmap, beyond = (-limit, SIGNED, "both") if np.nanmin(left) < 0 else (0, None, "max")
    words = f"map of the height left on the part, from {least:g} to {limit:g} mm"
    with canvas(7.0, 5.0, ax, words=words) as (figure, ax):
        shown = ax.pcolormesh(
            x, y, 1e3 * left.T, cmap=cmap, vmin=1e3 * least, vmax=1e3 * limit, rasterized=True
        )
        figure.colorbar(shown, ax=ax, label="left on the part, vertically [µm]", extend=beyond)
        ax.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal")
    return figure


def milling(program, stock, *, alt, frames=24, resolution=0.4):
    """The cutter at work on its block: an animation that plays without a kernel.

    Parameters
    ----------
    program : Program
    stock : as for `simulate`
    alt : str
        Alternative text.
    frames : int
        Each takes about 0.1 s of processor time.
    resolution : float
        Of the block, in mm.

    Returns
    -------
    Stored
    """
    stock = as_stock(program.stock if stock is None else stock)
    lengths = np.cumsum([move.curve.length() for move in program.moves])
    counts = np.searchsorted(lengths, lengths[-1] * np.linspace(0.02, 1.0, frames)) + 1
    milled = [stock]

    def draw(moves):
        part = replace(program, moves=tuple(program.moves[slice(*moves)]))
        milled.append(simulate(part, milled.pop(), resolution))
        block = _block(milled[0])
        stage = scene(width=480, height=360)
        stage.add_mesh(block, color=CLAY, smooth_shading=False, **MATERIAL)
        if part.cutter is not None:
            tip = part.moves[-1].curve.control_points[-1]
            stage.add_mesh(_body(part.cutter, tip), color=ORANGE, smooth_shading=True, **MATERIAL)
        frame(stage)
        *room, top = block.bounds
        stage.reset_camera(bounds=(*room, top + (program.cutter.length if program.cutter else 0.0)))
        return stage

    parts = list(itertools.pairwise([0, *np.unique(counts)]))
    return animation(draw, parts, alt=alt, frame_s=0.2)


def _surface(part):
    """The triangles of a part, in the order of its tree."""
    corners = prepare_part(part).tree.corners.reshape(-1, 3)
    return pv.PolyData.from_regular_faces(corners, np.arange(len(corners)).reshape(-1, 3))


def _block(simulation):
    """The upper side of a milled block, with skirts down to its floor."""
    field = simulation.field
    every = int(np.ceil(np.sqrt(field.z.size / MOST_NODES)))
    upper = triangles(replace(field, z=field.z[::every, ::every], step=every * field.step).surface())
    rim = upper.extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )
    plane = pv.Plane(center=(*upper.center[:2], field.floor), i_size=1e4, j_size=1e4)
    skirt = rim.extrude_trim((0, 0, -1), plane)
    return upper.merge(skirt)


def _body(cutter, tip):
    """A cutter as a surface of revolution."""
    a, r, slope, wide = cutter.shape
    turn = np.linspace(0.0, np.arctan(slope), 12)
    low, rim = r - r * np.cos(turn), wide - a - r * np.sin(turn[-1])
    above = low[-1] + (slope * rim if np.isfinite(slope) else 0.0)
    radius = np.concatenate([[0.0], a + r * np.sin(turn), [wide, wide, 0.0]])
    height = np.concatenate([[0.0], low, [above, cutter.length, cutter.length]])
    around = np.linspace(0.0, 2.0 * np.pi, 33)[:, None]
    x, y, z = radius * np.cos(around), radius * np.sin(around), np.broadcast_to(height, (33, len(height)))
    return pv.StructuredGrid(x + tip[0], y + tip[1], z + tip[2]).extract_surface(algorithm=None)
