"""Reading in a separate process: on a damaged file a CAD library may crash, hang or fill the memory.

This file is both ends of it. Imported, it gives `shapes_in`, which starts the process. Run as a program, it
first lays limits upon its own process, which the operating system keeps whatever the library does, and then
runs the reader: the process ends after its time, beyond its memory, and (on Linux) when its parent ends. What
it writes goes to files of limited size, so that a library that prints without end fills no memory either.
"""

import os
import pickle
import signal
import subprocess
import sys
import tempfile

PATIENCE_S = 60  # for any file, and
PATIENCE_S_PER_MB = 2.0  # more for a large one
MEMORY_BYTES = 4 * 2**30  # of addresses; the libraries alone take a quarter of it
MEMORY_PER_BYTE = 100  # more for every byte of the file
OUTPUT = 0.25  # of its memory: the most that it may write
LAST_WORDS = 10_000  # bytes of its messages that are looked at
PARENT_DEATH_SIGNAL = 1  # Linux: PR_SET_PDEATHSIG of prctl(2)


def shapes_in(reader, library, path, *arguments):
    """What the program ``reader`` finds in a file, as plain numbers.

    Raises
    ------
    ValueError
        With the last words of the program, or saying that the library crashed or was stopped.
    """
    size = path.stat().st_size
    patience = PATIENCE_S + PATIENCE_S_PER_MB * size / 1e6
    memory = MEMORY_BYTES + MEMORY_PER_BYTE * size
    limits = map(str, (patience, memory, os.getpid()))
    command = [sys.executable, "-P", __file__, *limits, reader, path, *arguments]
    with tempfile.TemporaryFile() as found, tempfile.TemporaryFile() as said:
        try:
            ran = subprocess.run(
                command, stdin=subprocess.DEVNULL, stdout=found, stderr=said, timeout=patience
            )
        except subprocess.TimeoutExpired:
            raise ValueError(f"{library} found no end of it in {patience:.3g} s; it is damaged") from None
        written = [file.seek(0, os.SEEK_END) for file in (found, said)]
        if max(written) >= int(OUTPUT * memory):
            raise ValueError(f"{library} wrote without end about it; it is damaged")
        said.seek(-min(written[1], LAST_WORDS), os.SEEK_END)
        last = (said.read().decode(errors="replace").splitlines() or [""])[-1]
        if last.startswith("MemoryError") or "bad_alloc" in last:
            raise ValueError(f"{library} asked for more than {memory / 2**30:.1f} GB for it; it is damaged")
        if ran.returncode < 0:
            raise ValueError(f"{library} crashed on it; it is damaged")
        if ran.returncode:
            raise ValueError(last)
        found.seek(0)
        return pickle.load(found)


def _limit_this_process(patience, memory, parent):
    """Limits that hold inside of a library's endless loop too, where no Python runs."""
    signal.setitimer(signal.ITIMER_REAL, patience + 1)  # its signal ends the process
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(OUTPUT * memory),) * 2)
    except (ImportError, ValueError, OSError):
        pass  # a system without such limits
    if sys.platform == "linux":
        import ctypes

        ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, signal.SIGKILL)
        if os.getppid() != parent:
            sys.exit("the parent process ended before this one began")


if __name__ == "__main__":
    import runpy

    _limit_this_process(float(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
    del sys.argv[:4]
    runpy.run_path(sys.argv[0], run_name="__main__")
