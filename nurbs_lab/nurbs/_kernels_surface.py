"""Hot loops of surface evaluation; control points arrive homogeneous, ``(nu, nv, dim + 1)``."""

import numpy as np
from numba import njit

from nurbs_lab.nurbs._kernels import (
    basis_functions,
    basis_table,
    basis_triangle,
    find_span,
    spline_derivatives,
)

LONG = 8  # points per span from which on vector instructions pay


@njit(cache=True, nogil=True)
def surface_points(degree_u, degree_v, knots_u, knots_v, homogeneous, u, v, out):
    """S(u, v) for every pair of two equally long arrays, into ``out (len(u), dim)`` (A4.3)."""
    dim = out.shape[1]
    left = np.empty(max(degree_u, degree_v) + 1)
    right = np.empty_like(left)
    values_u = np.empty(degree_u + 1)
    values_v = np.empty(degree_v + 1)
    sums = np.empty(dim + 1)
    for k in range(u.size):
        span_u = find_span(degree_u, knots_u, u[k])
        span_v = find_span(degree_v, knots_v, v[k])
        basis_functions(span_u, degree_u, knots_u, u[k], values_u, left, right)
        basis_functions(span_v, degree_v, knots_v, v[k], values_v, left, right)
        sums[:] = 0.0
        for i in range(degree_u + 1):
            for j in range(degree_v + 1):
                factor = values_u[i] * values_v[j]
                for d in range(dim + 1):
                    sums[d] += factor * homogeneous[span_u - degree_u + i, span_v - degree_v + j, d]
        for d in range(dim):
            out[k, d] = sums[d] / sums[dim]


@njit(cache=True, nogil=True)
def row_in_space(degree, first, table, row, out):
    """One row of a grid in 3-D, with scalar sums that the compiler keeps in registers."""
    for b in range(first.size):
        x = y = z = w = 0.0
        for j in range(degree + 1):
            factor = table[b, j]
            at = first[b] + j
            x += factor * row[at, 0]
            y += factor * row[at, 1]
            z += factor * row[at, 2]
            w += factor * row[at, 3]
        scale = 1.0 / w
        out[b, 0] = x * scale
        out[b, 1] = y * scale
        out[b, 2] = z * scale


@njit(cache=True, nogil=True)
def span_runs(first):
    """Indices at which a new span begins, and the end: parameters between two of them lie in one span."""
    begins = np.ones(first.size, dtype=np.bool_)
    begins[1:] = first[1:] != first[:-1]
    return np.append(np.flatnonzero(begins), first.size)


@njit(cache=True, nogil=True, error_model="numpy")  # a check for zero weights would prevent vectorising
def cubic_run(c, turned, low, high, out):
    """Points ``low`` to ``high`` in 3-D of one cubic span with control points c, into ``out (3 m,)``.

    ``turned (4, m)`` are the basis functions. The loop is written out so that the compiler vectorises it.
    """
    t0, t1, t2, t3 = turned[0][low:high], turned[1][low:high], turned[2][low:high], turned[3][low:high]
    flat = out[3 * low : 3 * high]
    x0, y0, z0, w0 = c[0, 0], c[0, 1], c[0, 2], c[0, 3]
    x1, y1, z1, w1 = c[1, 0], c[1, 1], c[1, 2], c[1, 3]
    x2, y2, z2, w2 = c[2, 0], c[2, 1], c[2, 2], c[2, 3]
    x3, y3, z3, w3 = c[3, 0], c[3, 1], c[3, 2], c[3, 3]
    for b in range(t0.size):
        scale = 1.0 / (t0[b] * w0 + t1[b] * w1 + t2[b] * w2 + t3[b] * w3)
        flat[3 * b] = (t0[b] * x0 + t1[b] * x1 + t2[b] * x2 + t3[b] * x3) * scale
        flat[3 * b + 1] = (t0[b] * y0 + t1[b] * y1 + t2[b] * y2 + t3[b] * y3) * scale
        flat[3 * b + 2] = (t0[b] * z0 + t1[b] * z1 + t2[b] * z2 + t3[b] * z3) * scale


