"""Least number of periods to rest: what holds in `motion` and in `hardware` are compared with."""

import numpy as np


def least_periods(speed, braking, alpha, beta):
    """Least whole number of periods in which a machine that acts once a period comes to rest.

    In n periods it loses x_1, ..., x_n of its speed: numbers of at most ``alpha`` in size, which change by at
    most ``beta`` from each to the next, from ``braking``, what it lost in the period before, to 0 at the end.
    The largest such numbers are min(braking + k beta, alpha, (n + 1 - k) beta), the smallest ones
    max(braking - k beta, -alpha, -(n + 1 - k) beta). Both keep the limits, and so does every mean of them, so
    each sum between theirs can be reached: n periods are enough exactly if ``speed`` lies between the two.

    If it brakes so hard already that the softest braking ends before the limit of jerk does, no n is enough;
    then the periods of that braking count.
    """
    speed, braking, alpha, beta = map(float, (speed, braking, alpha, beta))
    softest = np.cumsum(braking - beta * np.arange(1, braking // beta + 1)) if np.isfinite(beta) else []
    if len(softest) and softest[-1] > speed * (1 + 1e-9):
        return int(np.argmax(softest >= speed)) + 1
    n = int(np.ceil(speed / alpha * (1 - 1e-9)))
    while True:
        k = np.arange(1, n + 1)
        most = np.minimum(np.minimum(braking + k * beta, alpha), (n + 1 - k) * beta)
        least = np.maximum(np.maximum(braking - k * beta, -alpha), -(n + 1 - k) * beta)
        if (least <= most).all() and least.sum() <= speed * (1 + 1e-9) and most.sum() >= speed * (1 - 1e-9):
            return n
        n += 1
