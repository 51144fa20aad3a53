"""Points that live on a mesh: taken back from a coarse mesh to the fine one, moved along it, spread evenly.

Such a point is a triangle and three weights of its corners (its barycentric coordinates).
"""

from collections import namedtuple

import numpy as np
from numba import njit

from nurbs_lab.mesh._kernels_distance import dot, less

PLACES = 8  # where the normals beside an edge are taken
MOST_CROSSINGS = 200  # edges that one move may cross
LEAST_SINE = 0.3  # of a corner of a cell, below which a move must not make it smaller
STEPS = (0.8, 0.4, 0.15, 0.05)  # parts of the way to the mean of the neighbours
PROBE = 0.15  # of the distance to the neighbours: the step of the search for wider corners

# A mesh; of a net, `around[first[i] : first[i + 1]]` are the cells of node i, `mean_of` its neighbours;
# the nodes are points with normals, each in a triangle of the mesh with weights of its corners.
Surface = namedtuple("Surface", "vertices triangles opposite sharp normals")
Net = namedtuple("Net", "cells first around free mean_first mean_of")
Nodes = namedtuple("Nodes", "points normals triangle weights")


@njit(cache=True, nogil=True)
def containing(px, py, size, turned, u, v):
    """Which triangle of a flat picture holds a place, or nearly so, and its barycentric coordinates there."""
    best, place = -np.inf, 0
    s0, s1, s2 = 0.0, 0.0, 0.0
    for j in range(size):
        if turned:  # (u, v, a) and (v, u, b)
            o, b, c = j, 1 - j, 2 + j
            ox, oy = px[o], py[o]
        else:
            b, c = j, (j + 1) % size
            ox, oy = 0.0, 0.0
        x1, y1, x2, y2 = px[b] - ox, py[b] - oy, px[c] - ox, py[c] - oy
        det = x1 * y2 - y1 * x2
        if not det > 0.0:
            continue
        s, t = ((u - ox) * y2 - (v - oy) * x2) / det, (x1 * (v - oy) - y1 * (u - ox)) / det
        least = min(s, t, 1.0 - s - t)
        if least > best:
            best, place, s0, s1, s2 = least, j, 1.0 - s - t, s, t
    return place, s0, s1, s2


@njit(cache=True, nogil=True)
def trace_back(log, count, triangle, weights):
    """Undo collapses and turned edges, last one first, for points on the coarse mesh, in place.

    ``log`` holds, for every change, its half-edges with the flat picture of its ring, and then their number,
    negative for a turned edge. ``count`` is the number of triangles of the fine mesh.
    """
    first, after = np.full(count, -1), np.empty(len(triangle), np.int64)
    for p in range(len(triangle)):
        after[p] = first[triangle[p]]
        first[triangle[p]] = p
    end = len(log)
    while end > 0:
        turned, size = log[end - 1, 0] < 0.0, int(abs(log[end - 1, 0]))
        start = end - 1 - size
        halves, px, py = (
            log[start : end - 1, 0].astype(np.int64),
            log[start : end - 1, 1],
            log[start : end - 1, 2],
        )
        end = start
        moved = -1
        for j in range(0 if turned else 1, 2 if turned else size - 1):
            f, e = halves[j] // 3, halves[j] % 3
            if turned:  # (a, u, b) and (b, v, a)
                e, a, b, c = 0, 2 + j, j, 3 - j
            else:
                a, b, c = 0, j, j + 1
            p, first[f] = first[f], -1
            while p >= 0:
                w0, w1, w2 = weights[p, e], weights[p, (e + 1) % 3], weights[p, (e + 2) % 3]
                weights[p, 0] = w0 * px[a] + w1 * px[b] + w2 * px[c]
                weights[p, 1] = w0 * py[a] + w1 * py[b] + w2 * py[c]
                following, after[p] = after[p], moved
                moved, p = p, following
        while moved >= 0:
            p, moved = moved, after[moved]
            u, v = weights[p, 0], weights[p, 1]
            place, s0, s1, s2 = containing(px, py, 2 if turned else size, turned, u, v)
            s0, s1, s2 = max(s0, 0.0), max(s1, 0.0), max(s2, 0.0)
            f, e, total = halves[place] // 3, halves[place] % 3, s0 + s1 + s2
            weights[p, e], weights[p, (e + 1) % 3], weights[p, (e + 2) % 3] = (
                s0 / total,
                s1 / total,
                s2 / total,
            )
            after[p] = first[f]
            first[f] = p
    for f in range(count):
        p = first[f]
        while p >= 0:
            triangle[p] = f
            p = after[p]


