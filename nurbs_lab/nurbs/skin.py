"""A surface through a family of section curves (NURBS Book 10.3), whatever their point counts.

Knot vectors of unlike sections are never united, which would multiply the control points: every section is
sampled at the same shares of its length instead, and the samples make one grid.
"""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.nurbs.curve import CLOSED_WITHIN, NurbsCurve
from nurbs_lab.nurbs.interpolate import as_degrees, interpolate_curve, interpolate_surface

MOST_SAMPLES = 100_000  # of a section


def skin(curves_or_contours, degrees=(3, 3), *, samples=None):
    """The surface through sections, in their order.

    Parameters
    ----------
    curves_or_contours : sequence
        Each a `NurbsCurve` in 3-D, an array of points ``(n, 3)``, or a contour: an object with ``points``
        ``(n, 3)``, or ``(n, 2)`` and a ``height``, and with ``closed``. An array is closed if its last
        point repeats the first. All closed or all open, but for single points: poles.
    degrees : (int, int)
        Around the sections, and across them.
    samples : int, optional
        Points taken from each section; as many as the largest section has if left out.

    Returns
    -------
    NurbsSurface
        u runs along the sections, v across them; closed along u if the sections are.

    Notes
    -----
    Closed sections are turned, and reversed if need be, so that each starts where the one before does:
    the shift is the one of greatest correlation of the centred samples.

    Examples
    --------
    >>> import numpy as np
    >>> import nurbs_lab as nl
    >>> angle = np.linspace(0.0, 2.0 * np.pi, 33)
    >>> rings = [np.column_stack([np.cos(angle), np.sin(angle), 0 * angle + z]) for z in range(5)]
    >>> tube = nl.skin(rings)
    >>> tube.closed, bool(tube.closest_point((2.0, 0.0, 1.5))[1].round(4) == 1.0)
    ((True, False), True)
    """
    degree_u, degree_v = as_degrees(degrees)
    try:
        sections = list(curves_or_contours)
    except Exception:  # whatever a thing that is no sequence says
        raise TypeError(
            f"curves_or_contours must be a sequence of sections, got {type(curves_or_contours).__name__}"
        ) from None
    if len(sections) <= degree_v:
        raise ValueError(
            f"curves_or_contours: degree {degree_v} across needs at least {degree_v + 1} sections, "
            f"got {len(sections)}"
        )
    curves = [_as_curve(f"curves_or_contours[{i}]", s, degree_u) for i, s in enumerate(sections)]
    kinds = {c.closed: i for i, c in enumerate(curves) if np.ptp(c.control_points, axis=0).any()}
    if len(kinds) > 1:
        raise ValueError(
            f"curves_or_contours[{kinds[True]}] is closed and [{kinds[False]}] is open; give one kind"
        )
    closed = True in kinds
    if samples is None:
        samples = max(len(c.control_points) - closed * c.degree for c in curves)
        samples = max(samples, 4 * (degree_u + 1))
    samples = checks.as_count("samples", samples, degree_u + 1, MOST_SAMPLES)
    shares = np.linspace(0.0, 1.0, samples, endpoint=not closed)
    rows = [_sample(curves[0], shares)]
    for curve in curves[1:]:
        rows.append(_aligned(curve, shares, rows[-1], closed))
    try:
        return interpolate_surface(np.stack(rows, axis=1), (degree_u, degree_v), closed=(closed, False))
    except ValueError as error:
        raise ValueError(f"curves_or_contours: as a {error}") from None


def _as_curve(name, section, degree):
    """A section as a 3-D curve."""
    if isinstance(section, NurbsCurve):
        if section.dim != 3:
            raise ValueError(f"{name} must be a curve in 3-D, got {section.dim}-D")
        return section
    if hasattr(section, "points"):
        points = checks.as_points(f"{name}.points", section.points)
        closed = bool(getattr(section, "closed", False))
        if points.shape[1] == 2:
            if getattr(section, "height", None) is None:
                raise ValueError(f"{name} has points in 2-D and no height; give points of shape (n, 3)")
            height = checks.as_number(f"{name}.height", section.height)
            points = np.column_stack([points, np.full(len(points), height)])
    else:
        points = checks.as_points(name, section)
        gap = np.linalg.norm(points[-1] - points[0])
        closed = len(points) > 2 and gap <= CLOSED_WITHIN * checks.extent(points)
    if points.shape[1] != 3:
        raise ValueError(f"{name} must have points of shape (n, 3), got {points.shape}")
    if not np.ptp(points, axis=0).any():
        return NurbsCurve(1, [0, 0, 1, 1], points[[0, 0]])
    try:
        return interpolate_curve(points, min(degree, 3), closed=bool(closed))
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _sample(curve, shares):
    """Points at these shares of the length."""
    low, high = curve.domain
    u = np.linspace(low, high, 16 * len(curve.control_points) + 1)
    speed = np.linalg.norm(curve.derivative(u), axis=1)
    length = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
    if not length[-1] > 0:
        return curve(np.full(len(shares), low))
    return curve(np.interp(shares * length[-1], length, u))


def _aligned(curve, shares, before, closed):
    """Samples of a section, started and oriented like the section before."""
    points = _sample(curve, shares)
    if not closed:
        straight = np.linalg.norm(points - before, axis=1).sum()
        turned = np.linalg.norm(points[::-1] - before, axis=1).sum()
        return points[::-1] if turned < straight else points
    reference = np.fft.rfft(before - before.mean(axis=0), axis=0).conj()
    best = -np.inf
    for backward in (False, True):
        walk = (-shares) % 1.0 if backward else shares
        centred = _sample(curve, walk)
        spectrum = np.fft.rfft(centred - centred.mean(axis=0), axis=0)
        match = np.fft.irfft((spectrum * reference).sum(axis=1), len(shares))
        top = int(np.argmax(match))
        if match[top] > best:
            best = match[top]
            left, here, right = match[top - 1], match[top], match[(top + 1) % len(match)]
            bend = left - 2 * here + right
            fraction = 0.5 * (left - right) / bend if bend < 0 else 0.0
            start = (top + fraction) / len(shares)
            chosen = (walk - start) % 1.0 if backward else (walk + start) % 1.0
    return _sample(curve, chosen)
