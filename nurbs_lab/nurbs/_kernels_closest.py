"""Closest points by branch and bound, refined by Newton's method.

Leaves are Bezier patches in Morton order, in a tree of boxes (`common.box_tree`). A cell of a leaf is done
with when Bernstein coefficients show that nothing in it is nearer than what is known, or that it has
a single local minimum, which Newton's method has found; until then it is halved, at most 16 times. A curve
is a surface of degree 0 along v.
"""

import numpy as np

from nurbs_lab.common.box_tree import box_distance, open_box
from nurbs_lab.common.kernels import compiled, inlined
from nurbs_lab.nurbs._kernels_bernstein import (
    bernstein,
    distance_net,
    doubtful_axis,
    excess,
    halve,
    square_nets,
    squared_size,
)

ITERATIONS = 100
DEEPEST = 16  # halvings of a leaf; beyond them Newton's method decides
EVERY = 4  # after so many halvings Newton's method is tried, because a shorter distance excludes other cells
TIE = 1e-12  # relative decrease of a squared distance that is not searched for
NOISE = 1e-14  # relative rounding error of the coefficients of D
FLAT = 1e-12  # of the square of the tangent: a smaller second derivative is not used by Newton's method
ENOUGH = 1e-14  # of a leaf: smaller steps are not taken
TOLD = 1e-14  # of a squared distance: below it rounding hides the decrease, and Newton's step is taken anyway
ROUNDING = 4e-16  # relative to the coordinates: distances below it are zero


@compiled
def square_jet(net, point, s, t, work):
    """|S - point|^2 of the patch at (s, t), half its gradient and Hessian, and S_s S_s, S_s S_t, S_t S_t."""
    table_s, table_t, rows, lifted, jet = work
    dim = point.size
    bernstein(net.shape[0] - 1, s, table_s)
    bernstein(net.shape[1] - 1, t, table_t)
    for k in range(3):
        for j in range(net.shape[1]):
            for d in range(dim + 1):
                total = 0.0
                for i in range(net.shape[0]):
                    total += table_s[k, i] * net[i, j, d]
                rows[j, d] = total
        for m in range(3 - k):
            for d in range(dim + 1):
                total = 0.0
                for j in range(net.shape[1]):
                    total += table_t[m, j] * rows[j, d]
                lifted[k, m, d] = total
    scale = 1.0 / lifted[0, 0, dim]
    ws, wt = lifted[1, 0, dim] * scale, lifted[0, 1, dim] * scale
    wss, wst, wtt = lifted[2, 0, dim] * scale, lifted[1, 1, dim] * scale, lifted[0, 2, dim] * scale
    jet[:] = 0.0
    for d in range(dim):
        at = lifted[0, 0, d] * scale
        a = lifted[1, 0, d] * scale - ws * at
        b = lifted[0, 1, d] * scale - wt * at
        gap = at - point[d]
        jet[0] += gap * gap
        jet[1] += gap * a
        jet[2] += gap * b
        jet[3] += a * a + gap * (lifted[2, 0, d] * scale - 2.0 * ws * a - wss * at)
        jet[4] += a * b + gap * (lifted[1, 1, d] * scale - ws * b - wt * a - wst * at)
        jet[5] += b * b + gap * (lifted[0, 2, d] * scale - 2.0 * wt * b - wtt * at)
        jet[6] += a * a
        jet[7] += a * b
        jet[8] += b * b
    return jet[0]


@inlined
def descend(net, point, cell, s, t, work):
    """Least |S(s, t) - point|^2 on a cell of a patch, by Newton from (s, t): (s, t, square).

    At most 100 steps are made; each is halved at most 47 times, and one along the gradient as often.
    """
    low_s, high_s, low_t, high_t = cell
    best = square_jet(net, point, s, t, work)
    floor = ROUNDING**2 * squared_size(point)
    for _ in range(ITERATIONS):
        _, gs, gt, hss, hst, htt, ss, st, tt = work[-1]
        # at an edge of the cell or at a pole one parameter is fixed, and the other moves alone
        stuck_s = ss <= 0.0 or (s <= low_s and gs >= 0.0) or (s >= high_s and gs <= 0.0)
        stuck_t = tt <= 0.0 or (t <= low_t and gt >= 0.0) or (t >= high_t and gt <= 0.0)
        free, curved = not (stuck_s or stuck_t), hss > FLAT * ss and htt > FLAT * tt
        determinant = hss * htt - hst * hst
        if free and not (curved and determinant > FLAT * hss * htt):
            hss, hst, htt = ss, st, tt  # the matrix of Gauss and Newton leads along bent valleys
            determinant = hss * htt - hst * hst
        if free and determinant > FLAT * hss * htt:
            step_s = (hst * gt - htt * gs) / determinant
            step_t = (hst * gs - hss * gt) / determinant
        else:
            step_s = 0.0 if stuck_s else -gs / (hss if hss > FLAT * ss else ss)
            step_t = 0.0 if stuck_t else -gt / (htt if htt > FLAT * tt else tt)
        moved = False
        for attempt in range(2):
            if attempt == 1:  # a clipped Newton step may increase the distance; the scaled gradient does not
                step_s = 0.0 if stuck_s else -gs / ss
                step_t = 0.0 if stuck_t else -gt / tt
            to_s = min(max(s + step_s, low_s), high_s)
            to_t = min(max(t + step_t, low_t), high_t)
            step_s, step_t = to_s - s, to_t - t
            if abs(gs * step_s + gt * step_t) <= TOLD * best:
                s, t = to_s, to_t  # too short to change the distance, but the parameters improve
                break
            move = max(abs(step_s), abs(step_t))
            while move > ENOUGH:
                trial = square_jet(net, point, to_s, to_t, work)
                if trial < best:
                    s, t, best, moved = to_s, to_t, trial, True
                    break
                to_s, to_t = 0.5 * (to_s + s), 0.5 * (to_t + t)
                move *= 0.5
            if moved:
                break
        if not moved or best <= floor:
            break
    return s, t, best


