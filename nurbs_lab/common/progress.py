"""Progress bars of long work, and Ctrl-C in it."""

import os
from contextlib import contextmanager

from tqdm.auto import tqdm

PATIENCE_S = 1.0  # before a bar is shown


def hidden():
    """Whether the environment asks for no progress bars."""
    return os.environ.get("NURBS_LAB_PROGRESS") == "0"


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
