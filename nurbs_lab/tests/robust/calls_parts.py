"""Calls that build whole parts and programs, and with them all calls of the rooms that compute."""

import numpy as np
import trimesh

import nurbs_lab as nl
from nurbs_lab import machining
from nurbs_lab.tests.robust.calls import BALL, BALL_CUTTER, BLOCK, CLOUD, QUICK

BUILT = nl.reconstruct(BALL, tolerance=1.0)
PROGRAM = nl.finish(BLOCK, BALL_CUTTER, scallop=0.25, tolerance=0.0625)
STOCK = machining.stock_around(BLOCK, margin=1.0)
PART = trimesh.creation.box(extents=(9.0, 7.0, 1.0))
FOUND = nl.verify(PROGRAM, BLOCK, spacing=0.5)

PARTS = {
    "mesh_from_points": (nl.mesh_from_points, {"points": CLOUD, "normals": CLOUD}),
    "reconstruct": (
        nl.reconstruct,
        {
            "mesh": BALL,
            "tolerance": 1.0,
            "sharp_angle": 30.0,
            "max_faces": 10_000,
            "executor": None,
        },
    ),
    "Reconstruction.to_mesh": (BUILT.to_mesh, {"tolerance": 0.5}),
    "Reconstruction.report": (BUILT.report, {}),
    "Shell.to_mesh": (BUILT.shells[0].to_mesh, {"tolerance": 0.5}),
    "finish": (
        nl.finish,
        {
            "part": BLOCK,
            "cutter": BALL_CUTTER,
            "scallop": 0.25,
            "tolerance": 0.0625,
            "feed": 20.0,
            "machine": machining.MACHINE,
            "executor": None,
        },
    ),
    "verify": (nl.verify, {"program": PROGRAM, "part": BLOCK, "spacing": 0.5, "executor": None}),
    "Verification.percentile": (FOUND.percentile, {"percent": 99.0}),
    "rough": (
        nl.rough,
        {
            "part": BLOCK,
            "stock": STOCK,
            "cutter": BALL_CUTTER,
            "step_down": 1.0,
            "stock_to_leave": 0.25,
            "feed": 20.0,
            "machine": machining.MACHINE,
            "executor": None,
        },
    ),
    "simulate": (nl.simulate, {"program": PROGRAM, "stock": STOCK, "resolution": 0.5, "executor": None}),
    "Simulation.remaining": (nl.simulate(PROGRAM, STOCK, 0.5).remaining, {"part": PART}),
    "Program": (
        machining.Program,
        {"moves": PROGRAM.moves, "cutter": BALL_CUTTER, "machine": machining.MACHINE, "tolerance": 0.0625},
    ),
}
CALLS = QUICK | PARTS
#: Name and argument of every array in them.
ARRAYS = [
    (name, argument)
    for name, (_, good) in CALLS.items()
    for argument, value in good.items()
    if isinstance(value, np.ndarray)
]
