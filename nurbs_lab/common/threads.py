"""Kernels over many points: in blocks, on all cores, with progress, and interrupted by Ctrl-C."""

import itertools
import os
import threading
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import contextmanager

import numba
import numpy as np

from nurbs_lab.common.progress import bar, interruptible

BLOCK = 2048  # points
_here = threading.local()


def _start_pool():
    """Threads are kept: to start one takes longer than many a part. A forked process has none of them."""
    global _pool
    _pool = ThreadPoolExecutor(max(1, numba.config.NUMBA_NUM_THREADS - 1), "nurbs_lab")


_start_pool()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_start_pool)


def threads() -> int:
    """Number of threads that a call may use: Numba's setting, or one within a chunk of `map_items`."""
    return 1 if getattr(_here, "single", False) else numba.get_num_threads()


@contextmanager
def single_thread():
    """Let calls of the current thread use no other threads."""
    before, _here.single = getattr(_here, "single", False), True
    try:
        yield
    finally:
        _here.single = before


def over_blocks(kernel, count, what):
    """Call ``kernel(slice)`` for the blocks of ``count`` points."""
    over_slices(kernel, [slice(start, min(start + BLOCK, count)) for start in range(0, count, BLOCK)], what)


def even_slices(costs) -> list:
    """Slices of about equal cost, one a thread; ``costs`` is the running sum of the items' costs, from 0."""
    bounds = np.searchsorted(costs, np.linspace(0, costs[-1], threads() + 1, dtype=costs.dtype)[1:-1])
    bounds = np.unique([0, *bounds, len(costs) - 1])
    return [slice(start, stop) for start, stop in itertools.pairwise(bounds.tolist())]


@interruptible()
def over_slices(kernel, slices, what) -> list:
    """Results of ``kernel(part)`` for all parts of the work, in order.

    The calling thread takes parts like the others: if it only waited, new threads would often share one core
    for as long as a short call lasts. Nor does it need the others, so calls may be nested.
    """
    if len(slices) == 1:
        return [kernel(slices[0])]
    results, todo = [None] * len(slices), iter(range(len(slices)))

    def work(done=None):
        try:
            for i in todo:
                results[i] = kernel(slices[i])
                if done:
                    done.update(i + 1 - done.n)
        finally:  # after an error no thread begins another part
            for _ in todo:
                pass

    others = range(min(threads(), len(slices)) - 1)
    with bar(None, len(slices), what) as done:
        running = [_pool.submit(work) for _ in others]
        try:
            work(done)
        finally:
            begun = [one for one in running if not one.cancel()]
            wait(begun)
        for one in begun:
            one.result()
    return results
