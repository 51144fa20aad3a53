"""The same input gives the same bytes: again, in another process, and in many threads at once."""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange import shapes
from nurbs_lab.tests.robust.calls import CALLS, fingerprint

EXPORTS = {
    ".step": shapes.surface,
    ".stp": shapes.curve,
    ".igs": shapes.curve,
    ".iges": shapes.surface,
    ".json": shapes.surface,
    ".obj": shapes.cylinder,
    ".stl": shapes.cylinder,
    ".ngc": shapes.path,
    ".csv": shapes.path,
}  # not .3dm: Rhino's library puts new identifiers into every file


def exported(folder, suffix):
    return nl.export(folder / f"part{suffix}", EXPORTS[suffix]()).read_bytes()


def result(name):
    call, good = CALLS[name]
    return fingerprint(call(**good))


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory):
    """What another process makes of the same, with another hash seed and other numbers of threads."""
    code = (
        "import json, sys, pathlib; from nurbs_lab.tests.robust import test_repeatable as t;"
        "folder = pathlib.Path(sys.argv[1]);"
        "files = {s: t.exported(folder, s).hex() for s in t.EXPORTS};"
        "print(json.dumps(files | {name: t.result(name) for name in t.CALLS}))"
    )
    threads = {"NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "3", "OPENBLAS_NUM_THREADS": "3"}
    env = {**os.environ, "PYTHONHASHSEED": "7", **threads}
    folder = tmp_path_factory.mktemp("elsewhere")
    ran = subprocess.run([sys.executable, "-c", code, folder], env=env, check=True, capture_output=True)
    return json.loads(ran.stdout)


@pytest.mark.parametrize("name", CALLS)
def test_same_result_again_and_in_another_process(name, elsewhere):
    assert result(name) == result(name) == elsewhere[name]


@pytest.mark.parametrize("suffix", EXPORTS)
def test_same_file_again_and_from_another_process(suffix, elsewhere, tmp_path):
    first = exported(tmp_path, suffix)
    assert first == exported(tmp_path, suffix) == bytes.fromhex(elsewhere[suffix])


def test_same_results_with_all_kernels_in_parallel_threads():
    alone = {name: result(name) for name in CALLS}
    with ThreadPoolExecutor(8) as pool:
        many = list(pool.map(result, 4 * list(CALLS)))
    assert many == 4 * list(alone.values())
