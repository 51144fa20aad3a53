"""Long work in kernels: Ctrl-C is heard, and a progress bar moves."""

import os
import time
from contextlib import contextmanager

from tqdm.auto import tqdm

BLOCK = 512  # points that a slow kernel gets at first, and then twice as many for as long as it is quick
QUICK_S = 0.1
PATIENCE_S = 1.0  # before a bar is shown


def hidden():
    """Whether the environment asks for no progress bars."""
    return os.environ.get("NURBS_LAB_PROGRESS") == "0"


def blocks(count, what):
    """Slices that cut ``count`` points into blocks of short work, behind a progress bar if there are many."""
    if count <= BLOCK:
        yield slice(0, count)
        return
    start, size = 0, BLOCK
    with tqdm(total=count, desc=what, unit=" points", delay=PATIENCE_S, leave=False, disable=hidden()) as bar:
        while start < count:
            began = time.perf_counter()
            yield slice(start, start + size)
            bar.update(min(size, count - start))
            start += size
            if time.perf_counter() - began < QUICK_S:
                size *= 2


def bar(items, count, what, unit=" blocks"):
    """The items, behind a progress bar if they take long."""
    return tqdm(items, total=count, desc=what, unit=unit, delay=PATIENCE_S, leave=False, disable=hidden())


@contextmanager
def heard():
    """Let Ctrl-C be a KeyboardInterrupt, also where Numba, boxing arrays, hides it in SystemErrors."""
    try:
        yield
    except SystemError as error:
        cause = error.__cause__
        while isinstance(cause, SystemError):
            cause = cause.__cause__
        if isinstance(cause, KeyboardInterrupt):
            raise cause from None
        raise
