"""Exact contact of a descending cutter with triangles.

A cutter has a flat bottom of radius ``a``, a corner of radius ``r``, a side that rises by ``c`` for each
millimetre outwards, and the radius ``w`` of its cylinder: a ball is (0, r, inf, r), a flat end mill
(a, 0, inf, a), a bull nose (a, r, inf, a + r), a V-bit (a, 0, c, w), a taper ball (0, r, c, w).
At distance d from the axis its lower side is ``rise(d)`` above the tip. The tip comes to rest at the largest
``z(p) - rise(|p - axis|)`` over all points p of the mesh. This function is concave on every facet and every
edge, so its maximum has a closed form, with one exception: contact of a bull nose with an edge leaves one
unknown angle, which a bracketed Newton's method finds.
"""

import numpy as np
from numba import njit

from nurbs_lab.nurbs.span_kernels import kernel

UPRIGHT = 1e-9  # a facet whose unit normal has a smaller z is vertical: contact is with its edges only
ROUNDING = 1e-12  # relative rounding error allowed for in bounds
APART = 0.05  # fraction of the radius: tips this close together share one search for triangles
PUSHED = 2e-6  # fraction of the radius: how precisely a cutter is pushed against the part
_ROUNDS = 60


@kernel
def rise(d, a, r, c, w):
    """Height of the lower side over the tip at distance ``d <= w``."""
    if d <= a:
        return 0.0
    if c < np.inf:
        side = np.sqrt(1.0 + c * c)
        joint = a + r * c / side
        if d > joint:
            return r * (1.0 - 1.0 / side) + c * (min(d, w) - joint)
    if r == 0.0:
        return 0.0
    d = min(d - a, r)
    return d * d / (r + np.sqrt((r - d) * (r + d)))


@kernel
def over_facet(p, f, n, x, y, a, r, c, w):
    """Height of the tip at (x, y) over the inside of triangle f, of unit normal ``n[f]``."""
    nx, ny, nz = n[f, 0], n[f, 1], n[f, 2]
    if nz < 0.0:
        nx, ny, nz = -nx, -ny, -nz
    if nz < UPRIGHT:
        return -np.inf
    square = nx * nx + ny * ny
    reach, up = r + a / np.sqrt(square) if a > 0.0 and square > 0.0 else r, r * square / (1.0 + nz)
    if square > (c * nz) ** 2:  # steeper than the side: contact where the side meets the cylinder
        reach, up = w / np.sqrt(square), rise(w, a, r, c, w)
    x, y = x - reach * nx, y - reach * ny
    left, right = False, False
    for k in range(3):
        i, j = 3 * k, 3 * ((k + 1) % 3)
        cross = (p[f, j] - p[f, i]) * (y - p[f, i + 1]) - (p[f, j + 1] - p[f, i + 1]) * (x - p[f, i])
        left |= cross > 0.0
        right |= cross < 0.0
    if left and right:
        return -np.inf
    contact = p[f, 2] - (nx * (x - p[f, 0]) + ny * (y - p[f, 1])) / nz
    low, high = min(p[f, 2], p[f, 5], p[f, 8]), max(p[f, 2], p[f, 5], p[f, 8])
    return min(max(contact, low), high) - up


@kernel
def over_edge(p, f, k, x, y, a, r, c, w, best):
    """Height of the tip at (x, y) over edge k of triangle f and its ends, or -inf if not above ``best``.

    The parameter t is the length along the edge, upwards, from the point nearest to the axis.
    """
    i, j = 3 * k, 3 * ((k + 1) % 3)
    if p[f, i + 2] > p[f, j + 2]:
        i, j = j, i
    x0, y0, z0 = p[f, i] - x, p[f, i + 1] - y, p[f, i + 2]
    dx, dy, dz = p[f, j] - p[f, i], p[f, j + 1] - p[f, i + 1], p[f, j + 2] - z0
    square = dx * dx + dy * dy + dz * dz
    if (
        a == 0.0 and c == np.inf and z0 + dz <= best + r and square > 0.0
    ):  # the edge lies below the ball's centre at best
        up = best + r - z0
        t = min(max((up * dz - x0 * dx - y0 * dy) / square, 0.0), 1.0)
        off = (x0 + t * dx) ** 2 + (y0 + t * dy) ** 2 + (t * dz - up) ** 2
        if off >= r * r * (1.0 + ROUNDING):
            return -np.inf
    length = np.sqrt(dx * dx + dy * dy)
    if length <= 1e-12 * dz or length == 0.0:
        d = np.sqrt((x0 + dx) ** 2 + (y0 + dy) ** 2)
        return z0 + dz - rise(d, a, r, c, w) if d <= w else -np.inf
    start = (x0 * dx + y0 * dy) / length
    d = abs(x0 * dy - y0 * dx) / length
    if d > w:
        return -np.inf
    half = np.sqrt((w - d) * (w + d))
    slope = dz / length
    if z0 + min(dz, slope * (half - start)) - rise(d, a, r, c, w) <= best:
        return -np.inf
    if r == 0.0:
        t = half
    elif a == 0.0:
        t = np.sqrt(max((r - d) * (r + d), 0.0)) * slope / np.sqrt(1.0 + slope * slope)
    else:
        t = _touch_of_torus(d, slope, a, r)
    if c < np.inf:
        joint = a + r * c / np.sqrt(1.0 + c * c)
        if d * d + t * t > joint * joint:  # contact is with the side, or at one of its ends
            t = d * slope / np.sqrt(c * c - slope * slope) if slope < c else half
            t = min(max(t, np.sqrt(max((joint - d) * (joint + d), 0.0))), half)
    t = min(max(t, start), start + length)
    if abs(t) > half:
        return -np.inf
    return z0 + min(slope * (t - start), dz) - rise(np.sqrt(d * d + t * t), a, r, c, w)


