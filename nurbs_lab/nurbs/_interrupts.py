"""Long work in kernels: Ctrl-C is heard, and a progress bar moves."""

import os
from contextlib import contextmanager

from tqdm.auto import tqdm

BLOCK = 2048  # points that a slow kernel gets at once: an interrupt is heard in between
PATIENCE_S = 1.0  # before a bar is shown


def blocks(count, what):
    """Slices that cut ``count`` points into blocks, behind a progress bar if they take long."""
    if count <= BLOCK:
        yield slice(0, count)
        return
    hidden = os.environ.get("NURBS_LAB_PROGRESS") == "0"
    with tqdm(total=count, desc=what, unit=" points", delay=PATIENCE_S, leave=False, disable=hidden) as bar:
        for start in range(0, count, BLOCK):
            yield slice(start, start + BLOCK)
            bar.update(min(BLOCK, count - start))


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