@njit(cache=True, nogil=True, inline="always")
def cross(a, b):
    """Vector product of two triples."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True, nogil=True, inline="always")
def row(table, i):
    """A row of a table as a triple."""
    return table[i, 0], table[i, 1], table[i, 2]


@njit(cache=True, nogil=True, inline="always")
def corners_of(surface, f):
    """The corners of a triangle as triples."""
    a, b, c = surface.triangles[f, 0], surface.triangles[f, 1], surface.triangles[f, 2]
    return row(surface.vertices, a), row(surface.vertices, b), row(surface.vertices, c)


@njit(cache=True, nogil=True, inline="always")
def turned_over(surface, half, flat, left):
    """The rest of a step in one triangle, as it goes on in the next one across a half-edge."""
    f, e = half // 3, half % 3
    tail, head = surface.triangles[f, e], surface.triangles[f, (e + 1) % 3]
    edge = less(row(surface.vertices, head), row(surface.vertices, tail))
    size = np.sqrt(dot(edge, edge))
    edge = (edge[0] / size, edge[1] / size, edge[2] / size)
    along = dot(flat, edge)
    side = (flat[0] - along * edge[0], flat[1] - along * edge[1], flat[2] - along * edge[2])
    rest = np.sqrt(dot(side, side))
    g, e = surface.opposite[half] // 3, surface.opposite[half] % 3
    inward = less(row(surface.vertices, surface.triangles[g, (e + 2) % 3]), row(surface.vertices, tail))
    height = dot(inward, edge)
    inward = (inward[0] - height * edge[0], inward[1] - height * edge[1], inward[2] - height * edge[2])
    size = max(np.sqrt(dot(inward, inward)), 1e-300)
    return (
        left * (along * edge[0] + rest * inward[0] / size),
        left * (along * edge[1] + rest * inward[1] / size),
        left * (along * edge[2] + rest * inward[2] / size),
    )


@njit(cache=True, nogil=True)
def walk(surface, f, w, step, out):
    """Move straight ahead along the mesh, no farther than a sharp edge; the triangle reached.

    The point starts in triangle ``f`` with weights ``w``; ``out`` receives the weights where it ends. Across
    an edge the step turns with the surface.
    """
    out[0], out[1], out[2] = w
    for _ in range(MOST_CROSSINGS):
        a, b, c = corners_of(surface, f)
        first, second = less(b, a), less(c, a)
        uu, uv, vv = dot(first, first), dot(first, second), dot(second, second)
        su, sv = dot(step, first), dot(step, second)
        det = uu * vv - uv * uv
        if not det > 1e-14 * uu * vv:
            return f
        d1, d2 = (vv * su - uv * sv) / det, (uu * sv - uv * su) / det
        slopes = (-d1 - d2, d1, d2)
        t, leaves = 1.0, -1
        for k in range(3):
            if slopes[k] < 0.0 and out[k] + slopes[k] < 0.0 and out[k] / -slopes[k] < t:
                t, leaves = out[k] / -slopes[k], k
        for k in range(3):
            out[k] = max(out[k] + t * slopes[k], 0.0)
        total = out[0] + out[1] + out[2]
        for k in range(3):
            out[k] /= total
        if leaves < 0:
            return f
        half = 3 * f + (leaves + 1) % 3  # the edge that faces corner ``leaves``
        if surface.sharp[half]:
            return f
        flat = (
            d1 * first[0] + d2 * second[0],
            d1 * first[1] + d2 * second[1],
            d1 * first[2] + d2 * second[2],
        )
        at_tail, at_head = out[(leaves + 1) % 3], out[(leaves + 2) % 3]
        step = turned_over(surface, half, flat, 1.0 - t)
        f, e = surface.opposite[half] // 3, surface.opposite[half] % 3
        out[e], out[(e + 1) % 3], out[(e + 2) % 3] = at_head, at_tail, 0.0
    return f


@njit(cache=True, nogil=True)
def normals_beside(vertices, triangles, opposite, normals, halves, reach):
    """Mean normal of the mesh along the straight way from the middle of every half-edge into its triangle.

    The way is ``reach`` long and at right angles to the edge.
    """
    out, end = np.zeros((len(halves), 3)), np.empty(3)
    surface = Surface(vertices, triangles, opposite, np.zeros(3 * len(triangles), np.bool_), normals)
    for i in range(len(halves)):
        f, e = halves[i] // 3, halves[i] % 3
        tail = row(vertices, triangles[f, e])
        edge = less(row(vertices, triangles[f, (e + 1) % 3]), tail)
        side = less(row(vertices, triangles[f, (e + 2) % 3]), tail)
        along = dot(side, edge) / max(dot(edge, edge), 1e-300)
        side = (side[0] - along * edge[0], side[1] - along * edge[1], side[2] - along * edge[2])
        size = max(np.sqrt(dot(side, side)), 1e-300)
        weights = (0.0 if e == 1 else 0.5, 0.0 if e == 2 else 0.5, 0.0 if e == 0 else 0.5)
        for k in range(PLACES):
            far = reach * (k + 0.5) / PLACES / size
            step = (far * side[0], far * side[1], far * side[2])
            g = walk(surface, f, weights, step, end)
            for d in range(3):
                out[i, d] += normals[g, d] / PLACES
    return out


@njit(cache=True, nogil=True)
def place(table, triangles, f, w):
    """The mean of a table's rows at the corners of a triangle."""
    x = y = z = 0.0
    for k in range(3):
        v = triangles[f, k]
        x += w[k] * table[v, 0]
        y += w[k] * table[v, 1]
        z += w[k] * table[v, 2]
    return x, y, z


