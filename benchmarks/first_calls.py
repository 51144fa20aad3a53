"""What a newcomer waits for: every statement of the tour in a fresh process, its first and second time."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
import time
from pathlib import Path

TOUR = Path(__file__).parents[1] / "notebooks" / "00-tour.ipynb"
QUIET = {"PYVISTA_OFF_SCREEN": "true", "PYVISTA_JUPYTER_BACKEND": "static", "NURBS_LAB_PROGRESS": "0"}
#: Shorter waits are nobody's pain; the import of the package is listed all the same.
NOTICED_S = 0.02


def measure() -> list[dict]:
    """The import and the statements whose first run is noticed: ``{"code", "first_s", "again_s"}``."""
    command = [sys.executable, "-m", "benchmarks.first_calls"]
    run = subprocess.run(command, env=os.environ | QUIET, capture_output=True, text=True, check=True)
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


def _run() -> list[dict]:
    names = {}
    found = []
    for statement in _statements():
        code = compile(statement, TOUR.name, "exec")
        first, again = _seconds(code, names), _seconds(code, names)
        if first >= NOTICED_S or statement.startswith("import nurbs_lab"):
            found.append({"code": statement, "first_s": first, "again_s": again})
    return found


if __name__ == "__main__":
    print(json.dumps(_run()))
