"""The order in which passes are cut."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def nearest_first(starts, ends, both_ways, order, turned):
    """Always the pass that begins nearest to where the last one ended; some may be run backwards.

    ``order`` is filled with passes, ``turned`` says which of them are run backwards. The first pass is the
    highest one; a way down counts less than a way up.
    """
    n = len(starts)
    free = np.ones(n, np.bool_)
    last = 0
    for i in range(n):
        if starts[i, 2] > starts[last, 2]:
            last = i
    order[0], turned[last], free[last] = last, False, False
    for k in range(1, n):
        at = starts[last] if turned[last] else ends[last]
        best, chosen, back = np.inf, -1, False
        for i in range(n):
            if not free[i]:
                continue
            gap = 0.0
            for d in range(3):
                gap += (starts[i, d] - at[d]) ** 2
            if gap < best:
                best, chosen, back = gap, i, False
            if both_ways[i]:
                gap = 0.0
                for d in range(3):
                    gap += (ends[i, d] - at[d]) ** 2
                if gap < best:
                    best, chosen, back = gap, i, True
        order[k], turned[chosen], free[chosen] = chosen, back, False
        last = chosen
