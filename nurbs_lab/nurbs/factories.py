"""Exact circles, arcs and surfaces of revolution as rational quadratics (NURBS Book 7.5 and 8.5)."""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.nurbs.curve import NurbsCurve
from nurbs_lab.nurbs.surface import NurbsSurface


def arc(radius=1.0, start=0.0, end=np.pi, center=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0)):
    """The circular arc from angle ``start`` to ``end`` (radians, counter-clockwise about the normal).

    A center of two coordinates gives a curve in the plane. The domain is [0, 1]; the radius is exact to
    rounding. At most one full turn.
    """
    radius = checks.as_positive("radius", radius)
    start, end = checks.as_number("start", start), checks.as_number("end", end)
    if not 0 < end - start <= 2 * np.pi * (1 + 1e-15):
        raise ValueError(f"end must exceed start by at most a full turn, 2 pi, got {start} to {end}")
    center = checks.as_vector("center", center, 2, 3)
    plane, weights, knots = _unit_arc(start, end)
    axes = _axes(normal)[:2] if center.size == 3 else np.eye(2)
    return NurbsCurve(2, knots, center + radius * plane @ axes, weights)


def circle(radius=1.0, center=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0)):
    """The full circle about a center, counter-clockwise about the normal; see `arc`."""
    return arc(radius, 0.0, 2 * np.pi, center, normal)


def revolve(profile, angle=2 * np.pi):
    """The surface swept by a curve in 3-D that turns about the z axis; u runs around, v along the profile."""
    if not isinstance(profile, NurbsCurve) or profile.dim != 3:
        raise TypeError("profile must be a NurbsCurve in 3-D")
    angle = checks.as_positive("angle", angle)
    if angle > 2 * np.pi * (1 + 1e-15):
        raise ValueError(f"angle must be at most a full turn, 2 pi, got {angle}")
    plane, turn_weights, knots = _unit_arc(0.0, angle)
    x, y, z = profile.control_points.T
    c, s = plane.T[..., None]
    net = np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(z, (len(plane), z.size))], axis=-1)
    return NurbsSurface(
        (2, profile.degree), (knots, profile.knots), net, np.outer(turn_weights, profile.weights)
    )


def cylinder(radius=1.0, height=1.0):
    """The open cylinder about the z axis, from z = 0 up."""
    radius = checks.as_positive("radius", radius)
    height = checks.as_positive("height", height)
    return revolve(NurbsCurve(1, [0, 0, 1, 1], [(radius, 0, 0), (radius, 0, height)]))


def sphere(radius=1.0):
    """The sphere about the origin; v runs from the south pole to the north pole."""
    half = arc(radius, -np.pi / 2, np.pi / 2, (0, 0, 0), (0, -1, 0))
    points = half.control_points.copy()
    points[[0, -1], :2] = 0.0
    return revolve(NurbsCurve(2, half.knots, points, half.weights))


def torus(major=2.0, minor=1.0):
    """The torus about the z axis, of the circle with radius ``minor`` around (major, 0, 0)."""
    major = checks.as_positive("major", major)
    return revolve(circle(checks.as_positive("minor", minor), (major, 0, 0), (0, -1, 0)))


def _unit_arc(start, end):
    """Control points ``(n, 2)``, weights and knots of an arc of the unit circle."""
    pieces = max(1, int(np.ceil((end - start) / (np.pi / 2) - 1e-9)))
    half = 0.5 * (end - start) / pieces
    angles = np.linspace(start, end, 2 * pieces + 1)
    weights = np.ones(angles.size)
    weights[1::2] = np.cos(half)
    plane = np.column_stack([np.cos(angles), np.sin(angles)]) / weights[:, None]
    if abs(end - start - 2 * np.pi) < 1e-12:
        plane[-1] = plane[0]
    joints = np.repeat(np.arange(1, pieces) / pieces, 2)
    return plane, weights, np.concatenate([np.zeros(3), joints, np.ones(3)])


def _axes(normal):
    """Rows: two unit vectors that span the plane, and the unit normal."""
    normal = checks.as_direction("normal", normal)
    least = np.eye(3)[np.argmin(np.abs(normal))]
    first = least - (least @ normal) * normal
    first = first / np.linalg.norm(first)
    return np.array([first, np.cross(normal, first), normal])