@kernel
def _touch_of_torus(d, slope, a, r):
    """Where a line at distance d from the axis touches the corner of a bull nose.

    With ``rho = a + r sin(phi)`` and ``t = sqrt(rho**2 - d**2)`` the corner rises along the line as steeply
    as the line where ``sin(phi) t / rho = slope cos(phi)``; the left side less the right side grows with phi.
    """
    low = np.arcsin(min(max((d - a) / r, 0.0), 1.0))
    high = 0.5 * np.pi
    phi = max(low, np.arctan(slope))
    for _ in range(_ROUNDS):
        sine, cosine = np.sin(phi), np.cos(phi)
        rho = a + r * sine
        ratio = np.sqrt(max((rho - d) * (rho + d), 0.0)) / rho
        value = sine * ratio - slope * cosine
        if value > 0.0:
            high = phi
        else:
            low = phi
        step = np.inf
        if ratio > 0.0:
            growth = cosine * ratio + sine * r * cosine * d * d / (rho**3 * ratio) + slope * sine
            step = value / growth if growth > 0.0 else np.inf
        guess = phi - step
        if not low < guess < high:
            guess = 0.5 * (low + high)
        if abs(guess - phi) <= 1e-15:
            break
        phi = guess
    rho = a + r * np.sin(phi)
    return np.sqrt(max((rho - d) * (rho + d), 0.0))


@kernel
def inside(square, height, a, r, c, w):
    """Whether a point at this height over the tip and squared distance from the axis is in the cutter.

    Rounding may count a point of the cutter's surface as inside.
    """
    square *= 1.0 - ROUNDING
    if height <= 0.0 or square > w * w:
        return False
    if c < np.inf:
        return height >= rise(np.sqrt(square), a, r, c, w)
    if height >= r or square <= a * a:
        return True
    wide = height * (2.0 * r - height)  # square of how wide the corner is at that height
    if a == 0.0 or square <= wide:
        return square <= wide
    return (np.sqrt(square) - a) ** 2 <= wide


@kernel
def may_stop(p, f, n, x, y, z, a, r, c, w):
    """Whether triangle f may stop a tip at (x, y, z): its box and its plane intersect the cutter."""
    height = max(p[f, 2], p[f, 5], p[f, 8]) - z
    if height <= 0.0:
        return False
    dx = max(min(p[f, 0], p[f, 3], p[f, 6]) - x, x - max(p[f, 0], p[f, 3], p[f, 6]), 0.0)
    dy = max(min(p[f, 1], p[f, 4], p[f, 7]) - y, y - max(p[f, 1], p[f, 4], p[f, 7]), 0.0)
    if not inside(dx * dx + dy * dy, height, a, r, c, w):
        return False
    up = abs(n[f, 2])
    if up <= UPRIGHT:
        return True
    sideways = n[f, 0] * (p[f, 0] - x) + n[f, 1] * (p[f, 1] - y)
    across = np.sqrt(n[f, 0] * n[f, 0] + n[f, 1] * n[f, 1]) if a > 0.0 or c < np.inf else 0.0
    reach = r + a * across
    if c < np.inf:
        reach = max(reach, w * across - (rise(w, a, r, c, w) - r) * up)
    below = (z + r - p[f, 2]) * up
    return np.copysign(sideways, sideways * n[f, 2]) + reach + ROUNDING * (abs(z) + r) >= below


@kernel
def over_parts(p, f, n, edges, x, y, a, r, c, w, best):
    """The larger of ``best`` and the height of the tip at (x, y) over triangle f.

    Contact with the facet and with those of its edges that belong to it (``edges``) is considered.
    """
    best = max(best, over_facet(p, f, n, x, y, a, r, c, w))
    for k in range(3):
        if edges[f] >> k & 1:
            best = max(best, over_edge(p, f, k, x, y, a, r, c, w, best))
    return best


