"""Linear systems of fitting, whose memory grows in proportion to the number of points.

Matrices of B-spline values are totally positive, so elimination needs no pivoting (de Boor & Pinkus 1977).
A band is stored by rows: ``band[i, lower + j - i]`` is the entry (i, j).
"""

import numpy as np

from nurbs_lab.common.kernels import compiled
from nurbs_lab.nurbs._kernels import basis_table


@compiled
def solve_band(band, lower, right):
    """Solve in place: ``right (n, m)`` becomes the solution, ``band`` its factors.

    Where the data hardly determine a least-squares fit, a pivot can vanish by rounding. Its row is then left
    out; the callers measure the error of the fit.
    """
    count, width = band.shape
    columns = right.shape[1]
    for k in range(count):
        pivot = 1.0 / band[k, lower] if band[k, lower] != 0.0 else 0.0
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
        scale = 1.0 / band[i, lower] if band[i, lower] != 0.0 else 0.0
        for c in range(columns):
            right[i, c] *= scale


@compiled
def solve_open(degree, knots, sites, slopes, right):
    """Control points of the spline with the values ``right (n, m)`` at the sites, in place.

    Rows of ``right`` that ``slopes`` marks are C' there.
    """
    count = sites.size
    first, table = basis_table(degree, knots, sites)
    lower, lower_table = basis_table(max(degree - 1, 0), knots[1:-1].copy(), sites)
    band = np.zeros((count, 2 * degree + 1))
    for i in range(count):
        if slopes[i]:
            for k in range(degree):
                j = lower[i] + k
                factor = lower_table[i, k] * degree / (knots[j + degree + 1] - knots[j + 1])
                for offset, part in ((j - i + degree, -factor), (j + 1 - i + degree, factor)):
                    if part != 0.0 and 0 <= offset <= 2 * degree:
                        band[i, offset] += part
            continue
        for k in range(degree + 1):
            offset = first[i] + k - i + degree
            if table[i, k] != 0.0 and 0 <= offset <= 2 * degree:
                band[i, offset] = table[i, k]
    solve_band(band, degree, right)


@compiled
def solve_cyclic(rows, lower, right):
    """Solution ``(n, m)`` where ``rows[i, k]`` is the entry (i, i - lower + k), columns counted modulo n.

    The last unknowns form a border that is eliminated last, so that no entry lies outside the band.
    """
    count, width = rows.shape
    border, columns = max(lower, width - 1 - lower), right.shape[1]
    inner, out = count - border, right.copy()
    band, work = np.zeros((inner, width)), np.zeros((inner, columns + border))
    corner = np.zeros((border, 2 * border + 1))
    for i in range(inner):
        for c in range(columns):
            work[i, c] = right[i, c]
        for k in range(width):
            j = (i - lower + k) % count
            if j < inner:
                band[i, k] = rows[i, k]
            else:
                work[i, columns + j - inner] += rows[i, k]
    solve_band(band, lower, work)
    for i in range(inner, count):
        for k in range(width):
            entry, j = rows[i, k], (i - lower + k) % count
            if j >= inner:
                corner[i - inner, border + j - i] += entry
                continue
            for c in range(columns):
                out[i, c] -= entry * work[j, c]
            for c in range(border):
                corner[i - inner, border + inner + c - i] -= entry * work[j, columns + c]
    solve_band(corner, border, out[inner:])
    for i in range(inner):
        for c in range(columns):
            out[i, c] = work[i, c]
            for k in range(border):
                out[i, c] -= work[i, columns + k] * out[inner + k, c]
    return out


def wrap_rows(rows, shift, degree):
    """Control points ``(n + degree, m)`` of an unclamped periodic spline from its n distinct ones."""
    return np.take(rows, np.arange(-shift, len(rows) + degree - shift), axis=0, mode="wrap")


def solve_periodic(degree, knots, sites, right):
    """Control points ``(n + degree, m)`` of the periodic spline with values ``right (n, m)`` at n sites."""
    shift = degree // 2
    _, table = basis_table(degree, knots, sites)
    rows = table[:, : 2 * shift + 1].copy()  # of odd degree the last is zero: the sites are the knots
    return wrap_rows(solve_cyclic(rows, shift, right), shift, degree)


@compiled
def normal_equations(degree, knots, sites, values, weights, count):
    """Matrix rows ``(count, 2 degree + 1)`` and right side of weighted least squares.

    Control points are counted modulo ``count``, so that those of a periodic spline coincide.
    """
    first, table = basis_table(degree, knots, sites)
    rows = np.zeros((count, 2 * degree + 1))
    right = np.zeros((count, values.shape[1]))
    for k in range(sites.size):
        for a in range(degree + 1):
            i = (first[k] + a) % count
            factor = weights[k] * table[k, a]
            for b in range(degree + 1):
                rows[i, degree + b - a] += factor * table[k, b]
            for c in range(values.shape[1]):
                right[i, c] += factor * values[k, c]
    return rows, right


@compiled
def fit_open(degree, knots, sites, values, weights):
    """Least-squares control points of a clamped spline that meets the first and last values."""
    count = knots.size - degree - 1
    rows, right = normal_equations(degree, knots, sites, values, weights, count)
    for i, k in ((0, 0), (count - 1, sites.size - 1)):
        rows[i] = 0.0
        rows[i, degree] = 1.0
        for c in range(values.shape[1]):
            right[i, c] = values[k, c]
    solve_band(rows, degree, right)
    return right


def fit_periodic(degree, knots, sites, values):
    """Least-squares control points ``(n + degree, m)`` of a periodic spline."""
    count = knots.size - 2 * degree - 1
    rows, right = normal_equations(degree, knots, sites, values, np.ones(sites.size), count)
    return wrap_rows(solve_cyclic(rows, degree, right), 0, degree)
