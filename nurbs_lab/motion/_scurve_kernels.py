"""Kernels of the S-curve: the least time with limited jerk, found by a barrier method on v² over length.

The unknowns are the ordinates of a quadratic spline b(s) = v², smooth to its slope 2a. Node by node b and
its slope are linear in them, so that limits of speed, acceleration and axes are linear too; the jerk is
b'' v / 2. Its limit |b''| <= 2 J / sqrt(b) is not convex, but the tangent of 1 / sqrt(b) lies below it:
Newton steps that keep to the tangents descend, and every iterate keeps every limit with room to spare.

Cell i lies between nodes i and i + 1 and has the ordinate ``middle[i]``, the crossing of its end tangents.
"""

from math import log, sqrt

import numpy as np

from nurbs_lab.common.kernels import inlined, kernel
from nurbs_lab.motion._relaxation import add_time_of_cell, time_of_cell

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
def potential(problem, middle, weight, squares, slopes):
    """Time, infinite where a limit is exceeded, and the logarithms of all room to the limits."""
    widths, ends, caps, nodes, turns, free = problem
    n = middle.size
    nodal(widths, middle, ends, squares, slopes)
    total, logs, speed = 0.0, 0.0, sqrt(squares[0])
    for i in range(n):
        if not middle[i] > 0.0:  # else v² might fall below zero inside the cell
            return np.inf, 0.0
        before, speed = speed, sqrt(squares[i + 1])
        time = 2.0 * widths[i] / (before + speed)
        second = (slopes[i + 1] - slopes[i]) / widths[i]
        room = middle[i]
        if free.shape[1]:
            place = squares[i], squares[i + 1], slopes[i], slopes[i + 1]
            time, inner = time_of_cell(free, i, time, place, weight)
            room *= inner
        total += time
        if 0 < i < n - 1:
            if not middle[i] < caps[i]:
                return np.inf, 0.0
            room *= 1.0 - middle[i] / caps[i]
        inner = _room_at_node(nodes, i + 1, squares, slopes) if i + 1 < n else 1.0
        inner *= _room_of_turns(turns, i, second, squares, slopes)
        if not inner > 0.0:
            return np.inf, 0.0
        logs += log(room * inner)  # one logarithm a cell: it is slow
    return total, logs


@inlined
def _room_at_node(nodes, i, squares, slopes):
    """Product of the room to the limits of a node; not above zero if one is exceeded."""
    along, across, steepest, kappas = nodes
    b, d = squares[i], slopes[i]
    room = 1.0 - (0.5 * d / steepest[i]) ** 2 - (kappas[i] * b) ** 2
    for k in range(along.shape[1]):
        part = 1.0 - along[i, k] * d - across[i, k] * b
        if not (part > 0.0 and room > 0.0):
            return 0.0
        room *= part
    return room


@inlined
def _room_of_turns(turns, i, second, squares, slopes):
    """Product of the room to the jerks at both ends of a cell; not above zero if one is exceeded."""
    room = 1.0
    for k in range(turns.shape[1]):
        side = k % 2
        b = squares[i + side]
        part = turns[i, k, 0] * second + turns[i, k, 1] * slopes[i + side] + turns[i, k, 2] * b
        part = 1.0 - part * part * b
        if not part > 0.0:
            return 0.0
        room *= part
    return room


