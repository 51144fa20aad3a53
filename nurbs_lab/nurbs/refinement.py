"""Changes of representation along one direction that leave the shape as it is.

The functions take a degree, knots and homogeneous rows ``(n, m)`` and return ``(degree, knots, rows)``.
Curves pass their control points, surfaces their net, flattened for either direction.
"""

import itertools

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.nurbs import _kernels_shape
from nurbs_lab.nurbs.knots import clamp

CLOSED_WITHIN = 1e-9  # of the extent: ends nearer than this are one point
SAME_KNOT = 1e-13  # of the domain: a parameter this near to a knot means that knot


def domain(degree, knots):
    """First and last parameter."""
    return float(knots[degree]), float(knots[-degree - 1])


def inside(name, u, degree, knots, ends=False):
    """A parameter inside the domain, moved to a knot from which it differs by rounding only.

    With ``ends`` it may also be an end of the domain that is not clamped.
    """
    low, high = domain(degree, knots)
    given = u = float(checks.as_parameters(name, checks.as_number(name, u), (low, high)))
    nearest = knots[np.argmin(np.abs(knots - u))]
    if abs(nearest - u) <= SAME_KNOT * (high - low):
        u = float(nearest)
    open_end = ends and u in (low, high) and np.count_nonzero(knots == u) <= degree
    if not (low < u < high or open_end):
        raise ValueError(f"{name} = {given} must lie inside the domain, not at its ends [{low}, {high}]")
    return u


def refined(degree, knots, rows, finer):
    """The same spline over finer knots, or over a part of its domain."""
    finer = checks.freeze(finer)
    return degree, finer, _kernels_shape.refine(degree, knots, checks.freeze(rows[:]), finer)


def insert(degree, knots, rows, new, name):
    """Every parameter of a list inserted once (NURBS Book A5.4)."""
    new = checks.as_floats(name, new, ("m",))
    new = np.array([inside(name, u, degree, knots, ends=True) for u in new])
    finer = np.sort(np.append(knots, new))
    values, counts = np.unique(finer, return_counts=True)
    low, high = domain(degree, knots)
    crowded = (counts > degree) & (values > low) & (values < high)
    if crowded.any():
        raise ValueError(f"{name}: the knot {values[crowded][0]} would be there more than {degree} times")
    return refined(degree, knots, rows, finer)


def clamped(degree, knots, rows):
    """Both ends of multiplicity degree + 1."""
    low, high = domain(degree, knots)
    inner = knots[(knots > low) & (knots < high)]
    return refined(degree, knots, rows, clamp(np.concatenate([[low], inner, [high]]), degree))


def split(degree, knots, rows, u, name):
    """The part before u and the part after it."""
    u = inside(name, u, degree, knots)
    ends = np.repeat(u, degree + 1)
    return (
        refined(degree, knots, rows, np.concatenate([knots[knots < u], ends])),
        refined(degree, knots, rows, np.concatenate([ends, knots[knots > u]])),
    )


def reverse(degree, knots, rows):
    """The opposite direction over the same domain."""
    low, high = domain(degree, knots)
    least = low if knots[-1] == high else -np.inf  # clamped ends stay exact under rounding
    most = high if knots[0] == low else np.inf
    return degree, np.clip(low + high - knots[::-1], least, most), rows[::-1]


def elevate(degree, knots, rows, times):
    """A degree higher by ``times``, every knot so many times more (by blossoms, Ramshaw 1989)."""
    low, high = domain(degree, knots)
    for _ in range(times):
        values, counts = np.unique(knots, return_counts=True)
        raised = np.repeat(values, counts + 1)
        first = np.searchsorted(raised, low, side="right") - 1 - (degree + 1)
        last = np.searchsorted(raised, high, side="left") + degree + 1
        raised = checks.freeze(raised[first : last + 1])
        rows = _kernels_shape.elevate(degree, knots, checks.freeze(rows[:]), raised)
        degree, knots = degree + 1, raised
    return degree, knots, rows


def value(degree, knots, rows, u):
    """The row at u."""
    return refined(degree, knots, rows, np.full(degree + 2, u))[2][0]


