"""Hot loops of evaluation, on plain arrays. The faces validate; nothing here does.

Control points arrive homogeneous: ``(n, dim + 1)`` rows ``(w x, w y, ..., w)``.
Algorithm numbers are those of Piegl & Tiller, *The NURBS Book*.
"""

import numpy as np

from nurbs_lab.common.kernels import compiled, inlined, kernel


@kernel
def find_knot_span(degree, knots, u):
    """Index i of the non-empty span with knots[i] <= u < knots[i + 1]; the last one at the end (A2.1)."""
    low = degree
    high = knots.size - degree - 1
    if u >= knots[high]:
        low = high - 1
        while knots[low] == knots[high]:
            low -= 1
        return low
    while high - low > 1:
        middle = (low + high) // 2
        if u < knots[middle]:
            high = middle
        else:
            low = middle
    return low


@kernel
def basis_functions(span, degree, knots, u, values, left, right):
    """Fill ``values[:degree + 1]`` with the non-zero basis functions at u (A2.2, Cox-de Boor)."""
    values[0] = 1.0
    for j in range(1, degree + 1):
        left[j] = u - knots[span + 1 - j]
        right[j] = knots[span + j] - u
        saved = 0.0
        for r in range(j):
            term = values[r] / (right[r + 1] + left[j - r])
            values[r] = saved + right[r + 1] * term
            saved = left[j - r] * term
        values[j] = saved


@compiled
def basis_triangle(span, degree, knots, u, triangle):
    """Fill ``triangle[d, :d + 1]`` with the non-zero basis functions of every degree d <= degree at u."""
    triangle[0, 0] = 1.0
    for d in range(1, degree + 1):
        saved = 0.0
        for r in range(d):
            high = knots[span + r + 1]
            low = knots[span + 1 - d + r]
            term = triangle[d - 1, r] / (high - low)
            triangle[d, r] = saved + (high - u) * term
            saved = (u - low) * term
        triangle[d, d] = saved


@compiled
def basis_table(degree, knots, u):
    """First control point ``(m,)`` and basis functions ``(m, degree + 1)`` for every u of an array."""
    first = np.empty(u.size, dtype=np.int64)
    table = np.empty((u.size, degree + 1))
    left = np.empty(degree + 1)
    right = np.empty(degree + 1)
    span = degree
    for k in range(u.size):
        if not knots[span] <= u[k] < knots[span + 1]:  # parameters are usually in increasing order
            span += 1
            if span > knots.size - degree - 2 or not knots[span] <= u[k] < knots[span + 1]:
                span = find_knot_span(degree, knots, u[k])
        first[k] = span - degree
        basis_functions(span, degree, knots, u[k], table[k], left, right)
    return first, table


@compiled
def spline_derivatives(span, degree, knots, triangle, local, out):
    """All derivatives up to ``len(out) - 1`` of the polynomial spline with these local control points.

    ``local (degree + 1, m)`` is overwritten by its differences (A3.3). Equal control points over equal knots
    have equal differences to the last bit, so that both sides of a periodic seam agree.
    """
    columns = local.shape[1]
    for k in range(out.shape[0]):
        rest = degree - k
        if rest < 0:
            out[k] = 0.0
            continue
        if k > 0:
            for j in range(rest + 1):
                scale = (rest + 1) / (knots[span + 1 + j] - knots[span - rest + j])
                for c in range(columns):
                    local[j, c] = scale * (local[j + 1, c] - local[j, c])
        for c in range(columns):
            total = 0.0
            for j in range(rest + 1):
                total += triangle[rest, j] * local[j, c]
            out[k, c] = total


@inlined
def project(lifted, out):
    """Derivatives of A / w from those of (A, w), ``lifted (orders_u, orders_v, dim + 1)`` (A4.2, A4.4)."""
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


@compiled
def curve_derivatives(degree, knots, homogeneous, u, order):
    """C(u) and its derivatives for every u of an array: ``(len(u), order + 1, dim)``."""
    out = np.empty((u.size, order + 1, homogeneous.shape[1] - 1))
    triangle = np.empty((degree + 1, degree + 1))
    lifted = np.empty((order + 1, homogeneous.shape[1]))
    for k in range(u.size):
        span = find_knot_span(degree, knots, u[k])
        basis_triangle(span, degree, knots, u[k], triangle)
        local = homogeneous[span - degree : span + 1].copy()
        spline_derivatives(span, degree, knots, triangle, local, lifted)
        project(lifted[:, None], out[k][:, None])
    return out


@kernel
def curve_points(degree, knots, homogeneous, u, out):
    """C(u) for every u of an array, into ``out (len(u), dim)`` (A4.1)."""
    dim = out.shape[1]
    values = np.empty(degree + 1)
    left = np.empty(degree + 1)
    right = np.empty(degree + 1)
    for k in range(u.size):
        span = find_knot_span(degree, knots, u[k])
        basis_functions(span, degree, knots, u[k], values, left, right)
        weight = 0.0
        for j in range(degree + 1):
            weight += values[j] * homogeneous[span - degree + j, dim]
        for d in range(dim):
            total = 0.0
            for j in range(degree + 1):
                total += values[j] * homogeneous[span - degree + j, d]
            out[k, d] = total / weight
