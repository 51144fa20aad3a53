"""Reading in a separate process: on a damaged file a CAD library may crash, hang or fill the memory.

This file is both ends of it. Imported, it gives `shapes_in`, which starts the process. Run as a program, it
first lays limits upon its own process, which the operating system keeps whatever the library does, and then
runs the reader.
"""

import pickle
import signal
import subprocess
import sys
import tempfile

PATIENCE_S = 60  # for any file, and
PATIENCE_S_PER_MB = 2.0  # more for a large one
MEMORY_BYTES = 4 * 2**30  # of addresses; the libraries alone take a quarter of it
MEMORY_PER_BYTE = 100  # more for every byte of the file


def shapes_in(reader, library, path, *arguments):
    """What the program ``reader`` finds in a file, as plain numbers.

    ValueError has the last words of the program, or says that the library crashed or was stopped.
    """
    size = path.stat().st_size
    patience = PATIENCE_S + PATIENCE_S_PER_MB * size / 1e6
    memory = MEMORY_BYTES + MEMORY_PER_BYTE * size
    command = [sys.executable, "-P", __file__, str(patience), str(memory), reader, path, *arguments]
    with tempfile.TemporaryFile() as found, tempfile.TemporaryFile() as said:
        try:
            ran = subprocess.run(
                command, stdin=subprocess.DEVNULL, stdout=found, stderr=said, timeout=patience
            )
        except subprocess.TimeoutExpired:
            raise ValueError(f"{library} found no end of it in {patience:.3g} s; it is damaged") from None
        said.seek(0)
        last = (said.read().decode(errors="replace").splitlines() or [""])[-1]
        if last.startswith("MemoryError") or "bad_alloc" in last:
            raise ValueError(f"{library} asked for more than {memory / 2**30:.1f} GB for it; it is damaged")
        if ran.returncode:
            raise ValueError(last if ran.returncode > 0 else f"{library} crashed on it; it is damaged")
        found.seek(0)
        return pickle.load(found)


if __name__ == "__main__":
    import runpy

    patience, memory = float(sys.argv[1]), int(sys.argv[2])
    signal.setitimer(signal.ITIMER_REAL, patience + 1)  # its signal ends the process, without a parent too
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
        resource.setrlimit(resource.RLIMIT_FSIZE, (memory // 4, memory // 4))
    except (ImportError, ValueError, OSError):
        pass  # a system without such limits
    del sys.argv[:3]
    runpy.run_path(sys.argv[0], run_name="__main__")
