"""How kernels are compiled, where Numba stores them, and what a person sees meanwhile."""

import atexit
import shutil
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
from numba import config, njit
from numba.core import event
from numba.misc.appdirs import AppDirs
from tqdm.auto import tqdm

from nurbs_lab.common.progress import bar, hidden

#: No C function is made of a kernel: nothing calls it, and it takes a twentieth of the time to compile. A
#: division by zero gives infinity or NaN, as in NumPy; the callers check their results instead of divisors.
OPTIONS = {"cache": True, "nogil": True, "no_cfunc_wrapper": True, "error_model": "numpy"}
compiled = njit(**OPTIONS)
#: For a kernel that one place calls, and for short ones: the code becomes part of its callers'.
inlined = njit(inline="always", **OPTIONS)
#: Inlining is forced because a call counts references to every array, which costs more than a point does.
kernel = njit(forceinline=True, **OPTIONS)
#: Zero as an array or a loop would hold it. Numba compiles a kernel once more for each literal passed to it.
ZERO = np.int64(0)
SAID = "nurbs_lab compiles its inner loops at their first call and stores them: a minute or two in all, once"


def store_somewhere():
    """Store kernels in a folder for this process alone, if neither place that Numba tries can be written.

    Numba tries the folder of the sources and the user's cache, and stops with an error where it may write in
    neither, as in many containers. ``NUMBA_CACHE_DIR`` names another place, which lasts.
    """
    user = Path(AppDirs(appname="numba", appauthor=False).user_cache_dir)
    if not config.CACHE_DIR and not any(map(_writable, (Path(__file__).parent / "__pycache__", user))):
        config.CACHE_DIR = tempfile.mkdtemp(prefix="nurbs_lab-")
        atexit.register(shutil.rmtree, config.CACHE_DIR, ignore_errors=True)


def _writable(folder):
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False


class Compiling(event.Listener):
    """Say once that kernels are compiled, and count them in a progress bar."""

    def __init__(self):
        self.depth, self.bar, self.lock = 0, None, threading.Lock()

    def on_start(self, event):
        """A kernel begins to be compiled, perhaps for another one that calls it."""
        with self.lock:
            if self.bar is None and not hidden():
                tqdm.write(SAID, sys.stderr)
            if self.depth == 0:
                self.bar = bar(None, None, "compiling", " kernels")
            self.depth += 1

    def on_end(self, event):
        """A kernel is there."""
        with self.lock:
            self.depth -= 1
            self.bar.update()
            if self.depth == 0:
                self.bar.close()


store_somewhere()
event.register("numba:compile", Compiling())
