"""Symmetric systems of five diagonals."""

from nurbs_lab.common.kernels import kernel


@kernel
def factor_bands(bands):
    """Factors L D Lᵀ, in place, of a symmetric matrix of five diagonals: ``bands[i, k]`` is (i, i + k)."""
    n = bands.shape[0]
    for i in range(n):
        bands[i, 0] = inverse = 1.0 / bands[i, 0]
        one, two = bands[i, 1] * inverse, bands[i, 2] * inverse
        if i + 1 < n:
            bands[i + 1, 0] -= one * bands[i, 1]
            bands[i + 1, 1] -= one * bands[i, 2]
        if i + 2 < n:
            bands[i + 2, 0] -= two * bands[i, 2]
        bands[i, 1], bands[i, 2] = one, two


@kernel
def solve_bands(factors, right):
    """Solve a system in place, by what `factor_bands` left of its matrix."""
    n = right.size
    for i in range(n):
        if i + 1 < n:
            right[i + 1] -= factors[i, 1] * right[i]
        if i + 2 < n:
            right[i + 2] -= factors[i, 2] * right[i]
        right[i] *= factors[i, 0]
    right[n - 2] -= factors[n - 2, 1] * right[n - 1]
    for i in range(n - 3, -1, -1):
        right[i] -= factors[i, 1] * right[i + 1] + factors[i, 2] * right[i + 2]
