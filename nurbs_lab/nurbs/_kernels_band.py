"""Linear systems of fitting, memory linear in the number of points.

Matrices of B-spline values are totally positive, so elimination needs no pivots (de Boor & Pinkus 1977).
A band is stored by rows: ``band[i, lower + j - i]`` is the entry (i, j).
"""

import numpy as np
from numba import njit

from nurbs_lab.nurbs._kernels import basis_table


@njit(cache=True, nogil=True)
def solve_band(band, lower, right):
    """Solve in place: ``right (n, m)`` becomes the solution, ``band`` its factors."""
    count, width = band.shape
    columns = right.shape[1]
    for k in range(count):
        pivot = 1.0 / band[k, lower]
        for i in range(k + 1, min(k + lower + 1, count)):
            factor = band[i, lower + k - i] * pivot
            if factor == 0.0:
                continue
            shift = k - i
            for j in range(lower + 1, width):
                band[i, j + shift] -= factor * band[k, j]
            for c in range(columns):
                right[i, c] -= factor * right[k, c]
    for i in range(count - 1, -1, -1):
        for j in range(1, min(width - lower, count - i)):
            factor = band[i, lower + j]
            for c in range(columns):
                right[i, c] -= factor * right[i + j, c]
        scale = 1.0 / band[i, lower]
        for c in range(columns):
            right[i, c] *= scale


@njit(cache=True, nogil=True)
def solve_open(degree, knots, sites, slope_at_start, slope_at_end, right):
    """Control points of the spline with the values ``right (n, m)`` at the sites, in place.

    A slope is a row of ``right`` too: the second one belongs to C'(first site), the last but one to
    C'(last site).
    """
    count = sites.size
    first, table = basis_table(degree, knots, sites)
    band = np.zeros((count, 2 * degree + 1))
    for i in range(count):
        for k in range(degree + 1):
            offset = first[i] + k - i + degree
            if table[i, k] != 0.0 and 0 <= offset <= 2 * degree:
                band[i, offset] = table[i, k]
    if slope_at_start:
        scale = degree / (knots[degree + 1] - knots[1])
        band[1] = 0.0
        band[1, degree - 1] = -scale
        band[1, degree] = scale
    if slope_at_end:
        scale = degree / (knots[count + degree - 1] - knots[count - 1])
        band[count - 2] = 0.0
        band[count - 2, degree] = -scale
        band[count - 2, degree + 1] = scale
    solve_band(band, degree, right)


@njit(cache=True, nogil=True)
def solve_periodic(degree, knots, sites, right):
    """Control points ``(n + degree, m)`` of the periodic spline with the values ``right (n, m)`` at n sites.

    The wrapped corners of the matrix are kept out of the band: the last unknowns form a border, which
    is eliminated last.
    """
    count, columns = right.shape
    shift = degree // 2
    border = degree - shift
    inner = count - border
    _, table = basis_table(degree, knots, sites)
    band = np.zeros((inner, degree + 1))
    work = np.zeros((inner, columns + border))
    work[:, :columns] = right[:inner]
    corner = np.zeros((border, border))
    for i in range(inner):
        for k in range(degree + 1):
            j = (i - shift + k) % count
            if j >= inner:
                work[i, columns + j - inner] = table[i, k]
            else:
                band[i, k] = table[i, k]
    solve_band(band, shift, work)
    rest = right[inner:].copy()
    for a in range(border):
        i = inner + a
        for k in range(degree + 1):
            j = (i - shift + k) % count
            if j >= inner:
                corner[a, j - inner] += table[i, k]
            else:
                for b in range(border):
                    corner[a, b] -= table[i, k] * work[j, columns + b]
                for c in range(columns):
                    rest[a, c] -= table[i, k] * work[j, c]
    rest = np.linalg.solve(corner, rest)
    out = np.empty((count + degree, columns))
    for i in range(count + degree):
        j = (i - shift) % count
        for c in range(columns):
            if j >= inner:
                out[i, c] = rest[j - inner, c]
            else:
                total = work[j, c]
                for b in range(border):
                    total -= work[j, columns + b] * rest[b, c]
                out[i, c] = total
    return out
