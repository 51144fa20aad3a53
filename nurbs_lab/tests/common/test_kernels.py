"""Kernels compile and run wherever the package lies, and say once that they do."""

import os
import subprocess
import sys
from pathlib import Path

CODE = """
import numpy as np
import nurbs_lab as nl
from numba import config
config.CACHE_DIR = sys.argv[1] if len(sys.argv) > 1 else config.CACHE_DIR
print(nl.paper.CURVE(0.5), bool(config.CACHE_DIR))
"""


def ran(*arguments, **env):
    command = [sys.executable, "-c", "import sys" + CODE, *arguments]
    env = {**os.environ, "NURBS_LAB_PROGRESS": "1", **env}
    return subprocess.run(command, env=env, capture_output=True, text=True, check=True)


def test_one_line_says_that_kernels_are_compiled(tmp_path):
    first, second = ran(str(tmp_path)), ran(str(tmp_path))
    assert first.stderr.count("compiles its inner loops") == 1
    assert "compiles" not in second.stderr


def test_a_place_that_cannot_be_written_is_no_hindrance():
    """Neither the sources nor the home, as in many containers; root may write anywhere but below a file."""
    code = (
        "import pathlib, tempfile; from nurbs_lab.common import kernels; from numba import config\n"
        "kernels._writable = lambda folder: False; config.CACHE_DIR = ''; kernels.store_somewhere()\n"
        "import nurbs_lab as nl; print(nl.paper.CURVE(0.5)); print(config.CACHE_DIR)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    point, folder = done.stdout.splitlines()
    assert point == ran().stdout.rsplit(maxsplit=1)[0]
    assert folder
    assert not Path(folder).exists()
