"""Patches that meet with one tangent plane, by construction: linear conditions on control points.

Every face of a layout is a Bezier patch of degree 5. Let f and g be the patches on both sides of a smooth
edge, t the parameter along it in f, and D the derivative into a patch. They meet with one tangent plane if
``D f(t) + D g(1 - t) = a(t) f'(t)`` with any function a. Here it is ``2 (1 - t)^2 cos p - 2 t^2 cos q``,
where p and q are the angles between edges at both ends in the parameter plane: the full angle, or that
between two sharp edges, over the number of its faces. So a depends on the layout alone, and the condition is
linear in the control points. With a linear function a, tangents would have to vanish at vertices of four
faces (Peters 1994; Bercovier and Matskewich 2017). Sharp edges have no condition.
"""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.special import binom

from nurbs_lab.mesh.core import fans
from nurbs_lab.mesh.solid.net import DEGREE, turned

#: Degrees: sharp edges at a corner run straight on within so many of 180; no sector is nearer to 0 or 360.
_STRAIGHT = 20.0


def smooth_conditions(layout, net, angles) -> csr_matrix:
    """Rows that are zero on the control points of smooth patches, for each coordinate alike.

    There are seven rows for every smooth edge, the Bezier coefficients of its condition; those at vertices
    depend on one another. ``angles (faces, 4)`` are those of the faces at their corners, in degrees; they
    count at corners of sharp edges only.
    """
    first, second = layout.sides[~layout.sharp].T
    sides = np.stack(turned(net), axis=1).reshape(-1, DEGREE + 1, DEGREE + 1)
    cosine = np.cos(_angles_of_sectors(layout, angles.ravel()))
    cosine[np.abs(cosine) < 1e-12] = 0.0
    c, d = (cosine[ends][:, None, None] for ends in (first, first - first % 4 + (first + 1) % 4))
    k, i = np.arange(DEGREE + 2), np.arange(DEGREE + 1)
    share = k[:, None] / (DEGREE + 1)
    raised = share * (k[:, None] - 1 == i) + (1.0 - share) * (k[:, None] == i)  # to degree 6
    slopes = binom(4, i[:-1])[:, None] * (np.eye(DEGREE + 1)[1:] - np.eye(DEGREE + 1)[:-1])
    steps = np.stack([np.pad(slopes, ((0, 2), (0, 0))), np.pad(slopes, ((2, 0), (0, 0)))])
    steps *= 2.0 / binom(DEGREE + 1, k)[:, None]
    on_edge = -2.0 * raised - c * steps[0] + d * steps[1]
    beside = np.broadcast_to(raised, on_edge.shape)
    points = sides[first, :, 0], sides[first, :, 1], sides[second, ::-1, 1]
    columns = np.concatenate(points, axis=1)[:, None].repeat(DEGREE + 2, axis=1)
    values = np.concatenate([on_edge, beside, beside], axis=2)
    ends = np.arange(0, columns.size + 1, columns.shape[2])
    return csr_matrix((values.ravel(), columns.ravel(), ends), shape=(len(ends) - 1, int(net.max()) + 1))


def _angles_of_sectors(layout, angles):
    """For every corner of a face the angle between edges of its sector in the parameter plane, radians.

    A sector is what lies at a vertex between two sharp edges, or all around it. Its angle is a full turn if
    the vertex has fewer than two sharp edges, 180 degrees where just two run straight on, else the sum of the
    ``angles`` of its corners, but not too near to 180 degrees.
    """
    corners, sharp = layout.corners.ravel(), layout.sharp[layout.edges.ravel()]
    opposite = layout.sides[layout.edges.ravel()].sum(axis=1) - np.arange(len(corners))
    sector = fans(opposite, ~sharp, 4)[1]
    size, vertex = np.bincount(sector), np.empty(sector.max() + 1, dtype=np.int64)
    vertex[sector] = corners
    sharp = np.bincount(corners[sharp], minlength=len(layout.fixed))[vertex]
    angle = np.clip(np.bincount(sector, angles), _STRAIGHT, 360.0 - _STRAIGHT)
    off = np.abs(angle - 180.0)
    farthest = np.zeros(len(layout.fixed))
    np.maximum.at(farthest, vertex, off)
    through = (sharp == 2) & (~layout.fixed[vertex] | (farthest[vertex] < _STRAIGHT))
    beside = np.where(angle < 180.0, 180.0 - _STRAIGHT, 180.0 + _STRAIGHT)
    angle = np.where(through, 180.0, np.where(off < _STRAIGHT, beside, angle))
    return np.radians(np.where(sharp < 2, 360.0, angle) / size)[sector]
