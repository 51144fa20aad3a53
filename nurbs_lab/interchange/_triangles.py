"""Triangles for printers and viewers: Wavefront OBJ and binary STL."""

import numpy as np
import trimesh

from nurbs_lab.interchange._export_items import in_space

HOLDS = ("surfaces", "solids")
FINENESS = 1e-4  # of the diagonal: the middle of a cell lies no further from its corners' mean
MAX_CELLS = 32  # of a span, along each direction


def write(path, parts):
    mesh = trimesh.util.concatenate([triangles(s) for s in parts.all_surfaces])
    mesh.export(path)


def triangles(surface):
    """A triangle mesh on a grid of parameters, each span halved until it follows the surface."""
    cells = [1, 1]
    while True:
        fine = in_space(surface.grid(*_parameters(surface, [2 * c for c in cells])))
        within = FINENESS * np.linalg.norm(np.ptp(fine.reshape(-1, 3), axis=0))
        sag = [
            np.linalg.norm(fine[1:-1:2] - (fine[:-2:2] + fine[2::2]) / 2, axis=-1).max(),
            np.linalg.norm(fine[:, 1:-1:2] - (fine[:, :-2:2] + fine[:, 2::2]) / 2, axis=-1).max(),
        ]
        coarse = [i for i in (0, 1) if sag[i] > within and cells[i] < MAX_CELLS]
        if not coarse:
            return _weld(fine[::2, ::2])
        for i in coarse:
            cells[i] *= 2


def _parameters(surface, cells):
    for knots, (low, high), count in zip(surface.knots, surface.domain, cells, strict=True):
        spans = np.unique(np.clip(knots, low, high))
        inner = spans[:-1, None] + np.diff(spans)[:, None] * np.arange(count) / count
        yield np.append(inner, high)


def _weld(grid):
    """Two triangles a cell; equal points (seams, poles) become one, triangles without area go."""
    rows, columns = grid.shape[:2]
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    faces = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    mesh = trimesh.Trimesh(grid.reshape(-1, 3), faces, process=False)
    mesh.merge_vertices(digits_vertex=9)
    mesh.update_faces(mesh.nondegenerate_faces())
    return mesh
