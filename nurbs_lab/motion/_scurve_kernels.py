"""Kernels of the S-curve: the least time with limited jerk, found by a barrier method on v² over length.

The unknowns are the ordinates of a quadratic spline b(s) = v², smooth to its slope 2a. Node by node b and
its slope are linear in them, so that limits of speed, acceleration and axes are linear too; the jerk is
b'' v / 2. Its limit |b''| <= 2 J / sqrt(b) is not convex, but the tangent of 1 / sqrt(b) lies below it:
Newton steps that keep to the tangents descend, and every iterate keeps every limit with room to spare.

Cell i lies between nodes i and i + 1 and has the ordinate ``middle[i]``, the crossing of its end tangents.
"""

from math import log, sqrt

import numpy as np

from nurbs_lab.nurbs.span_kernels import kernel

#: Gauss points for the time of one cell.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(5)


@kernel
def nodal(widths, middle, ends, squares, slopes):
    """b and its slope at every node; ``ends`` are (b, slope) at the first and the last."""
    n = middle.size
    squares[0], slopes[0], squares[n], slopes[n] = ends
    for i in range(1, n):
        left, right = widths[i - 1], widths[i]
        squares[i] = (right * middle[i - 1] + left * middle[i]) / (left + right)
        slopes[i] = 2.0 * (middle[i] - middle[i - 1]) / (left + right)


@kernel
def _add(gradient, hessian, at, c, first, second):
    """Add f(c . x) at x = middle[at : at + 3], given the first two derivatives of f."""
    n = gradient.size
    for k in range(3):
        if 0 < at + k < n - 1:  # the ordinates of the end cells are given
            gradient[at + k] += first * c[k]
            for j in range(k, 3):
                if at + j < n - 1:
                    hessian[j - k, at + k] += second * c[k] * c[j]


@kernel
def _add_product(hessian, at, c, d, factor):
    """Add factor (c dᵀ + d cᵀ)."""
    n = hessian.shape[1]
    for k in range(3):
        if 0 < at + k < n - 1:
            for j in range(k, 3):
                if at + j < n - 1:
                    hessian[j - k, at + k] += factor * (c[k] * d[j] + d[k] * c[j])


@kernel
def potential(widths, middle, ends, caps, axes, machine, weight, squares, slopes):
    """Time minus weight times the logarithms of all room to the limits; infinite where one is exceeded."""
    acceleration, jerk = machine
    along, across = axes
    n = middle.size
    nodal(widths, middle, ends, squares, slopes)
    total = logs = 0.0
    for i in range(1, n):
        b, d = squares[i], slopes[i]
        if not 0.0 < b < caps[i] or not abs(d) < 2.0 * acceleration:
            return np.inf
        logs += log(1.0 - b / caps[i]) + log(1.0 - (0.5 * d / acceleration) ** 2)
        for k in range(along.shape[1]):
            share = along[i, k] * d + across[i, k] * b
            if not abs(share) < 1.0:
                return np.inf
            logs += log(1.0 - share * share)
    for i in range(n):
        if not middle[i] > 0.0:  # else v² might fall below zero inside the cell
            return np.inf
        logs += log(middle[i])
        second_derivative = (slopes[i + 1] - slopes[i]) / widths[i] / (2.0 * jerk)
        total += 2.0 * widths[i] / (sqrt(squares[i]) + sqrt(squares[i + 1]))
        for b in (squares[i], squares[i + 1]):
            room = 1.0 - second_derivative * second_derivative * b
            if not room > 0.0:
                return np.inf
            logs += log(room)
    return total - weight * logs


