"""Closest points: a tree of boxes for the global start, Newton's method for the digits.

Leaves are pieces of the curve or surface in an order that keeps neighbours together; the boxes stand in a
heap, ``boxes[k]`` around ``boxes[2 k]`` and ``boxes[2 k + 1]``, leaf i at ``boxes[len // 2 + i]``. Each leaf
has a second, tilted box, so thin that far points meet few of them, and ``seeds``: points at its ends and
middle (in each direction), the nearest of which starts the descent.
"""

import numpy as np
from numba import njit

from nurbs_lab.nurbs._kernels import curve_derivatives_at, find_span, span_derivatives
from nurbs_lab.nurbs._kernels_surface import second_order, second_order_work

ITERATIONS = 100
MIDDLE_OF_CURVE = 1
MIDDLE = 4  # the seed in the middle of a surface's leaf
ENOUGH = 1e-14  # of a piece: smaller steps are not worth taking
ROUNDING = 4e-16  # relative gains below it are lost in rounding


@njit(cache=True, nogil=True)
def box_heap(leaves):
    """Heap ``(2 size, 2, dim)`` over leaf boxes ``(m, 2, dim)``; the places of missing leaves stay empty."""
    size = 1
    while size < len(leaves):
        size *= 2
    heap = np.empty((2 * size, 2, leaves.shape[2]))
    heap[:, 0] = np.inf
    heap[:, 1] = -np.inf
    heap[size : size + len(leaves)] = leaves
    for k in range(size - 1, 0, -1):
        heap[k, 0] = np.minimum(heap[2 * k, 0], heap[2 * k + 1, 0])
        heap[k, 1] = np.maximum(heap[2 * k, 1], heap[2 * k + 1, 1])
    return heap


@njit(cache=True, nogil=True)
def box_distance(box, point):
    """Squared distance of a point to a box."""
    total = 0.0
    for d in range(point.size):
        gap = max(box[0, d] - point[d], point[d] - box[1, d], 0.0)
        total += gap * gap
    return total


@njit(cache=True, nogil=True)
def tilted_distance(axes, corners, point):
    """Squared distance of a point to a box with its own ``axes (dim, dim)``, one axis a column."""
    total = 0.0
    for a in range(point.size):
        along = 0.0
        for d in range(point.size):
            along += axes[d, a] * point[d]
        gap = max(corners[0, a] - along, along - corners[1, a], 0.0)
        total += gap * gap
    return total


@njit(cache=True, nogil=True)
def gap_square(frame_row, point):
    """Squared distance of two points."""
    total = 0.0
    for d in range(point.size):
        total += (frame_row[d] - point[d]) ** 2
    return total


@njit(cache=True, nogil=True)
def nearest_seed(seeds, point):
    """Index of the nearest of a leaf's seeds."""
    nearest = 0
    best = np.inf
    for k in range(len(seeds)):
        square = gap_square(seeds[k], point)
        if square < best:
            nearest, best = k, square
    return nearest


@njit(cache=True, nogil=True)
def descend_curve(degree, knots, homogeneous, point, start, end, seed, frame):
    """Least |C(u) - point|^2 on [start, end], by Newton from a seed: (u, square)."""
    u = start + (end - start) * 0.5 * seed
    span = find_span(degree, knots, 0.5 * (start + end))
    span_derivatives(span, degree, knots, homogeneous, u, frame)
    best = gap_square(frame[0], point)
    floor = ROUNDING**2 * (point**2).sum()
    for _ in range(ITERATIONS):
        slope = bend = square = 0.0
        for d in range(point.size):
            gap = frame[0, d] - point[d]
            slope += gap * frame[1, d]
            bend += gap * frame[2, d]
            square += frame[1, d] * frame[1, d]
        rate = square + bend if square + bend > 1e-12 * square else square
        if rate <= 0.0:
            break
        target = min(max(u - slope / rate, start), end)
        move = abs(target - u) / (end - start)
        gain = abs(slope * (target - u))
        if gain <= ROUNDING * best:
            u = target  # the distance cannot tell any more, but Newton still can
            break
        moved = False
        while move > ENOUGH:
            span_derivatives(span, degree, knots, homogeneous, target, frame)
            trial = gap_square(frame[0], point)
            if trial < best:
                u, best, moved = target, trial, True
                break
            target = 0.5 * (target + u)
            move *= 0.5
        if not moved or best <= floor:
            break
    return u, best


