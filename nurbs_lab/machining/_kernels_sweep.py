"""Distances of points from a cutter at many tips, and the cutting of a height field."""

import numpy as np

from nurbs_lab.common.box_tree import LEAF, open_box
from nurbs_lab.common.kernels import ZERO, compiled, inlined
from nurbs_lab.machining._kernels_contact import rise


@inlined
def beside_cone(u, v, c, size):
    """Signed distance to a cone: ``u`` outside its disc, ``v`` above it, which widens by ``size``."""
    side = np.sqrt(1.0 + c * c)
    along, off = (u + c * v) / side, (c * u - v) / side
    if along <= 0.0:  # below the side
        return np.sqrt(u * u + v * v) if u > 0.0 else max(-v, off)
    if along < size * side:
        return max(off, -v)
    if u > size and v < c * size:
        return np.sqrt((u - size) ** 2 + (v - c * size) ** 2)
    return max(u - size, off)


@inlined
def depth(dx, dy, dz, shape):
    """Signed distance of a point to a cutter whose tip is at the origin, negative inside.

    The cutter is all that is nearer than r to a vertical cylinder of radius a from height r upwards, or to a
    cone of that height and radius, whose side rises by c.
    """
    a, r, c, w = shape
    if c < np.inf:
        return beside_cone(np.sqrt(dx * dx + dy * dy) - a, dz - r, c, w - r - a) - r
    out, down = np.sqrt(dx * dx + dy * dy) - a, r - dz
    if out <= 0.0 and down <= 0.0:
        return max(out, down) - r
    out, down = max(out, 0.0), max(down, 0.0)
    return np.sqrt(out * out + down * down) - r


@inlined
def off(dx, dy, dz, shape, upright):
    """`depth` of a point, or how high above it the cutter is, infinite beside it."""
    if not upright:
        return depth(dx, dy, dz, shape)
    d = np.sqrt(dx * dx + dy * dy)
    return rise(d, shape) - dz if d <= shape[3] else np.inf


@inlined
def beside_box(boxes, node, x, y, z, shape, upright):
    """How far `off` a point is, no more than that for any tip in the box."""
    dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
    dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
    return off(dx, dy, z - boxes[node, 2], shape, upright)


@compiled
def left(points, shape, tips, boxes, enough, upright, out, nearest):
    """Lower ``out`` at every point to how far `off` the nearest of all cutters is, and take its tip.

    The tips are in the order of the tree ``boxes``. The nearer one of two boxes is opened first. The tip
    nearest to one point gives a first distance for the next. A search ends below ``enough (n,)``.
    """
    held, leaves, stack, gaps = ZERO, (len(boxes) + 1) // 2, np.empty(128, np.int64), np.empty(128)
    for i in range(len(points) if len(tips) else 0):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        best = min(out[i], off(x - tips[held, 0], y - tips[held, 1], z - tips[held, 2], shape, upright))
        stack[0], gaps[0], waiting = 0, -np.inf, 1
        while waiting and best >= enough[i]:
            waiting -= 1
            node = stack[waiting]
            if gaps[waiting] >= best:
                continue
            if node < leaves - 1:
                to_left = beside_box(boxes, 2 * node + 1, x, y, z, shape, upright)
                to_right = beside_box(boxes, 2 * node + 2, x, y, z, shape, upright)
                waiting = open_box(node, to_left, to_right, stack, gaps, waiting)
                continue
            start = (node - leaves + 1) * LEAF
            for k in range(start, min(start + LEAF, len(tips))):
                gap = off(x - tips[k, 0], y - tips[k, 1], z - tips[k, 2], shape, upright)
                if gap < best:
                    best, held = gap, k
        if best < out[i]:
            out[i], nearest[i] = best, tips[held]


@compiled
def rest_at(grid, x, y, shape, grow):
    """Height of the tip of a cutter that rests on a height field, -inf where it meets no node.

    The distance of a node from the axis counts as smaller by ``grow``.
    """
    (heights, low, step), w = grid, shape[3]
    nx, ny = heights.shape
    x, y, wide, best = (x - low[0]) / step, (y - low[1]) / step, (w + grow) / step, -np.inf
    for i in range(max(int(np.ceil(x - wide)), 0), min(int(np.floor(x + wide)), nx - 1) + 1):
        across = np.sqrt(max(wide * wide - (i - x) ** 2, 0.0))
        for j in range(max(int(np.ceil(y - across)), 0), min(int(np.floor(y + across)), ny - 1) + 1):
            if heights[i, j] > best:
                off = max(step * np.sqrt((i - x) ** 2 + (j - y) ** 2) - grow, 0.0)
                best = max(best, heights[i, j] - rise(min(off, w), shape))
    return best


@compiled
def cut(grid, tips, shape, grow, bodies, before, top, rim, edges, found):
    """Lower a height field to the cutter at each of the tips.

    The distance of a node from the axis counts as larger by ``grow``. ``bodies (k, 2)`` have a radius and a
    height above the tip, and meet nothing with tips above ``top``. ``found (3 + k,)`` takes the volume, with
    ``edges`` the share of a cell at the first and last x and y that is stock, the largest amount by which
    material stood above the tip under the cutter, the same for material whose top, as it was in the heights
    ``before``, is cut off and came deeper than ``rim`` into the cutter, and how deep each body was in it.
    """
    (heights, low, step), w = grid, shape[3]
    nx, ny = heights.shape
    wide, volume = (w - grow) / step, 0.0
    for k in range(len(tips)):
        x, y, z = (tips[k, 0] - low[0]) / step, (tips[k, 1] - low[1]) / step, tips[k, 2]
        if z < top:
            for b in range(len(bodies)):
                flat = bodies[b, 0], 0.0, np.inf, bodies[b, 0]
                above = rest_at(grid, tips[k, 0], tips[k, 1], flat, 0.0) - bodies[b, 1] - z
                found[3 + b] = max(found[3 + b], above)
        for i in range(max(int(np.ceil(x - wide)), 0), min(int(np.floor(x + wide)), nx - 1) + 1):
            across = np.sqrt(max(wide * wide - (i - x) ** 2, 0.0))
            for j in range(max(int(np.ceil(y - across)), 0), min(int(np.floor(y + across)), ny - 1) + 1):
                if before[i, j] <= z:  # nor are the heights above the tip
                    continue
                off = step * np.sqrt((i - x) ** 2 + (j - y) ** 2) + grow
                lower = z + rise(min(off, w), shape)
                if lower < heights[i, j]:
                    share = edges[0] if i == 0 or i == nx - 1 else 1.0
                    share *= edges[1] if j == 0 or j == ny - 1 else 1.0
                    volume += share * (heights[i, j] - lower)
                    found[1] = max(found[1], heights[i, j] - z)
                    heights[i, j] = lower
                above = before[i, j] - z
                fresh = before[i, j] > heights[i, j] and above > found[2]
                if fresh and depth(off, 0.0, above, shape) < -rim:
                    found[2] = above
    found[0] += volume * step * step


@compiled
def rest(grid, xy, shape, grow, out):
    """`rest_at` at every point."""
    for k in range(len(xy)):
        out[k] = rest_at(grid, xy[k, 0], xy[k, 1], shape, grow)