@inlined
def search_leaf(net, squares, offset, point, best, room, work):
    """The place of a leaf that is nearer than ``best``: (s, t, square); (0, 0, best) if there is none.

    A cell is halved at most `DEEPEST` times, so at most 2**17 cells of a leaf are visited.
    """
    cells, spots, depths, gap = room
    rows, across = gap.shape
    nearest_s = nearest_t = 0.0
    noise = NOISE * distance_net(squares, offset, cells[0])
    for k in range(4):
        spots[0, k] = k % 2
    depths[0] = 0
    undecided = 1
    while undecided > 0:
        undecided -= 1
        cell, spot, depth = cells[undecided], spots[undecided], depths[undecided]
        i, j = excess(cell, best * (1 - TIE), gap)
        if gap[i, j] >= 0.0:
            continue
        axis = doubtful_axis(gap, gap[i, j], noise) if depth % EVERY else -1
        if axis < 0:
            s = spot[0] + (spot[1] - spot[0]) * (i / max(rows - 1, 1))
            t = spot[2] + (spot[3] - spot[2]) * (j / max(across - 1, 1))
            s, t, square = descend(net, point, spot, s, t, work)
            if square < best:
                nearest_s, nearest_t, best = s, t, square
            i, j = excess(cell, square * (1 - TIE), gap)
            axis = doubtful_axis(gap, gap[i, j], noise)
            if axis < 0 or depth == DEEPEST:
                continue
        other = undecided + 1
        depths[undecided] = depths[other] = depth + 1
        for k in range(4):
            spots[other, k] = spot[k]
        spot[2 * axis + 1] = spots[other, 2 * axis] = 0.5 * (spot[2 * axis] + spot[2 * axis + 1])
        for part in range(2):
            if axis == 0:
                halve(cell[part, :, :], cells[other, part, :, :])
            else:
                halve(cell[part, :, :].T, cells[other, part, :, :].T)
        undecided += 2
    return nearest_s, nearest_t, best


@compiled
def closest(boxes, nets, pieces, factors, points, uv, distance):
    """Fill ``uv (k, 2)`` and ``distance (k,)`` for ``points (k, dim)``.

    ``nets (m, p + 1, q + 1, dim + 1)`` are the leaves' homogeneous Bezier nets, ``pieces (m, 4)`` their
    intervals u0, u1, v0, v1. At worst every leaf is searched for every point.
    """
    leaves, order_u, order_v, columns = nets.shape
    inner = len(boxes) // 2
    rows, across = 2 * order_u - 1, 2 * order_v - 1
    squares = np.empty((leaves, columns + 1, rows, across))
    ready = np.zeros(leaves, dtype=np.bool_)
    room = (
        np.empty((DEEPEST + 2, 2, rows, across)),
        np.empty((DEEPEST + 2, 4)),
        np.empty(DEEPEST + 2, dtype=np.int64),
        np.empty((rows, across)),
    )
    work = (
        np.empty((3, order_u)),
        np.empty((3, order_v)),
        np.empty((order_v, columns)),
        np.empty((3, 3, columns)),
        np.empty(9),
    )
    stack = np.empty(64, dtype=np.int64)
    bounds = np.empty(64)
    centre, offset = np.empty(columns - 1), np.empty(columns - 1)
    for k in range(len(points)):
        point = points[k]
        stack[0], bounds[0] = 0, ROUNDING**2 * squared_size(point)
        best, waiting = np.inf, 1
        while waiting > 0:
            waiting -= 1
            node = stack[waiting]
            if bounds[waiting] >= best:
                continue
            if node < inner:
                left = box_distance(boxes, 2 * node + 1, point)
                right = box_distance(boxes, 2 * node + 2, point)
                waiting = open_box(node, left, right, stack, bounds, waiting)
                continue
            here = node - inner
            for d in range(point.size):
                centre[d] = 0.5 * (boxes[node, d] + boxes[node, point.size + d])
                offset[d] = point[d] - centre[d]
            if not ready[here]:
                square_nets(nets[here], centre, factors[0], factors[1], squares[here])
                ready[here] = True
            s, t, square = search_leaf(nets[here], squares[here], offset, point, best, room, work)
            if square < best:
                best = square
                u0, u1, v0, v1 = pieces[here]
                uv[k, 0], uv[k, 1] = (1.0 - s) * u0 + s * u1, (1.0 - t) * v0 + t * v1
        distance[k] = np.sqrt(best)
