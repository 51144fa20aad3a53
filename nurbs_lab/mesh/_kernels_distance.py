"""Exact distance from points to a triangle mesh: a tree of boxes over triangles."""

import numpy as np

from nurbs_lab.common.box_tree import LEAF, box_distance, open_box
from nurbs_lab.common.kernels import compiled, inlined, kernel

ROUNDING = 1e-11  # difference of distances, of the coordinates, up to which they are equal


@kernel
def dot(a, b):
    """Scalar product of two triples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def less(a, b):
    """Difference of two triples."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@kernel
def cross(a, b):
    """Vector product of two triples."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@kernel
def triple(rows, i, k=0):
    """Three numbers of a row, such as corner k of triangle i."""
    return (rows[i, 3 * k], rows[i, 3 * k + 1], rows[i, 3 * k + 2])


@inlined
def squared_distance_to_triangle(p, a, b, c):
    """By the region of the triangle nearest to p (Ericson, Real-Time Collision Detection, 5.1.5)."""
    ab, ac, ap = less(b, a), less(c, a), less(p, a)
    d1, d2 = dot(ab, ap), dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return dot(ap, ap)
    bp = less(p, b)
    d3, d4 = dot(ab, bp), dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return dot(bp, bp)
    cp = less(p, c)
    d5, d6 = dot(ab, cp), dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return dot(cp, cp)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        v, w = d1 / (d1 - d3) if d1 > d3 else 0.0, 0.0
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        v, w = 0.0, d2 / (d2 - d6) if d2 > d6 else 0.0
    elif va <= 0.0 and d4 >= d3 and d5 >= d6:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v = 1.0 - w
    else:
        v, w = vb / (va + vb + vc), vc / (va + vb + vc)
    rest = (ap[0] - v * ab[0] - w * ac[0], ap[1] - v * ab[1] - w * ac[1], ap[2] - v * ab[2] - w * ac[2])
    return dot(rest, rest)


@compiled
def nearest(points, directions, corners, normals, boxes, names, out):
    """Distance of every point to the nearest of the triangles ``corners (m, 9)``, in the order of the leaves.

    ``out`` receives the name of the triangle, and the least of the names where several are equally near but
    for rounding, as beside a common edge. Triangles whose normal points away from ``directions[i]`` are left
    out, unless there is no direction: ``(0, 3)``.

    Points that follow one another are near one another as a rule, so the triangle nearest to the last point
    gives the first bound. At worst every triangle is looked at for every point.
    """
    rounding = 0.0
    for d in range(len(boxes[0])):
        rounding = max(rounding, ROUNDING * abs(boxes[0, d]))
    distances = np.empty(len(points))
    directed = len(directions) > 0
    leaves = (len(boxes) + 1) // 2
    stack = np.empty(128, np.int64)
    gaps = np.empty(128)
    last = 0
    for i in range(len(points)):
        p = triple(points, i)
        best = most = np.inf  # what is equal but for rounding ends at most
        out[i] = -1
        start, stop = last, last + 1
        stack[0], gaps[0], depth = 0, 0.0, 1
        while True:
            for f in range(start, stop):
                if directed and not dot(triple(directions, i), triple(normals, f)) > 0.0:
                    continue
                a, b, c = triple(corners, f, 0), triple(corners, f, 1), triple(corners, f, 2)
                gap = squared_distance_to_triangle(p, a, b, c)
                if gap > most:
                    continue
                if out[i] < 0 or names[f] < out[i] or (np.sqrt(gap) + rounding) ** 2 < best:
                    out[i], last = names[f], f
                best = min(best, gap)
                most = (np.sqrt(best) + rounding) ** 2
            start, stop = 0, 0
            if depth == 0:
                break
            depth -= 1
            node = stack[depth]
            if gaps[depth] > most:
                continue
            if node >= leaves - 1:
                start = (node - leaves + 1) * LEAF
                stop = min(start + LEAF, len(corners))
                continue
            left, right = box_distance(boxes, 2 * node + 1, p), box_distance(boxes, 2 * node + 2, p)
            depth = open_box(node, left, right, stack, gaps, depth)
        distances[i] = np.sqrt(best)
    return distances


@kernel
def orientation(a, b, c, d):
    """Six times the signed volume of a tetrahedron."""
    return dot(less(a, d), cross(less(b, d), less(c, d)))


@inlined
def passes_through(p, q, a, b, c):
    """Whether a segment passes through the inside of a triangle."""
    if orientation(a, b, c, p) * orientation(a, b, c, q) >= 0.0:
        return False
    x, y, z = orientation(p, q, a, b), orientation(p, q, b, c), orientation(p, q, c, a)
    return (x > 0.0 and y > 0.0 and z > 0.0) or (x < 0.0 and y < 0.0 and z < 0.0)


@compiled
def crossed_by(corners, names, boxes, first, out):
    """For triangles from ``first`` on: one that an edge of theirs passes through, or -1.

    Triangles that share a corner do not count. ``names (m, 3)`` are the numbers of the corners.
    """
    leaves = (len(boxes) + 1) // 2
    stack = np.empty(128, np.int64)
    for i in range(first, first + len(out)):
        out[i - first] = -1
        low, high = np.empty(3), np.empty(3)
        for d in range(3):
            low[d] = min(corners[i, d], corners[i, 3 + d], corners[i, 6 + d])
            high[d] = max(corners[i, d], corners[i, 3 + d], corners[i, 6 + d])
        stack[0], depth = 0, 1
        while depth > 0 and out[i - first] < 0:
            depth -= 1
            node = stack[depth]
            apart = False
            for d in range(3):
                apart = apart or boxes[node, d] > high[d] or boxes[node, 3 + d] < low[d]
            if apart:
                continue
            if node < leaves - 1:
                stack[depth], stack[depth + 1] = 2 * node + 1, 2 * node + 2
                depth += 2
                continue
            begin = (node - leaves + 1) * LEAF
            for j in range(begin, min(begin + LEAF, len(corners))):
                joined = False
                for k in range(9):
                    joined = joined or names[i, k // 3] == names[j, k % 3]
                if joined:
                    continue
                a, b, c = triple(corners, j, 0), triple(corners, j, 1), triple(corners, j, 2)
                for k in range(3):
                    p, q = triple(corners, i, k), triple(corners, i, (k + 1) % 3)
                    if passes_through(p, q, a, b, c):
                        out[i - first] = j
