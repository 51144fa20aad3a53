"""The places of patches that are nearest to points."""

import numpy as np

from nurbs_lab.common.kernels import compiled, kernel
from nurbs_lab.mesh.solid.net import DEGREE

ROUNDS = 6  # of Gauss-Newton


@kernel
def bernstein(t, values, slopes):
    """The Bernstein polynomials and their derivatives at t."""
    values[:], slopes[:] = 0.0, 0.0
    values[0] = 1.0
    for degree in range(1, DEGREE + 1):
        for i in range(degree, 0, -1):
            if degree == DEGREE:
                slopes[i] = degree * (values[i - 1] - values[i])
            values[i] += t * (values[i - 1] - values[i])
        if degree == DEGREE:
            slopes[0] = -degree * values[0]
        values[0] *= 1.0 - t


@kernel
def tangents(net, u, v, work, out):
    """Point, derivative by u and derivative by v of one patch, the rows of ``out``."""
    a, da, b, db = work
    bernstein(u, a, da)
    bernstein(v, b, db)
    out[:] = 0.0
    for i in range(DEGREE + 1):
        for x in range(3):
            point = slope = 0.0
            for j in range(DEGREE + 1):
                point += b[j] * net[i, j, x]
                slope += db[j] * net[i, j, x]
            out[0, x] += a[i] * point
            out[1, x] += da[i] * point
            out[2, x] += a[i] * slope


@compiled
def nearest_places(nets, points, face, uv, gaps):
    """Move the (u, v) of points to the nearest places of their faces, by Gauss-Newton; the distances."""
    work, s = np.empty((4, DEGREE + 1)), np.empty((3, 3))
    for k in range(len(points)):
        u, v = uv[k]
        best = np.inf
        for _ in range(ROUNDS):
            tangents(nets[face[k]], u, v, work, s)
            gap = e = f = g = down_u = down_v = 0.0
            for x in range(3):
                rest = points[k, x] - s[0, x]
                gap += rest * rest
                e, f, g = e + s[1, x] ** 2, f + s[1, x] * s[2, x], g + s[2, x] ** 2
                down_u, down_v = down_u + rest * s[1, x], down_v + rest * s[2, x]
            if gap >= best:
                u, v = (u + uv[k, 0]) / 2, (v + uv[k, 1]) / 2
                continue
            best = gap
            uv[k, 0], uv[k, 1] = u, v
            if (u == 0.0 and down_u < 0.0) or (u == 1.0 and down_u > 0.0):
                down_u = f = 0.0
            if (v == 0.0 and down_v < 0.0) or (v == 1.0 and down_v > 0.0):
                down_v = f = 0.0
            det = max(e * g - f * f, 1e-12 * e * g + 1e-300)
            step_u, step_v = (g * down_u - f * down_v) / det, (e * down_v - f * down_u) / det
            if max(abs(step_u), abs(step_v)) < 1e-6:
                break
            u, v = min(max(u + step_u, 0.0), 1.0), min(max(v + step_v, 0.0), 1.0)
        gaps[k] = np.sqrt(best)
