"""Cubic splines along cutter locations, refined until they keep their distance from the part."""

import numpy as np
from numba import njit

from nurbs_lab.machining._kernels_contact import around, drop, first_stop, over_triangle, push_against
from nurbs_lab.machining._kernels_spline import between, curvature, fit
from nurbs_lab.nurbs.span_kernels import kernel

ROUNDS = 9  # of insertion; each halves the steps that fail their check
WIDE, FINE = 0.3, 0.04  # fractions of the tolerance: possible loss of clearance between checked points
MARGIN = 0.3  # fraction of the tolerance: with that much clearance the wide spacing is enough
LONG = 3.0  # steps longer than this many wide spacings are halved before the first check
FEWEST = 4  # locations that determine a spline
BESIDE = 0.03  # fraction of a step: how far beside and below it its list of triangles is complete
APART = 1e-3  # fraction of the tolerance: smallest distance between locations
FIT = 0.45  # fraction of the tolerance: largest distance of the spline from the locations
STILL = 0.03  # fraction of the tolerance: a span of the spline that moves less is not checked again


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
def refined(points, level, tolerance, shortest, p, n, edges, boxes, leaf, a, r, c, w):
    """Cutter locations refined until the spline's distance from contact is between 0 and the tolerance.

    At the locations ``points (n, 3)`` the cutter enlarged by half the tolerance touches the part, at the
    height ``level`` unless that is NaN. Returned are the locations, the spline, and the steps between
    locations that still fail their check, because they are shorter than ``2 shortest`` or because ``ROUNDS``
    of insertion were not enough.
    """
    body, scratch = (p, n, edges, boxes, leaf, a, r, c, w), np.empty(len(p), np.int64)
    radius = r if r > 0.0 else max(a, 0.1 * w)
    long = np.diff(lengths_along(points)) > LONG * np.sqrt(8.0 * radius * WIDE * tolerance)
    long |= len(points) < FEWEST
    home, taken = np.full(len(long), -1), np.zeros(len(points), np.bool_)
    cover, first, near = np.empty((0, 4)), np.zeros(1, np.int64), scratch[:0]
    new = between_locations(points, long, level, tolerance, home, cover, first, near, scratch, body)
    seen = np.full((len(long), 9), np.nan)
    points, taken, seen, home = inserted(points, taken, seen, home, long, new, APART * tolerance)
    cover, first, near = near_steps(points, tolerance, scratch, body)
    home = np.arange(len(home))
    for left in range(ROUNDS - 1, -1, -1):
        t = lengths_along(points)
        nodes, values, slopes = fit(t, points, FIT * tolerance, taken, 1)
        spline, wrong, k = (t, nodes, values, slopes), np.zeros(len(home), np.bool_), 0
        for i in range(len(home)):
            while nodes[k + 1] <= i:
                k += 1
            if moved(i, k, spline, seen[i], STILL * tolerance):
                h = home[i]
                known = near[first[h] : first[h + 1]]
                wrong[i] = is_wrong(i, k, spline, tolerance, radius, cover[h], known, scratch, body)
        long = wrong & (np.diff(t) > 2.0 * shortest)
        if left == 0 or not long.any():
            break
        new = between_locations(points, long, level, tolerance, home, cover, first, near, scratch, body)
        seen[wrong] = np.nan
        points, taken, seen, home = inserted(points, taken, seen, home, long, new, APART * tolerance)
    return points, t, nodes, values, slopes, wrong


@kernel
def moved(i, k, spline, seen, still):
    """Whether span k of the spline moved in step i since it was ``seen (9,)`` at both ends and in the middle.

    If so, ``seen`` is brought up to date.
    """
    t, nodes, values, slopes = spline
    place = np.empty(9)
    for j in range(3):
        for d in range(3):
            at = t[i] + 0.5 * j * (t[i + 1] - t[i])
            place[3 * j + d] = between(t, nodes, values, slopes, k, at, d)
    for j in range(9):
        if not abs(place[j] - seen[j]) <= still:
            seen[:] = place
            return True
    return False


@njit(cache=True, nogil=True)
def near_steps(points, tolerance, scratch, body):
    """The triangles that may stop tips near each step between locations.

    Returned are the regions for which the lists are complete, ``(n, 4)``: x, y, the radius about them, the
    lowest height; and the triangles of step i as ``near[first[i]:first[i + 1]]``.
    """
    p, n, _, boxes, leaf, a, r, c, w = body
    m = len(points) - 1
    cover, first, near = np.empty((m, 4)), np.zeros(m + 1, np.int64), np.empty(32 * m, np.int64)
    for i in range(m):
        x, y, z = 0.5 * (points[i] + points[i + 1])
        dx, dy, dz = 0.5 * (points[i + 1] - points[i])
        slack = 2.0 * BESIDE * np.sqrt(dx * dx + dy * dy + dz * dz)
        beside, low = np.sqrt(dx * dx + dy * dy) + slack, z - abs(dz) - slack
        cover[i, 0], cover[i, 1], cover[i, 2], cover[i, 3] = x, y, beside, low
        count = around(
            x, y, low - tolerance, beside, p, n, boxes, leaf, a, r + tolerance, c, w + tolerance, scratch
        )
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


