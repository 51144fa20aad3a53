"""Cubic splines through cutter locations, refined until they keep their distance from the part."""

import numpy as np
from numba import njit

from nurbs_lab.machining._kernels_contact import around, drop, first_stop, over_triangle, push_against
from nurbs_lab.nurbs.span_kernels import kernel

ROUNDS = 9  # of insertion; each halves the steps that fail their check
WIDE, FINE = 0.3, 0.05  # fractions of the tolerance: possible loss of clearance between checked points
MARGIN = 0.3  # fraction of the tolerance: with that much clearance the wide spacing is enough
LONG = 3.0  # steps longer than this many wide spacings are halved before the first check
BESIDE = 0.03  # fraction of a step: how far beside and below it its list of triangles is complete
FIT = 0.45  # fraction of the tolerance: largest distance of the spline from the locations
FEWER = 4  # of so many nodes of a spline one is left out at a time
STILL = 0.1  # fraction of the tolerance: a span of the spline that moves less is not checked again


@njit(cache=True, nogil=True)
def tangents(t, points, nodes):
    """Derivatives ``(m, 3)`` of the cubic spline at its nodes; those at the ends are of parabolas."""
    m = len(nodes)
    out = np.empty((m, 3))
    if m == 2:
        for d in range(3):
            out[0, d] = (points[nodes[1], d] - points[nodes[0], d]) / (t[nodes[1]] - t[nodes[0]])
            out[1, d] = out[0, d]
        return out
    over = np.empty(m)
    for d in range(3):
        for end in (0, 1):
            i, j, k = (0, 1, 2) if end == 0 else (m - 1, m - 2, m - 3)
            one, two = t[nodes[j]] - t[nodes[i]], t[nodes[k]] - t[nodes[j]]
            first = (points[nodes[j], d] - points[nodes[i], d]) / one
            second = (points[nodes[k], d] - points[nodes[j], d]) / two
            out[i, d] = first - one * (second - first) / (one + two)
        over[0] = 0.0
        for i in range(1, m - 1):  # forward elimination of the tridiagonal system
            before, after = t[nodes[i]] - t[nodes[i - 1]], t[nodes[i + 1]] - t[nodes[i]]
            first = (points[nodes[i], d] - points[nodes[i - 1], d]) / before
            second = (points[nodes[i + 1], d] - points[nodes[i], d]) / after
            right = 3.0 * (after * first + before * second)
            pivot = 2.0 * (before + after) - after * over[i - 1]
            over[i] = before / pivot
            out[i, d] = (right - after * out[i - 1, d]) / pivot
        for i in range(m - 2, 0, -1):
            out[i, d] -= over[i] * out[i + 1, d]
    return out


@kernel
def between(t, points, nodes, slopes, k, at, d):
    """Coordinate d of the spline at parameter ``at`` of span k (cubic Hermite form)."""
    width = t[nodes[k + 1]] - t[nodes[k]]
    x = (at - t[nodes[k]]) / width
    p0, p1 = points[nodes[k], d], points[nodes[k + 1], d]
    step = p1 - p0
    low, high = width * slopes[k, d] - step, step - width * slopes[k + 1, d]
    return p0 + x * step + x * (1.0 - x) * ((1.0 - x) * low + x * high)


@njit(cache=True, nogil=True)
def missed(t, points, nodes, slopes, tolerance):
    """The point that each span misses most, -1 where it misses none by more than the tolerance."""
    out = np.full(len(nodes) - 1, -1)
    for k in range(len(out)):
        worst = tolerance * tolerance
        for i in range(nodes[k] + 1, nodes[k + 1]):
            miss = 0.0
            for d in range(3):
                miss += (between(t, points, nodes, slopes, k, t[i], d) - points[i, d]) ** 2
            if miss > worst:
                worst, out[k] = miss, i
    return out


