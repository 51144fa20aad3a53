"""Hot loops of evaluation, on plain arrays. The faces validate; nothing here does.

Control points arrive homogeneous: ``(n, dim + 1)`` rows ``(w x, w y, ..., w)``.
Algorithm numbers are those of Piegl & Tiller, *The NURBS Book*.
"""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def find_span(degree, knots, u):
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


@njit(cache=True, nogil=True)
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


@njit(cache=True, nogil=True)
def curve_points(degree, knots, homogeneous, u, out):
    """C(u) for every u of an array, into ``out (len(u), dim)`` (A4.1)."""
    dim = out.shape[1]
    values = np.empty(degree + 1)
    left = np.empty(degree + 1)
    right = np.empty(degree + 1)
    for k in range(u.size):
        span = find_span(degree, knots, u[k])
        basis_functions(span, degree, knots, u[k], values, left, right)
        weight = 0.0
        for j in range(degree + 1):
            weight += values[j] * homogeneous[span - degree + j, dim]
        for d in range(dim):
            total = 0.0
            for j in range(degree + 1):
                total += values[j] * homogeneous[span - degree + j, d]
            out[k, d] = total / weight
