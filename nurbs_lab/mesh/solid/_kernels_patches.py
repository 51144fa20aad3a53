"""Bezier patches of degree 5: values, sums of squares, and nearest places.

A patch has 6 x 6 control points; a place is a face and (u, v) in the unit square. Side k of a face runs from
its corner k to the next: v = 0, u = 1, v = 1, u = 0.
"""

import numpy as np
from numba import njit

N = 6  # control points along a side
ROUNDS = 6  # of Gauss-Newton in one face
HOPS = 4  # to neighbouring faces
LEAST_GAIN = 1e-6  # of the squared distance, by the last step of Gauss-Newton


@njit(cache=True, nogil=True)
def bernstein(t, values, slopes):
    """The six Bernstein polynomials of degree 5 and their derivatives at t."""
    s = 1.0 - t
    a, b, c, d, e = (
        s * s * s * s,
        4.0 * s * s * s * t,
        6.0 * s * s * t * t,
        4.0 * s * t * t * t,
        t * t * t * t,
    )
    values[0], values[5] = s * a, t * e
    values[1], values[2] = s * b + t * a, s * c + t * b
    values[3], values[4] = s * d + t * c, s * e + t * d
    slopes[0], slopes[5] = -5.0 * a, 5.0 * e
    slopes[1], slopes[2] = 5.0 * (a - b), 5.0 * (b - c)
    slopes[3], slopes[4] = 5.0 * (c - d), 5.0 * (d - e)


@njit(cache=True, nogil=True)
def sums(first, order, uv, weight, target, energy, factor, start, stop, left, right):
    """Weighted squares and pulls of samples, summed for the faces from ``start`` to ``stop``.

    The samples of face f are ``order[first[f] : first[f + 1]]``. ``left (faces, 36, 36)`` begins as
    ``energy`` times the ``factor`` of the face; ``right`` is ``(faces, 36, 3)``.
    """
    a, b, slopes, row = np.empty(N), np.empty(N), np.empty(N), np.empty(N * N)
    for f in range(start, stop):
        block = factor[f] * energy
        pull = np.zeros((N * N, 3))
        for k in order[first[f] : first[f + 1]]:
            bernstein(uv[k, 0], a, slopes)
            bernstein(uv[k, 1], b, slopes)
            for i in range(N):
                for j in range(N):
                    row[N * i + j] = a[i] * b[j]
            x, y, z = target[k, 0], target[k, 1], target[k, 2]
            for i in range(N * N):
                part = weight[k] * row[i]
                pull[i, 0] += part * x
                pull[i, 1] += part * y
                pull[i, 2] += part * z
                for j in range(N * N):
                    block[i, j] += part * row[j]
        left[f] = block
        right[f] = pull


@njit(cache=True, nogil=True)
def nearest_in_face(nets, face, u, v, p, out):
    """Gauss-Newton steps to the point of one face that is nearest to p; the squared distance.

    ``out`` receives u, v, and how far the last step wanted to leave the unit square in u and in v.
    """
    a, da, b, db = np.empty(N), np.empty(N), np.empty(N), np.empty(N)
    best = np.inf
    for _ in range(ROUNDS):
        bernstein(u, a, da)
        bernstein(v, b, db)
        x = y = z = xu = yu = zu = xv = yv = zv = 0.0
        for r in range(N):
            ax = ay = az = bx = by = bz = 0.0  # of one row of control points: the point, and its derivative
            for s in range(N):
                cx, cy, cz = nets[face, r, s, 0], nets[face, r, s, 1], nets[face, r, s, 2]
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
def nearest_places(nets, across, points, face, uv):
    """Move the place of every point downhill to the nearest one, across smooth edges too; the distances.

    ``across`` is the side on the other side of every side, -1 where no way leads across.
    """
    found = np.empty(len(points))
    out, other, start = np.empty(4), np.empty(4), np.empty(2)
    for k in range(len(points)):
        p = points[k]
        u, v = uv[k]
        best = nearest_in_face(nets, face[k], u, v, p, out)
        for _ in range(HOPS):
            if out[2] == 0.0 and out[3] == 0.0:
                break
            if abs(out[2]) >= abs(out[3]):
                side = 1 if out[0] == 1.0 else 3
                t = out[1] if side == 1 else 1.0 - out[1]
            else:
                side = 0 if out[1] == 0.0 else 2
                t = out[0] if side == 0 else 1.0 - out[0]
            beyond = across[4 * face[k] + side]
            if beyond < 0:
                break
            on_side(beyond % 4, 1.0 - t, start)
            gap = nearest_in_face(nets, beyond // 4, start[0], start[1], p, other)
            if not gap < best:
                break
            best = gap
            face[k] = beyond // 4
            out[:] = other
        uv[k, 0], uv[k, 1] = out[0], out[1]
        found[k] = np.sqrt(best)
    return found
