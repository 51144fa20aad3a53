"""The JSON of geomdl (NURBS-Python), also read by its command line tools."""

import json

import numpy as np

from nurbs_lab.interchange._export_items import clamped
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

WANTED = "a file of geomdl is {'shape': {'type': 'curve' or 'surface', 'count': ..., 'data': [...]}}"


def write(path, parts):
    surfaces = [*parts.surfaces, *(surface for solid in parts.solids for surface in solid.surfaces)]
    if parts.curves and surfaces:
        raise ValueError("items: a .json file holds either curves or surfaces; write two files")
    kind, data = "curve" if parts.curves else "surface", [*map(_entry, parts.curves or surfaces)]
    with path.open("w", encoding="utf-8") as file:
        json.dump({"shape": {"type": kind, "count": len(data), "data": data}}, file)


def read(path):
    try:
        shape = json.loads(path.read_text(encoding="utf-8-sig"))["shape"]
        build = {"curve": _to_curve, "surface": _to_surface}[shape["type"]]
        found = [build(entry) for entry in shape["data"]]
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"missing, or of another kind: {error}; {WANTED}") from error
    if len(found) != (promised := shape.get("count", len(found))):
        raise ValueError(f"it promises {promised!r} shapes and holds {len(found)}; it is damaged")
    return found


def _entry(shape):
    shape = clamped(shape)
    if isinstance(shape, NurbsCurve):
        own = {"degree": shape.degree, "knotvector": shape.knots.tolist()}
    else:
        names = "degree_u", "degree_v", "knotvector_u", "knotvector_v", "size_u", "size_v"
        values = *shape.degrees, *(knots.tolist() for knots in shape.knots), *shape.weights.shape
        own = dict(zip(names, values, strict=True))
    points = shape.control_points.reshape(-1, shape.dim).tolist()
    net = {"points": points, "weights": shape.weights.ravel().tolist()}
    return {"type": "spline", "rational": True, "dimension": shape.dim, **own, "control_points": net}


def _to_curve(entry):
    return NurbsCurve(entry["degree"], entry["knotvector"], *_net(**entry["control_points"]))


def _to_surface(entry):
    (points, weights), size = _net(**entry["control_points"]), (entry["size_u"], entry["size_v"])
    return NurbsSurface(
        (entry["degree_u"], entry["degree_v"]),
        (entry["knotvector_u"], entry["knotvector_v"]),
        np.reshape(points, (*size, -1)),
        None if weights is None else np.reshape(weights, size),
    )


def _net(points, weights=None):
    return points, weights  # and no other word, which may be a damaged one of them
