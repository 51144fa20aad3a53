"""A binary tree of boxes over leaves in Morton order, for searches that visit the nearest boxes first.

``boxes (2 leaves - 1, 2 dim)`` holds the least and then the largest coordinates of every node. The children
of node i are 2 i + 1 and 2 i + 2; the last ``leaves`` nodes are the leaves, a power of two. Leaves that are
missing are infinitely far from everything.
"""

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined


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
def open_box(boxes, node, point, stack, bounds, waiting):
    """Push the two children of a node on the stack, the nearer one on top; return the size of the stack."""
    near, far = 2 * node + 1, 2 * node + 2
    to_near, to_far = box_distance(boxes, near, point), box_distance(boxes, far, point)
    if to_far < to_near:
        near, far, to_near, to_far = far, near, to_far, to_near
    stack[waiting], bounds[waiting] = far, to_far
    stack[waiting + 1], bounds[waiting + 1] = near, to_near
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


def along_morton(points):
    """An order ``(n,)`` of points in space along the Z-order curve."""
    extent = np.ptp(points, axis=0).max()
    cells = (points - points.min(axis=0)) * ((2**20 - 1) / extent if extent > 0 else 0.0)
    return np.argsort(morton(cells.astype(np.int64)), kind="stable")
