"""Grids of nodes on a layout, such as control points: numbers, sides and cells.

Side k of a face runs from its corner k to the next: v = 0, u = 1, v = 1, u = 0.
"""

import numpy as np

DEGREE = 5  # of all patches


def number_nodes(layout, n):
    """Numbers of n x n nodes of every face, ``(faces, n, n)``, equal where faces meet; how many there are.

    The nodes of vertices come first, then those of edges, in their direction, then those inside the faces.
    """
    net = np.empty((len(layout.edges), n, n), dtype=np.int64)
    first = int(layout.corners.max()) + 1
    for k, side in enumerate(sides_of(net)):
        along = first + (n - 2) * layout.edges[:, k, None] + np.arange(n - 2)
        side[:, 0] = layout.corners[:, k]
        side[:, 1:-1] = np.where(layout.forward[:, k, None], along, along[:, ::-1])
    count, inside = first + (n - 2) * len(layout.sides), net[:, 1:-1, 1:-1]
    inside[:] = count + np.arange(inside.size).reshape(inside.shape)
    return net, count + inside.size


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
