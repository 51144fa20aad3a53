"""Certificates of answers: what a right one must fulfil, found without a second implementation of it.

A certificate takes the shape whose method was called (or the function), the arguments and the answer, and
returns how far the answer is off and how far it may be.
"""

import numpy as np

import nurbs_lab as nl

CLOSE = 1e-9  # of the size of what is compared


def wrong(call, given, result):
    """Why an answer cannot be right, or an empty string."""
    from nurbs_lab.tests.robust.calls import leaves

    if any(leaf.dtype.kind == "f" and np.isnan(leaf).any() for leaf in leaves(result)):
        return "NaN"
    shape = getattr(call, "__self__", call)
    known = CERTIFICATES.get(getattr(call, "__name__", ""))
    if known is None or isinstance(result, list):
        return ""
    try:
        for what, off, allowed in known(shape, given, result):
            if not off <= allowed + 1e-300:  # below it, numbers have no digits left
                return f"{what}: {off:g}, allowed {allowed:g}"
    except Exception as error:
        return f"the certificate fails: {type(error).__name__}: {error}"
    return ""


def size_of(shape):
    """The largest coordinate of a shape, or of points."""
    points = shape.control_points if hasattr(shape, "control_points") else np.asarray(shape, float)
    return np.abs(points).max(initial=0.0)


def samples(shape, count=41):
    """Points of a curve ``(n, dim)``, or of a surface ``(n, n, dim)``, even in the parameters."""
    if isinstance(shape, nl.NurbsCurve):
        return shape(np.linspace(*shape.domain, count))
    return shape.grid(*(np.linspace(*domain, count) for domain in shape.domain))


def distances(points, shape):
    """Largest distance of points to a shape."""
    points = np.reshape(points, (-1, shape.dim))
    return shape.closest_point(points)[1].max(initial=0.0)


def _same(shape, given, result):
    """The same points at the same parameters, within a tolerance where one is given."""
    tolerance = given.get("tolerance", 0.0)
    yield "moved", np.abs(samples(result) - samples(shape)).max(), tolerance + CLOSE * size_of(shape)


def _length(shape, given, result):
    low, high = (end if u is None else u for u, end in zip(given.values(), shape.domain, strict=True))
    chord = np.linalg.norm(np.diff(shape(np.linspace(low, high, 400)), axis=0), axis=1).sum()
    rounding = 400 * 3e-15 * size_of(shape)  # of the chords between rational points
    yield "below its chords", chord - abs(result), CLOSE * chord + rounding
    if shape.domain[0] <= min(low, high) and max(low, high) <= shape.domain[1]:
        polygon = np.linalg.norm(np.diff(shape.clamped().control_points, axis=0), axis=1).sum()
        yield "above its polygon", abs(result) - polygon, CLOSE * polygon + rounding


def _closest_point(shape, given, result):
    at, distance = result
    if isinstance(shape, nl.NurbsSurface):
        orders, u, domains = [(1, 0), (0, 1)], tuple(np.moveaxis(at, -1, 0)), shape.domain
    else:
        orders, u, domains = [1], (at,), [shape.domain]
    apart = np.linalg.norm(shape(*u) - np.asarray(given["points"], float), axis=-1)
    scale = size_of(shape) + size_of(given["points"])
    allowed = CLOSE * scale
    for order, domain in zip(orders, domains, strict=True):  # what rounding the parameter moves the point
        slope = np.linalg.norm(shape.derivative(*u, order), axis=-1)
        allowed = allowed + 1e-15 * np.abs(domain).max() * slope.max(initial=0.0)
    yield "not the distance of the point", np.abs(apart - distance).max(initial=0.0), allowed
    grid = samples(shape, 15).reshape(-1, shape.dim)
    given_points = np.reshape(given["points"], (-1, shape.dim))
    nearest = np.linalg.norm(given_points[:20, None] - grid, axis=-1).min(axis=1, initial=np.inf)
    away = (distance.ravel()[:20] - nearest).max(initial=0.0)
    yield "a nearer point exists", away, allowed


def _through(points_name):
    """A fit through points, or within a tolerance of them."""

    def fitted(_, given, result):
        points = given[points_name]
        allowed = given.get("tolerance", 0.0) + CLOSE * (size_of(points) + size_of(result))
        yield "misses its points", distances(points, result), allowed

    return fitted


def _closed(_, given, result):
    yield "open edges", float(not result.is_watertight or not result.is_winding_consistent), 0.0
    yield "volume is negative", -result.volume, 1e-6 * np.ptp(result.vertices, axis=0).max() ** 3


def _planned(_, given, result):
    curve, length = given["curve"], given["curve"].length()
    backward = -np.diff(result.terms[:, 0]).min(initial=0.0)
    yield "another length than the curve", abs(result.length - length), 1e-6 * length
    yield "goes back", backward, CLOSE * length
    wanted = [given.get("start_speed", 0.0), given.get("end_speed", 0.0)]
    off = np.abs(result.speed([0.0, result.duration]) - wanted).max()
    yield "misses the speeds of its ends", off, 1e-6 * given["speed"]
    t = np.linspace(0.0, result.duration, 1000)
    yield "faster than allowed", result.speed(t).max() - given["speed"], 1e-6 * given["speed"]
    over = np.abs(result.acceleration(t)).max() - given["acceleration"]
    yield "accelerates more than allowed", over, 1e-6 * given["acceleration"]
    if given.get("centripetal_acceleration") is not None:
        curve = curve.translate(-curve.control_points[0])  # far from the origin, curvature has no digits
        u = np.linspace(*curve.domain, 200)
        u = u[np.linalg.norm(curve.derivative(u), axis=-1) > 0.0]
        at = result.time_at([curve.length(None, end) for end in u])
        felt = curve.curvature(u) * result.speed(at) ** 2
        limit = given["centripetal_acceleration"]
        yield "centripetal acceleration", felt.max() - limit, 1e-3 * limit


def _traced(_, given, result):
    low, high = given["curve"].domain
    yield "outside the domain", max(low - result.u.min(), result.u.max() - high), CLOSE * (high - low)
    if given.get("stepper") == "rtl":  # its points are rounded to the format's last bit
        return
    off = np.abs(given["curve"](np.clip(result.u, low, high)) - result.points).max(initial=0.0)
    yield "points off the curve", off, CLOSE * size_of(given["curve"])


#: Name of a function or method -> its certificate.
CERTIFICATES = {
    **dict.fromkeys(("insert_knot", "refine", "elevate_degree", "remove_knot", "clamped"), _same),
    **dict.fromkeys(("interpolate_curve", "approximate_curve"), _through("points")),
    "interpolate_surface": _through("grid"),
    "length": _length,
    "closest_point": _closest_point,
    "mesh_from_points": _closed,
    "plan_feed": _planned,
    "trace": _traced,
}
