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
STUB = 0.1  # of that distance: nearer points, and shorter paths, are left out


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
    list of (points (n, 3), closed); a ring of which two points are left is open, or it would have a cusp
    """
    surface, paths = field.surface(), []
    rings = [c for layer in slice_mesh(surface, levels) for c in layer.contours]
    if not rings:
        return paths
    edges, places = [_crossed(surface.faces, ring) for ring in rings], field.places()
    some = [_apart(places[ends].mean(axis=1), True, CLOSEST * field.step) for ends in edges]
    points = np.concatenate([ring.points_3d[k] for ring, k in zip(rings, some, strict=True)])
    inward = np.concatenate([_inward(ring.points)[k] for ring, k in zip(rings, some, strict=True)])
    starts = np.cumsum([0, *(np.count_nonzero(k) for k in some)])
    keep = wanted(points, inward, field.step)
    edges = np.concatenate([ends[k] for ends, k in zip(edges, some, strict=True)])
    points[keep] = _pushed(touch, field, edges[keep], points[keep, 2])
    keep &= np.isfinite(points[:, 0])
    keep[keep] = wanted(points[keep], inward[keep], 0.0)
    for a, b in itertools.pairwise(starts):
        paths += runs(points[a:b], keep[a:b], True)
    least = STUB * CLOSEST * field.step
    thinned = [(points[_apart(points, closed, CLOSEST * field.step)], closed) for points, closed in paths]
    return [(p, closed and len(p) > 2) for p, closed in thinned if lengths_along(p)[-1] > least]


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
    along = lengths_along(np.vstack([points, points[:1]]) if closed else points)
    some = np.flatnonzero(np.append(True, np.diff(np.floor(along / closest)) > 0.0))
    some = some[np.append(np.diff(along[some]), along[-1] - along[some[-1]]) > STUB * closest]
    keep = np.zeros(len(points), bool)
    keep[some] = True
    keep[-1] |= not closed
    return keep


def _inward(points):
    """Unit directions to the left of a closed polyline."""
    along = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    left = np.column_stack([-along[:, 1], along[:, 0]])
    size = lengths(left)[:, None]
    return np.divide(left, size, out=np.zeros_like(left), where=size > 0)


def _crossed(triangles, ring):
    """The two corners of the edge of the grid on which each point of a closed contour lies, ``(n, 2)``."""
    before, after = triangles[np.roll(ring.triangles, 1)], triangles[ring.triangles]
    return before[(before[:, :, None] == after[:, None, :]).any(axis=2)].reshape(-1, 2)


def _pushed(touch, field, edges, level):
    """Points at ``level (n,)`` on edges of the grid, where the cutter touches the part itself."""
    z = field.z.ravel()[edges]
    first = z.argmin(axis=1)[:, None]
    free, end = (field.places()[np.take_along_axis(edges, k, axis=1)[:, 0]] for k in (first, 1 - first))
    way = touch.push(free, end, level)
    way = np.where(z.max(axis=1) > level, way, 1.0)  # a node at the level itself stays
    return np.column_stack([free + way[:, None] * (end - free), level])
