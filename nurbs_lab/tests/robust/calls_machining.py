"""The public functions and methods of the milling room, with a good example of every argument."""

import numpy as np
import trimesh

import nurbs_lab as nl
from nurbs_lab import machining

BLOCK = trimesh.creation.box(extents=(6.0, 4.0, 2.0))
BALL_CUTTER = nl.Cutter("ball", diameter=2.0)
LINE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0.0, 0.0, 4.0), (3.0, 0.0, 4.0)])

MACHINING = {
    "Cutter": (
        nl.Cutter,
        {"kind": "bull", "diameter": 8.0, "corner_radius": 1.0, "length": 40.0, "shank": 10.0},
    ),
    "prepare_part": (machining.prepare_part, {"part": BLOCK, "tessellation": 0.25}),
    "Part.require_closed": (machining.prepare_part(BLOCK).require_closed, {}),
    "drop_cutter": (
        nl.drop_cutter,
        {"part": BLOCK, "cutter": BALL_CUTTER, "xy": np.array([(0.0, 0.0), (3.5, 0.25), (9.0, 9.0)])},
    ),
    "Move": (machining.Move, {"kind": "cut", "curve": LINE, "feed": 20.0}),
}
