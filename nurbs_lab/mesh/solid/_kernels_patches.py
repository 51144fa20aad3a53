"""Bicubic patches on common clamped uniform knots: values, rows of equations, and nearest places.

A patch has ``spans`` spans along each side and (spans + 3)^2 control points. A place is a face and (u, v) in
the unit square. Side k of a face runs from its corner k to the next: v = 0, u = 1, v = 1, u = 0.
"""

import numpy as np
from numba import njit

ROUNDS = 6  # of Gauss-Newton in one face
HOPS = 4  # to neighbouring faces
LEAST_GAIN = 1e-6  # of the squared distance, by the last step of Gauss-Newton
INVERSE = np.array([0.0, 1.0, 1.0 / 2.0, 1.0 / 3.0])  # of the knots between the ends of a spline


@njit(cache=True, nogil=True)
def cubic_basis(spans, t, values, slopes):
    """Four cubic B-splines and their derivatives at t in [0, 1]; returns the first control point."""
    span = min(int(t * spans), spans - 1)
    x = t * spans
    values[0] = 1.0
    for j in range(1, 4):
        if j == 3:
            slopes[0], slopes[1], slopes[2], slopes[3] = 0.0, 0.0, 0.0, 0.0
            for r in range(3):
                low, high = max(span + r - 2, 0), min(span + r + 1, spans)
                part = 3.0 * spans * values[r] * INVERSE[high - low]
                slopes[r] -= part
                slopes[r + 1] += part
        saved = 0.0
        for r in range(j):
            low, high = max(span + 1 - j + r, 0), min(span + r + 1, spans)
            left, right = x - low, high - x
            part = values[r] * INVERSE[high - low]
            values[r] = saved + right * part
            saved = left * part
        values[j] = saved
    return span


@njit(cache=True, nogil=True)
def equations(net, spans, face, uv, columns, value, along_u, along_v):
    """Columns of the sixteen control points at every place, and their weights in S, S_u and S_v."""
    a, da, b, db = np.empty(4), np.empty(4), np.empty(4), np.empty(4)
    for k in range(len(face)):
        i = cubic_basis(spans, uv[k, 0], a, da)
        j = cubic_basis(spans, uv[k, 1], b, db)
        for r in range(4):
            for s in range(4):
                columns[k, 4 * r + s] = net[face[k], i + r, j + s]
                value[k, 4 * r + s] = a[r] * b[s]
                along_u[k, 4 * r + s] = da[r] * b[s]
                along_v[k, 4 * r + s] = a[r] * db[s]


@njit(cache=True, nogil=True)
def values(spans, uv, out):
    """Weights of the sixteen control points in S at every place."""
    a, b, slopes = np.empty(4), np.empty(4), np.empty(4)
    for k in range(len(uv)):
        cubic_basis(spans, uv[k, 0], a, slopes)
        cubic_basis(spans, uv[k, 1], b, slopes)
        for r in range(4):
            for s in range(4):
                out[k, 4 * r + s] = a[r] * b[s]


@njit(cache=True, nogil=True)
def add_vectors(net, spans, face, uv, values, vectors, out):
    """Add the vector at every place to its sixteen control points, by their weights there."""
    for k in range(len(face)):
        f, i, j = face[k], min(int(uv[k, 0] * spans), spans - 1), min(int(uv[k, 1] * spans), spans - 1)
        x, y, z = vectors[k, 0], vectors[k, 1], vectors[k, 2]
        for r in range(4):
            for s in range(4):
                c, w = net[f, i + r, j + s], values[k, 4 * r + s]
                out[c, 0] += w * x
                out[c, 1] += w * y
                out[c, 2] += w * z


@njit(cache=True, nogil=True)
def product(first, columns, values, x, start, stop, out):
    """Rows ``start`` to ``stop`` of the product of a sparse matrix, row by row, with three columns."""
    for i in range(start, stop):
        a = b = c = 0.0
        for e in range(first[i], first[i + 1]):
            j, w = columns[e], values[e]
            a += w * x[j, 0]
            b += w * x[j, 1]
            c += w * x[j, 2]
        out[i, 0], out[i, 1], out[i, 2] = a, b, c


