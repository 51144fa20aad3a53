"""Exact contact of a descending cutter with triangles.

A cutter has a flat bottom of radius ``a``, a corner of radius ``r``, a side that rises by ``c`` for each
millimetre outwards, and the radius ``w`` of its cylinder: a ball is (0, r, inf, r), a flat end mill
(a, 0, inf, a), a bull nose (a, r, inf, a + r), a V-bit (a, 0, c, w), a taper ball (0, r, c, w).
At distance d from the axis its lower side is ``rise(d)`` above the tip. The tip comes to rest at the largest
``z(p) - rise(|p - axis|)`` over all points p of the mesh. This function is concave on every facet and every
edge, so its maximum has a closed form, with one exception: contact of a bull nose with an edge leaves one
unknown angle, which a bracketed Newton's method finds.

Kernels take a part as ``body``: corners (m, 9), unit normals and `Part.edges` of its triangles, and the boxes
of their tree; and a cutter as ``shape``: (a, r, c, w).
"""

import numpy as np

from nurbs_lab.common.kernels import inlined, kernel

ROUNDING = 1e-12  # relative rounding error: allowed for in bounds, and in the z of a vertical unit normal
_ROUNDS = 60


@kernel
def rise(d, shape):
    """Height of the lower side over the tip at distance ``d <= w``."""
    a, r, c, w = shape
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


@inlined
def over_facet(body, f, x, y, shape):
    """Height of the tip at (x, y) over the inside of triangle f, of unit normal ``n[f]``."""
    p, n = body[0], body[1]
    a, r, c, w = shape
    nx, ny, nz = n[f, 0], n[f, 1], n[f, 2]
    if nz < 0.0:
        nx, ny, nz = -nx, -ny, -nz
    if nz < ROUNDING:  # vertical: contact is with its edges only
        return -np.inf
    square = nx * nx + ny * ny
    reach, up = r + a / np.sqrt(square) if a > 0.0 and square > 0.0 else r, r * square / (1.0 + nz)
    if square > (c * nz) ** 2:  # steeper than the side: contact where the side meets the cylinder
        reach, up = w / np.sqrt(square), rise(w, shape)
    x, y = x - reach * nx, y - reach * ny
    left, right = False, False
    for k in range(3):
        i, j = 3 * k, 3 * ((k + 1) % 3)
        one, two = (p[f, j] - p[f, i]) * (y - p[f, i + 1]), (p[f, j + 1] - p[f, i + 1]) * (x - p[f, i])
        slack = ROUNDING * (abs(one) + abs(two))  # on a common edge, a point is over both triangles
        left |= one - two > slack
        right |= two - one > slack
    if left and right:
        return -np.inf
    contact = p[f, 2] - (nx * (x - p[f, 0]) + ny * (y - p[f, 1])) / nz
    low, high = min(p[f, 2], p[f, 5], p[f, 8]), max(p[f, 2], p[f, 5], p[f, 8])
    return min(max(contact, low), high) - up


@inlined
def over_edge(body, f, k, x, y, shape, best):
    """Height of the tip at (x, y) over edge k of triangle f and its ends, or -inf if not above ``best``.

    The parameter t is the length along the edge, upwards, from the point nearest to the axis.
    """
    p, (a, r, c, w) = body[0], shape
    i, j = 3 * k, 3 * ((k + 1) % 3)
    if p[f, i + 2] > p[f, j + 2]:
        i, j = j, i
    x0, y0, z0 = p[f, i] - x, p[f, i + 1] - y, p[f, i + 2]
    dx, dy, dz = p[f, j] - p[f, i], p[f, j + 1] - p[f, i + 1], p[f, j + 2] - z0
    length = np.sqrt(dx * dx + dy * dy)
    if length <= ROUNDING * dz or length == 0.0:
        d = np.sqrt((x0 + dx) ** 2 + (y0 + dy) ** 2)
        return z0 + dz - rise(d, shape) if d <= w else -np.inf
    start = (x0 * dx + y0 * dy) / length
    d = abs(x0 * dy - y0 * dx) / length
    if d > w:
        return -np.inf
    half = np.sqrt((w - d) * (w + d))
    slope = dz / length
    if z0 + min(dz, slope * (half - start)) - rise(d, shape) <= best:
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
    return z0 + min(slope * (t - start), dz) - rise(np.sqrt(d * d + t * t), shape)


@inlined
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
def inside(square, height, shape):
    """Whether a point at this height over the tip and squared distance from the axis is in the cutter.

    Rounding may count a point beside the cutter as inside.
    """
    a, r, c, w = shape
    square *= 1.0 - ROUNDING
    if height <= 0.0 or square > w * w:
        return False
    if square <= a * a:
        return True
    if c < np.inf:
        return height >= rise(np.sqrt(square), shape)
    wide = r * r if height >= r else height * (2.0 * r - height)  # square of how wide the corner is there
    if a > 0.0:
        square = (np.sqrt(square) - a) ** 2
    return square <= wide


@kernel
def may_stop(body, f, x, y, z, shape):
    """Whether triangle f may stop a tip at (x, y, z): its box intersects the cutter, or nearly."""
    p = body[0]
    dx = max(min(p[f, 0], p[f, 3], p[f, 6]) - x, x - max(p[f, 0], p[f, 3], p[f, 6]), 0.0)
    dy = max(min(p[f, 1], p[f, 4], p[f, 7]) - y, y - max(p[f, 1], p[f, 4], p[f, 7]), 0.0)
    return inside(dx * dx + dy * dy, max(p[f, 2], p[f, 5], p[f, 8]) - z, shape)


@kernel
def over_triangle(body, f, x, y, shape, best):
    """The larger of ``best`` and the height of the tip at (x, y) over triangle f.

    Contact with the facet and with those of its edges that belong to it (``edges``) is considered.
    """
    if not may_stop(body, f, x, y, best, shape):
        return best
    best, edges = max(best, over_facet(body, f, x, y, shape)), body[2]
    for k in range(3):
        if edges[f] >> k & 1:
            best = max(best, over_edge(body, f, k, x, y, shape, best))
    return best
