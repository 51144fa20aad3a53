"""Ctrl-C while a kernel hands its arrays over."""

from contextlib import contextmanager


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
