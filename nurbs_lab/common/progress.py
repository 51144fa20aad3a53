"""Long work in blocks, with a progress bar, which Ctrl-C can interrupt."""

import os
import time
from contextlib import contextmanager

from tqdm.auto import tqdm

BLOCK = 512  # points in the first block of a slow kernel
QUICK_S = 0.1  # a block that took less is followed by one of twice its size
PATIENCE_S = 1.0  # before a bar is shown


def hidden():
    """Whether the environment asks for no progress bars."""
    return os.environ.get("NURBS_LAB_PROGRESS") == "0"


def blocks(count, what, unit="points"):
    """Slices that cut ``count`` items into blocks of short work, with a progress bar if there are many.

    Ctrl-C is noticed between two blocks. Blocks double in size as long as they are quick.
    """
    if count <= BLOCK:
        yield slice(0, count)
        return
    start, size = 0, BLOCK
    look = {"unit": f" {unit}", "unit_scale": True, "delay": PATIENCE_S, "leave": False}
    with tqdm(total=count, desc=what, disable=hidden(), **look) as bar:
        while start < count:
            began = time.perf_counter()
            stop = min(start + size, count)
            yield slice(start, stop)
            bar.update(stop - start)
            start = stop
            if time.perf_counter() - began < QUICK_S:
                size *= 2


def bar(items, count, what, unit=" blocks"):
    """The items, with a progress bar if they take long."""
    return tqdm(items, total=count, desc=what, unit=unit, delay=PATIENCE_S, leave=False, disable=hidden())


@contextmanager
def interruptible():
    """Raise KeyboardInterrupt after Ctrl-C, also where Numba hides it in a SystemError."""
    try:
        yield
    except SystemError as error:
        cause = error.__cause__
        while isinstance(cause, SystemError):
            cause = cause.__cause__
        if isinstance(cause, KeyboardInterrupt):
            raise cause from None
        raise