@njit(cache=True, nogil=True)
def fit(t, points, tolerance, taken):
    """Numbers of the points on the spline, and its derivatives there.

    The spline through the points ``taken (n,)`` is tried first. A span that misses a point by more than the
    tolerance is split at the point that it misses most. Then every fourth node is left out; those with a span
    beside them that now misses a point are put back. This is repeated until each node was left out once.
    """
    taken[0] = taken[-1] = True
    for turn in range(FEWER + 1):
        left_out = np.flatnonzero(taken)[turn : -1 if turn else 0 : FEWER]
        taken[left_out] = False
        while True:
            nodes = np.flatnonzero(taken)
            slopes = tangents(t, points, nodes)
            wrong = missed(t, points, nodes, slopes, tolerance)
            if wrong.max() < 0:
                break
            if len(left_out):
                for i in left_out:
                    span = np.searchsorted(nodes, i) - 1
                    taken[i] = wrong[max(span - 1, 0) : span + 2].max() >= 0
                left_out = left_out[:0]
            else:
                taken[wrong[wrong >= 0]] = True
    return nodes, slopes


@njit(cache=True, nogil=True)
def samples(t, points, nodes, slopes, counts):
    """Points of the spline: step i is cut into ``counts[i]`` equal parts, and their midpoints are taken."""
    out = np.empty((counts.sum(), 3))
    k, row = 0, 0
    for i in range(len(counts)):
        while nodes[k + 1] <= i:
            k += 1
        for j in range(counts[i]):
            at = t[i] + (j + 0.5) * (t[i + 1] - t[i]) / counts[i]
            for d in range(3):
                out[row, d] = between(t, points, nodes, slopes, k, at, d)
            row += 1
    return out


@njit(cache=True, nogil=True)
def b_spline(t, points, slopes):
    """Knots and control points of the spline with these points and derivatives at the parameters ``t``.

    Every control point is a value of the blossom of one span.
    """
    m = len(t)
    knots, control = np.empty(m + 6), np.empty((m + 2, 3))
    knots[:3], knots[3:-3], knots[-3:] = t[0], t, t[-1]
    for i in range(m + 2):
        k = min(max(i - 2, 0), m - 2)
        width = t[k + 1] - t[k]
        a, b, c = knots[i + 1] - t[k], knots[i + 2] - t[k], knots[i + 3] - t[k]
        for d in range(3):
            step = (points[k + 1, d] - points[k, d]) / width
            low, high = slopes[k, d] - step, step - slopes[k + 1, d]
            # p0 + x step + x (w - x) ((w - x) low + x high) / w**2, as powers of x
            square, cube = (high - 2.0 * low) / width, (low - high) / width**2
            linear = points[k, d] + slopes[k, d] * (a + b + c) / 3.0
            control[i, d] = linear + square * (a * b + b * c + c * a) / 3.0 + cube * a * b * c
    control[0], control[-1] = points[0], points[-1]
    return knots, control


@njit(cache=True, nogil=True)
def lengths_along(points):
    """Length of a polyline up to each of its points."""
    t = np.zeros(len(points))
    for i in range(1, len(points)):
        square = 0.0
        for d in range(3):
            square += (points[i, d] - points[i - 1, d]) ** 2
        t[i] = t[i - 1] + np.sqrt(square)
    return t


@njit(cache=True, nogil=True)
def refined(points, level, tolerance, shortest, p, n, edges, boxes, leaf, a, r):
    """Cutter locations refined until the spline's distance from contact is between 0 and the tolerance.

    At the locations ``points (n, 3)`` the cutter ``(a, r)`` enlarged by half the tolerance touches the part,
    at the height ``level`` unless that is NaN. Returned are the locations, the spline, and the steps between
    locations that still fail their check, because they are shorter than ``2 shortest`` or because ``ROUNDS``
    of insertion were not enough.
    """
    body, scratch = (p, n, edges, boxes, leaf, a, r), np.empty(len(p), np.int64)
    radius = r if r > 0.0 else a
    t = lengths_along(points)
    long = np.diff(t) > LONG * np.sqrt(8.0 * radius * WIDE * tolerance)
    home, before = np.full(len(long), -1), np.full(points.shape, np.nan)
    cover, first, near = np.empty((0, 4)), np.zeros(1, np.int64), scratch[:0]
    new = between_locations(points, long, level, tolerance, home, cover, first, near, scratch, body)
    points, before, home, unsure = inserted(points, before, home, long, long, new)
    cover, first, near = near_steps(points, tolerance, scratch, body)
    home, unsure[:] = np.arange(len(home)), True
    for left in range(ROUNDS - 1, -1, -1):
        t = lengths_along(points)
        nodes, slopes = fit(t, points, FIT * tolerance, ~np.isnan(before[:, 0]))
        mark_moved(t, nodes, slopes, before, STILL * tolerance, unsure)
        wrong, k = np.zeros(len(unsure), np.bool_), 0
        for i in np.flatnonzero(unsure):
            while nodes[k + 1] <= i:
                k += 1
            h = home[i]
            known, spline = near[first[h] : first[h + 1]], (t, points, nodes, slopes)
            wrong[i] = is_wrong(i, k, spline, tolerance, radius, cover[h], known, scratch, body)
        long = wrong & (np.diff(t) > 2.0 * shortest)
        if left == 0 or not long.any():
            break
        new = between_locations(points, long, level, tolerance, home, cover, first, near, scratch, body)
        before[:] = np.nan
        before[nodes] = slopes
        points, before, home, unsure = inserted(points, before, home, wrong, long, new)
    return points, t, nodes, slopes, wrong