@njit(cache=True, nogil=True)
def sides_around(cells, normals, first, around, node, out):
    """The sum of the normals at the corners of every cell around a node, and the inverse of its size."""
    for k in range(first[node], first[node + 1]):
        normal = (0.0, 0.0, 0.0)
        for j in range(4):
            n = row(normals, cells[around[k], j])
            normal = (normal[0] + n[0], normal[1] + n[1], normal[2] + n[2])
        one = out[k - first[node]]
        one[0], one[1], one[2] = normal
        one[3] = 1.0 / max(np.sqrt(dot(normal, normal)), 1e-300)


@njit(cache=True, nogil=True)
def least_corner(cells, sides, first, around, node, points, enough):
    """Smallest sine of a corner of the cells around a node, negative where a cell has turned over.

    ``sides`` are those of `sides_around`. The search ends at a cell with a sine below ``enough``.
    """
    worst = 1.0
    for k in range(first[node], first[node + 1]):
        cell, side = around[k], k - first[node]
        normal, scale = row(sides, side), sides[side, 3]
        a, b = row(points, cells[cell, 0]), row(points, cells[cell, 1])
        c, d = row(points, cells[cell, 2]), row(points, cells[cell, 3])
        ahead = (less(b, a), less(c, b), less(d, c), less(a, d))
        behind = ahead[3]
        for edge in ahead:
            size = np.sqrt(dot(edge, edge) * dot(behind, behind))
            worst = min(worst, scale * dot(cross(behind, edge), normal) / max(size, 1e-300))
            behind = edge
        if worst < enough:
            break
    return worst


