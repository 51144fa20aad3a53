"""The order in which passes are cut."""

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def nearest_first(starts, ends, both_ways, order, turned):
    """Order passes greedily: next comes the pass that begins nearest to the end of the last one.

    ``order`` is filled with the numbers of the passes. Those with ``both_ways`` may be reversed, and
    ``turned`` says which are. The pass that starts highest comes first.
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