@njit(cache=True, nogil=True)
def find_slots(numbers, first, columns, slots):
    """Where a sparse matrix keeps the entry of every pair of control points of a face.

    ``first`` and ``columns`` are the rows of the matrix, in rising order.
    """
    for f in range(len(numbers)):
        for a in range(numbers.shape[1]):
            low, high = first[numbers[f, a]], first[numbers[f, a] + 1]
            for b in range(numbers.shape[1]):
                slots[f, a, b] = low + np.searchsorted(columns[low:high], numbers[f, b])


@njit(cache=True, nogil=True)
def add_squares(slots, spans, order, face, uv, values, weight, data):
    """Add the weighted squares of equations with 16 control points of a face each, taken in an ``order``.

    The equations of one span after another are summed before they go to their slots of ``data``.
    """
    size, last = spans + 3, spans - 1
    block = np.zeros((16, 16))
    for k in range(len(order)):
        one = order[k]
        f, i, j = face[one], min(int(uv[one, 0] * spans), last), min(int(uv[one, 1] * spans), last)
        for a in range(16):
            part = weight[one] * values[one, a]
            if part != 0.0:
                for b in range(16):
                    block[a, b] += part * values[one, b]
        if k + 1 < len(order):
            after = order[k + 1]
            u, v = uv[after]
            if (
                face[after] == f
                and min(int(u * spans), spans - 1) == i
                and min(int(v * spans), spans - 1) == j
            ):
                continue
        for a in range(16):
            row = (i + a // 4) * size + j + a % 4
            for b in range(16):
                data[slots[f, row, (i + b // 4) * size + j + b % 4]] += block[a, b]
        block[:] = 0.0


@njit(cache=True, nogil=True)
def push_planes(first, columns, values, factors, normal, hold, x, start, stop, out):
    """Derivatives at samples under the linear equations of tangent planes; see `nurbs_lab.mesh.solid.seams`.

    ``first``, ``columns`` and ``values`` are the sparse matrix from control points x to the three derivatives
    at all samples, ``out (samples, 3, 3)`` takes those from ``start`` to ``stop``. With a derivative d, its
    factor f and the unit normal n of the plane, the equations are those of the sum of ``f d``, and ``hold``
    times those of the part of d within the plane.
    """
    count, slope = len(normal), np.empty((3, 3))
    for i in range(start, stop):
        change = 0.0
        for k in range(3):
            a = b = c = 0.0
            for e in range(first[k * count + i], first[k * count + i + 1]):
                j, w = columns[e], values[e]
                a += w * x[j, 0]
                b += w * x[j, 1]
                c += w * x[j, 2]
            slope[k, 0], slope[k, 1], slope[k, 2] = a, b, c
            change += factors[k, i, 0] * a + factors[k, i, 1] * b + factors[k, i, 2] * c
        for k in range(3):
            up = 0.0
            for d in range(3):
                up += slope[k, d] * normal[i, d]
            for d in range(3):
                out[i, k, d] = factors[k, i, d] * change + hold[i] * (slope[k, d] - up * normal[i, d])


@njit(cache=True, nogil=True)
def nearest_in_face(control, net, spans, face, u, v, p, out):
    """Gauss-Newton steps to the point of one face that is nearest to p; the squared distance.

    ``out`` receives u, v, and how far the last step wanted to leave the unit square in u and in v.
    """
    a, da, b, db = np.empty(4), np.empty(4), np.empty(4), np.empty(4)
    best = np.inf
    for _ in range(ROUNDS):
        i = cubic_basis(spans, u, a, da)
        j = cubic_basis(spans, v, b, db)
        x = y = z = xu = yu = zu = xv = yv = zv = 0.0
        for r in range(4):
            ax = ay = az = bx = by = bz = 0.0  # of one row of control points: the point, and its derivative
            for s in range(4):
                k = net[face, i + r, j + s]
                cx, cy, cz = control[k, 0], control[k, 1], control[k, 2]
                ax += b[s] * cx
                ay += b[s] * cy
                az += b[s] * cz
                bx += db[s] * cx
                by += db[s] * cy
                bz += db[s] * cz
            x += a[r] * ax
            y += a[r] * ay
            z += a[r] * az
            xu += da[r] * ax
            yu += da[r] * ay
            zu += da[r] * az
            xv += a[r] * bx
            yv += a[r] * by
            zv += a[r] * bz
        x, y, z = p[0] - x, p[1] - y, p[2] - z
        gap = x * x + y * y + z * z
        e, f, g = xu * xu + yu * yu + zu * zu, xu * xv + yu * yv + zu * zv, xv * xv + yv * yv + zv * zv
        down_u, down_v = x * xu + y * yu + z * zu, x * xv + y * yv + z * zv
        if gap < best:
            best = gap
            out[0], out[1] = u, v
            out[2] = down_u / e if (u == 0.0 and down_u < 0.0) or (u == 1.0 and down_u > 0.0) else 0.0
            out[3] = down_v / g if (v == 0.0 and down_v < 0.0) or (v == 1.0 and down_v > 0.0) else 0.0
        elif gap > best:
            u, v = (u + out[0]) / 2, (v + out[1]) / 2
            continue
        det = e * g - f * f
        move_u = out[2] == 0.0
        move_v = out[3] == 0.0
        if move_u and move_v and det > 1e-12 * e * g:
            step_u, step_v = (g * down_u - f * down_v) / det, (e * down_v - f * down_u) / det
        else:
            step_u = down_u / e if move_u and e > 0.0 else 0.0
            step_v = down_v / g if move_v and g > 0.0 else 0.0
        gain = down_u * step_u + down_v * step_v
        if gain < LEAST_GAIN * gap or abs(step_u) + abs(step_v) < 1e-9:
            break
        largest = max(abs(step_u), abs(step_v))
        if largest > 0.3:
            step_u, step_v = 0.3 * step_u / largest, 0.3 * step_v / largest
        u, v = min(max(u + step_u, 0.0), 1.0), min(max(v + step_v, 0.0), 1.0)
    return best


@njit(cache=True, nogil=True)
def on_side(side, t, out):
    """u and v on a side of the unit square, t from 0 to 1 counter-clockwise."""
    out[0] = t if side == 0 else 1.0 if side == 1 else 1.0 - t if side == 2 else 0.0
    out[1] = 0.0 if side == 0 else t if side == 1 else 1.0 if side == 2 else 1.0 - t


@njit(cache=True, nogil=True)
def nearest_places(control, net, spans, opposite, sharp, points, face, uv):
    """Move the place of every point downhill to the nearest one, across smooth seams too; the distances.

    ``opposite`` is the side across every side.
    """
    found = np.empty(len(points))
    out, other, start = np.empty(4), np.empty(4), np.empty(2)
    for k in range(len(points)):
        p = points[k]
        u, v = uv[k]
        best = nearest_in_face(control, net, spans, face[k], u, v, p, out)
        for _ in range(HOPS):
            if out[2] == 0.0 and out[3] == 0.0:
                break
            if abs(out[2]) >= abs(out[3]):
                side = 1 if out[0] == 1.0 else 3
                t = out[1] if side == 1 else 1.0 - out[1]
            else:
                side = 0 if out[1] == 0.0 else 2
                t = out[0] if side == 0 else 1.0 - out[0]
            if sharp[4 * face[k] + side]:
                break
            across = opposite[4 * face[k] + side]
            on_side(across % 4, 1.0 - t, start)
            gap = nearest_in_face(control, net, spans, across // 4, start[0], start[1], p, other)
            if not gap < best:
                break
            best = gap
            face[k] = across // 4
            out[:] = other
        uv[k, 0], uv[k, 1] = out[0], out[1]
        found[k] = np.sqrt(best)
    return found


@njit(cache=True, nogil=True)
def grids(control, net, spans, parameters, out):
    """Points of every face on the grid of ``parameters`` in both directions, ``(faces, n, n, 3)``."""
    n = len(parameters)
    first = np.empty(n, np.int64)
    table, slopes = np.empty((n, 4)), np.empty(4)
    for a in range(n):
        first[a] = cubic_basis(spans, parameters[a], table[a], slopes)
    for f in range(len(net)):
        for a in range(n):
            for b in range(n):
                x = y = z = 0.0
                for r in range(4):
                    for s in range(4):
                        row = control[net[f, first[a] + r, first[b] + s]]
                        w = table[a, r] * table[b, s]
                        x += w * row[0]
                        y += w * row[1]
                        z += w * row[2]
                out[f, a, b, 0], out[f, a, b, 1], out[f, a, b, 2] = x, y, z
