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
from nurbs_lab.motion._bands import factor_bands, solve_bands
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
    widths, ends, caps, nodes, turns, jerk, free = problem
    n = middle.size
    nodal(widths, middle, ends, squares, slopes)
    total, logs, speed = 0.0, 0.0, sqrt(squares[0])
    for i in range(n):
        if not middle[i] > 0.0:  # else v² might fall below zero inside the cell
            return np.inf, 0.0
        before, speed = speed, sqrt(squares[i + 1])
        time = 2.0 * widths[i] / (before + speed)
        second = (slopes[i + 1] - slopes[i]) / widths[i]
        part = second / (2.0 * jerk[i])
        first, last = 1.0 - part * part * squares[i], 1.0 - part * part * squares[i + 1]
        if not (first > 0.0 and last > 0.0):
            return np.inf, 0.0
        room = middle[i] * first * last
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
    """Product of the room to the jerks of axes at both ends of a cell; not above zero if one is exceeded."""
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
    both at every node, and an array for 1 / v at every node.
    """
    slowness = grid[2]
    widths, ends, caps, nodes, turns, jerk, free = problem
    gradient, hessian = padded
    nodal(widths, middle, ends, squares, slopes)
    gradient[:] = 0.0
    hessian[:] = 0.0
    for i in range(squares.size):
        slowness[i] = 1.0 / sqrt(squares[i])
    for i in range(1, middle.size):
        _add_node(grid, nodes, weight, i, (squares[i], slopes[i]), padded)
    for i in range(middle.size):
        if free.shape[1]:
            place = squares[i], squares[i + 1], slopes[i], slopes[i + 1]
            add_time_of_cell(grid, free, weight, i, place, padded)
        else:
            _add_cell(grid, jerk[i], weight, i, slopes[i + 1] - slopes[i], padded)
        if turns.shape[1]:
            _add_turns(grid, turns, weight, i, squares, slopes, padded)
        room = 1.0 / middle[i]
        gradient[i + 1] -= weight * room
        hessian[i + 1, 0] += weight * room * room
        if 0 < i < middle.size - 1:
            room = 1.0 / (caps[i] - middle[i])
            gradient[i + 1] += weight * room
            hessian[i + 1, 0] += weight * room * room


@kernel
def _between(most, x):
    """First and second derivative by x of the barrier that keeps x between -most and most."""
    room = 1.0 / ((most - x) * (most + x))  # one division: these take most of the time
    first, other = 2.0 * x * room, 2.0 * most * room
    return first, other, 0.5 * (first * first + other * other)


@inlined
def _add_node(grid, nodes, weight, i, place, padded):
    """Add the limits at a node, which depend on b and its slope d, to the model."""
    along, across, steepest, kappas = nodes
    gradient, hessian = padded
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
    widths, slope = grid[0], 2.0 * grid[1][i]
    left, right = 0.5 * slope * widths[i + 1], 0.5 * slope * widths[i]
    gradient[i] += weight * (by_b * left - by_d * slope)
    gradient[i + 1] += weight * (by_b * right + by_d * slope)
    hessian[i, 0] += weight * (by_bb * left * left - 2.0 * by_bd * left * slope + by_dd * slope * slope)
    hessian[i, 1] += weight * (by_bb * left * right + by_bd * slope * (left - right) - by_dd * slope * slope)
    hessian[i + 1, 0] += weight * (
        by_bb * right * right + 2.0 * by_bd * right * slope + by_dd * slope * slope
    )


@inlined
def _add_turns(grid, turns, weight, i, squares, slopes, padded):
    """Add the jerks of axes at both ends of a cell: |t b'' + n b' + m b| <= 1 / sqrt(b) each."""
    widths, joined, slowness = grid
    gradient, hessian = padded
    own = 1.0 / widths[i + 1]
    second = (slopes[i + 1] - slopes[i]) * own
    s0, s2 = 2.0 * joined[i] * own, 2.0 * joined[i + 1] * own
    for k in range(turns.shape[1]):
        side = k % 2
        j, b, slow = joined[i + side], squares[i + side], slowness[i + side]
        t, n, m = turns[i, k, 0], turns[i, k, 1], turns[i, k, 2]
        wide = widths[i + 1] * j  # b and its slope by the ordinates of three cells
        if side == 0:
            b0, b1, b2 = wide, widths[i] * j, 0.0
            d0, d1, d2 = -2.0 * j, 2.0 * j, 0.0
        else:
            b0, b1, b2 = 0.0, widths[i + 2] * j, wide
            d0, d1, d2 = 0.0, -2.0 * j, 2.0 * j
        x, y, z = (
            t * s0 + n * d0 + m * b0,
            t * (-s0 - s2) + n * d1 + m * b1,
            t * s2 + n * d2 + m * b2,
        )
        first, other, curved = _between(slow, t * second + n * slopes[i + side] + m * b)
        fall = 0.5 * slow**3
        by_b, by_bb = fall * other - slow * slow, fall * fall * curved + slow**4
        mixed = fall * first * other
        for c, (own_b, own_l) in enumerate(((b0, x), (b1, y), (b2, z))):
            gradient[i + c] += weight * (first * own_l + by_b * own_b)
            hessian[i + c, 0] += weight * (
                curved * own_l * own_l + by_bb * own_b * own_b + 2.0 * mixed * own_l * own_b
            )
        hessian[i, 1] += weight * (curved * x * y + by_bb * b0 * b1 + mixed * (x * b1 + y * b0))
        hessian[i, 2] += weight * (curved * x * z + by_bb * b0 * b2 + mixed * (x * b2 + z * b0))
        hessian[i + 1, 1] += weight * (curved * y * z + by_bb * b1 * b2 + mixed * (y * b2 + z * b1))