@inlined
def _model(grid, problem, middle, weight, squares, slopes, padded):
    """Gradient and convex Hessian of the potential, the jerk limits on their tangents.

    Both arrays of ``padded`` have a row more at each end, for b there; ``hessian[i, k]`` belongs to cells
    i - 1 and i - 1 + k. ``grid`` holds the widths of the cells, zero beyond the ends, one over the sum of
    both at every node, an array for 1 / v at every node, and the model by b and its slope d at the nodes:
    first derivatives, second ones (b b, b d, d d) of a node and (b b, b d, d b, d d) of the two of a cell.
    """
    wide, joined, slowness, nodal_model = grid
    widths, ends, caps, nodes, turns, free = problem
    gradient, hessian = padded
    nodal(widths, middle, ends, squares, slopes)
    gradient[:] = 0.0
    hessian[:] = 0.0
    for part in nodal_model:
        part[:] = 0.0
    for i in range(squares.size):
        slowness[i] = 1.0 / sqrt(squares[i])
    for i in range(1, middle.size):
        _add_node(nodes, weight, i, (squares[i], slopes[i]), nodal_model)
    for i in range(middle.size):
        if free.shape[1]:
            place = squares[i], squares[i + 1], slopes[i], slopes[i + 1]
            add_time_of_cell(widths[i], slowness, free, weight, i, place, nodal_model)
        else:
            _add_cell(widths[i], slowness, turns, weight, i, squares, slopes, nodal_model)
        room = 1.0 / middle[i]
        gradient[i + 1] -= weight * room
        hessian[i + 1, 0] += weight * room * room
        if 0 < i < middle.size - 1:
            room = 1.0 / (caps[i] - middle[i])
            gradient[i + 1] += weight * room
            hessian[i + 1, 0] += weight * room * room
    _by_ordinates(wide, joined, nodal_model, padded)


@inlined
def _by_ordinates(wide, joined, nodal_model, padded):
    """Add the model by b and its slope at the nodes to that by ordinates, in which both are linear."""
    first, own, cross = nodal_model
    gradient, hessian = padded
    for i in range(joined.size):
        slope, left, right = 2.0 * joined[i], wide[i + 1] * joined[i], wide[i] * joined[i]
        by_b, by_d, bb, bd, dd = first[i, 0], first[i, 1], own[i, 0], own[i, 1], own[i, 2] * slope
        gradient[i] += by_b * left - by_d * slope
        gradient[i + 1] += by_b * right + by_d * slope
        hessian[i, 0] += bb * left * left + slope * (dd - 2.0 * bd * left)
        hessian[i, 1] += bb * left * right + slope * (bd * (left - right) - dd)
        hessian[i + 1, 0] += bb * right * right + slope * (dd + 2.0 * bd * right)
        if i < cross.shape[0]:
            after, low, high = 2.0 * joined[i + 1], wide[i + 2] * joined[i + 1], wide[i + 1] * joined[i + 1]
            b_y, d_y = cross[i, 0] * low - cross[i, 1] * after, cross[i, 2] * low - cross[i, 3] * after
            b_z, d_z = cross[i, 0] * high + cross[i, 1] * after, cross[i, 2] * high + cross[i, 3] * after
            hessian[i, 1] += left * b_y - slope * d_y
            hessian[i, 2] += left * b_z - slope * d_z
            hessian[i + 1, 0] += 2.0 * (right * b_y + slope * d_y)
            hessian[i + 1, 1] += right * b_z + slope * d_z


@kernel
def _between(most, x):
    """Derivatives of the barrier that keeps x between -most and most: by x, by -most, and twice by x."""
    room = 1.0 / ((most - x) * (most + x))  # one division: these take most of the time
    first, other = 2.0 * x * room, 2.0 * most * room
    return first, other, 0.5 * (first * first + other * other)


@inlined
def _add_node(nodes, weight, i, place, nodal_model):
    """Add the limits at a node, which depend on b and its slope d, to the model."""
    along, across, steepest, kappas = nodes
    first, own, _ = nodal_model
    b, d = place
    flat, bent = 0.5 / steepest[i] ** 2, 2.0 * kappas[i] ** 2
    room = 1.0 / (1.0 - 0.5 * flat * d * d - 0.5 * bent * b * b)
    by_d, by_b = flat * d * room, bent * b * room
    by_dd, by_bb, by_bd = flat * room + by_d * by_d, bent * room + by_b * by_b, by_d * by_b
    for k in range(along.shape[1]):
        t, n = along[i, k], across[i, k]
        room = 1.0 / (1.0 - t * d - n * b)
        t, n = t * room, n * room
        by_b += n
        by_d += t
        by_bb += n * n
        by_bd += n * t
        by_dd += t * t
    first[i, 0], first[i, 1] = weight * by_b, weight * by_d
    own[i, 0], own[i, 1], own[i, 2] = weight * by_bb, weight * by_bd, weight * by_dd


