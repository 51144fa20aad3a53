"""Kernels over many points, in blocks on every core, with progress and a Ctrl-C that is heard."""

import os
from concurrent.futures import ThreadPoolExecutor

from nurbs_lab.common.progress import bar, heard

BLOCK = 2048  # points


@heard()
def over_blocks(kernel, count, what, block=BLOCK):
    """Call ``kernel(slice)`` for the blocks of ``count`` points; other threads run while it does."""
    slices = [slice(start, min(start + block, count)) for start in range(0, count, block)]
    if len(slices) < 2:
        for one in slices:
            kernel(one)
        return
    with ThreadPoolExecutor(min(os.cpu_count() or 1, len(slices))) as pool:
        try:
            for _ in bar(pool.map(kernel, slices), len(slices), what):
                pass
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
