"""Searches for the triangles that a cutter touches, in their tree of boxes."""

import numpy as np
from numba import njit

from nurbs_lab.machining._kernels_contact import ROUNDING, inside, may_stop, over_parts, over_triangle, rise
from nurbs_lab.nurbs.span_kernels import kernel

PUSHED = 2e-6  # fraction of the radius: how precisely a cutter is pushed against the part
HALVINGS = 30  # of a depth


@kernel
def bound(body, node, x, y, shape, best):
    """Upper bound of the height of the tip at (x, y) over anything in the box.

    A bound that is not above ``best`` may be replaced by any number up to ``best``.
    """
    boxes, w = body[3], shape[3]
    if boxes[node, 5] <= best:
        return best
    dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
    dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
    square, reach = dx * dx + dy * dy, w * (1.0 + ROUNDING)
    return boxes[node, 5] - rise(np.sqrt(square), shape) if square <= reach * reach else best


@njit(cache=True, nogil=True)
def highest(x, y, best, enough, held, body, shape, waiting):
    """The larger of ``best`` and the height of the tip over the part at (x, y), and the triangle below it.

    Triangle ``held`` is looked at first, then boxes in the order of their bounds, the highest first. The
    search ends when the height is more than ``enough``. ``waiting (2, 128)`` is room to work in.
    """
    p, boxes, leaf = body[0], body[3], body[4]
    leaves = (len(boxes) + 1) // 2
    nodes, bounds = waiting
    best = over_triangle(body, held, x, y, shape, best)
    nodes[0], bounds[0], depth = 0, bound(body, 0, x, y, shape, best), 1
    while depth and best <= enough:
        depth -= 1
        node = int(nodes[depth])
        if bounds[depth] <= best:
            continue
        if node >= leaves - 1:
            start = (node - leaves + 1) * leaf
            for f in range(start, min(start + leaf, len(p))):
                height = over_triangle(body, f, x, y, shape, best)
                if height > best:
                    best, held = height, f
            continue
        one, two = 2 * node + 1, 2 * node + 2
        under_one, under_two = bound(body, one, x, y, shape, best), bound(body, two, x, y, shape, best)
        if under_one > under_two:
            one, two, under_one, under_two = two, one, under_two, under_one
        nodes[depth], bounds[depth], nodes[depth + 1], bounds[depth + 1] = one, under_one, two, under_two
        depth += 2
    return best, held


@njit(cache=True, nogil=True)
def drop(xy, body, shape, out):
    """Height of the resting tip at every point, -inf where it meets nothing.

    Successive points are usually close together, so the triangle that stopped the last one comes first.
    """
    waiting, held = np.empty((2, 128)), 0
    for i in range(len(xy)):
        out[i], held = highest(xy[i, 0], xy[i, 1], -np.inf, np.inf, held, body, shape, waiting)


@njit(cache=True, nogil=True)
def collides(tips, body, shape, out):
    """Whether a cutter cuts into the part with its tip at any tip of each row of ``tips (n, m, 3)``."""
    waiting, held = np.empty((2, 128)), 0
    for i in range(len(tips)):
        out[i] = False
        for x, y, z in tips[i]:
            height, held = highest(x, y, z, z, held, body, shape, waiting)
            if height > z:
                out[i] = True
                break


@njit(cache=True, nogil=True)
def around(x, y, level, beside, body, shape, found):
    """Fill ``found`` with the triangles that may stop tips within ``beside`` of (x, y) above ``level``.

    Returns how many there are.
    """
    p, boxes, leaf = body[0], body[3], body[4]
    leaves = (len(boxes) + 1) // 2
    stack = np.empty(128, np.int64)
    stack[0], depth, count = 0, 1, 0
    wider = shape[0] + beside, shape[1], shape[2], shape[3] + beside
    while depth:
        depth -= 1
        node = stack[depth]
        dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
        dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
        if not inside(dx * dx + dy * dy, boxes[node, 5] - level, wider):
            continue
        if node < leaves - 1:
            stack[depth], stack[depth + 1] = 2 * node + 1, 2 * node + 2
            depth += 2
            continue
        start = (node - leaves + 1) * leaf
        for f in range(start, min(start + leaf, len(p))):
            if may_stop(body, f, x, y, level, wider):
                found[count] = f
                count += 1
    return count


