"""The public functions that draw, with an example of every argument that is no canvas."""

import numpy as np
import trimesh

import nurbs_lab as nl
from nurbs_lab import plotting
from nurbs_lab.motion.leaderboard import Score
from nurbs_lab.tests.robust.calls import BALL, CLOUD, CURVE, FEED, GRAPH, LINE, PATH, SURFACE
from nurbs_lab.tests.robust.calls_parts import PART, PROGRAM, STOCK

SOLID = nl.reconstruct(trimesh.creation.box((4.0, 3.0, 2.0)), tolerance=0.1)
MILLING = nl.machining.Program(PROGRAM.moves[:4], PROGRAM.cutter)
MILLED = nl.simulate(MILLING, STOCK, 0.5)
LAYERS = nl.slice_mesh(BALL, np.linspace(-3.0, 3.0, 6))
LAYER = LAYERS[2]
RING = nl.approximate_curve(LAYER.contours[0].points_3d, tolerance=0.5, closed=True)
TIMES = {"serial": {"paper": 2e-3, "counted": 1e-4}}
SCORE = Score("adams", "line", chord_max=1e-4, chord_rms=1e-5, evaluations_per_step=2.0, ns_per_step=90.0)

PICTURES = {
    "animation": {
        "draw": lambda _: plotting.basis(CURVE),
        "values": [1, 2],
        "alt": "words",
        "frame_s": 0.1,
        "colours": 16,
    },
    "area": {"groups": {"cells": {"serial": 50}}, "limits": {"cells": 100}},
    "basis": {"curve": CURVE},
    "binding": {"path": PATH},
    "chord_error": {},
    "cloud": {"points": CLOUD, "title": "cloud"},
    "control_net": {"surface": SURFACE, "title": "net"},
    "faces": {"solid": SOLID, "title": "faces"},
    "curve": {
        "curve": CURVE,
        "control_polygon": True,
        "knots": True,
        "comb": False,
        "points": LINE,
        "label": "line",
    },
    "deviation": {
        "mesh": BALL,
        "values": BALL.vertices[:, 2],
        "tolerance": 1.0,
        "title": "deviation",
    },
    "drag": {"curve": CURVE},
    "explore": {"draw": lambda: plotting.basis(CURVE)},
    "feed": {"profile": FEED, "limits": {"speed": 4.0}, "curve": CURVE},
    "figure_7": {
        "points": CLOUD,
        "mesh": BALL,
        "layers": LAYERS,
        "surfaces": SURFACE,
        "curves": [RING],
        "width": 400,
        "height": 100,
    },
    "figures_8_to_10": {"path": PATH},
    "milled": {"simulation": MILLED, "title": "milled"},
    "milling": {"program": MILLING, "stock": STOCK, "alt": "words", "frames": 2, "resolution": 0.5},
    "program": {"program": MILLING, "title": "program"},
    "remaining": {"simulation": MILLED, "part": PART, "limit": 0.25},
    "fluctuation": {"paths": PATH, "metric": "arc", "over": "t"},
    "layer": {"layer": LAYER, "order": True},
    "layers": {"layers": LAYERS, "mesh": BALL, "curves": [RING], "title": "layers"},
    "leaderboard": {"rows": [SCORE], "metric": "chord"},
    "lines": {
        "x": np.arange(1.0, 4.0),
        "series": np.ones(3),
        "x_label": "x [mm]",
        "y_label": "y [mm]",
        "log": "x",
        "markers": True,
        "title": "t",
    },
    "mesh": {"mesh": BALL, "edges": True, "title": "ball"},
    "orders": {
        "periods_s": np.array([1e-3, 2e-3]),
        "errors": {"adams": np.array([1.0, 16.0])},
        "y_label": "e",
    },
    "path": {"path": PATH},
    "plane_and_triangle": {"graph": GRAPH, "contour": LAYER.contours[0], "at": 1, "title": "cut"},
    "repeating_node": {"graph": GRAPH, "contour": LAYER.contours[0], "at": 1, "title": "cut"},
    "scene": {"columns": 1, "width": 200, "height": 100},
    "show": {"picture": plotting.basis(CURVE), "alt": "words"},
    "subplots": {"rows": 1, "columns": 2, "width": 4.0, "height": 3.0},
    "surface": {"surfaces": SURFACE, "isocurves": True, "color": "red", "title": "surface"},
    "times": {"groups": TIMES, "period_s": 1e-3},
    "waveform": {"signals": {"clk": [0, 1, 0]}, "clock_hz": 50e6},
    "weighted_graph": {"graph": nl.mesh.mesh_graph(trimesh.creation.box())},
}
PICTURES = {name: (getattr(plotting, name), good) for name, good in PICTURES.items()}