@kernel
def is_wrong(i, k, spline, tolerance, radius, cover, known, scratch, body):
    """Whether span k of the spline, in step i, gouges the part or is farther from it than the tolerance.

    The spacing of the checked points follows from the radius of the cutter and the curvature of the spline,
    so that hardly anything is missed between them.
    """
    p, n, edges, boxes, leaf, a, r, c, w = body
    t, nodes, values, slopes = spline
    size = t[i + 1] - t[i]
    curved = size * np.sqrt((1.0 / radius + curvature(t, nodes, values, slopes, k, i)) / (8.0 * tolerance))
    tight = False
    for fine in range(2):
        count = int(np.ceil(curved / np.sqrt(FINE if fine else WIDE)))
        for j in range(count):
            at = t[i] + (j + 0.5) * size / count
            x = between(t, nodes, values, slopes, k, at, 0)
            y = between(t, nodes, values, slopes, k, at, 1)
            z = between(t, nodes, values, slopes, k, at, 2)
            near = known
            if not covers(cover, x, y, z):
                found = around(
                    x, y, z - tolerance, 0.0, p, n, boxes, leaf, a, r + tolerance, c, w + tolerance, scratch
                )
                near = scratch[:found]
            spare = (FINE if fine else MARGIN) * tolerance
            if first_stop(near, x, y, z - spare, p, n, edges, a, r + spare, c, w + spare) >= 0:
                if fine:
                    return True
                tight = True
            elif not fine:
                stop = first_stop(near, x, y, z - tolerance, p, n, edges, a, r + tolerance, c, w + tolerance)
                if stop < 0:
                    return True
                near[0], near[stop] = near[stop], near[0]  # it probably stops the next tip too
        if not tight:
            return False
    return False


@njit(cache=True, nogil=True)
def between_locations(points, long, level, tolerance, home, cover, first, near, scratch, body):
    """A cutter location near the middle of each long step, ``(count, 3)``.

    On a waterline the enlarged cutter is pushed across the step from right to left, first over a short
    distance and then over the length of the step. On other passes, or if that fails, it is dropped.
    """
    p, n, edges, boxes, leaf, a, r, c, w = body
    allowance, steps = 0.5 * tolerance, np.flatnonzero(long)
    r, w = r + allowance, w + allowance
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
                way = push_against(known, x0, y0, z0, ahead, aside, p, n, edges, a, r, c, w)
            if np.isnan(way):
                wide = 0.5
                count = around(x, y, z0, 0.5 * np.hypot(dx, dy), p, n, boxes, leaf, a, r, c, w, scratch)
                x0, y0 = x - 0.5 * dx, y - 0.5 * dy
                way = push_against(scratch[:count], x0, y0, z0, dx, dy, p, n, edges, a, r, c, w)
            if not np.isnan(way):
                out[i, 0] += (2.0 * way - 1.0) * wide * dx
                out[i, 1] += (2.0 * way - 1.0) * wide * dy
                continue
        height = -np.inf
        for f in known:
            height = over_triangle(p, f, n, edges, x, y, a, r, c, w, height)
        if not covered or height + allowance < cover[h, 3]:  # otherwise no other triangle is higher
            one = np.empty(1)
            drop(out[i : i + 1, :2], one[:0], p, n, edges, boxes, leaf, a, r, c, w, one)
            height = one[0]
        height += allowance
        if not np.isnan(level):
            height = max(height, level)
        out[i, 2] = height if height > -np.inf else z
    return out


@njit(cache=True, nogil=True)
def inserted(points, taken, seen, home, long, new, least):
    """Locations, which have knots, what was seen of each step, and its list, with the ``new`` locations."""
    size = len(points) + len(new)
    out, knots = np.empty((size, 3)), np.zeros(size, np.bool_)
    homes, places = np.empty(size - 1, np.int64), np.full((size - 1, 9), np.nan)
    row = count = 0
    for i in range(len(points)):
        out[row], knots[row] = points[i], taken[i]
        row += 1
        if i < len(long):
            homes[row - 1], places[row - 1] = home[i], seen[i]
            count += long[i]
            if (
                long[i]
                and apart(points[i], new[count - 1], least)
                and apart(points[i + 1], new[count - 1], least)
            ):
                out[row], homes[row] = new[count - 1], home[i]
                row += 1
    return out[:row], knots[:row], places[: row - 1], homes[: row - 1]


@kernel
def apart(one, two, least):
    """Whether two locations are so far apart that a spline may have knots at both."""
    return abs(two[0] - one[0]) + abs(two[1] - one[1]) + abs(two[2] - one[2]) > least
