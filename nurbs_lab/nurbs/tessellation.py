"""Tessellation: grids of parameters whose triangles keep a tolerance."""

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.nurbs.spans import span_parameters

MOST = 3000  # parameters along one direction
SAFETY = 0.8  # of the tolerance: the largest error need not lie where it is measured


def triangles(surface, tolerance):
    """Points ``(n, dim)`` and triangles ``(m, 3)`` that lie within a tolerance of the surface.

    The grid has every knot; points on seams and poles come as often as the grid has them. ValueError if
    more than 3000 points along a direction would be needed.

    All spans of a direction are halved until the surface in the middles of the cells, of their edges and of
    their diagonals is near enough, or until the direction has 3000 parameters, so at most twelve times. An S
    may pass through all middles; it cannot through those of degree - 1 cells a span, which are looked at too.

    Examples
    --------
    >>> from nurbs_lab.nurbs import sphere
    >>> points, triangles = sphere(10.0).tessellate(0.1)
    >>> points.shape[1], triangles.shape[1]
    (3, 3)
    """
    tolerance = checks.as_positive("tolerance", tolerance)
    cells, limit = [1, 1], SAFETY * tolerance
    while True:
        u, v, off_u, off_v, off = _errors(surface, cells)
        finer = [max(n, 1 << max(p - 2, 0).bit_length()) for n, p in zip(cells, surface.degrees, strict=True)]
        if off <= limit and finer != cells and _errors(surface, finer)[-1] > limit:
            cells = finer
            continue
        wanted = [] if off <= limit else [axis for axis in (0, 1) if (off_u, off_v)[axis] > 0.4 * limit]
        growing = [axis for axis in wanted or (0, 1) if (len(u), len(v))[axis] < MOST]
        if off <= limit or not growing:
            break
        for axis in growing:
            cells[axis] *= 2
    if off > tolerance:
        said = f"tolerance = {tolerance:.3g} needs more than {MOST} points along a direction"
        raise ValueError(f"{said}; allow {off:.3g}, or export the surface as .step")
    points = surface.grid(u[::2], v[::2])
    return points.reshape(-1, surface.dim), grid_triangles(*points.shape[:2])


def _errors(surface, cells):
    """The parameters for so many cells a span and those between, and the distances of edges and of all."""
    u, v = (
        span_parameters(knots, degree, 2 * count)
        for knots, degree, count in zip(surface.knots, surface.degrees, cells, strict=True)
    )
    fine = surface.grid(u, v)
    corners = fine[::2, ::2]
    off_u = np.linalg.norm(fine[1::2, ::2] - 0.5 * (corners[1:] + corners[:-1]), axis=-1).max()
    off_v = np.linalg.norm(fine[::2, 1::2] - 0.5 * (corners[:, 1:] + corners[:, :-1]), axis=-1).max()
    diagonal = 0.5 * (corners[1:, 1:] + corners[:-1, :-1])
    off = max(off_u, off_v, np.linalg.norm(fine[1::2, 1::2] - diagonal, axis=-1).max())
    return u, v, off_u, off_v, off


def grid_triangles(rows, columns):
    """Two triangles for each cell of a grid of points in row-major order: ``(m, 3)``."""
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    return np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
