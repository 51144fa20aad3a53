"""The same input gives the same bytes: again, in another process, and in many threads at once."""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange import shapes
from nurbs_lab.tests.robust.calls import fingerprint
from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import CALLS

EXPORTS = {
    ".step": shapes.surface,
    ".stp": shapes.curve,
    ".igs": shapes.curve,
    ".iges": shapes.surface,
    ".json": shapes.surface,
    ".obj": nl.nurbs.cylinder,
    ".stl": nl.nurbs.cylinder,
    ".ngc": shapes.path,
    ".csv": shapes.path,
}
CALLS = {
    **CALLS,
    **{
        name: HARDWARE[name]
        for name in ("load_curve", "cu_error_bound", "build_program", "run_twin", "word_length_study")
    },
    **{
        f"stepper {name}": (
            nl.trace,
            {"curve": nl.paper.CURVE, "feed": 4.0, "stepper": name, "period_s": 2.0**-6},
        )
        for name in nl.STEPPERS
        if name not in ("board", "inverse-length", "feed-correction")  # a board; peers that others register
    },
}


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
    """The arguments are left as they were."""
    before = [fingerprint(value) for value in CALLS[name][1].values()]
    assert result(name) == result(name) == elsewhere[name]
    assert [fingerprint(value) for value in CALLS[name][1].values()] == before


@pytest.mark.parametrize("suffix", EXPORTS)
def test_same_file_again_and_from_another_process(suffix, elsewhere, tmp_path):
    first = exported(tmp_path, suffix)
    assert first == exported(tmp_path, suffix) == bytes.fromhex(elsewhere[suffix])


def test_same_results_with_all_kernels_in_parallel_threads(elsewhere):
    names = 2 * list(CALLS)
    with ThreadPoolExecutor(8) as pool:
        assert list(pool.map(result, names)) == [elsewhere[name] for name in names]
