"""Processor times that tests compare with one another: none of them knows how fast its machine is."""

import time
from functools import cache


def least_seconds(work, runs=3):
    """Processor time of the quickest run: a busy machine makes runs slower, and none of them quicker."""
    seconds = []
    for _ in range(runs):
        begun = time.process_time()
        work()
        seconds.append(time.process_time() - begun)
    return min(seconds)


@cache
def at_once_s():
    """Processor time that no small piece of work takes: 200 times that of a sum of a million squares."""
    return 200 * least_seconds(lambda: sum(k * k for k in range(10**6)))