@kernel
def over_triangle(p, f, n, edges, x, y, a, r, c, w, best):
    """`over_parts` where the triangle may be higher than ``best``."""
    if may_stop(p, f, n, x, y, best, a, r, c, w):
        return over_parts(p, f, n, edges, x, y, a, r, c, w, best)
    return best


@kernel
def bound(boxes, node, x, y, a, r, c, w, best):
    """Upper bound of the height of the tip at (x, y) over anything in the box.

    A bound that is not above ``best`` may be replaced by any number up to ``best``.
    """
    if boxes[node, 5] <= best:
        return best
    dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
    dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
    square, reach = dx * dx + dy * dy, w * (1.0 + ROUNDING)
    return boxes[node, 5] - rise(np.sqrt(square), a, r, c, w) if square <= reach * reach else best


@kernel
def enough(levels, best):
    """The height that has to be exceeded to matter: ``best``, or the first of ``levels`` from there on."""
    if len(levels) == 0:
        return best
    k = np.searchsorted(levels, best)
    return levels[k] if k < len(levels) else np.inf


@njit(cache=True, nogil=True)
def drop(xy, levels, p, n, edges, boxes, leaf, a, r, c, w, out):
    """Height of the resting tip at every point, -inf where it meets nothing.

    Given sorted ``levels``, a height is only exact as to the two levels between which it lies. Boxes are
    visited in the order of their bounds, the highest first. Successive points are usually close together, so
    the triangle that stopped the last point gives a first height.
    """
    leaves = (len(boxes) + 1) // 2
    stack, bounds = np.empty(128, np.int64), np.empty(128)
    held = 0
    for i in range(len(xy)):
        x, y = xy[i, 0], xy[i, 1]
        out[i] = over_triangle(p, held, n, edges, x, y, a, r, c, w, -np.inf)
        least = enough(levels, out[i])
        stack[0], bounds[0], depth = 0, bound(boxes, 0, x, y, a, r, c, w, least), 1
        while depth:
            depth -= 1
            node = stack[depth]
            if bounds[depth] <= least:
                continue
            if node >= leaves - 1:
                start = (node - leaves + 1) * leaf
                for f in range(start, min(start + leaf, len(p))):
                    height = over_triangle(p, f, n, edges, x, y, a, r, c, w, least)
                    if height > least:
                        out[i], held = height, f
                        least = enough(levels, height)
                continue
            one, two = 2 * node + 1, 2 * node + 2
            under_one = bound(boxes, one, x, y, a, r, c, w, least)
            under_two = bound(boxes, two, x, y, a, r, c, w, least)
            if under_one > under_two:
                one, two, under_one, under_two = two, one, under_two, under_one
            if under_one > least:
                stack[depth], bounds[depth] = one, under_one
                depth += 1
            if under_two > least:
                stack[depth], bounds[depth] = two, under_two
                depth += 1


@njit(cache=True, nogil=True)
def around(x, y, level, beside, p, n, boxes, leaf, a, r, c, w, found):
    """Fill ``found`` with the triangles that may stop tips within ``beside`` of (x, y) above ``level``.

    Returns how many there are.
    """
    leaves = (len(boxes) + 1) // 2
    stack = np.empty(128, np.int64)
    stack[0], depth, count = 0, 1, 0
    a, w = a + beside, w + beside
    while depth:
        depth -= 1
        node = stack[depth]
        dx = max(boxes[node, 0] - x, x - boxes[node, 3], 0.0)
        dy = max(boxes[node, 1] - y, y - boxes[node, 4], 0.0)
        if not inside(dx * dx + dy * dy, boxes[node, 5] - level, a, r, c, w):
            continue
        if node < leaves - 1:
            stack[depth], stack[depth + 1] = 2 * node + 1, 2 * node + 2
            depth += 2
            continue
        start = (node - leaves + 1) * leaf
        for f in range(start, min(start + leaf, len(p))):
            if may_stop(p, f, n, x, y, level, a, r, c, w):
                found[count] = f
                count += 1
    return count


@kernel
def stops(f, x, y, z, p, n, edges, a, r, c, w):
    """Whether triangle f keeps the tip from going down to (x, y, z)."""
    return over_triangle(p, f, n, edges, x, y, a, r, c, w, z) > z


@kernel
def first_stop(near, x, y, z, p, n, edges, a, r, c, w):
    """Position in ``near`` of the first triangle that stops the tip at (x, y, z), -1 if none does."""
    k = 0
    while k < len(near) and not stops(near[k], x, y, z, p, n, edges, a, r, c, w):
        k += 1
    return k if k < len(near) else -1


