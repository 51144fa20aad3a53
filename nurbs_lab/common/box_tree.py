"""A binary tree of boxes, for searches that visit the nearest boxes first.

``boxes (2 leaves - 1, 2 dim)`` holds the least and then the largest coordinates of every node. The children
of node i are 2 i + 1 and 2 i + 2; the last ``leaves`` nodes are the leaves, a power of two. Leaves that are
missing are infinitely far from everything.
"""

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined

LEAF = 4  # items of a leaf


def box_tree(leaves):
    """The tree over the boxes ``leaves (m, 2 dim)``."""
    dim, size = leaves.shape[1] // 2, 1 << max(len(leaves) - 1, 0).bit_length()
    boxes = np.full((2 * size - 1, 2 * dim), np.repeat([np.inf, -np.inf], dim))
    boxes[size - 1 : size - 1 + len(leaves)] = leaves
    while size > 1:
        size //= 2
        nodes, below = boxes[size - 1 : 2 * size - 1], boxes[2 * size - 1 : 4 * size - 1]
        np.minimum(below[::2, :dim], below[1::2, :dim], out=nodes[:, :dim])
        np.maximum(below[::2, dim:], below[1::2, dim:], out=nodes[:, dim:])
    return boxes


@inlined
def box_distance(boxes, node, point):
    """Squared distance of a point (an array, or faster a tuple) to a box, zero inside."""
    dim = len(point)
    total = 0.0
    for d in range(dim):
        gap = max(boxes[node, d] - point[d], point[d] - boxes[node, dim + d], 0.0)
        total += gap * gap
    return total


@inlined
def open_box(node, to_left, to_right, stack, bounds, waiting):
    """Push the two children of a node with the distances of both, the nearer one on top; return the size."""
    near, far = 2 * node + 1, 2 * node + 2
    if to_right < to_left:
        near, far, to_left, to_right = far, near, to_right, to_left
    stack[waiting], bounds[waiting] = far, to_right
    stack[waiting + 1], bounds[waiting + 1] = near, to_left
    return waiting + 2


def morton(cells):
    """Places ``(n,)`` of cells with coordinates ``(n, dim)`` along the Z-order curve, neighbours together."""
    code, dim = np.zeros(len(cells), np.int64), cells.shape[1]
    for bit in range(int(cells.max()).bit_length()):
        for d in range(dim):
            code |= ((cells[:, d] >> bit) & 1) << (dim * bit + d)
    return code


def order_along(places):
    """An order of places ``(n, dim)`` along the Z-order curve, in which neighbours come together."""
    low, high = np.array([[x.min(), x.max()] for x in places.T]).T
    extent = (high - low).max()
    cells = (places - low) * ((2**20 - 1) / extent if extent > 0 else 0.0)
    return np.argsort(morton(cells.astype(np.int64)), kind="stable")


@compiled
def order_halved(places):
    """An order of places ``(n, dim)`` for a tree whose nodes are halved across their longest side."""
    order, size = np.arange(len(places)), LEAF
    while size < len(places):
        size *= 2
    waiting = [(0, len(places), size)]
    while waiting:
        start, stop, size = waiting.pop()
        half, some = size // 2, order[start:stop]
        if half < LEAF:
            continue
        if len(some) > half:
            sides = np.array([np.ptp(places[some, d]) for d in range(places.shape[1])])
            along = places[some, sides.argmax()]
            cut = np.partition(along, half)[half]
            order[start:stop] = np.concatenate((some[along < cut], some[along == cut], some[along > cut]))
            waiting.append((start + half, stop, half))
        waiting.append((start, min(start + half, stop), half))
    return order


def tree_along(places, lows, highs, order=None):
    """Items in boxes from ``lows (n, 3)`` to ``highs``: an ``order`` by their places, and a tree over it.

    Every leaf holds `LEAF` items that follow one another in this order ``(n,)``, the last one perhaps fewer.
    """
    order = order_halved(places) if order is None else order
    leaves = np.append(order, order[-1:].repeat(-len(order) % LEAF)).reshape(-1, LEAF).T
    return order, box_tree(np.hstack([lows[leaves].min(axis=0), highs[leaves].max(axis=0)]))
