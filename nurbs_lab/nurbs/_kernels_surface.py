"""Hot loops of surface evaluation; control points arrive homogeneous, ``(nu, nv, dim + 1)``."""

import numpy as np

from nurbs_lab.common.kernels import compiled, kernel
from nurbs_lab.nurbs._kernels import (
    basis_functions,
    basis_table,
    basis_triangle,
    find_knot_span,
    project,
    spline_derivatives,
)


@compiled
def surface_points(degree_u, degree_v, knots_u, knots_v, homogeneous, u, v, out):
    """S(u, v) for every pair of two equally long arrays, into ``out (len(u), dim)`` (A4.3)."""
    dim = out.shape[1]
    left = np.empty(max(degree_u, degree_v) + 1)
    right = np.empty_like(left)
    values_u = np.empty(degree_u + 1)
    values_v = np.empty(degree_v + 1)
    sums = np.empty(dim + 1)
    for k in range(u.size):
        span_u = find_knot_span(degree_u, knots_u, u[k])
        span_v = find_knot_span(degree_v, knots_v, v[k])
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


@kernel  # a check for zero weights would prevent vectorising
def surface_grid(degree_u, degree_v, knots_u, knots_v, homogeneous, u, v, out):
    """S on the grid u x v into ``out (len(u), len(v), dim)``: v contracted once a row of the net, then u."""
    count_u, _, columns = homogeneous.shape
    dim = columns - 1
    first_u, table_u = basis_table(degree_u, knots_u, u)
    first_v, table_v = basis_table(degree_v, knots_v, v)
    rows, ready = np.zeros((count_u, columns * v.size)), np.zeros(count_u, dtype=np.bool_)
    for a in range(u.size):
        first = first_u[a]
        for at in range(first, first + degree_u + 1):
            if not ready[at]:
                ready[at] = True
                for d in range(columns):
                    for b in range(v.size):
                        for j in range(degree_v + 1):
                            rows[at, d * v.size + b] += table_v[b, j] * homogeneous[at, first_v[b] + j, d]
        sums = np.dot(table_u[a], rows[first : first + degree_u + 1]).reshape((columns, v.size))
        weights = 1.0 / sums[dim]
        for d in range(dim):
            for b in range(v.size):
                out[a, b, d] = sums[d, b] * weights[b]


@compiled
def surface_derivatives(degree_u, degree_v, knots_u, knots_v, homogeneous, u, v, orders):
    """Mixed derivatives for pairs of parameters: ``(len(u), order_u + 1, order_v + 1, dim)``."""
    columns, (order_u, order_v) = homogeneous.shape[2], orders
    out = np.empty((u.size, order_u + 1, order_v + 1, columns - 1))
    triangle_u = np.empty((degree_u + 1, degree_u + 1))
    triangle_v = np.empty((degree_v + 1, degree_v + 1))
    along_u = np.empty((order_u + 1, (degree_v + 1) * columns))
    lifted = np.empty((order_u + 1, order_v + 1, columns))
    for k in range(u.size):
        span_u, span_v = find_knot_span(degree_u, knots_u, u[k]), find_knot_span(degree_v, knots_v, v[k])
        basis_triangle(span_u, degree_u, knots_u, u[k], triangle_u)
        basis_triangle(span_v, degree_v, knots_v, v[k], triangle_v)
        net = homogeneous[span_u - degree_u : span_u + 1, span_v - degree_v : span_v + 1].copy()
        flat = net.reshape((degree_u + 1, (degree_v + 1) * columns))
        spline_derivatives(span_u, degree_u, knots_u, triangle_u, flat, along_u)
        for i in range(order_u + 1):
            rows = along_u[i].reshape((degree_v + 1, columns))
            spline_derivatives(span_v, degree_v, knots_v, triangle_v, rows, lifted[i])
        project(lifted, out[k])
    return out