@njit(cache=True, nogil=True)
def surface_grid(degree_u, degree_v, knots_u, knots_v, homogeneous, u, v, out):
    """S on the grid u x v into ``out (len(u), len(v), dim)``: contract u once a row, then v."""
    count_v = homogeneous.shape[1]
    columns = homogeneous.shape[2]
    dim = columns - 1
    first_u, table_u = basis_table(degree_u, knots_u, u)
    first_v, table_v = basis_table(degree_v, knots_v, v)
    turned = table_v.T.copy()
    runs = span_runs(first_v)
    long_cubic_runs = columns == 4 and degree_v == 3 and v.size > LONG * (runs.size - 1)
    row = np.empty((count_v, columns))
    sums = np.empty(columns)
    for a in range(u.size):
        for j in range(count_v):
            for d in range(columns):
                total = 0.0
                for i in range(degree_u + 1):
                    total += table_u[a, i] * homogeneous[first_u[a] + i, j, d]
                row[j, d] = total
        if long_cubic_runs:
            flat = out[a].reshape(3 * v.size)
            for k in range(runs.size - 1):
                low, high = runs[k], runs[k + 1]
                cubic_run(row[first_v[low] : first_v[low] + 4], turned, low, high, flat)
            continue
        if columns == 4:
            row_in_space(degree_v, first_v, table_v, row, out[a])
            continue
        for b in range(v.size):
            for d in range(columns):
                total = 0.0
                for j in range(degree_v + 1):
                    total += table_v[b, j] * row[first_v[b] + j, d]
                sums[d] = total
            for d in range(dim):
                out[a, b, d] = sums[d] / sums[dim]


@njit(cache=True, nogil=True)
def project_surface(lifted, out):
    """Derivatives of A / w from those of (A, w), ``lifted (orders_u, orders_v, dim + 1)`` (A4.4)."""
    dim = out.shape[2]
    for k in range(out.shape[0]):
        for m in range(out.shape[1]):
            for d in range(dim):
                total = lifted[k, m, d]
                choose_k = 1.0
                for i in range(k + 1):
                    if i > 0:
                        choose_k = choose_k * (k - i + 1) / i
                    choose_m = 1.0
                    for j in range(m + 1):
                        if j > 0:
                            choose_m = choose_m * (m - j + 1) / j
                        if i + j > 0:
                            total -= choose_k * choose_m * lifted[i, j, dim] * out[k - i, m - j, d]
                out[k, m, d] = total / lifted[0, 0, dim]


@njit(cache=True, nogil=True)
def surface_derivatives(degree_u, degree_v, knots_u, knots_v, homogeneous, u, v, orders):
    """Mixed derivatives for pairs of parameters: ``(len(u), order_u + 1, order_v + 1, dim)``."""
    columns, (order_u, order_v) = homogeneous.shape[2], orders
    out = np.empty((u.size, order_u + 1, order_v + 1, columns - 1))
    triangle_u = np.empty((degree_u + 1, degree_u + 1))
    triangle_v = np.empty((degree_v + 1, degree_v + 1))
    along_u = np.empty((order_u + 1, (degree_v + 1) * columns))
    lifted = np.empty((order_u + 1, order_v + 1, columns))
    for k in range(u.size):
        span_u, span_v = find_span(degree_u, knots_u, u[k]), find_span(degree_v, knots_v, v[k])
        basis_triangle(span_u, degree_u, knots_u, u[k], triangle_u)
        basis_triangle(span_v, degree_v, knots_v, v[k], triangle_v)
        net = homogeneous[span_u - degree_u : span_u + 1, span_v - degree_v : span_v + 1].copy()
        flat = net.reshape((degree_u + 1, (degree_v + 1) * columns))
        spline_derivatives(span_u, degree_u, knots_u, triangle_u, flat, along_u)
        for i in range(order_u + 1):
            rows = along_u[i].reshape((degree_v + 1, columns))
            spline_derivatives(span_v, degree_v, knots_v, triangle_v, rows, lifted[i])
        project_surface(lifted, out[k])
    return out
