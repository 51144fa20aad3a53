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
def _add(gradient, hessian, i, c, first, second):
    """Add f(c . x) at the ordinates of cells i - 1 to i + 1, given the first two derivatives of f.

    Both arrays have a row more at each end; ``hessian[i, k]`` belongs to cells i - 1 and i - 1 + k.
    """
    c0, c1, c2 = c
    gradient[i] += first * c0
    gradient[i + 1] += first * c1
    gradient[i + 2] += first * c2
    hessian[i, 0] += second * c0 * c0
    hessian[i, 1] += second * c0 * c1
    hessian[i, 2] += second * c0 * c2
    hessian[i + 1, 0] += second * c1 * c1
    hessian[i + 1, 1] += second * c1 * c2
    hessian[i + 2, 0] += second * c2 * c2


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
        room = (1.0 - b / caps[i]) * (1.0 - (0.5 * d / acceleration) ** 2)
        for k in range(along.shape[1]):
            part = along[i, k] * d + across[i, k] * b
            if not abs(part) < 1.0:
                return np.inf
            room *= 1.0 - part * part
        logs += log(room)
    for i in range(n):
        if not middle[i] > 0.0:  # else v² might fall below zero inside the cell
            return np.inf
        second_derivative = (slopes[i + 1] - slopes[i]) / widths[i] / (2.0 * jerk)
        total += 2.0 * widths[i] / (sqrt(squares[i]) + sqrt(squares[i + 1]))
        first = 1.0 - second_derivative * second_derivative * squares[i]
        last = 1.0 - second_derivative * second_derivative * squares[i + 1]
        if not (first > 0.0 and last > 0.0):
            return np.inf
        logs += log(middle[i] * first * last)
    return total - weight * logs


@kernel
def _model(widths, middle, ends, caps, axes, machine, weight, squares, slopes, gradient, hessian):
    """Gradient and convex Hessian of the potential, the jerk limits on their tangents; see `_add`."""
    acceleration, jerk = machine
    along, across = axes
    n = middle.size
    nodal(widths, middle, ends, squares, slopes)
    gradient[:] = 0.0
    hessian[:] = 0.0
    for i in range(1, n):
        w = widths[i - 1] + widths[i]
        bl, br, slope = widths[i] / w, widths[i - 1] / w, 2.0 / w
        room = 1.0 / (caps[i] - squares[i])
        _add(gradient, hessian, i, (bl, br, 0.0), weight * room, weight * room * room)
        more, less = 1.0 / (2.0 * acceleration - slopes[i]), 1.0 / (2.0 * acceleration + slopes[i])
        first, second = weight * (more - less), weight * (more * more + less * less)
        _add(gradient, hessian, i, (-slope, slope, 0.0), first, second)
        for k in range(along.shape[1]):
            part = along[i, k] * slopes[i] + across[i, k] * squares[i]
            c = across[i, k] * bl - along[i, k] * slope, across[i, k] * br + along[i, k] * slope, 0.0
            more, less = 1.0 / (1.0 - part), 1.0 / (1.0 + part)
            first, second = weight * (more - less), weight * (more * more + less * less)
            _add(gradient, hessian, i, c, first, second)
    for i in range(n):
        h = widths[i]
        before = h + widths[i - 1] if i > 0 else 1.0
        after = h + widths[i + 1] if i < n - 1 else 1.0
        inner_left, inner_right = 1.0 if i > 0 else 0.0, 1.0 if i < n - 1 else 0.0
        left = inner_left * h / before, inner_left * (before - h) / before, 0.0
        right = 0.0, inner_right * (after - h) / after, inner_right * h / after
        second_left, second_right = inner_left * 2.0 / (before * h), inner_right * 2.0 / (after * h)
        second_own = -second_left - second_right
        p, q = squares[i], squares[i + 1]
        vp, vq = sqrt(p), sqrt(q)
        total = vp + vq
        first, second = h / total**2, h / total**3
        # the time of the cell as a function of b at both ends: f(left . x) + f(right . x) + a mixed term
        mixed = second / (vp * vq)
        _add(gradient, hessian, i, left, -first / vp, second / p + 0.5 * first / (p * vp) - mixed)
        _add(gradient, hessian, i, right, -first / vq, second / q + 0.5 * first / (q * vq) - mixed)
        both = left[0], left[1] + right[1], right[2]
        _add(gradient, hessian, i, both, 0.0, mixed)
        _add(gradient, hessian, i, (0.0, 1.0, 0.0), -weight / middle[i], weight / middle[i] ** 2)
        second_derivative = (slopes[i + 1] - slopes[i]) / h
        for end in range(2):
            b = q if end else p
            c = right if end else left
            most = 2.0 * jerk / sqrt(b)
            _add(gradient, hessian, i, c, -weight / b, weight / (b * b))
            fall = 0.5 * most / b
            for sign in (1.0, -1.0):
                room = 1.0 / (most - sign * second_derivative)
                d = (
                    sign * second_left + fall * c[0],
                    sign * second_own + fall * c[1],
                    sign * second_right + fall * c[2],
                )
                _add(gradient, hessian, i, d, weight * room, weight * room * room)


@kernel
def _solve(bands, right):
    """Solve a symmetric system of five diagonals in place (L D Lᵀ); ``bands[i, k]`` is entry (i, i + k)."""
    n = right.size
    for i in range(n):
        for k in range(1, 3):
            if i + k < n:
                factor = bands[i, k] / bands[i, 0]
                for j in range(k, 3):
                    if i + j < n:
                        bands[i + k, j - k] -= factor * bands[i, j]
                right[i + k] -= factor * right[i]
    for i in range(n - 1, -1, -1):
        value = right[i] / bands[i, 0]
        for k in range(1, 3):
            if i + k < n:
                value -= bands[i, k] / bands[i, 0] * right[i + k]
        right[i] = value


@kernel
def centre(widths, middle, ends, caps, axes, machine, weight, tolerance, most):
    """Newton steps on the potential, in place, from a motion that keeps all limits: their number."""
    n = middle.size
    squares, slopes = np.empty(n + 1), np.empty(n + 1)
    padded, rows = np.empty(n + 2), np.empty((n + 2, 3))
    step, scale, trial = np.empty(n), np.zeros(n), np.empty(n)
    value = potential(widths, middle, ends, caps, axes, machine, weight, squares, slopes)
    for count in range(most):
        _model(widths, middle, ends, caps, axes, machine, weight, squares, slopes, padded, rows)
        gradient, hessian = padded[1 : n + 1], rows[1 : n + 1]
        for i in range(1, n - 1):  # the ordinates of the end cells are given
            scale[i] = 1.0 / sqrt(hessian[i, 0])
        for i in range(n):
            for k in range(min(3, n - i)):
                hessian[i, k] *= scale[i] * scale[i + k]
        hessian[0, 0] = hessian[n - 1, 0] = 1.0
        step[:] = -scale * gradient
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