@njit(cache=True, nogil=True)
def open_box(node, heap, point, stack, bounds, waiting):
    """Put the two halves of a box on the stack, the nearer one on top; how many are waiting then."""
    near, far = 2 * node, 2 * node + 1
    to_near, to_far = box_distance(heap[near], point), box_distance(heap[far], point)
    if to_far < to_near:
        near, far, to_near, to_far = far, near, to_far, to_near
    stack[waiting], bounds[waiting] = far, to_far
    stack[waiting + 1], bounds[waiting + 1] = near, to_near
    return waiting + 2


@njit(cache=True, nogil=True)
def closest_on_curve(degree, knots, homogeneous, heap, axes, corners, pieces, seeds, points, u, distance):
    """Fill u and distance for each point; ``pieces (m, 2)`` are the leaves' parameter intervals."""
    size = len(heap) // 2
    frame = np.empty((3, points.shape[1]))
    stack = np.empty(64, dtype=np.int64)
    bounds = np.empty(64)
    low, high = knots[degree], knots[knots.size - degree - 1]
    for k in range(len(points)):
        point = points[k]
        best = np.inf
        for end in (low, high):
            curve_derivatives_at(degree, knots, homogeneous, end, frame)
            square = gap_square(frame[0], point)
            if square < best:
                best, u[k] = square, end
        stack[0], bounds[0] = 1, 0.0
        waiting = 1
        while waiting > 0:
            waiting -= 1
            node = stack[waiting]
            if bounds[waiting] >= best:
                continue
            if node >= size:
                leaf = node - size
                if tilted_distance(axes[leaf], corners[leaf], point) >= best:
                    continue
                start, end = pieces[leaf]
                seed = nearest_seed(seeds[leaf], point)
                for _ in range(2):
                    where, square = descend_curve(degree, knots, homogeneous, point, start, end, seed, frame)
                    if square < best:
                        best, u[k] = square, where
                    if start < where < end or seed == MIDDLE_OF_CURVE:
                        break
                    seed = MIDDLE_OF_CURVE  # an end stopped it: there may be another minimum inside
                continue
            waiting = open_box(node, heap, point, stack, bounds, waiting)
        distance[k] = np.sqrt(best)


