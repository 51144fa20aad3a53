"""The public functions and methods of the milling room, with a good example of every argument."""

import numpy as np
import trimesh

import nurbs_lab as nl
from nurbs_lab import machining

BLOCK = trimesh.creation.box(extents=(6.0, 4.0, 2.0))
BALL_CUTTER = nl.Cutter("ball", diameter=2.0)
LINE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0.0, 0.0, 4.0), (3.0, 0.0, 4.0)])

PROGRAM = nl.finish(BLOCK, BALL_CUTTER, scallop=0.25, tolerance=0.0625)
STOCK = machining.stock_around(BLOCK, margin=1.0)
PART = trimesh.creation.box(extents=(9.0, 7.0, 1.0))
FOUND = nl.verify(PROGRAM, BLOCK, spacing=0.5)

ARC = np.round(2**9 * np.exp(1j * np.arange(30) / 20)).view(float).reshape(-1, 2) / 2**6  # exact as float32

MACHINING = {
    "Cutter": (
        nl.Cutter,
        {"kind": "bull", "diameter": 8.0, "corner_radius": 1.0, "length": 40.0, "shank": 10.0},
    ),
    "prepare_part": (machining.prepare_part, {"part": BLOCK, "tessellation": 0.25}),
    "Part.require_closed": (machining.prepare_part(BLOCK).require_closed, {"name": "part"}),
    "drop_cutter": (
        nl.drop_cutter,
        {"part": BLOCK, "cutter": BALL_CUTTER, "xy": np.array([(0.0, 0.0), (3.5, 0.25), (9.0, 9.0)])},
    ),
    "finish": (
        nl.finish,
        {
            "part": BLOCK,
            "cutter": BALL_CUTTER,
            "scallop": 0.25,
            "tolerance": 0.0625,
            "feed": 20.0,
            "floor": -1.0,
            "clearance": 2.0,
            "direction": "conventional",
            "machine": machining.Machine(),
        },
    ),
    "verify": (nl.verify, {"program": PROGRAM, "part": BLOCK, "spacing": 0.5}),
    "Verification.percentile": (FOUND.percentile, {"percent": 99.0}),
    "Verification.fraction_above": (FOUND.fraction_above, {"height": 0.25}),
    "stock_around": (machining.stock_around, {"part": BLOCK, "margin": 1.0}),
    "rough": (
        nl.rough,
        {
            "part": BLOCK,
            "stock": STOCK,
            "cutter": BALL_CUTTER,
            "step_down": 1.0,
            "stock_to_leave": 0.25,
            "feed": 20.0,
            "clearance": 2.0,
            "direction": "conventional",
            "machine": machining.Machine(),
        },
    ),
    "simulate": (nl.simulate, {"program": PROGRAM, "stock": STOCK, "resolution": 0.5}),
    "Simulation.remaining": (nl.simulate(PROGRAM, STOCK, 0.5).remaining, {"part": PART}),
    "Simulation.surface": (nl.simulate(PROGRAM, STOCK, 0.5).surface, {}),
    "Machine": (
        machining.Machine,
        {"rapid_speed": 200.0, "acceleration": 2000.0, "jerk": 5e4, "chord_error": 1e-3, "period_s": 1e-3},
    ),
    "Program": (
        machining.Program,
        {
            "moves": PROGRAM.moves,
            "cutter": BALL_CUTTER,
            "machine": machining.Machine(),
            "tolerance": 0.0625,
        },
    ),
    "Program.trace": (
        machining.Program((machining.Move("cut", LINE, 20.0),)).trace,
        {"stepper": "adams"},
    ),
    "Move": (machining.Move, {"kind": "cut", "curve": LINE, "feed": 20.0, "line": 3}),
    "blend": (nl.interchange.blend, {"points": ARC, "tolerance": 0.125}),
    "smooth": (nl.smooth, {"program_or_points": ARC, "tolerance": 0.01, "corner_deg": 20.0}),
}
