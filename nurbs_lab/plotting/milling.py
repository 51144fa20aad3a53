"""Milling: paths coloured by their feed, milled parts, what is left, the cutter at work."""

import numpy as np

from nurbs_lab.common.checks import as_choice, as_count, as_kind, as_number, as_positive
from nurbs_lab.machining import Program, Simulation, simulate
from nurbs_lab.machining.part import prepare_part
from nurbs_lab.plotting._checks import as_text
from nurbs_lab.plotting.animations import animation
from nurbs_lab.plotting.solids import MATERIAL
from nurbs_lab.plotting.stage import CLAY, frame, on, polylines, scene
from nurbs_lab.plotting.style import BLUE, INK, MAGNITUDE, RED, SIGNED, subplots

COLOURS = {"cut": BLUE, "link": "#E69F00", "plunge": "#009E73", "rapid": RED}
SPACING = 0.5  # mm between the points drawn


def program(program, *, color="feed", part=None, stage=None, title=None):
    """The moves of a program in space.

    Parameters
    ----------
    program : Program
    color : {"feed", "kind"}
        By the speed planned along the path, or by the kind of move: cuts blue, links orange, plunges green,
        rapid moves red.
    part : mesh, optional
        Shown below.
    stage, title
        See `cloud`.

    Returns
    -------
    pyvista.Plotter
    """
    program = as_kind("program", program, Program)
    as_choice("color", color, ("feed", "kind"))
    stage = on(stage, title)
    if part is not None:
        graph = prepare_part(part).graph
        faces = np.column_stack([np.full(len(graph.triangles), 3), graph.triangles]).ravel()
        stage.add_mesh(_surface(graph.vertices, faces), color=CLAY, smooth_shading=True, **MATERIAL)
    if color == "kind":
        for kind, colour in COLOURS.items():
            lines = [_points(move.curve) for move in program.moves if move.kind == kind]
            if lines:
                stage.add_mesh(polylines(lines), color=colour, line_width=1.5)
    else:
        lines = polylines([_points(curve) for curve, _ in program.chains])
        lines["feed, mm/s"] = np.concatenate([_speeds(*pair) for pair in zip(program.chains, program.feeds)])
        bar = {"title": "feed, mm/s", "vertical": True, "position_x": 0.88, "color": INK}
        stage.add_mesh(lines, scalars="feed, mm/s", cmap=MAGNITUDE, line_width=2, scalar_bar_args=bar)
    return frame(stage, title=title)