@kernel
def stops(f, x, y, z, body, shape):
    """Whether triangle f keeps the tip from going down to (x, y, z)."""
    return over_triangle(body, f, x, y, shape, z) > z


@kernel
def first_stop(near, x, y, z, body, shape):
    """Position in ``near`` of the first triangle that stops the tip at (x, y, z), -1 if none does."""
    k = 0
    while k < len(near) and not stops(near[k], x, y, z, body, shape):
        k += 1
    return k if k < len(near) else -1


@njit(cache=True, nogil=True)
def push(free, stuck, level, body, shape, out):
    """How far a cutter moves sideways at height ``level[i]``, from ``free[i]`` towards ``stuck[i]``.

    Returned is the fraction of the distance at which the part stops it, to ``PUSHED`` on the free side;
    NaN if nothing stops it or if it collides at the start already.
    """
    near = np.empty(len(body[0]), np.int64)
    for i in range(len(free)):
        x, y, z = free[i, 0], free[i, 1], level[i]
        dx, dy = stuck[i, 0] - x, stuck[i, 1] - y
        size = np.sqrt(dx * dx + dy * dy)
        count = around(x + dx / 2, y + dy / 2, z, size / 2, body, shape, near)
        out[i] = push_against(near[:count], x, y, z, dx, dy, body, shape)


@njit(cache=True, nogil=True)
def push_against(near, x, y, z, dx, dy, body, shape):
    """`push` along (dx, dy) against the triangles ``near`` only.

    For each triangle that stops it the cutter moves back until none stops it, by the rule of false position
    (Illinois), or by bisection as long as there is no finite height on both sides.
    """
    w = shape[3]
    way, met, fine = 1.0, True, PUSHED * w / max(np.sqrt(dx * dx + dy * dy), PUSHED * w)
    while met:
        met = False
        for f in near:
            if not stops(f, x + way * dx, y + way * dy, z, body, shape):
                continue
            if way <= 0.0:
                return np.nan
            met, low, below, above, side = True, 0.0, -np.inf, np.inf, 0
            while way - low > fine:
                middle = 0.5 * (low + way)
                if below > -np.inf and above < np.inf:
                    middle = (low * above - way * below) / (above - below)
                    middle = min(max(middle, low + 0.5 * fine), way - 0.5 * fine)
                over = over_parts(body, f, x + middle * dx, y + middle * dy, shape, -np.inf) - z
                if over > 0.0:
                    way, above = middle, over
                    below *= 0.5 if side > 0 else 1.0
                    side = 1
                else:
                    low, below = middle, over
                    above *= 0.5 if side < 0 else 1.0
                    side = -1
            way = low
    return way if way < 1.0 else np.nan


@njit(cache=True, nogil=True)
def depths(tips, body, shape, out):
    """How much smaller all round a cutter must be not to cut into the part, by bisection."""
    near, (a, r, c, w) = np.empty(len(body[0]), np.int64), shape
    for i in range(len(tips)):
        x, y, z = tips[i, 0], tips[i, 1], tips[i, 2]
        count = around(x, y, z, 0.0, body, shape, near)
        low, high = 0.0, w
        for _ in range(HALVINGS):
            less = 0.5 * (low + high)
            flat, corner, up = a + min(r - less, 0.0), max(r - less, 0.0), less
            if c < np.inf:  # the side moves inwards by its own normal, and ends in a point at last
                flat = a - max(less - r, 0.0) * (np.sqrt(1.0 + c * c) - 1.0) / c
                up, flat = less + c * max(-flat, 0.0), max(flat, 0.0)
            if first_stop(near[:count], x, y, z + up, body, (flat, corner, c, w - less)) >= 0:
                low = less
            else:
                high = less
        out[i] = high
