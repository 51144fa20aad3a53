"""The public functions with a good example of every argument, and the bytes of whatever they return."""

import dataclasses
import hashlib
from collections.abc import Mapping

import numpy as np
import trimesh

import nurbs_lab as nl

KNOTS = np.array([0, 0, 0, 0, 0.5, 1, 1, 1, 1])
LINE = np.array([(0, 0, 0), (1, 0, 0.25), (2, 1, 0), (3, 1, 1), (4, 0, 1.5)])
WEIGHTS = np.array([1, 2, 3, 2, 1.5])
PLANE = np.stack(np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij"), axis=-1)
GRID = np.dstack([PLANE, PLANE[..., 0] ** 2 / 8 - PLANE[..., 1] / 4])
CURVE = nl.NurbsCurve(3, KNOTS, LINE, WEIGHTS)
SURFACE = nl.interpolate_surface(GRID)
BALL = trimesh.creation.icosphere(subdivisions=2, radius=4.0)
CLOUD = np.asarray(BALL.vertices).astype(np.float32).astype(float)
LIMITS = {"speed": 4.0, "acceleration": 40.0, "period_s": 2.0**-6}
FEED = nl.plan_feed(CURVE, **LIMITS)

#: Name -> function and good arguments. Arrays hold values that float32 holds exactly.
CALLS = {
    "NurbsCurve": (
        nl.NurbsCurve,
        {"degree": 3, "knots": KNOTS, "control_points": LINE, "weights": WEIGHTS},
    ),
    "NurbsSurface": (
        lambda **arguments: nl.NurbsSurface(knots=SURFACE.knots, **arguments),
        {"degrees": (3, 3), "control_points": GRID, "weights": np.ones((5, 6))},
    ),
    "curve": (CURVE, {"u": np.array([0.125, 0.5, 0.75])}),
    "derivative": (CURVE.derivative, {"u": np.array([0.125, 0.5]), "order": 2}),
    "curvature": (CURVE.curvature, {"u": np.array([0.125, 0.5])}),
    "length": (CURVE.length, {"u0": 0.25, "u1": 0.75}),
    "parameter_at": (CURVE.parameter_at, {"length": np.array([0.5, 2.0])}),
    "curve.closest_point": (CURVE.closest_point, {"points": LINE}),
    "insert_knot": (CURVE.insert_knot, {"u": 0.25, "times": 2}),
    "remove_knot": (CURVE.remove_knot, {"u": 0.5, "tolerance": 10.0}),
    "elevate_degree": (CURVE.elevate_degree, {"times": 2}),
    "split": (CURVE.split, {"u": 0.25}),
    "surface": (SURFACE, {"u": np.array([0.125, 0.5]), "v": np.array([0.25, 0.5])}),
    "surface.grid": (SURFACE.grid, {"u": np.array([0.125, 0.5]), "v": np.array([0.25, 0.5, 1.0])}),
    "surface.derivative": (SURFACE.derivative, {"u": 0.25, "v": 0.5, "order": (1, 1)}),
    "surface.normal": (SURFACE.normal, {"u": 0.25, "v": 0.5}),
    "surface.closest_point": (SURFACE.closest_point, {"points": LINE}),
    "interpolate_curve": (
        nl.interpolate_curve,
        {
            "points": LINE,
            "degree": 3,
            "parametrization": "chord",
            "parameters": np.arange(5),
        },
    ),
    "approximate_curve": (
        nl.approximate_curve,
        {"points": LINE, "degree": 2, "tolerance": 0.25, "closed": False},
    ),
    "interpolate_surface": (
        nl.interpolate_surface,
        {"grid": GRID, "degrees": (3, 2), "parametrization": "chord", "closed": (False, False)},
    ),
    "approximate_surface": (
        nl.nurbs.approximate_surface,
        {"grid": GRID, "degrees": (3, 2), "tolerance": 0.25},
    ),
    "skin": (
        nl.skin,
        {"curves_or_contours": [LINE, LINE + 1, LINE + 3, LINE + 4], "degrees": (2, 3), "samples": 12},
    ),
    "mesh_from_points": (
        nl.mesh_from_points,
        {"points": CLOUD, "normals": CLOUD, "neighbours": 12, "method": "distance"},
    ),
    "slice_mesh": (
        nl.slice_mesh,
        {"mesh": BALL, "heights": np.array([-1.5, 0.25, 2.0]), "axis": np.array([0.0, 0.5, 1.0])},
    ),
    "uniform_heights": (nl.mesh.uniform_heights, {"mesh": BALL, "layer_height": 0.5, "axis": "x"}),
    "adaptive_heights": (
        nl.mesh.adaptive_heights,
        {"mesh": BALL, "cusp": 0.25, "thinnest": 0.125, "thickest": 1.0},
    ),
    "reconstruct": (
        nl.reconstruct,
        {"mesh": BALL, "layers": 6, "tolerance": 1.0, "axis": "z", "adaptive": False},
    ),
    "plan_feed": (
        nl.plan_feed,
        {
            "curve": CURVE,
            **LIMITS,
            "jerk": 4000.0,
            "chord_error": 0.25,
            "axis_speed": np.array([4.0, 3.0, 2.0]),
            "start_speed": 0.0,
        },
    ),
    "trace": (nl.trace, {"curve": CURVE, "feed": FEED, "stepper": "adams", "period_s": 2.0**-6}),
}


def leaves(value):
    """The arrays, words and lengths that a result is made of, in their order."""
    if isinstance(value, trimesh.Trimesh):
        value = (value.vertices, value.faces)
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