@inlined
def _add_cell(h, slowness, turns, weight, i, squares, slopes, nodal_model):
    """Add the time of a cell, and the jerks at both of its ends: |t b'' + n b' + m b| <= 1 / sqrt(b) each."""
    first, own, cross = nodal_model
    p, q = slowness[i], slowness[i + 1]
    mean, second = p * q / (p + q), (slopes[i + 1] - slopes[i]) / h
    short, shorter = h * mean**2, h * mean**3
    cross[i, 0] = shorter * p * q
    for side in range(2):
        slow, at, other = slowness[i + side], i + side, i + 1 - side
        fall, change = 0.5 * slow**3, (2.0 * side - 1.0) / h  # b'' is the difference of slopes times this
        t, by_d, sd, dd, bd = turns[i, side, 0], 0.0, 0.0, 0.0, 0.0  # the jerk along the path
        steep, falls, curved = _between(slow, t * second)
        by_s, ss, sb = steep * t, curved * t * t, fall * steep * falls * t
        by_b, bb = fall * falls - slow * slow, fall * fall * curved + slow**4
        for k in range(side + 2, turns.shape[1], 2):
            t, n, m = turns[i, k, 0], turns[i, k, 1], turns[i, k, 2]
            steep, falls, curved = _between(slow, t * second + n * slopes[at] + m * squares[at])
            mixed = fall * steep * falls
            by_s, by_d = by_s + steep * t, by_d + steep * n
            by_b += steep * m + fall * falls - slow * slow
            ss, sd, sb = ss + curved * t * t, sd + curved * t * n, sb + (curved * m + mixed) * t
            dd, bd = dd + curved * n * n, bd + (curved * m + mixed) * n
            bb += curved * m * m + 2.0 * mixed * m + fall * fall * curved + slow**4
        by_s, ss, sb = weight * change * by_s, weight * change * change * ss, weight * change * sb
        sd *= weight * change
        first[at, 0] += weight * by_b - short * slow
        first[at, 1] += weight * by_d + by_s
        first[other, 1] -= by_s
        own[at, 0] += weight * bb + slow * slow * (shorter + 0.5 * short * slow)
        own[at, 1] += weight * bd + sb
        own[at, 2] += weight * dd + 2.0 * sd + ss
        own[other, 2] += ss
        cross[i, 1 + side] -= sb
        cross[i, 3] -= sd + ss


@kernel
def _border(padded, ends, middle, border):
    """Derivatives of the potential as both ends and the ordinates there grow by a part: first and second.

    ``border`` takes the mixed ones.
    """
    (gradient, hessian), n = padded, middle.size
    border[:] = 0.0
    first = second = 0.0
    for low, high, at in ((ends[0], middle[0], 0), (middle[n - 1], ends[2], n)):
        first += low * gradient[at] + high * gradient[at + 1]
        second += low * low * hessian[at, 0] + high * high * hessian[at + 1, 0]
        second += 2.0 * low * high * hessian[at, 1]
    border[1] += hessian[0, 2] * ends[0] + hessian[1, 1] * middle[0]
    border[2] += hessian[1, 2] * middle[0]
    border[n - 2] += hessian[n - 1, 1] * middle[n - 1] + hessian[n - 1, 2] * ends[2]
    border[n - 3] += hessian[n - 2, 2] * middle[n - 1]
    return first, second


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


