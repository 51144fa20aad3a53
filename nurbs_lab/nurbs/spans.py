"""The span table of a curve, which the kernels of `nurbs.span_kernels` take."""

import numpy as np

from nurbs_lab.nurbs import span_kernels

ROUNDS = 60  # of halving spans whose powers cancel; a parameter has no more binary digits


def find_breaks(knots, degree):
    """The different knots of the domain, its ends included."""
    inside = knots[degree : len(knots) - degree]
    return np.concatenate([inside[:1], inside[1:][inside[1:] > inside[:-1]]])


def span_parameters(knots, degree, cells):
    """Parameters that cut every span into ``cells`` equal parts, the ends of the domain included."""
    ends = find_breaks(knots, degree)
    inner = ends[:-1, None] + np.diff(ends)[:, None] * np.arange(cells) / cells
    return np.append(inner.ravel(), ends[-1])


def span_table(degree, knots, rows, ends=None):
    """Polynomials between the knots of a curve with homogeneous control points ``rows (n, dim + 1)``.

    ``ends`` are the different knots, by default of the whole domain; the outer two may lie inside.

    A span is halved where powers of x would cancel and lose digits: where weights differ by a factor above
    100 within it, and where the degree is high. Its halves then count as spans of their own.

    Returns
    -------
    breaks : ndarray, shape (spans + 1,)
    scales : ndarray, shape (spans,)
    coefficients : ndarray, shape (spans, degree + 1, columns)
        Four columns (x, y, z, w) for a curve in up to three dimensions, else dim + 1.
    rational : bool
        If False, all weights are one.
    """
    rational = bool((rows[:, -1] != rows[0, -1]).any())
    padded = np.zeros((len(rows), max(rows.shape[1], 4)))
    padded[:, : rows.shape[1] - 1] = rows[:, :-1]
    padded[:, -1] = rows[:, -1]
    if not rational:
        padded /= rows[0, -1]
    ends = find_breaks(knots, degree) if ends is None else ends
    for _ in range(ROUNDS):
        coefficients, poor = span_kernels.span_polynomials(degree, knots, padded, ends)
        if not poor.any():
            break
        ends = np.insert(ends, 1 + np.flatnonzero(poor), 0.5 * (ends[:-1] + ends[1:])[poor])
    return ends, 2.0 / (ends[1:] - ends[:-1]), coefficients, rational
