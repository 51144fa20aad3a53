"""Waterlines: paths of the tip at one height along which the cutter touches the part.

The height field of the tip is sliced as a mesh. Every point of a slice lies on an edge of the grid and is
then moved along that edge until the cutter touches the part itself. So the grid only decides how the points
are connected; their positions are exact.
"""

import itertools

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.machining import _kernels_order
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.field import TipField
from nurbs_lab.mesh.slicing.planes import slice_mesh

CLOSEST = 0.25  # fraction of the grid step: smallest distance between points of a path


def waterlines(touch: Contact, field: TipField, levels, wanted=lambda points, *_: np.ones(len(points), bool)):
    """Paths of the tip at each level, material on their left.

    Parameters
    ----------
    touch : Contact
    field : TipField
    levels : (n,) array
        In mm, above the floor.
    wanted : callable, optional
        Function of points ``(n, 3)``, unit directions ``(n, 2)`` towards the material and the largest error
        of the points in mm. It says where a path is needed; by default everywhere.

    Returns
    -------
    list of (points (n, 3), closed)
    """
    rings, paths = [c for layer in slice_mesh(field.surface(), levels) for c in layer.contours], []
    if not rings:
        return paths
    points = np.concatenate([ring.points_3d for ring in rings])
    starts = np.cumsum([0, *(len(ring.points) for ring in rings)])
    inward = np.concatenate([_inward(ring.points) for ring in rings])
    keep = wanted(points, inward, field.step)
    points[keep] = _pushed(touch, field, points[keep])
    keep &= np.isfinite(points[:, 0])
    keep[keep] = wanted(points[keep], inward[keep], 0.0)
    for a, b in itertools.pairwise(starts):
        paths += runs(points[a:b], keep[a:b], True, CLOSEST * field.step)
    return paths


def runs(points, keep, closed, closest=0.0):
    """The parts of a path where ``keep`` is true, as ``(points, closed)``, without coincident points."""
    if not keep.any():
        return []
    if closed and not keep.all():
        first = int(np.argmin(keep))
        points, keep = np.roll(points, -first, axis=0), np.roll(keep, -first)
    if keep.all():
        parts, whole = [points], closed
    else:
        edges = np.flatnonzero(np.diff(np.concatenate([[0], keep.view(np.int8), [0]])))
        parts, whole = [points[a:b] for a, b in edges.reshape(-1, 2)], False
    thinned = [part[_kernels_order.spaced(part, whole, closest)] for part in parts]
    return [(part, whole) for part in thinned if len(part) > (3 if whole else 1)]


def _inward(points):
    """Unit directions to the left of a closed polyline."""
    along = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    left = np.column_stack([-along[:, 1], along[:, 0]])
    size = lengths(left)[:, None]
    return np.divide(left, size, out=np.zeros_like(left), where=size > 0)


def _pushed(touch, field, points):
    """Points of the sliced grid, moved along their edges of the grid to where the cutter touches the part."""
    at = (points[:, :2] - field.origin) / field.step
    near = np.rint(at)
    on = np.abs(at - near) < 1e-7
    first = np.where(on, near, np.floor(at)).astype(int)
    second = first + ~on  # an edge along x, along y or a diagonal; a point at a node stays
    last = np.array(field.z.shape) - 1
    first, second = np.clip(first, 0, last), np.clip(second, 0, last)
    stuck = field.z[second[:, 0], second[:, 1]] >= points[:, 2]
    free = np.where(stuck[:, None], first, second) * field.step + field.origin
    end = np.where(stuck[:, None], second, first) * field.step + field.origin
    way = touch.push(free, end, points[:, 2])
    node = on.all(axis=1)
    way = np.where(np.isfinite(way) | ~node, way, 1.0)
    moved = free + way[:, None] * (end - free)
    return np.column_stack([np.where(node[:, None], points[:, :2], moved), points[:, 2]])
