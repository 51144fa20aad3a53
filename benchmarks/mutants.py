"""Does the suite notice a wrong core? ``make mutants`` breaks one operator at a time, runs the quick tests.

A mutant is a core file with one change: ``+`` for ``-``, ``*`` for ``/``, ``<`` for ``<=``, a constant one
more, a ``not`` dropped, ``and`` for ``or`` (not in sizes of ``np.empty``: a larger one changes nothing). It
is killed when a test fails, or when the tests take thrice as long as on the whole code. Kernels run as
plain Python, so that nothing is compiled; every mutant lives in a fork of one process that has the
libraries loaded, on a scratch copy of the package. A hash of its line draws which mutants are tried: a
change elsewhere draws no others. Survivors are listed in ``benchmarks/mutants.json``; those that change
nothing a caller can see are explained there by hand, and stay explained while their line is the same.
"""

import ast
import copy
import hashlib
import io
import itertools
import json
import os
import resource
import shutil
import sys
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

ROOT = Path(__file__).parent.parent
RESULT = Path(__file__).with_suffix(".json")
EACH, PATIENCE, MEMORY = 13, 3, 8 << 30
STEPS = "divides or closed_form or may"
STEPPING = "order trace properties rest"
FITS = "same_knots or pivot or points_and_scipy or seam or given or formulas or periodic"
SLOW_SLICES = "figure_eight or order or uneven or torus or every_vertex or cusp or in_memory or threads"
#: Core file -> the tests that its mutants meet, and which of them are quick enough without the compiler.
CORE = {
    "nurbs/_kernels.py": ("evaluate shape", "not surface_equals_scipy"),
    "nurbs/_kernels_band.py": ("approximate interpolate", FITS),
    "nurbs/interpolate.py": ("interpolate refusals", "not fuzz"),
    "nurbs/knots.py": ("interpolate approximate", "interpolate or same_knots or one_control or holds"),
    "mesh/slicing/_kernels.py": ("slicing slicing_hard_cases streaming heights", f"not ({SLOW_SLICES})"),
    "nurbs/span_kernels.py": (
        f"{STEPPING} measure",
        f"(taylor2 or exact) and ({STEPS}) or weighted or cusp or cannot or slower or reverses or far_apart",
    ),
    "motion/steppers/one_step.py": (STEPPING, f"(rk2 or rk4 or taylor) and ({STEPS}) and not quotient"),
    "motion/steppers/adams.py": (
        STEPPING,
        f"(adams or abm or quotient or rk4 or paper) and ({STEPS} or eq_)",
    ),
    "motion/steppers/multistep.py": (
        f"{STEPPING} multistep",
        f"(history or multistep) and ({STEPS}) or printed_formula or order_is_that or rest_no_step",
    ),
    "motion/steppers/corrected.py": (STEPPING, f"corrected and ({STEPS})"),
    "motion/steppers/exact.py": (STEPPING, f"exact and ({STEPS} or faster or moves)"),
}
SWAPS = {
    ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult,
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.And: ast.Or, ast.Or: ast.And,
}  # fmt: skip


def changes(tree):
    """Every change of one node: its function, the node, and what makes it on a copy of that node."""
    skipped = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):  # decorators, defaults and docstrings are no logic
            aside = [*node.decorator_list, node.args, *node.body[: ast.get_docstring(node) is not None]]
            skipped |= {id(inner) for part in aside for inner in ast.walk(part)}
        scratch = isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "empty"
        if scratch or isinstance(node, ast.Raise | ast.JoinedStr):
            skipped |= {id(inner) for inner in ast.walk(node)}
    for function in [node for node in tree.body if isinstance(node, ast.FunctionDef)]:
        for node in ast.walk(function):
            if id(node) in skipped:
                continue
            if isinstance(node, ast.BinOp | ast.AugAssign | ast.BoolOp) and type(node.op) in SWAPS:
                yield function.name, node, lambda n: setattr(n, "op", SWAPS[type(n.op)]())
            elif isinstance(node, ast.Compare) and type(node.ops[0]) in SWAPS:
                yield function.name, node, lambda n: n.ops.__setitem__(0, SWAPS[type(n.ops[0])]())
            elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
                yield function.name, node, lambda n: setattr(n, "op", ast.UAdd())
            elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
                yield function.name, node, lambda n: setattr(n, "value", n.value + 1)