@kernel
def _jerk_barrier(jerk, weight, slowness, s):
    """Derivatives of the jerk limit's barrier at one end of a cell: by b, s, b b, b s and s s."""
    fall = jerk * slowness**3  # of the largest s, as b grows
    by_s, by_most, by_ss = _between(2.0 * jerk * slowness, s)
    return (
        weight * fall * by_most, weight * by_s, weight * fall * fall * by_ss,
        weight * fall * by_most * by_s, weight * by_ss,
    )  # fmt: skip


@inlined
def _add_cell(grid, jerk, weight, i, rise, padded):
    """Add the time and the jerk limit of a cell, in which the slope of b rises, to the model."""
    widths, joined, slowness = grid
    gradient, hessian = padded
    h, tp, tq = widths[i + 1], slowness[i], slowness[i + 1]
    own_width, mean = 1.0 / h, tp * tq / (tp + tq)
    s = rise * own_width
    first, second = h * mean**2, h * mean**3
    by_p, by_q = -tp * (first + weight * tp), -tq * (first + weight * tq)
    by_pp = tp * tp * (second + tp * (0.5 * first + weight * tp))
    by_qq = tq * tq * (second + tq * (0.5 * first + weight * tq))
    by_pq = second * tp * tq
    own, slope, own_own, by_ps, both = _jerk_barrier(jerk, weight, tp, s)
    by_p, by_pp, by_s, by_ss = by_p + own, by_pp + own_own, slope, both
    own, slope, own_own, by_qs, both = _jerk_barrier(jerk, weight, tq, s)
    by_q, by_qq, by_s, by_ss = by_q + own, by_qq + own_own, by_s + slope, by_ss + both
    # p = p0 x + p1 y, q = q1 y + q2 z, s = s0 x + s1 y + s2 z for the ordinates x, y, z of three cells
    p0, p1 = h * joined[i], widths[i] * joined[i]
    q1, q2 = widths[i + 2] * joined[i + 1], h * joined[i + 1]
    s0, s2 = 2.0 * joined[i] * own_width, 2.0 * joined[i + 1] * own_width
    s1 = -s0 - s2
    gradient[i] += by_p * p0 + by_s * s0
    gradient[i + 1] += by_p * p1 + by_q * q1 + by_s * s1
    gradient[i + 2] += by_q * q2 + by_s * s2
    px, sx = p0 * by_pp + s0 * by_ps, p0 * by_ps + s0 * by_ss  # the Hessian times each column
    qx = p0 * by_pq + s0 * by_qs
    py, sy = p1 * by_pp + q1 * by_pq + s1 * by_ps, p1 * by_ps + q1 * by_qs + s1 * by_ss
    qy = p1 * by_pq + q1 * by_qq + s1 * by_qs
    hessian[i, 0] += p0 * px + s0 * sx
    hessian[i, 1] += p1 * px + q1 * qx + s1 * sx
    hessian[i, 2] += q2 * qx + s2 * sx
    hessian[i + 1, 0] += p1 * py + q1 * qy + s1 * sy
    hessian[i + 1, 1] += q2 * qy + s2 * sy
    hessian[i + 2, 0] += q2 * (q2 * by_qq + 2.0 * s2 * by_qs) + s2 * s2 * by_ss


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
    grid, padded = (wide, joined, np.empty(n + 1)), (np.empty(n + 2), np.empty((n + 2, 3)))
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