@njit(cache=True, nogil=True)
def near_steps(points, tolerance, scratch, body):
    """The triangles that may stop tips near each step between locations.

    Returned are the regions for which the lists are complete, ``(n, 4)``: x, y, the radius about them, the
    lowest height; and the triangles of step i as ``near[first[i]:first[i + 1]]``.
    """
    p, n, _, boxes, leaf, a, r = body
    m = len(points) - 1
    cover, first, near = np.empty((m, 4)), np.zeros(m + 1, np.int64), np.empty(32 * m, np.int64)
    for i in range(m):
        x, y, z = 0.5 * (points[i] + points[i + 1])
        dx, dy, dz = 0.5 * (points[i + 1] - points[i])
        slack = 2.0 * BESIDE * np.sqrt(dx * dx + dy * dy + dz * dz)
        beside, low = np.sqrt(dx * dx + dy * dy) + slack, z - abs(dz) - slack
        cover[i, 0], cover[i, 1], cover[i, 2], cover[i, 3] = x, y, beside, low
        count = around(x, y, low - tolerance, beside, p, n, boxes, leaf, a, r + tolerance, scratch)
        first[i + 1] = first[i] + count
        if first[i + 1] > len(near):
            near = np.append(near, np.empty(len(near) + count, np.int64))
        near[first[i] : first[i + 1]] = scratch[:count]
    return cover, first, near


@kernel
def covers(cover, x, y, z):
    """Whether the list of triangles of a region is complete for the tip (x, y, z)."""
    off = (x - cover[0]) ** 2 + (y - cover[1]) ** 2
    return off <= cover[2] * cover[2] and z >= cover[3]


@njit(cache=True, nogil=True)
def is_wrong(i, k, spline, tolerance, radius, cover, known, scratch, body):
    """Whether span k of the spline, in step i, gouges the part or is farther from it than the tolerance.

    The spacing of the checked points follows from the radius of the cutter and the curvature of the spline,
    so that hardly anything is missed between them.
    """
    p, n, edges, boxes, leaf, a, r = body
    t, points, nodes, slopes = spline
    size = t[i + 1] - t[i]
    curved = size * np.sqrt((1.0 / radius + curvature(t, points, nodes, slopes, k, i)) / (8.0 * tolerance))
    tight = False
    for fine in range(2):
        count = int(np.ceil(curved / np.sqrt(FINE if fine else WIDE)))
        for j in range(count):
            at = t[i] + (j + 0.5) * size / count
            x = between(t, points, nodes, slopes, k, at, 0)
            y = between(t, points, nodes, slopes, k, at, 1)
            z = between(t, points, nodes, slopes, k, at, 2)
            near = known
            if not covers(cover, x, y, z):
                found = around(x, y, z - tolerance, 0.0, p, n, boxes, leaf, a, r + tolerance, scratch)
                near = scratch[:found]
            if fine:
                if first_stop(near, x, y, z, p, n, edges, a, r) >= 0:
                    return True
            elif first_stop(near, x, y, z - MARGIN * tolerance, p, n, edges, a, r + MARGIN * tolerance) >= 0:
                tight = True
            elif first_stop(near, x, y, z - tolerance, p, n, edges, a, r + tolerance) < 0:
                return True
        if not tight:
            return False
    return False


