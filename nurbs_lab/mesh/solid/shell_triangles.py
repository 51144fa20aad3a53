"""A shell of patches as closed triangles: an even grid of cells on every patch.

Opposite sides of a patch have equally many cells, and so have all edges across a strip of patches.
"""

import numpy as np
import trimesh

from nurbs_lab.mesh.core import components, unit
from nurbs_lab.mesh.distance import crossing_triangles
from nurbs_lab.mesh.solid.net import cells_of, number_grids
from nurbs_lab.mesh.solid.patches import Patches, basis_at
from nurbs_lab.nurbs.tessellation import SAFETY

_MOST_TRIANGLES = 5_000_000
_PLACES = np.linspace(0.0, 1.0, 9)  # along a side of a patch, where curvature is measured


def shell_triangles(patches: Patches, tolerance) -> trimesh.Trimesh:
    """Closed triangles within ``tolerance`` of the patches."""
    return trimesh.Trimesh(*_divided(patches, tolerance)[:2], process=False)


def finest(patches: Patches) -> float:
    """The tolerance for which about `_MOST_TRIANGLES` are needed."""
    return float(2.0 * _cells(patches)[patches.layout.edges[:, :2]].prod(axis=1).sum() / _MOST_TRIANGLES)


def crossed(patches: Patches, tolerance) -> np.ndarray:
    """Patches of which triangles within ``tolerance``, or the finest, pass through others, ``(faces,)``."""
    points, triangles, owner = _divided(patches, max(tolerance, finest(patches)))
    out = np.zeros(len(patches.net), dtype=bool)
    out[owner[crossing_triangles(points, triangles) >= 0]] = True
    return out


def _divided(patches, tolerance):
    """Points, triangles, and the patch of each triangle."""
    cells = np.ceil(_cells(patches) / np.sqrt(tolerance)).clip(1)
    grids, count = number_grids(patches.layout, cells.astype(np.int64))
    points, triangles, owners = np.zeros((count, 3)), [], []  # of faces left out, none are used
    for faces, net in grids:
        u, v = (basis_at(np.linspace(0.0, 1.0, n)) for n in net.shape[1:])
        points[net] = np.einsum("ai,bj,fijx->fabx", u, v, patches.nets[faces], optimize=True)
        a, b, c, d = cells_of(net)
        triangles.append(np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3))
        owners.append(np.repeat(faces, len(triangles[-1]) // len(faces)))
    return points, np.concatenate(triangles), np.concatenate(owners)


def _cells(patches):
    """Numbers of cells along every edge for a tolerance of 1, not rounded; they grow as its root falls.

    Triangles inside a cell of h by k are within (h² |Suu| + 2 h k |Suv| + k² |Svv|) / 8 of the patch (Filip,
    Magedson and Markot 1986). Only the parts along the normal count, the largest of those at even places.
    """
    normals, edges = unit(patches.normals(_PLACES)), patches.layout.edges
    uu, uv, vv = (
        np.abs(np.einsum("fabx,fabx->fab", patches.grid(_PLACES, *orders), normals)).max(axis=(1, 2))
        for orders in ((2, 0), (1, 1), (0, 2))
    )
    wanted = np.sqrt(np.column_stack([uu + uv, vv + uv]) / (4.0 * SAFETY))
    count, strip = components(len(patches.layout.sides), edges[:, :2].ravel(), edges[:, 2:].ravel())
    cells = np.zeros(count)
    np.maximum.at(cells, strip[edges[:, :2]], wanted)
    return cells[strip]