@njit(cache=True, nogil=True)
def descend_surface(degree_u, degree_v, knots_u, knots_v, homogeneous, point, piece, seed, work, frame):
    """Least |S(u, v) - point|^2 on a piece, by Newton from a seed: (u, v, square)."""
    low_u, high_u, low_v, high_v = piece
    span_u = find_span(degree_u, knots_u, 0.5 * (low_u + high_u))
    span_v = find_span(degree_v, knots_v, 0.5 * (low_v + high_v))
    u = low_u + (high_u - low_u) * 0.5 * (seed % 3)
    v = low_v + (high_v - low_v) * 0.5 * (seed // 3)
    second_order(span_u, span_v, degree_u, degree_v, knots_u, knots_v, homogeneous, u, v, work, frame)
    best = gap_square(frame[0, 0], point)
    floor = ROUNDING**2 * (point**2).sum()
    for _ in range(ITERATIONS):
        gu = gv = uu = uv = vv = su = sv = mixed = 0.0
        for d in range(point.size):
            gap = frame[0, 0, d] - point[d]
            a, b = frame[1, 0, d], frame[0, 1, d]
            gu += gap * a
            gv += gap * b
            su += a * a
            sv += b * b
            mixed += a * b
            uu += gap * frame[2, 0, d]
            uv += gap * frame[1, 1, d]
            vv += gap * frame[0, 2, d]
        huu, huv, hvv = su + uu, mixed + uv, sv + vv
        # where a wall of the piece, or a pole, stops one parameter, the other moves alone
        stuck_u = su <= 0.0 or (u <= low_u and gu >= 0.0) or (u >= high_u and gu <= 0.0)
        stuck_v = sv <= 0.0 or (v <= low_v and gv >= 0.0) or (v >= high_v and gv <= 0.0)
        determinant = huu * hvv - huv * huv
        if not (stuck_u or stuck_v) and huu > 0.0 and determinant > 1e-12 * su * sv:
            step_u = (huv * gv - hvv * gu) / determinant
            step_v = (huv * gu - huu * gv) / determinant
        else:
            step_u = 0.0 if stuck_u else -gu / (huu if huu > 1e-6 * su else su)
            step_v = 0.0 if stuck_v else -gv / (hvv if hvv > 1e-6 * sv else sv)
        moved = False
        for attempt in range(2):
            if attempt == 1:  # a clipped Newton step may climb; the scaled gradient never does
                step_u = 0.0 if stuck_u else -gu / su
                step_v = 0.0 if stuck_v else -gv / sv
            target_u = min(max(u + step_u, low_u), high_u)
            target_v = min(max(v + step_v, low_v), high_v)
            step_u, step_v = target_u - u, target_v - v
            move = max(abs(step_u) / (high_u - low_u), abs(step_v) / (high_v - low_v))
            gain = abs(gu * step_u + gv * step_v)
            if gain <= ROUNDING * best:
                u, v = target_u, target_v  # the distance cannot tell any more, but Newton still can
                break
            while move > ENOUGH:
                second_order(
                    span_u,
                    span_v,
                    degree_u,
                    degree_v,
                    knots_u,
                    knots_v,
                    homogeneous,
                    target_u,
                    target_v,
                    work,
                    frame,
                )
                trial = gap_square(frame[0, 0], point)
                if trial < best:
                    u, v, best, moved = target_u, target_v, trial, True
                    break
                target_u, target_v = 0.5 * (target_u + u), 0.5 * (target_v + v)
                move *= 0.5
            if moved:
                break
        if not moved or best <= floor:
            break
    return u, v, best


@njit(cache=True, nogil=True)
def closest_on_surface(
    degree_u,
    degree_v,
    knots_u,
    knots_v,
    homogeneous,
    heap,
    axes,
    corners,
    pieces,
    seeds,
    points,
    uv,
    distance,
):
    """Fill ``uv (k, 2)`` and distance; ``pieces (m, 4)`` are the leaves' intervals u0, u1, v0, v1."""
    size = len(heap) // 2
    frame = np.empty((3, 3, points.shape[1]))
    work = second_order_work(degree_u, degree_v, homogeneous.shape[2])
    stack = np.empty(64, dtype=np.int64)
    bounds = np.empty(64)
    for k in range(len(points)):
        point = points[k]
        best = np.inf
        stack[0], bounds[0] = 1, 0.0
        waiting = 1
        while waiting > 0:
            waiting -= 1
            node = stack[waiting]
            if bounds[waiting] >= best:
                continue
            if node >= size:
                leaf = node - size
                if tilted_distance(axes[leaf], corners[leaf], point) >= best:
                    continue
                piece = pieces[leaf]
                seed = nearest_seed(seeds[leaf], point)
                for _ in range(2):
                    u, v, square = descend_surface(
                        degree_u, degree_v, knots_u, knots_v, homogeneous, point, piece, seed, work, frame
                    )
                    if square < best:
                        best = square
                        uv[k, 0], uv[k, 1] = u, v
                    inner = piece[0] < u < piece[1] and piece[2] < v < piece[3]
                    if inner or seed == MIDDLE:
                        break
                    seed = MIDDLE  # a wall stopped it: there may be another minimum inside
                continue
            waiting = open_box(node, heap, point, stack, bounds, waiting)
        distance[k] = np.sqrt(best)
