"""A shell of patches as closed triangles, as few as a tolerance allows.

Every patch has its own number of cells along u and v. An edge takes the finer of its two patches, and strips
of triangles join the rim of a patch to its inner cells where the two differ.
"""

import numpy as np
import trimesh

from nurbs_lab.mesh.solid.net import cells_of, side_places, sides_of
from nurbs_lab.mesh.solid.patches import Patches
from nurbs_lab.mesh.solid.quads import SQUARE

_MOST_CELLS = 2000  # along a side of a patch
_MOST_TRIANGLES = 5_000_000
_PLACES = 8  # along a side of a patch, where curvature is measured
_SAFETY = 0.8  # of the tolerance


def shell_triangles(patches: Patches, tolerance) -> trimesh.Trimesh:
    """Closed triangles within ``tolerance`` of the patches."""
    layout = patches.layout
    cells = _cells(patches, tolerance)
    total = 2.0 * cells.prod(axis=1).sum()
    if total > _MOST_TRIANGLES or cells.max() == _MOST_CELLS:
        raise ValueError(
            f"tolerance is {tolerance} mm, which needs more than {total:.3g} triangles; give a larger one"
        )
    on_edge = np.zeros(len(layout.sides), dtype=np.int64)
    np.maximum.at(on_edge, layout.edges, cells[:, [0, 1, 0, 1]])
    rims = on_edge[layout.edges]
    even = (rims == cells[:, [0, 1, 0, 1]]).all(axis=1)
    cells[~even] = np.maximum(cells[~even], 2)
    vertices = _Vertices(layout, on_edge)
    triangles = []
    kinds, kind = np.unique(np.column_stack([cells, rims]), axis=0, return_inverse=True)
    order = np.argsort(kind.ravel(), kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(kind.ravel()))[:-1])
    for (nu, nv, *_), faces in zip(kinds.tolist(), groups, strict=True):
        triangles += _even(vertices, faces, nu, nv) if even[faces[0]] else _joined(vertices, faces, nu, nv)
    face, uv = np.concatenate(vertices.face), np.concatenate(vertices.uv)
    points = patches.at(face, uv)
    return trimesh.Trimesh(points, np.concatenate([t.reshape(-1, 3) for t in triangles]), process=False)


def _cells(patches, tolerance):
    """Numbers of cells of every patch along u and v, ``(faces, 2)``.

    Triangles inside a cell of h by k are within (h² |Suu| + 2 h k |Suv| + k² |Svv|) / 8 of the patch (Filip,
    Magedson and Markot 1986). Only the parts along the normal count, the largest of those at even places.
    """
    uu, uv, vv = _normal_curving(patches)
    best = np.full((len(uu), 2), _MOST_CELLS)
    for nu in np.unique(np.geomspace(1, _MOST_CELLS, 60).astype(int)).tolist():
        rest, half = 8.0 * _SAFETY * tolerance - uu / nu**2, uv / nu
        root = half + np.sqrt(np.maximum(half**2 + vv * rest, 0.0))
        with np.errstate(divide="ignore"):
            nv = np.where(rest > 0.0, np.ceil(np.maximum(root / rest, 1.0)), np.inf)
        better = nu * nv < best.prod(axis=1)
        best[better] = np.column_stack([np.full(better.sum(), nu), nv[better]])
    return best


def _normal_curving(patches):
    """Largest parts of Suu, Suv and Svv along the normal of every patch, three arrays ``(faces,)``."""
    t = np.linspace(0.0, 1.0, _PLACES + 1)
    normals = patches.normals(t)
    sizes = np.linalg.norm(normals, axis=-1, keepdims=True)
    flat = sizes > 1e-6 * sizes.max()
    normals /= np.where(flat, sizes, 1.0)
    out = []
    for u, v in ((2, 0), (1, 1), (0, 2)):
        part = patches.grid(t, u, v)
        along = np.where(flat[..., 0], np.abs((part * normals).sum(axis=-1)), np.linalg.norm(part, axis=-1))
        out.append(along.max(axis=(1, 2)))
    return out


class _Vertices:
    """Numbers of the vertices on corners, edges and inside of faces, and one place (face, u, v) of each."""

    def __init__(self, layout, on_edge):
        self.layout, self.on_edge = layout, on_edge
        corners = int(layout.corners.max()) + 1
        self.first = corners + np.concatenate([[0], np.cumsum(on_edge - 1)])
        self.count = int(self.first[-1])
        at_corner = np.empty(corners, dtype=np.int64)
        at_corner[layout.corners.ravel()] = np.arange(layout.corners.size)
        edge = np.repeat(np.arange(len(on_edge)), on_edge - 1)
        t = (corners + np.arange(len(edge)) - self.first[edge] + 1) / on_edge[edge]
        side = layout.sides[edge, 0]
        on_sides = side_places(np.arange(4), t).reshape(4, -1, 2)
        self.face = [at_corner // 4, side // 4]
        self.uv = [SQUARE[at_corner % 4], on_sides[side % 4, np.arange(len(t))]]

    def rim(self, faces, k):
        """Vertices along side k of faces, counter-clockwise, ``(faces, cells + 1)``."""
        edge = self.layout.edges[faces, k]
        inside = self.first[edge][:, None] + np.arange(self.on_edge[edge[0]] - 1)
        inside = np.where(self.layout.forward[faces, k][:, None], inside, inside[:, ::-1])
        ends = self.layout.corners[faces][:, [k, (k + 1) % 4]]
        return np.concatenate([ends[:, :1], inside, ends[:, 1:]], axis=1)

    def inside(self, faces, nu, nv):
        """New vertices inside faces at multiples of 1 / nu and 1 / nv, ``(faces, nu - 1, nv - 1)``."""
        u, v = np.meshgrid(np.arange(1, nu) / nu, np.arange(1, nv) / nv, indexing="ij")
        self.face.append(np.repeat(faces, u.size))
        self.uv.append(np.tile(np.column_stack([u.ravel(), v.ravel()]), (len(faces), 1)))
        numbers = self.count + np.arange(len(faces) * u.size)
        self.count += len(numbers)
        return numbers.reshape(len(faces), nu - 1, nv - 1)


def _of_cells(grid):
    """Two triangles for each cell of grids of vertices."""
    a, b, c, d = cells_of(grid)
    return [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]


def _even(vertices, faces, nu, nv):
    """Triangles of faces whose sides have as many cells as their inside."""
    grid = np.empty((len(faces), nu + 1, nv + 1), dtype=np.int64)
    for k, side in enumerate(sides_of(grid)):
        side[:] = vertices.rim(faces, k)
    grid[:, 1:-1, 1:-1] = vertices.inside(faces, nu, nv)
    return _of_cells(grid)


def _joined(vertices, faces, nu, nv):
    """Triangles of faces whose inner cells are joined to the rim by strips."""
    grid = vertices.inside(faces, nu, nv)
    out = _of_cells(grid)
    for k, row in enumerate(sides_of(grid)):
        rim = vertices.rim(faces, k)
        outer = (np.arange(rim.shape[1] - 1) + 0.5) / (rim.shape[1] - 1)
        inner = (np.arange(1, row.shape[1]) + 0.5) / (row.shape[1] + 1)
        beside, behind = np.searchsorted(inner, outer), np.searchsorted(outer, inner, side="right")
        out.append(np.stack([rim[:, :-1], rim[:, 1:], row[:, beside]], -1))
        out.append(np.stack([row[:, 1:], row[:, :-1], rim[:, behind]], -1))
    return out
