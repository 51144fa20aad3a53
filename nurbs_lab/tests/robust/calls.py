"""The public functions and methods of the rooms that compute, with a good example of every argument."""

import dataclasses
import hashlib
from collections.abc import Mapping

import numpy as np
import pyvista
import trimesh
from scipy.interpolate import BSpline, NdBSpline

import nurbs_lab as nl
from nurbs_lab import machining

KNOTS = np.array([0, 0, 0, 0, 0.5, 1, 1, 1, 1])
LINE = np.array([(0, 0, 0), (1, 0, 0.25), (2, 1, 0), (3, 1, 1), (4, 0, 1.5)])
WEIGHTS = np.array([1, 2, 3, 2, 1.5])
PLANE = np.stack(np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij"), axis=-1)
GRID = np.dstack([PLANE, PLANE[..., 0] ** 2 / 8 - PLANE[..., 1] / 4])
CURVE = nl.NurbsCurve(3, KNOTS, LINE, WEIGHTS)
SURFACE = nl.interpolate_surface(GRID)
BALL = trimesh.creation.icosphere(subdivisions=2, radius=4.0)
BLOCK = trimesh.creation.box(extents=(6.0, 4.0, 2.0))
BALL_CUTTER = nl.Cutter("ball", diameter=2.0)
CUT = nl.NurbsCurve(1, [0, 0, 1, 1], [(0.0, 0.0, 4.0), (3.0, 0.0, 4.0)])
ARC = np.round(2**9 * np.exp(1j * np.arange(30) / 20)).view(float).reshape(-1, 2) / 2**6  # exact as float32
CLOUD = np.asarray(BALL.vertices).astype(np.float32).astype(float)
LIMITS = {"speed": 4.0, "acceleration": 40.0, "period_s": 2.0**-6}
SOFT = {"jerk": 4000.0, "chord_error": 0.25, "start_speed": 0.0, "end_speed": 0.0}
AXES = {
    "centripetal_acceleration": 30.0,
    "axis_speed": np.array([4.0, 3.0, 2.0]),
    "axis_acceleration": np.array([40.0, 30.0, 20.0]),
}
FEED = nl.plan_feed(CURVE, **LIMITS)
PATH = nl.trace(CURVE, FEED)
GRAPH = nl.mesh.mesh_graph(BALL)
(LAYER,) = nl.slice_mesh(GRAPH, [0.25])
U, V = np.array([0.125, 0.5, 0.75]), np.array([0.25, 0.5, 1.0])

#: Name -> function and good arguments. Arrays hold values that float32 holds exactly.
NURBS = {
    "NurbsCurve": (nl.NurbsCurve, {"degree": 3, "knots": KNOTS, "control_points": LINE, "weights": WEIGHTS}),
    "NurbsCurve.__call__": (CURVE, {"u": U}),
    "NurbsCurve.derivative": (CURVE.derivative, {"u": U, "order": 2}),
    "NurbsCurve.derivatives": (CURVE.derivatives, {"u": U, "order": 2}),
    "NurbsCurve.curvature": (CURVE.curvature, {"u": U}),
    "NurbsCurve.tangent": (CURVE.tangent, {"u": U}),
    "NurbsCurve.normal": (CURVE.normal, {"u": U}),
    "NurbsCurve.binormal": (CURVE.binormal, {"u": U}),
    "NurbsCurve.torsion": (CURVE.torsion, {"u": U}),
    "NurbsCurve.translate": (CURVE.translate, {"offset": np.array([1.0, -2.0, 0.5])}),
    "NurbsCurve.rotate": (CURVE.rotate, {"angle": 0.5, "axis": (0, 1, 1), "center": (1, 0, 0)}),
    "NurbsCurve.scale": (CURVE.scale, {"factor": np.array([1.0, 2.0, -0.5]), "center": (1, 0, 0)}),
    "NurbsCurve.join": (lambda other: CURVE.join(other), {"other": CURVE.translate(LINE[-1] - LINE[0])}),
    "NurbsCurve.to_pyvista": (CURVE.to_pyvista, {}),
    "NurbsCurve.length": (CURVE.length, {"u0": 0.25, "u1": 0.75}),
    "NurbsCurve.parameter_at": (CURVE.parameter_at, {"length": np.array([0.5, 2.0])}),
    "NurbsCurve.closest_point": (CURVE.closest_point, {"points": LINE}),
    "NurbsCurve.insert_knot": (CURVE.insert_knot, {"u": 0.25, "times": 2}),
    "NurbsCurve.refine": (CURVE.refine, {"parameters": np.array([0.25, 0.75])}),
    "NurbsCurve.remove_knot": (CURVE.remove_knot, {"u": 0.5, "tolerance": 10.0}),
    "NurbsCurve.elevate_degree": (CURVE.elevate_degree, {"times": 2}),
    "NurbsCurve.split": (CURVE.split, {"u": 0.25}),
    "NurbsCurve.reverse": (CURVE.reverse, {}),
    "NurbsCurve.clamped": (nl.interpolate_curve(LINE, closed=True).clamped, {}),
    "NurbsCurve.beziers": (CURVE.beziers, {}),
    "NurbsCurve.transform": (
        CURVE.transform,
        {"matrix": np.array([[0.0, 1.0, 0.5], [2.0, 0.0, 0.25]]), "offset": np.array([1.0, -2.0])},
    ),
    "NurbsCurve.to_scipy": (nl.NurbsCurve(3, KNOTS, LINE).to_scipy, {}),
    "NurbsCurve.from_scipy": (nl.NurbsCurve.from_scipy, {"spline": BSpline(KNOTS, LINE, 3)}),
    "NurbsSurface": (
        nl.NurbsSurface,
        {"degrees": (3, 3), "knots": SURFACE.knots, "control_points": GRID, "weights": np.ones((5, 6))},
    ),
    "NurbsSurface.__call__": (SURFACE, {"u": U, "v": V}),
    "NurbsSurface.grid": (SURFACE.grid, {"u": U[:2], "v": V}),
    "NurbsSurface.derivative": (SURFACE.derivative, {"u": U, "v": V, "order": (1, 1)}),
    "NurbsSurface.derivatives": (SURFACE.derivatives, {"u": U, "v": V, "order": (1, 1)}),
    "NurbsSurface.normal": (SURFACE.normal, {"u": U, "v": V}),
    "NurbsSurface.closest_point": (SURFACE.closest_point, {"points": LINE}),
    "NurbsSurface.insert_knot": (SURFACE.insert_knot, {"u": 0.25, "times": 2, "direction": "v"}),
    "NurbsSurface.refine": (SURFACE.refine, {"parameters": np.array([0.25, 0.75]), "direction": "u"}),
    "NurbsSurface.remove_knot": (
        SURFACE.insert_knot(0.25).remove_knot,
        {"u": 0.25, "tolerance": 1.0, "direction": "u"},
    ),
    "NurbsSurface.elevate_degree": (SURFACE.elevate_degree, {"times": 1, "direction": "v"}),
    "NurbsSurface.split": (SURFACE.split, {"u": 0.25, "direction": "v"}),
    "NurbsSurface.reverse": (SURFACE.reverse, {"direction": "v"}),
    "NurbsSurface.clamped": (nl.interpolate_surface(GRID, closed=(True, False)).clamped, {}),
    "NurbsSurface.iso_curve": (SURFACE.iso_curve, {"u": 0.25}),
    "NurbsSurface.iso_curve along u": (SURFACE.iso_curve, {"v": 0.25}),
    "NurbsSurface.transform": (
        SURFACE.transform,
        {"matrix": np.diag([1.0, 2.0, 4.0]), "offset": np.array([1.0, -2.0, 0.5])},
    ),
    "NurbsSurface.to_scipy": (SURFACE.to_scipy, {}),
    "NurbsSurface.from_scipy": (
        nl.NurbsSurface.from_scipy,
        {"spline": NdBSpline(SURFACE.knots, GRID, (3, 3))},
    ),
    "NurbsSurface.curvature": (SURFACE.curvature, {"u": U, "v": V}),
    "NurbsSurface.translate": (SURFACE.translate, {"offset": np.array([1.0, -2.0, 0.5])}),
    "NurbsSurface.rotate": (SURFACE.rotate, {"angle": 0.5, "axis": (0, 1, 1), "center": (1, 0, 0)}),
    "NurbsSurface.scale": (SURFACE.scale, {"factor": 2.0, "center": (1, 0, 0)}),
    "NurbsSurface.tessellate": (SURFACE.tessellate, {"tolerance": 0.125}),
    "NurbsSurface.to_pyvista": (SURFACE.to_pyvista, {}),
    "interpolate_curve": (
        nl.interpolate_curve,
        {
            "points": LINE,
            "degree": 3,
            "parametrization": "chord",
            "closed": False,
            "parameters": np.arange(5),
            "executor": None,
        },
    ),
    "approximate_curve": (
        nl.approximate_curve,
        {
            "points": LINE,
            "degree": 2,
            "tolerance": 0.25,
            "closed": False,
            "executor": None,
        },
    ),
    "interpolate_surface": (
        nl.interpolate_surface,
        {
            "grid": GRID,
            "degrees": (3, 2),
            "parametrization": "chord",
            "closed": (False, False),
            "executor": None,
        },
    ),
    "skin": (
        nl.skin,
        {"curves_or_contours": [LINE, LINE + 1, LINE + 3, LINE + 4], "degrees": (2, 3), "samples": 12},
    ),
    "arc": (
        nl.nurbs.arc,
        {"radius": 2.0, "start": 0.5, "end": 3.0, "center": np.ones(3), "normal": np.array([0.0, 0.5, 1.0])},
    ),
    "circle": (nl.nurbs.circle, {"radius": 2.0, "center": np.ones(3), "normal": np.array([0.0, 0.5, 1.0])}),
    "revolve": (nl.nurbs.revolve, {"profile": CURVE, "angle": 2.0}),
    "cylinder": (nl.nurbs.cylinder, {"radius": 2.0, "height": 3.0}),
    "sphere": (nl.nurbs.sphere, {"radius": 2.0}),
    "torus": (nl.nurbs.torus, {"major": 3.0, "minor": 1.0}),
}
MESH = {
    "mesh_graph": (nl.mesh.mesh_graph, {"mesh": BALL}),
    "MeshGraph.division_mark": (GRAPH.division_mark, {"layer": LAYER}),
    "check_mesh": (nl.mesh.check_mesh, {"mesh": BALL}),
    "slice_mesh": (
        nl.slice_mesh,
        {
            "mesh": BALL,
            "heights": np.array([-1.5, 0.25, 2.0]),
            "axis": np.array([0.0, 0.5, 1.0]),
            "fill": "nonzero",
            "executor": None,
        },
    ),
}
MOTION = {
    "plan_feed": (nl.plan_feed, {"curve": CURVE, **LIMITS, **SOFT, "executor": None}),
    "plan_feed with axes": (nl.plan_feed, {"curve": CURVE, **LIMITS, **AXES}),
    "plan_windows": (
        lambda **given: list(nl.motion.plan_windows(**given)),
        {"curves": [CURVE], **LIMITS, **SOFT, **AXES},
    ),
    "plan_program": (nl.motion.plan_program, {"curves": [CURVE], **LIMITS}),
    "trace": (
        nl.trace,
        {"curve": CURVE, "feed": FEED, "stepper": "adams", "period_s": 2.0**-6, "executor": None},
    ),
    "trace with an override": (
        nl.trace,
        {"curve": CURVE, "feed": FEED, "period_s": 2.0**-6, "override": np.array([(0.25, 0.5), (0.5, 1.0)])},
    ),
    "trace at one speed": (nl.trace, {"curve": CURVE, "feed": 4.0, "period_s": 2.0**-6}),
    "trace with trials": (
        nl.trace,
        {"curve": CURVE, "feed": FEED, "stepper": "chord-corrected", "trials": 1},
    ),
    "ToolPath.statistics": (PATH.statistics, {"metric": "arc", "undisturbed": True}),
    "FeedProfile": (
        nl.motion.FeedProfile,
        {
            "times": np.array([0.0, 1.0, 2.0]),
            "terms": np.array([[0, 0, 2, 0], [2, 4, -2, 0]]),
            "period_s": 0.5,
            "limited_by": ("acceleration", "acceleration"),
        },
    ),
    "FeedProfile.displacement": (FEED.displacement, {"t": V}),
    "FeedProfile.speed": (FEED.speed, {"t": V}),
    "FeedProfile.acceleration": (FEED.acceleration, {"t": V}),
    "FeedProfile.jerk": (FEED.jerk, {"t": V}),
    "FeedProfile.limiting": (FEED.limiting, {"t": V}),
    "FeedProfile.time_at": (FEED.time_at, {"length": V}),
    "FeedProfile.portion": (FEED.portion, {"start": 0.25, "stop": 0.5}),
    "apply_override": (nl.motion.apply_override, {"feed": FEED, "override": [(0.25, 0.5), (0.5, 1.0)]}),
    "FeedProfile.stretches": (FEED.stretches, {}),
}
CUTTING = {
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
    "stock_around": (machining.stock_around, {"part": BLOCK, "margin": 1.0}),
    "Move": (machining.Move, {"kind": "cut", "curve": CUT, "feed": 20.0, "line": 3}),
    "blend": (nl.interchange.blend, {"points": ARC, "tolerance": 0.125}),
    "smooth": (nl.smooth, {"program_or_points": ARC, "tolerance": 0.01}),
}
#: What plain Python has time for.
QUICK = NURBS | MESH | MOTION | CUTTING


def leaves(value):
    """The arrays, words and lengths that a result is made of, in their order."""
    if isinstance(value, trimesh.Trimesh):
        value = (value.vertices, value.faces)
    elif isinstance(value, pyvista.DataSet):
        value = value.points
    elif isinstance(value, (BSpline, NdBSpline)):
        value = (value.t, value.c, value.k)
    elif isinstance(value, Mapping):
        value = list(value.items())
    elif dataclasses.is_dataclass(value):
        value = [getattr(value, field.name) for field in dataclasses.fields(value)]
    if isinstance(value, (list, tuple)):
        yield np.array(len(value))
        for part in value:
            yield from leaves(part)
    else:
        leaf = np.ascontiguousarray("" if value is None else value)
        assert leaf.dtype != object, value
        yield leaf


def fingerprint(value):
    """A hash of a result to its last bit."""
    digest = hashlib.sha256()
    for leaf in leaves(value):
        digest.update(f"{leaf.dtype}{leaf.shape}".encode() + leaf.tobytes())
    return digest.hexdigest()
