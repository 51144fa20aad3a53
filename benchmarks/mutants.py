"""Does the suite notice a wrong core? ``make mutants`` breaks one operator at a time, runs the quick tests.

A mutant is a core file with one change: ``+`` for ``-``, ``*`` for ``/``, ``<`` for ``<=``, a constant one
more, a ``not`` dropped, ``and`` for ``or``. It is killed when a test fails, or when the tests take six times
as long as on the whole code. The kernels run as plain Python, so that nothing is compiled; every mutant lives
in a fork of one process that has the libraries loaded, on a scratch copy of the package. The sample is
seeded: the same code gives the same mutants. Survivors are listed in ``benchmarks/mutants.json``; those that
change nothing a caller can see are explained there by hand, and stay explained while their line is the same.
"""

import ast
import copy
import io
import json
import os
import random
import resource
import shutil
import sys
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

ROOT = Path(__file__).parent.parent
RESULT = Path(__file__).with_suffix(".json")
SEED, EACH, PATIENCE = 20, 13, 6
STEPS = "divides or ramp or counted or lag"
SLOW_FITS = "parametrization or surface_order or untwists or few or tolerance or less"
SLOW_SLICES = "eight or order or uneven or torus or frogs or every_vertex or cusp or 2000000"
#: Core file -> the tests that its mutants meet, and which of them are quick enough without the compiler.
CORE = {
    "nurbs/_kernels.py": ("nurbs/test_evaluate.py nurbs/test_shape.py", "not surface_equals_scipy"),
    "nurbs/_kernels_band.py": ("nurbs/test_approximate.py nurbs/test_interpolate.py", f"not ({SLOW_FITS})"),
    "nurbs/interpolate.py": ("nurbs/test_interpolate.py nurbs/test_refusals.py", f"not ({SLOW_FITS})"),
    "mesh/_kernels.py": (
        "mesh/test_slicing_hard_cases.py mesh/test_slicing.py mesh/test_streaming.py mesh/test_heights.py",
        f"not ({SLOW_SLICES})",
    ),
    "motion/_kernels.py": ("motion/test_order.py motion/test_trace.py", f"taylor2 and ({STEPS}) or weighted"),
    "motion/steppers/taylor.py": ("motion/test_order.py motion/test_trace.py", f"taylor and ({STEPS})"),
    "motion/steppers/adams.py": (
        "motion/test_order.py motion/test_trace.py",
        f"(adams or abm) and ({STEPS})",
    ),
    "motion/steppers/history.py": ("motion/test_order.py motion/test_trace.py", f"history and ({STEPS})"),
}
SWAPS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip


def changes(tree):
    """Every change of one node: the node, and what makes it on that node."""
    skipped = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):  # decorators, defaults and docstrings are no logic
            aside = [*node.decorator_list, node.args, *node.body[: ast.get_docstring(node) is not None]]
            skipped |= {id(inner) for part in aside for inner in ast.walk(part)}
        if isinstance(node, ast.Raise | ast.JoinedStr):
            skipped |= {id(inner) for inner in ast.walk(node)}
    for function in [node for node in tree.body if isinstance(node, ast.FunctionDef)]:
        for node in ast.walk(function):
            if id(node) in skipped:
                continue
            if isinstance(node, ast.BinOp | ast.AugAssign | ast.BoolOp) and type(node.op) in SWAPS:
                yield node, lambda n: setattr(n, "op", SWAPS[type(n.op)]())
            elif isinstance(node, ast.Compare) and type(node.ops[0]) in SWAPS:
                yield node, lambda n: n.ops.__setitem__(0, SWAPS[type(n.ops[0])]())
            elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
                yield node, lambda n: setattr(n, "op", ast.UAdd())
            elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
                yield node, lambda n: setattr(n, "value", n.value + 1)


def mutants(file):
    """A seeded sample of a file's mutants: (line, before, after, source)."""
    source = file.read_text()
    tree = ast.parse(source)
    many = list(changes(tree))
    for node, change in random.Random(f"{SEED} {file.name}").sample(many, min(EACH, len(many))):
        before, kept = ast.unparse(node), copy.copy(node)
        if hasattr(node, "ops"):
            kept.ops = list(node.ops)
        change(node)
        yield source.splitlines()[node.lineno - 1].strip(), before, ast.unparse(node), ast.unparse(tree)
        node.__dict__.update(kept.__dict__)


def tested(package, tests, chosen, seconds):
    """Run tests on the copy in a fork: (whether they passed, CPU seconds)."""
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        os.chdir(package.parent)
        sys.path.insert(0, str(package.parent))
        paths = [str(package / "tests" / test) for test in tests.split()]
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            os._exit(pytest.main(["-xq", "-p", "no:nbval", "-W", "ignore", "-k", chosen, *paths]))
    _, status, used = os.wait4(child, 0)
    return status == 0, used.ru_utime + used.ru_stime


def meet_tests(package, name, explained):
    """Break a file again and again: its entry of the result."""
    file, (tests, chosen) = package / name, CORE[name]
    whole = file.read_text()
    passed, seconds = tested(package, tests, chosen, 600)
    assert passed, f"{name}: the tests fail on the whole code"
    tried, survivors = 0, []
    for line, before, after, source in mutants(file):
        file.write_text(source)
        tried += 1
        if tested(package, tests, chosen, int(PATIENCE * seconds) + 5)[0]:
            why = explained.get((line, after), "")
            survivors.append({"line": line, "before": before, "after": after, "why": why})
            print(f"  survived: {before}  ->  {after}   in   {line}", flush=True)
    file.write_text(whole)
    print(f"{name}: {tried - len(survivors)} of {tried} killed; its tests take {seconds:.1f} s", flush=True)
    return {"tried": tried, "killed": tried - len(survivors), "survivors": survivors}


def main():
    result = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder, "nurbs_lab")
        shutil.copytree(ROOT / "nurbs_lab", package, ignore=shutil.ignore_patterns("__pycache__"))
        for name in sys.argv[1:] or CORE:
            known = result.get(name, {"survivors": []})["survivors"]
            explained = {(survivor["line"], survivor["after"]): survivor["why"] for survivor in known}
            result[name] = meet_tests(package, name, explained)
            RESULT.write_text(json.dumps(result, indent=1) + "\n")
    killed, tried = (sum(entry[key] for entry in result.values()) for key in ("killed", "tried"))
    open_ones = sum(not survivor["why"] for entry in result.values() for survivor in entry["survivors"])
    print(f"{killed} of {tried} killed; {open_ones} survivors without an explanation")


if __name__ == "__main__":
    os.environ |= {"NUMBA_DISABLE_JIT": "1", "NURBS_LAB_PROGRESS": "0"}
    sys.dont_write_bytecode = True  # or a mutant of the same size and second would be taken for the last one
    import hypothesis
    import numba  # noqa: F401  (what every fork would load again)
    import numpy as np
    import pytest
    import scipy.interpolate  # noqa: F401
    import trimesh  # noqa: F401

    np.seterr(all="ignore")
    quick = {"max_examples": 15, "derandomize": True, "deadline": None, "phases": [hypothesis.Phase.generate]}
    hypothesis.settings.register_profile("mutants", **quick)
    hypothesis.settings.load_profile("mutants")
    main()