@kernel
def _model(widths, middle, ends, caps, axes, machine, weight, squares, slopes, gradient, hessian):
    """Gradient and convex Hessian (diagonals) of the potential, the jerk limits on their tangents."""
    acceleration, jerk = machine
    along, across = axes
    n = middle.size
    nodal(widths, middle, ends, squares, slopes)
    gradient[:] = 0.0
    hessian[:] = 0.0
    left, right, c, bent = np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3)
    for i in range(1, n):
        w = widths[i - 1] + widths[i]
        bl, br, slope = widths[i] / w, widths[i - 1] / w, 2.0 / w
        room = 1.0 / (caps[i] - squares[i])
        c[0], c[1], c[2] = bl, br, 0.0
        _add(gradient, hessian, i - 1, c, weight * room, weight * room * room)
        c[0], c[1] = -slope, slope
        more, less = 1.0 / (2.0 * acceleration - slopes[i]), 1.0 / (2.0 * acceleration + slopes[i])
        _add(gradient, hessian, i - 1, c, weight * (more - less), weight * (more * more + less * less))
        for k in range(along.shape[1]):
            share = along[i, k] * slopes[i] + across[i, k] * squares[i]
            c[0], c[1] = across[i, k] * bl - along[i, k] * slope, across[i, k] * br + along[i, k] * slope
            more, less = 1.0 / (1.0 - share), 1.0 / (1.0 + share)
            _add(gradient, hessian, i - 1, c, weight * (more - less), weight * (more * more + less * less))
    for i in range(n):
        h = widths[i]
        before = h + widths[i - 1] if i > 0 else 1.0
        after = h + widths[i + 1] if i < n - 1 else 1.0
        inner_left, inner_right = 1.0 if i > 0 else 0.0, 1.0 if i < n - 1 else 0.0
        left[0], left[1], left[2] = inner_left * h / before, inner_left * (before - h) / before, 0.0
        right[0], right[1], right[2] = 0.0, inner_right * (after - h) / after, inner_right * h / after
        bent[0], bent[2] = inner_left * 2.0 / (before * h), inner_right * 2.0 / (after * h)
        bent[1] = -bent[0] - bent[2]
        p, q = squares[i], squares[i + 1]
        vp, vq = sqrt(p), sqrt(q)
        total = vp + vq
        first, second = h / total**2, h / total**3
        _add(gradient, hessian, i - 1, left, -first / vp, second / p + 0.5 * first / (p * vp))
        _add(gradient, hessian, i - 1, right, -first / vq, second / q + 0.5 * first / (q * vq))
        _add_product(hessian, i - 1, left, right, second / (vp * vq))
        gradient[i] -= weight / middle[i]
        hessian[0, i] += weight / middle[i] ** 2
        second_derivative = (slopes[i + 1] - slopes[i]) / h
        for end in range(2):
            b = q if end else p
            most = 2.0 * jerk / sqrt(b)
            _add(gradient, hessian, i - 1, right if end else left, -weight / b, weight / (b * b))
            for sign in (1.0, -1.0):
                room = 1.0 / (most - sign * second_derivative)
                for k in range(3):
                    c[k] = sign * bent[k] + 0.5 * most / b * (right[k] if end else left[k])
                _add(gradient, hessian, i - 1, c, weight * room, weight * room * room)


@kernel
def _solve(bands, right):
    """Solve a symmetric system of five diagonals in place (L D Lᵀ); ``bands[k, i]`` is entry (i, i + k)."""
    n = right.size
    for i in range(n):
        for k in range(1, 3):
            if i + k < n:
                factor = bands[k, i] / bands[0, i]
                for j in range(k, 3):
                    if i + j < n:
                        bands[j - k, i + k] -= factor * bands[j, i]
                right[i + k] -= factor * right[i]
    for i in range(n - 1, -1, -1):
        value = right[i] / bands[0, i]
        for k in range(1, 3):
            if i + k < n:
                value -= bands[k, i] / bands[0, i] * right[i + k]
        right[i] = value


@kernel
def centre(widths, middle, ends, caps, axes, machine, weight, tolerance, most):
    """Newton steps on the potential, in place, from a motion that keeps all limits: their number."""
    n = middle.size
    squares, slopes = np.empty(n + 1), np.empty(n + 1)
    step, hessian, scale, trial = np.empty(n), np.empty((3, n)), np.empty(n), np.empty(n)
    value = potential(widths, middle, ends, caps, axes, machine, weight, squares, slopes)
    for count in range(most):
        _model(widths, middle, ends, caps, axes, machine, weight, squares, slopes, step, hessian)
        gradient = step.copy()
        for i in range(n):
            scale[i] = 1.0 / sqrt(hessian[0, i]) if 0 < i < n - 1 else 0.0
        for k in range(3):
            for i in range(n - k):
                hessian[k, i] *= scale[i] * scale[i + k]
        hessian[0, 0] = hessian[0, n - 1] = 1.0
        step *= -scale
        _solve(hessian, step)
        step *= scale
        decrement = 0.0
        for i in range(n):
            decrement -= gradient[i] * step[i]
        if not decrement > tolerance * weight:
            return count
        share = 1.0
        while share > 1e-9:
            trial[:] = middle + share * step
            found = potential(widths, trial, ends, caps, axes, machine, weight, squares, slopes)
            if found <= value - 0.1 * share * decrement + 1e-14 * abs(value):
                break
            share *= 0.5
        else:
            return count
        middle[:] = trial
        value = found
    return most


@kernel
def pieces(widths, squares, slopes, durations, jerks):
    """Three pieces of constant jerk for each cell, from node to node exactly in s, v and a.

    Their jerks lie between those at the ends of the cell, where the spline has ``b'' v / 2``.
    """
    for i in range(widths.size):
        h, second_derivative = widths[i], (slopes[i + 1] - slopes[i]) / widths[i]
        time = 0.0
        for k in range(_NODES.size):
            s = 0.5 * h * (1.0 + _NODES[k])
            time += 0.5 * h * _WEIGHTS[k] / sqrt(squares[i] + s * (slopes[i] + 0.5 * second_derivative * s))
        v, a = sqrt(squares[i]), 0.5 * slopes[i]
        third = time / 3.0
        zero = 0.5 * second_derivative * h / third
        one = (sqrt(squares[i + 1]) - v - a * time) / third**2
        two = (h - time * (v + 0.5 * a * time)) / third**3
        # zero = x + y + z; one = (5x + 3y + z) / 2; two = (19x + 7y + z) / 6
        x = zero / 3.0 - one + two
        y = -7.0 / 6.0 * zero + 3.0 * one - 2.0 * two
        durations[3 * i : 3 * i + 3] = third
        jerks[3 * i], jerks[3 * i + 1], jerks[3 * i + 2] = x, y, zero - x - y