@njit(cache=True, nogil=True)
def collides(tips, p, n, edges, boxes, leaf, a, r, c, w, out):
    """Whether a cutter cuts into the part with its tip at any tip of each row of ``tips (n, m, 3)``.

    One search for triangles serves several successive tips that are close together.
    """
    near, first, held, apart = np.empty(len(p), np.int64), 0, 0, APART * w
    out[:], m, tips = False, tips.shape[1], tips.reshape(-1, 3)
    while first < len(tips):
        x, y, level, beside, last, count = tips[first, 0], tips[first, 1], tips[first, 2], 0.0, first, -1
        while last < len(tips):
            off = np.sqrt((tips[last, 0] - x) ** 2 + (tips[last, 1] - y) ** 2)
            if off > apart or abs(tips[last, 2] - tips[first, 2]) > apart:
                break
            beside, level = max(beside, off), min(level, tips[last, 2])
            last += 1
        for i in range(first, last):
            if out[i // m]:
                continue
            tx, ty, tz = tips[i, 0], tips[i, 1], tips[i, 2]
            if stops(held, tx, ty, tz, p, n, edges, a, r, c, w):
                out[i // m] = True
                continue
            if count < 0:
                count = around(x, y, level, beside, p, n, boxes, leaf, a, r, c, w, near)
            met = first_stop(near[:count], tx, ty, tz, p, n, edges, a, r, c, w)
            if met >= 0:
                out[i // m], held = True, near[met]
        first = last


@njit(cache=True, nogil=True)
def push(free, stuck, level, p, n, edges, boxes, leaf, a, r, c, w, out):
    """How far a cutter moves sideways at height ``level[i]``, from ``free[i]`` towards ``stuck[i]``.

    Returned is the fraction of the distance at which the part stops it, to ``PUSHED`` on the free side;
    NaN if nothing stops it or if it collides at the start already.
    """
    near = np.empty(len(p), np.int64)
    for i in range(len(free)):
        x, y, z = free[i, 0], free[i, 1], level[i]
        dx, dy = stuck[i, 0] - x, stuck[i, 1] - y
        size = np.sqrt(dx * dx + dy * dy)
        count = around(x + dx / 2, y + dy / 2, z, size / 2, p, n, boxes, leaf, a, r, c, w, near)
        out[i] = push_against(near[:count], x, y, z, dx, dy, p, n, edges, a, r, c, w)


@njit(cache=True, nogil=True)
def push_against(near, x, y, z, dx, dy, p, n, edges, a, r, c, w):
    """`push` along (dx, dy) against the triangles ``near`` only.

    For each triangle that stops it the cutter moves back until none stops it, by the rule of false position
    (Illinois), or by bisection as long as there is no finite height on both sides.
    """
    way, met, fine = 1.0, True, PUSHED * w / max(np.sqrt(dx * dx + dy * dy), PUSHED * w)
    while met:
        met = False
        for f in near:
            if not stops(f, x + way * dx, y + way * dy, z, p, n, edges, a, r, c, w):
                continue
            if way <= 0.0:
                return np.nan
            met, low, below, above, side = True, 0.0, -np.inf, np.inf, 0
            while way - low > fine:
                middle = 0.5 * (low + way)
                if below > -np.inf and above < np.inf:
                    middle = (low * above - way * below) / (above - below)
                    middle = min(max(middle, low + 0.5 * fine), way - 0.5 * fine)
                over = over_parts(p, f, n, edges, x + middle * dx, y + middle * dy, a, r, c, w, -np.inf) - z
                if over > 0.0:
                    way, above = middle, over
                    below *= 0.5 if side > 0 else 1.0
                    side = 1
                else:
                    low, below = middle, over
                    above *= 0.5 if side < 0 else 1.0
                    side = -1
            way = low
    return way if way < 1.0 else np.nan


@njit(cache=True, nogil=True)
def depths(tips, p, n, edges, boxes, leaf, a, r, c, w, out):
    """How much smaller all round a cutter must be not to cut into the part, by bisection."""
    near = np.empty(len(p), np.int64)
    for i in range(len(tips)):
        x, y, z = tips[i, 0], tips[i, 1], tips[i, 2]
        count = around(x, y, z, 0.0, p, n, boxes, leaf, a, r, c, w, near)
        low, high = 0.0, w
        for _ in range(_ROUNDS // 2):
            less = 0.5 * (low + high)
            flat, corner, up = a + min(r - less, 0.0), max(r - less, 0.0), less
            if c < np.inf:  # the side moves inwards by its own normal, and ends in a point at last
                flat = a - max(less - r, 0.0) * (np.sqrt(1.0 + c * c) - 1.0) / c
                up, flat = less + c * max(-flat, 0.0), max(flat, 0.0)
            if first_stop(near[:count], x, y, z + up, p, n, edges, flat, corner, c, w - less) >= 0:
                low = less
            else:
                high = less
        out[i] = high