@njit(cache=True, nogil=True)
def curvature(t, points, nodes, slopes, k, i):
    """Larger curvature of span k at the two ends of step i; the parameter is nearly the arc length."""
    largest, width = 0.0, t[nodes[k + 1]] - t[nodes[k]]
    for end in range(2):
        x, square = (t[i + end] - t[nodes[k]]) / width, 0.0
        for d in range(3):
            step = (points[nodes[k + 1], d] - points[nodes[k], d]) / width
            low, high = slopes[k, d] - step, step - slopes[k + 1, d]
            square += (2.0 * ((3.0 * x - 2.0) * low + (1.0 - 3.0 * x) * high) / width) ** 2
        largest = max(largest, square)
    return np.sqrt(largest)


@njit(cache=True, nogil=True)
def mark_moved(t, nodes, slopes, before, still, unsure):
    """Add to ``unsure`` the steps of spans that moved since their derivatives were ``before``."""
    for k in range(len(nodes) - 1):
        i, j = nodes[k], nodes[k + 1]
        moved = False
        for d in range(3):
            off = max(abs(slopes[k, d] - before[i, d]), abs(slopes[k + 1, d] - before[j, d]))
            moved |= not off * (t[j] - t[i]) <= 4.0 * still
        for m in range(i, j):
            moved |= unsure[m] or (m > i and not np.isnan(before[m, 0]))
        for m in range(i, j):
            unsure[m] |= moved


@njit(cache=True, nogil=True)
def between_locations(points, long, level, tolerance, home, cover, first, near, scratch, body):
    """A cutter location near the middle of each long step, ``(count, 3)``.

    On a waterline the enlarged cutter is pushed across the step from right to left, first over a short
    distance and then over the length of the step. On other passes, or if that fails, it is dropped.
    """
    p, n, edges, boxes, leaf, a, r = body
    allowance, steps = 0.5 * tolerance, np.flatnonzero(long)
    r += allowance
    out = 0.5 * (points[steps] + points[steps + 1])
    for i in range(len(steps)):
        here, then = points[steps[i]], points[steps[i] + 1]
        x, y, z = out[i]
        dx, dy, known, h = here[1] - then[1], then[0] - here[0], near[:0], home[steps[i]]
        covered = h >= 0 and covers(cover[h], x, y, z)
        if covered:
            known = near[first[h] : first[h + 1]]
        if not np.isnan(level):
            way, wide, z0 = np.nan, BESIDE, level - allowance
            if covered:
                x0, y0 = x - BESIDE * dx, y - BESIDE * dy
                ahead, aside = 2.0 * BESIDE * dx, 2.0 * BESIDE * dy
                way = push_against(known, x0, y0, z0, ahead, aside, p, n, edges, a, r)
            if np.isnan(way):
                wide = 0.5
                count = around(x, y, z0, 0.5 * np.hypot(dx, dy), p, n, boxes, leaf, a, r, scratch)
                x0, y0 = x - 0.5 * dx, y - 0.5 * dy
                way = push_against(scratch[:count], x0, y0, z0, dx, dy, p, n, edges, a, r)
            if not np.isnan(way):
                out[i, 0] += (2.0 * way - 1.0) * wide * dx
                out[i, 1] += (2.0 * way - 1.0) * wide * dy
                continue
        height = -np.inf
        for f in known:
            height = over_triangle(p, f, n, edges, x, y, a, r, height)
        if not covered or height + allowance < cover[h, 3]:  # otherwise no other triangle is higher
            one = np.empty(1)
            drop(out[i : i + 1, :2], one[:0], p, n, edges, boxes, leaf, a, r, one)
            height = one[0]
        height += allowance
        if not np.isnan(level):
            height = max(height, level)
        out[i, 2] = height if height > -np.inf else z
    return out


@njit(cache=True, nogil=True)
def inserted(points, before, home, wrong, long, new):
    """Locations, derivatives and lists with ``new`` ones in the long steps, and the steps to be checked."""
    size = len(points) + len(new)
    out, derivatives = np.empty((size, 3)), np.full((size, 3), np.nan)
    homes, unsure = np.empty(size - 1, np.int64), np.zeros(size - 1, np.bool_)
    row = count = 0
    for i in range(len(points)):
        out[row], derivatives[row] = points[i], before[i]
        row += 1
        if i < len(wrong):
            homes[row - 1], unsure[row - 1] = home[i], wrong[i]
            if long[i]:
                out[row], homes[row], unsure[row] = new[count], home[i], True
                row, count = row + 1, count + 1
    return out, derivatives, homes, unsure
