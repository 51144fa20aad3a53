"""The JSON of geomdl (NURBS-Python), also read by its command line tools."""

import json

import numpy as np

from nurbs_lab.interchange._export_items import clamped
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

HOLDS = ("curves", "surfaces", "solids")


def write(path, parts):
    if parts.curves and parts.all_surfaces:
        raise ValueError("items: a .json file holds either curves or surfaces; write two files")
    if parts.curves:
        kind, data = "curve", [_curve(clamped(c)) for c in parts.curves]
    else:
        kind, data = "surface", [_surface(clamped(s)) for s in parts.all_surfaces]
    with path.open("w", encoding="utf-8") as file:
        json.dump({"shape": {"type": kind, "count": len(data), "data": data}}, file)


def read(path):
    try:
        shape = json.loads(path.read_text(encoding="utf-8-sig"))["shape"]
        build = {"curve": _to_curve, "surface": _to_surface}[shape["type"]]
        found = [build(entry) for entry in shape["data"]]
        if len(found) != (promised := shape.get("count", len(found))):
            raise ValueError(f"it promises {promised!r} shapes and holds {len(found)}; it is damaged")
        return found
    except (KeyError, TypeError, UnicodeDecodeError, json.JSONDecodeError) as wrong:
        raise ValueError(f"path: {str(path)!r} is no geomdl JSON file ({wrong!r})") from None


def _curve(curve):
    return {
        "type": "spline",
        "rational": True,
        "dimension": curve.dim,
        "degree": curve.degree,
        "knotvector": curve.knots.tolist(),
        "control_points": {"points": curve.control_points.tolist(), "weights": curve.weights.tolist()},
    }


def _surface(surface):
    rows, columns, dim = surface.control_points.shape
    return {
        "type": "spline",
        "rational": True,
        "dimension": dim,
        "degree_u": surface.degrees[0],
        "degree_v": surface.degrees[1],
        "knotvector_u": surface.knots[0].tolist(),
        "knotvector_v": surface.knots[1].tolist(),
        "size_u": rows,
        "size_v": columns,
        "control_points": {
            "points": surface.control_points.reshape(-1, dim).tolist(),
            "weights": surface.weights.ravel().tolist(),
        },
    }


def _to_curve(entry):
    net = entry["control_points"]
    return NurbsCurve(entry["degree"], entry["knotvector"], net["points"], net.get("weights"))


def _to_surface(entry):
    net, size = entry["control_points"], (entry["size_u"], entry["size_v"])
    points, weights = np.array(net["points"]), net.get("weights")
    return NurbsSurface(
        (entry["degree_u"], entry["degree_v"]),
        (entry["knotvector_u"], entry["knotvector_v"]),
        points.reshape(*size, -1),
        None if weights is None else np.reshape(weights, size),
    )