@kernel
def _newton_step(padded, ends, middle, pull, step):
    """The Newton step of the ordinates, in place; that of the part, and how steeply the potential falls.

    The part of the ends that is reached changes only with a ``pull`` above 0: see `centre`.
    """
    n = middle.size
    gradient, hessian = padded[0][1 : n + 1], padded[1][1 : n + 1]
    scale, border, mixed = np.zeros(n), np.zeros(n), np.empty(n)
    first, second = _border(padded, ends, middle, border) if pull > 0.0 else (0.0, 0.0)
    for i in range(1, n - 1):
        scale[i] = 1.0 / sqrt(hessian[i, 0])
    for i in range(n):
        for k in range(min(3, n - i)):
            hessian[i, k] *= scale[i] * scale[i + k]
    hessian[0, 0] = hessian[n - 1, 0] = 1.0
    factor_bands(hessian)
    for i in range(n):
        step[i] = -scale[i] * gradient[i]
    solve_bands(hessian, step)
    decrement = grown = 0.0
    if pull > 0.0:
        first, second = first - pull, second + pull
        for i in range(n):
            border[i] = mixed[i] = scale[i] * border[i]
        solve_bands(hessian, mixed)
        rest = first
        for i in range(n):
            rest += border[i] * step[i]
            second -= border[i] * mixed[i]
        grown = -rest / second
        for i in range(n):
            step[i] -= grown * mixed[i]
        decrement = -grown * first
    for i in range(n):
        step[i] *= scale[i]
        decrement -= gradient[i] * step[i]
    step[0], step[n - 1] = grown * middle[0], grown * middle[n - 1]
    return grown, decrement


@kernel
def centre(problem, middle, weight, tolerance, most, growth):
    """Newton steps on the potential, in place, from a motion that keeps all limits.

    At most ``most`` steps, each shortened at most 30 times; both take time in proportion to the cells.

    ``growth`` is (part, pull). As long as the ends and the ordinates beside them are a part below 1 of what
    they shall be, they grow with the others, and the potential falls by ``weight * pull * log(part)``. The
    part that is reached is returned, and twice what one more step would gain. The pull is 0 where the part
    is 1.
    """
    n, ends, (part, pull) = middle.size, problem[1], (growth[0], weight * growth[1])
    squares, slopes, joined, wide = np.empty(n + 1), np.empty(n + 1), np.empty(n + 1), np.zeros(n + 2)
    wide[1 : n + 1] = problem[0]
    for i in range(n + 1):
        joined[i] = 1.0 / (wide[i] + wide[i + 1])
    nodal_model = np.empty((n + 1, 2)), np.empty((n + 1, 3)), np.empty((n, 4))
    grid, padded = (wide, joined, np.empty(n + 1), nodal_model), (np.empty(n + 2), np.empty((n + 2, 3)))
    step, trial, before = np.empty(n), np.empty(n), ends.copy()
    time, logs = potential(problem, middle, weight, squares, slopes)
    value, decrement = time - weight * logs - pull * log(part), np.inf
    for _ in range(most):
        _model(grid, problem, middle, weight, squares, slopes, padded)
        grown, decrement = _newton_step(padded, ends, middle, pull, step)
        if not decrement > tolerance * weight:
            break
        fraction = min(1.0, max((1.0 / part - 1.0) / grown, -0.9 / grown)) if pull > 0.0 else 1.0
        while fraction > 1e-9:
            for i in range(n):
                trial[i] = middle[i] + fraction * step[i]
            ends[:] = before * (1.0 + fraction * grown)
            time, logs = potential(problem, trial, weight, squares, slopes)
            found = time - weight * logs - pull * log(part * (1.0 + fraction * grown))
            if found <= value - 0.1 * fraction * decrement + 1e-14 * abs(value):
                break
            fraction *= 0.5
        else:
            ends[:] = before
            break
        for i in range(n):
            middle[i] = trial[i]
        value, before[:] = found, ends
        part *= 1.0 + fraction * grown
        if pull > 0.0 and part > 1.0 - 1e-12:
            return 1.0, decrement
    return part, decrement


@kernel
def phases(widths, squares, slopes, durations, jerks):
    """Three phases of constant jerk for each cell, from node to node exactly in s, v and a.

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
