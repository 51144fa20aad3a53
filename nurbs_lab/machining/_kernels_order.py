"""The order in which passes are cut."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
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
                gap = (ends[i, back, 0] - x) ** 2 + (ends[i, back, 1] - y) ** 2 + (ends[i, back, 2] - z) ** 2
                if gap < best:
                    best, order[k], turned[k] = gap, i, back == 1
    return order, turned
