"""Kernels over many points, in blocks on every core, with progress and a Ctrl-C that is heard."""

import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import numba

from nurbs_lab.common.progress import bar, heard

BLOCK = 2048  # points
_here = threading.local()


def threads() -> int:
    """How many threads one call may use: Numba's setting, and one within a chunk of `map_chunks`."""
    return 1 if getattr(_here, "single", False) else numba.get_num_threads()


@contextmanager
def single_thread():
    """Let calls of the current thread use no other threads."""
    before, _here.single = getattr(_here, "single", False), True
    try:
        yield
    finally:
        _here.single = before


@heard()
def over_blocks(kernel, count, what, block=BLOCK):
    """Call ``kernel(slice)`` for the blocks of ``count`` points; other threads run while it does."""
    slices = [slice(start, min(start + block, count)) for start in range(0, count, block)]
    workers = min(threads(), len(slices))
    if workers < 2:
        for one in bar(slices, len(slices), what):
            kernel(one)
        return
    with ThreadPoolExecutor(workers) as pool:
        try:
            for _ in bar(pool.map(kernel, slices), len(slices), what):
                pass
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
