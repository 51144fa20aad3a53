"""Grids of nodes on a layout, such as control points: numbers, sides and cells.

Side k of a face runs from its corner k to the next: v = 0, u = 1, v = 1, u = 0.
"""

import numpy as np

DEGREE = 5  # of all patches


def number_nodes(layout, n):
    """Numbers of n x n nodes of every face, ``(faces, n, n)``, equal where faces meet; how many there are.

    Those of vertices come first, then those of the edges, in their direction, then those inside the faces.
    """
    vertices, edges, faces = int(layout.corners.max()) + 1, len(layout.sides), len(layout.corners)
    inner = n - 2
    net = np.empty((faces, n, n), dtype=np.int64)
    on_edge = vertices + inner * layout.edges[:, :, None] + np.arange(inner)
    on_edge = np.where(layout.forward[:, :, None], on_edge, on_edge[:, :, ::-1])
    for k, side in enumerate(sides_of(net)):
        side[:, 0], side[:, 1:-1] = layout.corners[:, k], on_edge[:, k]
    first = vertices + inner * edges
    net[:, 1:-1, 1:-1] = first + np.arange(faces * inner**2).reshape(faces, inner, inner)
    return net, first + faces * inner**2


def turned(grids):
    """Views of grids ``(faces, n, n, ...)``, turned so that side k lies at v = 0 and runs along u."""
    swapped = np.swapaxes(grids, 1, 2)
    return grids, swapped[:, :, ::-1], grids[:, ::-1, ::-1], swapped[:, ::-1, :]


def sides_of(grids):
    """Views of the four sides of grids ``(faces, n, n, ...)``, each counter-clockwise from its corner."""
    return tuple(grid[:, :, 0] for grid in turned(grids))


def cells_of(grids):
    """Views of the four corners of the cells of grids ``(faces, n, n, ...)``, counter-clockwise."""
    return grids[:, :-1, :-1], grids[:, 1:, :-1], grids[:, 1:, 1:], grids[:, :-1, 1:]


def side_places(side, t):
    """(u, v) at parameters t along sides, ``(len(side) len(t), 2)``."""
    zero, one = np.zeros_like(t), np.ones_like(t)
    table = np.stack([np.column_stack(p) for p in ((t, zero), (one, t), (1 - t, one), (zero, 1 - t))])
    return table[side].reshape(-1, 2)


def between_corners(layout, faces, t):
    """Points at parameters t along u and v between the corners of faces, ``(faces, len(t), len(t), 3)``."""
    a, b, c, d = (layout.points[layout.corners[faces, k]][:, None, None] for k in range(4))
    u, v = t[:, None, None], t[None, :, None]
    return (a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + c * u) * v
