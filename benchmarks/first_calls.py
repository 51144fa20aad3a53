"""What a newcomer waits for: every statement of the tour in a fresh process, its first and second time.

Three processes, one after the other: medians, so that a disk that is cold for the first of them does not
count. A last one finds no compiled kernels: what the first calls would cost without the set-up's.
"""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

TOUR = Path(__file__).parents[1] / "notebooks" / "00-tour.ipynb"
QUIET = {"PYVISTA_OFF_SCREEN": "true", "PYVISTA_JUPYTER_BACKEND": "static", "NURBS_LAB_PROGRESS": "0"}
#: Statements whose first run takes less are not listed, except for the import of the package.
NOTICED_S = 0.02


def measure() -> list[dict]:
    """The import and the statements whose first run is noticed.

    ``{"code", "first_s", "again_s", "compiling_s"}``, the last without the kernels of the set-up.
    """
    ready = [_process() for _ in range(3)]
    with tempfile.TemporaryDirectory() as empty:
        bare = _process(NUMBA_CACHE_DIR=empty)
    found = []
    for statement, (compiling, _) in bare.items():
        first, again = (median(times) for times in zip(*(run[statement] for run in ready), strict=True))
        if first >= NOTICED_S or statement.startswith("import nurbs_lab"):
            times = {"first_s": first, "again_s": again, "compiling_s": compiling}
            found.append({"code": statement} | times)
    return found


def _process(**environment) -> dict[str, list[float]]:
    """First and second time of every statement, in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.first_calls"]
    environment = os.environ | QUIET | environment
    run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(run.stdout.splitlines()[-1])


def _statements():
    for cell in json.loads(TOUR.read_text())["cells"]:
        if cell["cell_type"] == "code":
            source = "".join(cell["source"])
            yield from (ast.get_source_segment(source, node) for node in ast.parse(source).body)


def _seconds(code, names) -> float:
    start = time.perf_counter()
    exec(code, names)
    return time.perf_counter() - start


def _run() -> dict[str, list[float]]:
    """The whole tour twice: some statements work on what others have just made."""
    names, times = {}, {}
    for _ in range(2):
        for statement in _statements():
            code = compile(statement, TOUR.name, "exec")
            times.setdefault(statement, []).append(_seconds(code, names))
    return {statement: [found[0], found[-1]] for statement, found in times.items()}


if __name__ == "__main__":
    print(json.dumps(_run()))
