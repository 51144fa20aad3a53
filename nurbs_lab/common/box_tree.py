"""A binary tree of boxes over leaves in Morton order, for searches that visit the nearest boxes first.

``boxes (2 leaves - 1, 2 dim)`` holds the least and then the largest coordinates of every node. The children
of node i are 2 i + 1 and 2 i + 2; the last ``leaves`` nodes are the leaves, a power of two. Leaves that are
missing are infinitely far from everything.
"""

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined

LEAF = 4  # items of a leaf


@compiled
def box_tree(leaves):
    """The tree over the boxes ``leaves (m, 2 dim)``."""
    dim = leaves.shape[1] // 2
    size = 1
    while size < len(leaves):
        size *= 2
    boxes = np.empty((2 * size - 1, 2 * dim))
    for i in range(size):
        for d in range(2 * dim):
            missing = np.inf if d < dim else -np.inf
            boxes[size - 1 + i, d] = leaves[i, d] if i < len(leaves) else missing
    for node in range(size - 2, -1, -1):
        for d in range(dim):
            boxes[node, d] = min(boxes[2 * node + 1, d], boxes[2 * node + 2, d])
            boxes[node, dim + d] = max(boxes[2 * node + 1, dim + d], boxes[2 * node + 2, dim + d])
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


@compiled
def morton(cells):
    """Places ``(n,)`` of cells with coordinates ``(n, dim)`` along the Z-order curve, neighbours together."""
    count, dim = cells.shape
    code = np.zeros(count, np.int64)
    top = 0
    for i in range(count):
        for d in range(dim):
            top = max(top, cells[i, d])
    bits = 0
    while top >> bits:
        bits += 1
    for i in range(count):
        for bit in range(bits):
            for d in range(dim):
                code[i] |= ((cells[i, d] >> bit) & 1) << (dim * bit + d)
    return code


def order_along(places):
    """An order of places ``(n, dim)`` along the Z-order curve, in which neighbours come together."""
    low, high = np.array([[x.min(), x.max()] for x in places.T]).T
    extent = (high - low).max()
    cells = (places - low) * ((2**20 - 1) / extent if extent > 0 else 0.0)
    return np.argsort(morton(cells.astype(np.int64)), kind="stable")


def tree_along(places, lows, highs):
    """Items in boxes from ``lows (n, 3)`` to ``highs``: an order along the Z-order curve, and a tree over it.

    Every leaf holds `LEAF` items that follow one another in this order ``(n,)``, the last one perhaps fewer.
    """
    order = order_along(places)
    starts = np.arange(0, len(order), LEAF)
    leaves = np.minimum.reduceat(lows[order], starts), np.maximum.reduceat(highs[order], starts)
    return order, box_tree(np.hstack(leaves))