def remove(degree, knots, rows, u, tolerance, columns, name):
    """Remove one knot u, if that moves no point by more than the tolerance (compare A5.8).

    ``rows`` hold homogeneous points of ``columns`` numbers each. The new control points are the
    least-squares solution of the insertion that would undo the removal; its residual bounds the movement.
    """
    tolerance = checks.as_not_negative("tolerance", tolerance)
    u = inside(name, u, degree, knots, ends=True)
    there = int(np.count_nonzero(knots == u))
    if not there:
        raise ValueError(
            f"{name} = {u} is no knot; the inner knots are {np.unique(knots[degree + 1 : -degree - 1])}"
        )
    at = int(np.searchsorted(knots, u))
    less = np.delete(knots, at)
    first, last = at + there - 1 - degree, at - 1  # the rows of the insertion that mix two control points
    index = np.arange(first, last + 1)
    fraction = (u - less[index]) / (less[index + degree] - less[index])
    wanted = rows[index].copy()
    wanted[0] -= (1 - fraction[0]) * rows[first - 1]
    wanted[-1] -= fraction[-1] * rows[last + 1]
    mix = np.zeros((len(index), len(index) - 1))
    for i in range(len(index) - 1):
        mix[i, i], mix[i + 1, i] = fraction[i], 1 - fraction[i + 1]
    solved = np.linalg.lstsq(mix, wanted, rcond=0)[0]
    points = rows.reshape(len(rows), -1, columns)
    residual = (mix @ solved - wanted).reshape(len(index), *points.shape[1:])
    heavy = np.linalg.norm(project(points), axis=-1).max() * np.abs(residual[..., -1]).max()
    moved = (np.linalg.norm(residual[..., :-1], axis=-1).max() + heavy) / points[..., -1].min()
    if moved > tolerance:
        raise ValueError(f"tolerance = {tolerance}: removing the knot {u} could move points by {moved:.3g}")
    return degree, less, np.concatenate([rows[:first], solved, rows[last + 1 :]])


def bezier_rows(degree, knots, rows, ends):
    """Bezier control rows ``(pieces, degree + 1, m)`` between neighbouring ends, all knots among them."""
    finer = np.concatenate([ends[:1], np.repeat(ends, degree), ends[-1:]])
    flat = refined(degree, knots, rows, finer)[2]
    return flat[degree * np.arange(len(ends) - 1)[:, None] + np.arange(degree + 1)]


def halved(rows):
    """Both halves of Bezier rows ``(pieces, p + 1, m)``, by de Casteljau's algorithm, in order."""
    left, right, level = [rows[:, 0]], [rows[:, -1]], rows
    while level.shape[1] > 1:
        level = 0.5 * (level[:, :-1] + level[:, 1:])
        left.append(level[:, 0])
        right.append(level[:, -1])
    halves = np.stack([np.stack(left, axis=1), np.stack(right[::-1], axis=1)], axis=1)
    return halves.reshape(-1, *rows.shape[1:])


def lift(points, weights):
    """Homogeneous rows (w x, ..., w) of points."""
    rows = np.empty((*weights.shape, points.shape[-1] + 1))
    np.multiply(points, weights[..., None], out=rows[..., :-1])
    rows[..., -1] = weights
    return rows


def project(rows):
    """Points of homogeneous rows, the last axis holding (w x, ..., w)."""
    return rows[..., :-1] / rows[..., -1:]


def joined(curves):
    """See `NurbsCurve.join`."""
    dim, degree = curves[0].dim, max(c.degree for c in curves)
    for other in curves:
        if other.dim != dim:
            raise ValueError(f"other must be in {dim}-D like the curve, it is in {other.dim}-D")
    size = checks.extent(np.vstack([c.control_points for c in curves]))
    curves = [(c.elevate_degree(degree - c.degree) if c.degree < degree else c).clamped() for c in curves]
    knots, rows = [curves[0].knots[:-1]], [curves[0].homogeneous]
    for before, other in itertools.pairwise(curves):
        gap = np.linalg.norm(before.control_points[-1] - other.control_points[0])
        if gap > CLOSED_WITHIN * size:
            raise ValueError(f"other starts {gap:.3g} away from the end of the curve; move it there")
        knots.append(other.knots[degree + 1 : -1] + (knots[-1][-1] - other.domain[0]))
        rows.append(other.homogeneous[1:] * (rows[-1][-1, -1] / other.weights[0]))
    return curves[0]._of(degree, np.concatenate([*knots, knots[-1][-1:]]), np.vstack(rows))
