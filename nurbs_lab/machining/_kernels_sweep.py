"""Distances of points from a cutter at many tips, and the cutting of a height field."""

import numpy as np

from nurbs_lab.common.kernels import ZERO, compiled, inlined
from nurbs_lab.machining._kernels_contact import ROUNDING, rise


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


@compiled
def into_cells(tips, low, size, nx, ny):
    """Tips sorted into square cells: the first and the lowest tip of every cell, and the order of tips."""
    count, lowest = np.zeros(nx * ny + 1, np.int64), np.full(nx * ny, np.inf)
    cell = np.empty(len(tips), np.int64)
    for i in range(len(tips)):
        x, y = int((tips[i, 0] - low[0]) / size), int((tips[i, 1] - low[1]) / size)
        cell[i] = min(max(x, 0), nx - 1) * ny + min(max(y, 0), ny - 1)
        count[cell[i] + 1] += 1
        lowest[cell[i]] = min(lowest[cell[i]], tips[i, 2])
    first = np.cumsum(count)
    place, order = first[:-1].copy(), np.empty(len(tips), np.int64)
    for i in range(len(tips)):
        order[place[cell[i]]] = i
        place[cell[i]] += 1
    return first, lowest, order


@compiled
def left(points, tips, cells, shape, reach, out, which):
    """Distance of every point to the nearest of all cutters, at most ``reach``, which may be infinite.

    ``which`` is the number of its tip, or any other if none is so near.

    The tips are sorted into ``cells`` by `into_cells`. The tip nearest to one point gives a first distance
    for the next; others are looked for farther and farther away. Cells whose tips are all farther away than
    the nearest one are skipped.
    """
    held, w = ZERO, shape[3]
    for i in range(len(points)):
        out[i], most = np.inf, 0.5 * min(reach, w / 3.0)
        while out[i] >= most and most < reach:
            most = min(2.0 * most, reach)
            out[i], held = nearest(points[i], tips, cells, shape, most, held)
        which[i] = held


@compiled
def nearest(point, tips, cells, shape, most, held):
    """Distance of a point to the nearest cutter, at most ``most``, and the number of its tip."""
    (first, lowest, low, size, nx, ny), r, (x, y, z) = cells, shape[1], (point[0], point[1], point[2])
    best = min(most, depth(x - tips[held, 0], y - tips[held, 1], z - tips[held, 2], shape))
    span = shape[3] + max(best, 0.0)
    x0, x1 = int((x - span - low[0]) / size), int((x + span - low[0]) / size)
    y0, y1 = int((y - span - low[1]) / size), int((y + span - low[1]) / size)
    for cx in range(max(x0, 0), min(x1, nx - 1) + 1):
        dx = max(low[0] + cx * size - x, x - low[0] - (cx + 1) * size, 0.0)
        for cy in range(max(y0, 0), min(y1, ny - 1) + 1):
            cell = cx * ny + cy
            dy = max(low[1] + cy * size - y, y - low[1] - (cy + 1) * size, 0.0)
            if depth(dx, dy, z - lowest[cell], shape) >= best + ROUNDING * size:
                continue
            for k in range(first[cell], first[cell + 1]):
                dz = z - tips[k, 2]
                if r - dz < best + r:  # else the tip is too high above the point
                    off = depth(x - tips[k, 0], y - tips[k, 1], dz, shape)
                    if off < best:
                        best, held = off, k
    return best, held


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
def cut(grid, tips, shape, grow, bodies, before, rim, found):
    """Lower a height field to the cutter at each of the tips.

    The distance of a node from the axis counts as larger by ``grow``. ``bodies (k, 2)`` have a radius and a
    height above the tip. ``found (3 + k,)`` takes the volume, the largest amount by which material stood
    above the tip under the cutter, the same for material whose top, as it was in the heights ``before``, is
    cut off and came deeper than ``rim`` into the cutter, and how deep each body was in it.
    """
    (heights, low, step), w = grid, shape[3]
    nx, ny = heights.shape
    wide, volume, top = (w - grow) / step, 0.0, -np.inf
    for b in range(len(bodies)):
        top = max(top, heights.max() - bodies[b, 1])
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
                off = step * np.sqrt((i - x) ** 2 + (j - y) ** 2) + grow
                lower = z + rise(min(off, w), shape)
                if lower < heights[i, j]:
                    volume += heights[i, j] - lower
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
