"""Cubic splines through cutter locations, and the locations that keep them near a part."""

import numpy as np
from numba import njit

from nurbs_lab.machining._kernels_contact import collides, drop, push

ROUNDS = 9  # of new locations; each halves the wrong steps
WIDE, FINE = 0.2, 0.02  # of the tolerance: what a rolling ball may rise between two places that are checked
MARGIN = 0.2  # of the tolerance: where that much is free, wide places are enough
LONG = 3.0  # longer steps, in wide places, get a location before anything is checked
FIT = 0.45  # of the tolerance: largest distance of the spline from the locations
STILL = 0.02  # of the tolerance: a piece of the spline that moves by less is not checked again
PUSHED = 1e-5  # mm: how precisely a cutter is pushed against the part


@njit(cache=True, nogil=True)
def tangents(t, points, nodes):
    """Derivatives ``(m, 3)`` at the nodes of the cubic spline through them, of parabolas at the ends."""
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
        for i in range(1, m - 1):  # forward elimination of a system of three diagonals
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


@njit(cache=True, nogil=True, inline="always")
def between(t, points, nodes, slopes, k, at, d):
    """Coordinate d of the spline at parameter ``at`` of piece k (cubic Hermite form)."""
    width = t[nodes[k + 1]] - t[nodes[k]]
    x = (at - t[nodes[k]]) / width
    p0, p1 = points[nodes[k], d], points[nodes[k + 1], d]
    step = p1 - p0
    low, high = width * slopes[k, d] - step, step - width * slopes[k + 1, d]
    return p0 + x * step + x * (1.0 - x) * ((1.0 - x) * low + x * high)


@njit(cache=True, nogil=True)
def fit(t, points, tolerance):
    """Numbers of the points that the spline goes through, and its derivatives there.

    A piece that misses a point by more than the tolerance gets the point that it misses most.
    """
    n = len(points)
    taken = np.zeros(n, np.bool_)
    taken[0] = taken[n - 1] = True
    while True:
        nodes = np.flatnonzero(taken)
        slopes = tangents(t, points, nodes)
        good = True
        for k in range(len(nodes) - 1):
            worst, at = tolerance * tolerance, -1
            for i in range(nodes[k] + 1, nodes[k + 1]):
                miss = 0.0
                for d in range(3):
                    miss += (between(t, points, nodes, slopes, k, t[i], d) - points[i, d]) ** 2
                if miss > worst:
                    worst, at = miss, i
            if at >= 0:
                taken[at] = True
                good = False
        if good:
            return nodes, slopes


@njit(cache=True, nogil=True)
def samples(t, points, nodes, slopes, counts):
    """Points of the spline: ``counts[i]`` in the middles of as many equal parts of step i."""
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
    """More cutter locations where the spline through them is not within ``0 .. tolerance`` of the part.

    The locations ``points (n, 3)`` lie where the cutter ``(a, r)`` grown by half the tolerance touches the
    part, at the height ``level`` unless that is NaN. Returned are the locations, the spline and which steps
    between locations are still wrong, because they are shorter than ``2 shortest`` or because ``ROUNDS`` of
    new locations did not cure them.
    """
    radius, margin = r if r > 0.0 else a, MARGIN * tolerance
    wide, fine = np.sqrt(8.0 * radius * WIDE * tolerance), np.sqrt(8.0 * radius * FINE * tolerance)
    unsure, before = np.ones(len(points) - 1, np.bool_), np.full(points.shape, np.nan)
    for left in range(ROUNDS, -1, -1):
        t = lengths_along(points)
        steps = np.diff(t)
        nodes, slopes = fit(t, points, FIT * tolerance)
        if left == ROUNDS:
            wrong = steps > LONG * wide
        else:
            mark_moved(t, nodes, slopes, before, STILL * tolerance, unsure)
            counts = np.ceil(steps / wide).astype(np.int64) * unsure
            places = samples(t, points, nodes, slopes, counts)
            hit = np.empty(len(places), np.bool_)
            places[:, 2] -= tolerance
            collides(places, p, n, edges, boxes, leaf, a, r + tolerance, hit)
            wrong = any_of(~hit, counts)
            places[:, 2] += tolerance - margin
            collides(places, p, n, edges, boxes, leaf, a, r + margin, hit)
            counts = np.ceil(steps / fine).astype(np.int64) * (any_of(hit, counts) & ~wrong)
            places = samples(t, points, nodes, slopes, counts)
            hit = np.empty(len(places), np.bool_)
            collides(places, p, n, edges, boxes, leaf, a, r, hit)
            wrong |= any_of(hit, counts)
        long = wrong & (steps > 2.0 * shortest)
        if left == 0 or (left < ROUNDS and not long.any()):
            break
        new = between_locations(points, long, level, 0.5 * tolerance, p, n, edges, boxes, leaf, a, r)
        before[:] = np.nan
        before[nodes] = slopes
        points, before, unsure = inserted(points, before, wrong, long, new)
        if left == ROUNDS:
            unsure[:] = True
    return points, t, nodes, slopes, wrong


@njit(cache=True, nogil=True)
def any_of(found, counts):
    """Whether any of the ``counts[i]`` next entries is true, for every i."""
    out, row = np.zeros(len(counts), np.bool_), 0
    for i in range(len(counts)):
        out[i] = found[row : row + counts[i]].any()
        row += counts[i]
    return out


@njit(cache=True, nogil=True)
def mark_moved(t, nodes, slopes, before, still, unsure):
    """Add to ``unsure`` the steps of pieces that are not where they were, with the derivatives ``before``."""
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
def between_locations(points, long, level, allowance, p, n, edges, boxes, leaf, a, r):
    """A cutter location in the middle of each long step, ``(count, 3)``.

    On a level the grown cutter is pushed across the step from its right to its left, by its length in all;
    elsewhere, and where that finds nothing, it is dropped.
    """
    steps = np.flatnonzero(long)
    out = 0.5 * (points[steps] + points[steps + 1])
    aside, way = np.empty((len(steps), 2)), np.full(len(steps), np.nan)
    aside[:, 0] = 0.5 * (points[steps, 1] - points[steps + 1, 1])
    aside[:, 1] = 0.5 * (points[steps + 1, 0] - points[steps, 0])
    if not np.isnan(level):
        height = np.full(len(steps), level - allowance)
        free, stuck = out[:, :2] - aside, out[:, :2] + aside
        push(free, stuck, height, PUSHED, p, n, edges, boxes, leaf, a, r + allowance, way)
    for i in range(len(steps)):
        if not np.isnan(way[i]):
            out[i, :2] += (2.0 * way[i] - 1.0) * aside[i]
            continue
        z = np.empty(1)
        drop(out[i : i + 1, :2], np.empty(0), p, n, edges, boxes, leaf, a, r + allowance, z)
        height = z[0] + allowance
        if not np.isnan(level):
            height = max(height, level)
        out[i, 2] = height if height > -np.inf else out[i, 2]
    return out


@njit(cache=True, nogil=True)
def inserted(points, before, wrong, long, new):
    """Locations and derivatives with ``new`` ones in the long steps, and the steps that are to be checked."""
    size = len(points) + len(new)
    out, derivatives, unsure = np.empty((size, 3)), np.full((size, 3), np.nan), np.zeros(size - 1, np.bool_)
    row = count = 0
    for i in range(len(points)):
        out[row], derivatives[row] = points[i], before[i]
        row += 1
        if i < len(wrong) and wrong[i]:
            unsure[row - 1] = True
        if i < len(wrong) and long[i]:
            out[row] = new[count]
            unsure[row] = True
            row, count = row + 1, count + 1
    return out, derivatives, unsure
