"""The order in which passes are cut, and distances round obstacles."""

import numpy as np

from nurbs_lab.common.kernels import compiled

DOWN = 4.0  # times its height counts a way down, so that what is above is cut first and ramps are short


@compiled
def nearest_first(ends, both_ways):
    """Order passes greedily: next comes the pass that begins nearest to the end of the last one.

    ``ends (n, 2, 3)`` are first and last points; passes with ``both_ways`` may be reversed. The pass that
    starts highest comes first. Returned are the numbers of the passes in order, and whether each is reversed.
    """
    n = len(ends)
    order, turned, free = np.empty(n, np.int64), np.zeros(n, np.bool_), np.ones(n, np.bool_)
    order[0] = np.argmax(ends[:, 0, 2])
    for k in range(1, n):
        last = order[k - 1]
        free[last], best = False, np.inf
        x, y, z = ends[last, 0 if turned[k - 1] else 1]
        for i in range(n):
            if not free[i]:
                continue
            for back in range(2 if both_ways[i] else 1):
                up = ends[i, back, 2] - z
                up = up if up > 0.0 else DOWN * up
                gap = (ends[i, back, 0] - x) ** 2 + (ends[i, back, 1] - y) ** 2 + up * up
                if gap < best:
                    best, order[k], turned[k] = gap, i, back == 1
    return order, turned


@compiled
def spread(region, out, step):
    """Distance within the region from the nodes where ``out (nx, ny)`` is 0, in place of infinity there.

    Fast sweeping (Zhao 2005).
    """
    (nx, ny), changed = region.shape, True
    while changed:
        changed = False
        for sweep in range(4):
            for m in range(nx):
                i = m if sweep & 1 else nx - 1 - m
                for n in range(ny):
                    j = n if sweep & 2 else ny - 1 - n
                    if not region[i, j] or out[i, j] == 0.0:
                        continue
                    a = min(out[max(i - 1, 0), j], out[min(i + 1, nx - 1), j])
                    b = min(out[i, max(j - 1, 0)], out[i, min(j + 1, ny - 1)])
                    new = min(a, b) + step
                    if abs(a - b) < step:
                        new = 0.5 * (a + b + np.sqrt(2.0 * step * step - (a - b) ** 2))
                    if new < out[i, j] - 1e-9 * step:
                        out[i, j], changed = new, True
