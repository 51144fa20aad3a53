"""A shell of patches as closed triangles: an even grid of cells of its own inside every patch.

An edge is cut as finely as the finer one of its patches, and joined to the outermost nodes of both grids.
"""

import numpy as np
import trimesh

from nurbs_lab.mesh.core import unit
from nurbs_lab.mesh.distance import crossing_triangles
from nurbs_lab.mesh.solid.net import cells_of, sides_of
from nurbs_lab.mesh.solid.patches import Patches, basis_at
from nurbs_lab.nurbs.tessellation import SAFETY

_MOST_TRIANGLES = 5_000_000
_PLACES = np.linspace(0.0, 1.0, 9)  # along a side of a patch, where curvature is measured


def shell_triangles(patches: Patches, tolerance) -> trimesh.Trimesh:
    """Closed triangles within ``tolerance`` of the patches."""
    return trimesh.Trimesh(*_divided(patches, tolerance)[:2], process=False)


def finest(patches: Patches) -> float:
    """The tolerance for which about `_MOST_TRIANGLES` are needed."""
    return float(2.0 * _cells(patches).prod(axis=1).sum() / _MOST_TRIANGLES)


def crossed(patches: Patches, tolerance) -> np.ndarray:
    """Patches of which triangles within ``tolerance``, or the finest, pass through others, ``(faces,)``."""
    points, triangles, owner = _divided(patches, max(tolerance, finest(patches)))
    out = np.zeros(len(patches.net), dtype=bool)
    out[owner[crossing_triangles(points, triangles) >= 0]] = True
    return out


def _divided(patches, tolerance):
    """Points, triangles, and the patch of each triangle."""
    layout, nets = patches.layout, patches.nets
    cells = np.ceil(_cells(patches) / np.sqrt(tolerance)).clip(2).astype(np.int64)
    steps = np.zeros(len(layout.sides), dtype=np.int64)  # along every edge
    np.maximum.at(steps, layout.edges, np.tile(cells, 2))
    points, triangles, waiting = [np.zeros((layout.corners.max() + 1, 3))], [], {}
    points[0][layout.corners] = nets[:, [0, -1, -1, 0], [0, 0, -1, -1]]  # of faces left out, none are used
    count = len(points[0])

    def numbers(places):
        """Of nodes at places ``(..., 3)``, which are added to the points."""
        nonlocal count
        points.append(places.reshape(-1, 3))
        count += len(points[-1])
        return np.arange(count - len(points[-1]), count).reshape(places.shape[:-1])

    for face, net in enumerate(nets):
        u, v = (basis_at(np.arange(1, n) / n) for n in cells[face])
        grid = numbers(v @ np.tensordot(u, net, 1))[None]
        a, b, c, d = cells_of(grid)
        own = [np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)]
        for k, (inner, curve) in enumerate(zip(sides_of(grid), sides_of(net[None]), strict=True)):
            edge = layout.edges[face, k]
            if (nodes := waiting.pop(edge, None)) is None:
                nodes = numbers(basis_at(np.arange(1, steps[edge]) / steps[edge]) @ curve[0])
                waiting[edge] = nodes[::-1]  # for the patch on the other side
            first, last = layout.corners[face, [k, (k + 1) % 4]]
            own += _between(inner[0], np.concatenate([[first], nodes, [last]]))
        triangles.append(np.concatenate(own))
    owner = np.repeat(np.arange(len(nets)), list(map(len, triangles)))
    return np.concatenate(points), np.concatenate(triangles), owner


def _between(inner, outer):
    """Triangles between the nodes at even places along a side and those of the first row of cells inside.

    Those end a cell before the ends of the side. Every step along either row is joined to the node of the
    other row that is nearest to its middle, so no triangle is longer than the longer steps.
    """
    n, m = len(inner) + 1, len(outer) - 1
    inside, along = (np.arange(1, n - 1) + 0.5) / n, (np.arange(m) + 0.5) / m
    yield np.column_stack([outer[:-1], outer[1:], inner[np.searchsorted(inside, along)]])
    yield np.column_stack([inner[1:], inner[:-1], outer[np.searchsorted(along, inside, side="right")]])


def _cells(patches):
    """Cells by u and v of every patch for a tolerance of 1, not rounded; they grow as its root falls.

    Triangles inside a cell of h by k are within (h² |Suu| + 2 h k |Suv| + k² |Svv|) / 8 of the patch (Filip,
    Magedson and Markot 1986). Only the parts along the normal count, the largest of those at even places.
    """
    normals = unit(patches.normals(_PLACES))
    uu, uv, vv = (
        np.abs(np.einsum("fabx,fabx->fab", patches.grid(_PLACES, *orders), normals)).max(axis=(1, 2))
        for orders in ((2, 0), (1, 1), (0, 2))
    )
    return np.sqrt(np.column_stack([uu + uv, vv + uv]) / (4.0 * SAFETY))
