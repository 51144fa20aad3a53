"""Waterlines: paths of the tip at one height along which the cutter touches the part.

The height field of the tip is sliced as a mesh. Every point of a slice lies on an edge of the grid and is
then moved along that edge until the cutter touches the part itself. So the grid only decides how the points
are connected; their positions are exact.
"""

import itertools

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.machining.drop import Contact
from nurbs_lab.machining.field import TipField
from nurbs_lab.mesh.slicing.planes import slice_mesh
from nurbs_lab.nurbs.along import lengths_along

CLOSEST = 0.5  # fraction of the grid step: smallest distance between points of a path


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
    some = [_apart(ring.points, True, CLOSEST * field.step) for ring in rings]
    points = np.concatenate([ring.points_3d[k] for ring, k in zip(rings, some, strict=True)])
    inward = np.concatenate([_inward(ring.points)[k] for ring, k in zip(rings, some, strict=True)])
    starts = np.cumsum([0, *(np.count_nonzero(k) for k in some)])
    keep = wanted(points, inward, field.step)
    points[keep] = _pushed(touch, field, points[keep])
    keep &= np.isfinite(points[:, 0])
    keep[keep] = wanted(points[keep], inward[keep], 0.0)
    for a, b in itertools.pairwise(starts):
        paths += runs(points[a:b], keep[a:b], True)
    thinned = [(points[_apart(points, closed, CLOSEST * field.step)], closed) for points, closed in paths]
    return [(points, closed) for points, closed in thinned if len(points) > 1]


def runs(points, keep, closed):
    """The parts of a path where ``keep`` is true, as ``(points, closed)``; single points are left out."""
    if keep.all():
        return [(points, closed)] if len(points) > (3 if closed else 1) else []
    if closed:
        first = int(np.argmin(keep))
        points, keep = np.roll(points, -first, axis=0), np.roll(keep, -first)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], keep.view(np.int8), [0]])))
    return [(points[a:b], False) for a, b in edges.reshape(-1, 2) if b > a + 1]


def _apart(points, closed, closest):
    """Which points of a path are not closer than ``closest`` to the one before; open ones keep both ends."""
    keep = np.append(True, np.diff(np.floor(lengths_along(points) / closest)) > 0.0)
    keep[-1] |= not closed
    return keep


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