@njit(cache=True, nogil=True)
def to_mean(net, nodes, i):
    """The way from a node to the mean of its neighbours along the tangent plane, and their mean distance."""
    p, n = row(nodes.points, i), row(nodes.normals, i)
    count = net.mean_first[i + 1] - net.mean_first[i]
    d, reach = (0.0, 0.0, 0.0), 0.0
    for k in range(net.mean_first[i], net.mean_first[i + 1]):
        e = less(row(nodes.points, net.mean_of[k]), p)
        d = (d[0] + e[0] / count, d[1] + e[1] / count, d[2] + e[2] / count)
        reach += np.sqrt(dot(e, e)) / count
    up = dot(d, n)
    return (d[0] - up * n[0], d[1] - up * n[1], d[2] - up * n[2]), reach


@njit(cache=True, nogil=True)
def move(surface, net, nodes, i, trial, sides):
    """Move a node to the mean of its neighbours or, from narrow corners, to wider ones; whether it moved."""
    d, reach = to_mean(net, nodes, i)
    n = row(nodes.normals, i)
    sides_around(net.cells, nodes.normals, net.first, net.around, i, sides)
    before = least_corner(net.cells, sides, net.first, net.around, i, nodes.points, -np.inf)
    old = row(nodes.points, i)
    start, w, best, done = nodes.triangle[i], row(nodes.weights, i), before, False
    for part in STEPS:
        way = (part * d[0], part * d[1], part * d[2])
        g = walk(surface, start, w, way, trial)
        nodes.points[i] = place(surface.vertices, surface.triangles, g, trial)
        now = least_corner(net.cells, sides, net.first, net.around, i, nodes.points, min(before, LEAST_SINE))
        if now >= min(before, LEAST_SINE):
            nodes.triangle[i], nodes.weights[i] = g, trial
            best, done, old = now, True, row(nodes.points, i)
            break
    if best < LEAST_SINE and best < before + 0.02:
        side = cross(n, (1.0, 0.0, 0.0) if abs(n[0]) < 0.7 else (0.0, 1.0, 0.0))
        size = max(np.sqrt(dot(side, side)), 1e-300)
        side = (side[0] / size, side[1] / size, side[2] / size)
        other = cross(n, side)
        start, w = nodes.triangle[i], row(nodes.weights, i)
        for k in range(8):
            c, s = PROBE * reach * np.cos(k * np.pi / 4), PROBE * reach * np.sin(k * np.pi / 4)
            way = (c * side[0] + s * other[0], c * side[1] + s * other[1], c * side[2] + s * other[2])
            g = walk(surface, start, w, way, trial)
            nodes.points[i] = place(surface.vertices, surface.triangles, g, trial)
            now = least_corner(net.cells, sides, net.first, net.around, i, nodes.points, best)
            if now > best:
                nodes.triangle[i], nodes.weights[i] = g, trial
                best, done, old = now, True, row(nodes.points, i)
    nodes.points[i] = old
    return done


@njit(cache=True, nogil=True)
def spread(surface, net, nodes, times):
    """Move nodes on the mesh to the mean of their neighbours, as far as no cell is turned over by it.

    Normals of nodes that do not count for a cell are zero. Where a corner is narrow or turned over, the node
    goes where that is mended best instead.
    """
    trial, sides = np.empty(3), np.empty((np.diff(net.first).max(), 4))
    for _ in range(times):
        for i in range(len(nodes.points)):
            if net.free[i] and move(surface, net, nodes, i, trial, sides):
                x, y, z = place(surface.normals, surface.triangles, nodes.triangle[i], nodes.weights[i])
                size = max(np.sqrt(x * x + y * y + z * z), 1e-300)
                nodes.normals[i, 0], nodes.normals[i, 1], nodes.normals[i, 2] = x / size, y / size, z / size
