"""Reading in a process of its own: on a damaged file a CAD library may crash or never come back."""

import pickle
import subprocess
import sys

PATIENCE_S = 60


def shapes_in(reader, library, *arguments):
    """The curves and the surfaces, as plain numbers, that the program ``reader`` finds in a file.

    Raises
    ------
    ValueError
        With the last words of the program, or saying that the library crashed or was stopped.
    """
    command = [sys.executable, "-P", reader, *arguments]
    try:
        ran = subprocess.run(command, capture_output=True, timeout=PATIENCE_S)
    except subprocess.TimeoutExpired:
        raise ValueError(f"{library} found no end of it in {PATIENCE_S} s; it is damaged") from None
    if ran.returncode < 0:
        raise ValueError(f"{library} crashed on it; it is damaged")
    if ran.returncode:
        raise ValueError(ran.stderr.decode(errors="replace").splitlines()[-1])
    return pickle.loads(ran.stdout)