def mutants(source):
    """The mutants that are drawn: what is said of each, and its source."""
    lines, drawn = source.splitlines(), {}
    for function, node, change in changes(ast.parse(source)):
        changed = copy.deepcopy(node)
        change(changed)
        words = function, lines[node.lineno - 1].strip(), ast.unparse(node), ast.unparse(changed)
        chance = hashlib.sha256(
            f"{words} {node.col_offset - lines[node.lineno - 1].index(words[1])}".encode()
        )
        drawn[chance.digest()] = words, node
    for _, (words, node) in sorted(drawn.items())[:EACH]:
        after = words[-1] if isinstance(node, ast.AugAssign) else f"({words[-1]})"
        said = dict(zip(("function", "line", "before", "after"), words, strict=True))
        yield said, spliced(source, node, after)


def spliced(source, node, text):
    """The source with another text in place of a node."""
    whole = source.encode()  # which columns are counted in
    begins = [0, *itertools.accumulate(map(len, whole.splitlines(keepends=True)))]
    start, stop = begins[node.lineno - 1] + node.col_offset, begins[node.end_lineno - 1] + node.end_col_offset
    return (whole[:start] + text.encode() + whole[stop:]).decode()


def tested(package, tests, chosen, plain, seconds):
    """Run tests on the copy in a fork: (whether they passed, CPU seconds)."""
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        os.chdir(package.parent)
        sys.path.insert(0, str(package.parent))
        numba.config.DISABLE_JIT = plain
        paths = [str(next(package.glob(f"tests/*/test_{test}.py"))) for test in tests.split()]
        silent = [f"-pno:{plugin}" for plugin in ("nbval", "faulthandler", "cacheprovider")]
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            os._exit(pytest.main(["-xq", "--assert=plain", "-W", "ignore", *silent, "-k", chosen, *paths]))
    _, status, used = os.wait4(child, 0)
    return status == 0, used.ru_utime + used.ru_stime


def meet_tests(package, name, known):
    """Break a file again and again: its entry of the result."""
    file, explained = package / name, {tuple(one.values())[:4]: one["why"] for one in known}
    whole = file.read_text()
    tests = *CORE[name], "common.kernels import" in whole  # other files may call compiled kernels
    passed, seconds = tested(package, *tests, 600)
    assert passed, f"{name}: the tests fail on the whole code"
    tried, survivors = 0, []
    for said, source in mutants(whole):
        tried += 1
        file.write_text(source)
        if tested(package, *tests, int(PATIENCE * seconds) + 3)[0]:
            survivors.append({**said, "why": explained.get(tuple(said.values()), "")})
            print("  survived:", *survivors[-1].values(), sep="  |  ", flush=True)
    file.write_text(whole)
    print(f"{name}: {tried - len(survivors)} of {tried} killed; its tests take {seconds:.1f} s", flush=True)
    return {"tried": tried, "killed": tried - len(survivors), "survivors": survivors}


def main():
    known = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    result = {name: known[name] for name in CORE if name in known}
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder, "nurbs_lab")
        shutil.copytree(ROOT / "nurbs_lab", package)
        for name in sys.argv[1:] or CORE:
            result[name] = meet_tests(package, name, known.get(name, {"survivors": []})["survivors"])
            RESULT.write_text(json.dumps(result, indent=1) + "\n")
    killed, tried = (sum(entry[key] for entry in result.values()) for key in ("killed", "tried"))
    open_ones = sum(not survivor["why"] for entry in result.values() for survivor in entry["survivors"])
    spent = sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2]) / 60
    print(f"{killed} of {tried} killed; {open_ones} survivors without an explanation; {spent:.0f} min of CPU")


if __name__ == "__main__":
    os.environ["NURBS_LAB_PROGRESS"] = "0"
    sys.dont_write_bytecode = True  # or a mutant of the same size and second would be taken for the last one
    import hypothesis
    import numba
    import numpy as np
    import pytest
    import scipy.interpolate  # noqa: F401  (what every fork would load again)
    import trimesh  # noqa: F401

    np.seterr(all="ignore")
    quick = {"max_examples": 15, "derandomize": True, "deadline": None, "phases": [hypothesis.Phase.generate]}
    hypothesis.settings.register_profile("mutants", **quick)
    hypothesis.settings.load_profile("mutants")
    main()
