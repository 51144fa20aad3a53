"""Searches for the triangles that a cutter touches, in their tree of boxes."""

import numpy as np

from nurbs_lab.common.box_tree import LEAF
from nurbs_lab.common.kernels import ZERO, compiled, kernel
from nurbs_lab.machining._kernels_contact import ROUNDING, inside, may_stop, over_triangle

PUSHED = 2e-5  # fraction of the radius: how precisely a cutter is pushed against the part


@kernel
def holds(body, node, x, y, z, shape):
    """Whether anything in the box may stop a tip at (x, y, z)."""
    boxes = body[3]
    dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
    dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
    return inside(dx * dx + dy * dy, boxes[node, 5] - z, shape)


@compiled
def highest(x, y, best, enough, held, body, shape, waiting):
    """The larger of ``best`` and the height of the tip over the part at (x, y), and the triangle below it.

    Triangle ``held`` is looked at first, then boxes, the higher one of two first. The search ends when the
    height is more than ``enough``. ``waiting (128,)`` is room to work in.
    """
    p, boxes = body[0], body[3]
    leaves = (len(boxes) + 1) // 2
    best = over_triangle(body, held, x, y, shape, best)
    waiting[0], depth = 0, 1
    while depth and best <= enough:
        depth -= 1
        node = waiting[depth]
        if not holds(body, node, x, y, best, shape):
            continue
        if node < leaves - 1:
            lower = int(boxes[2 * node + 1, 5] > boxes[2 * node + 2, 5])
            waiting[depth], waiting[depth + 1] = 2 * node + 1 + lower, 2 * node + 2 - lower
            depth += 2
            continue
        start = (node - leaves + 1) * LEAF
        for f in range(start, min(start + LEAF, len(p))):
            height = over_triangle(body, f, x, y, shape, best)
            if height > best:
                best, held = height, f
    return best, held


@compiled
def drop(xy, least, body, shape, out):
    """Height of the resting tip at every point, or ``least`` where that is higher.

    Successive points are usually close together, so the triangle that stopped the last one comes first.
    """
    waiting, held = np.empty(128, np.int64), ZERO
    for i in range(len(xy)):
        out[i], held = highest(xy[i, 0], xy[i, 1], least[i], np.inf, held, body, shape, waiting)


@compiled
def around(x, y, level, body, shape, found):
    """Fill ``found`` with the triangles that may stop a tip at (x, y) above ``level``.

    Returns how many there are.
    """
    leaves, stack = (len(body[3]) + 1) // 2, np.empty(128, np.int64)
    stack[0], depth, count = 0, 1, 0
    while depth:
        depth -= 1
        node = stack[depth]
        if not holds(body, node, x, y, level, shape):
            continue
        if node < leaves - 1:
            stack[depth], stack[depth + 1] = 2 * node + 1, 2 * node + 2
            depth += 2
            continue
        start = (node - leaves + 1) * LEAF
        for f in range(start, min(start + LEAF, len(body[0]))):
            if may_stop(body, f, x, y, level, shape):
                found[count] = f
                count += 1
    return count


@kernel
def stopped(near, x, y, z, body, shape):
    """Whether one of these triangles stops a tip at (x, y, z); it comes first of them then."""
    for k in range(len(near)):
        if over_triangle(body, near[k], x, y, shape, z) > z:
            near[0], near[k] = near[k], near[0]
            return True
    return False


@compiled
def collides(tips, starts, body, cutter, farther, out):
    """Whether a cutter cuts into the part at any tip of each row, or another one does not.

    Row i is ``tips[starts[i] : starts[i + 1]]``. A cutter is its shape and by how much it is higher; the
    other may be None.
    """
    waiting, held = np.empty(128, np.int64), ZERO
    for i in range(len(out)):
        out[i] = False
        for k in range(starts[i], starts[i + 1]):
            x, y, z = tips[k, 0], tips[k, 1], tips[k, 2] - cutter[1]
            height, held = highest(x, y, z, z, held, body, cutter[0], waiting)
            out[i] = height > z
            if not out[i] and farther is not None:
                z = tips[k, 2] - farther[1]
                height, held = highest(x, y, z, z, held, body, farther[0], waiting)
                out[i] = height <= z
            if out[i]:
                break


@compiled
def push(free, stuck, level, body, shape, out):
    """How far a cutter moves sideways at height ``level[i]``, from ``free[i]`` towards ``stuck[i]``.

    Returned is the fraction of the distance at which the part stops it, to ``PUSHED`` on the free side, by
    bisection; NaN if nothing stops it or if it collides at the start already.
    """
    found, (a, r, c, w) = np.empty(len(body[0]), np.int64), shape
    for i in range(len(free)):
        x, y, z, out[i] = free[i, 0], free[i, 1], level[i], np.nan
        dx, dy = stuck[i, 0] - x, stuck[i, 1] - y
        size = np.sqrt(dx * dx + dy * dy)
        wider = a + size / 2, r, c, w + size / 2
        near = found[: around(x + dx / 2, y + dy / 2, z, body, wider, found)]
        if stopped(near, x, y, z, body, shape) or not stopped(near, x + dx, y + dy, z, body, shape):
            continue
        low, high = 0.0, 1.0
        while (high - low) * size > PUSHED * w:
            middle = 0.5 * (low + high)
            if stopped(near, x + middle * dx, y + middle * dy, z, body, shape):
                high = middle
            else:
                low = middle
        out[i] = low


@compiled
def depths(tips, body, shape, out):
    """How much smaller all round a cutter must be not to cut into the part, by bisection."""
    waiting, held, (a, r, c, w) = np.empty(128, np.int64), ZERO, shape
    for i in range(len(tips)):
        x, y = tips[i, 0], tips[i, 1]
        low, high = 0.0, w
        while high - low > ROUNDING * w:
            less = 0.5 * (low + high)
            flat, corner, up = a + min(r - less, 0.0), max(r - less, 0.0), less
            if c < np.inf:  # the side moves inwards by its own normal, and ends in a point at last
                flat = a - max(less - r, 0.0) * (np.sqrt(1.0 + c * c) - 1.0) / c
                up, flat = less + c * max(-flat, 0.0), max(flat, 0.0)
            z, smaller = tips[i, 2] + up, (flat, corner, c, w - less)
            height, held = highest(x, y, z, z, held, body, smaller, waiting)
            if height > z:
                low = less
            else:
                high = less
        out[i] = high
