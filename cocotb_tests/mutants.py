"""Do benches and proofs notice wrong Verilog? ``make mutants-rtl`` breaks one operator at a time.

A mutant is a module with one change: ``&&`` for ``||``, ``==`` for ``!=``, ``<`` for ``<=``, ``+`` for ``-``,
a bit turned, a ``!`` dropped, a constant one more. Headers, checks of parameters and what only silences a
reader are left alone, and what Icarus refuses is no mutant. It is killed when the module's bench or proof
fails, or takes much longer than on the module as it is, which has to pass first; those that survive meet the
benches of the next larger modules. A hash of the line draws which are tried, so a change elsewhere draws no
others. All are listed in rtl/mutants.json; those that change nothing a caller can see are explained there by
hand, and stay explained while their line is the same.
"""

import contextlib
import hashlib
import importlib
import io
import itertools
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from functools import partial
from math import ceil
from pathlib import Path

from cocotb_tests.branches import COMMENT, ROOT, VERILOG

RESULT = ROOT / "rtl" / "mutants.json"
EACH = 5
SWAPS = [
    (r" && ", " || "), (r" \|\| ", " && "), (r" == ", " != "), (r" != ", " == "), (r" < ", " <= "),
    (r" > ", " >= "), (r" >= ", " > "), (r" \+ ", " - "), (r" - ", " + "), (r"1'b0", "1'b1"),
    (r"1'b1", "1'b0"), (r"!(?=[a-z(|])", ""), (r"\b\d+'d\d+\b", None),
]  # fmt: skip
#: Lines that are no logic, or whose change only fills memory with other constants.
SKIPPED = re.compile(
    r"localparam|parameter|begin : check|stop \(\)|unused|default:|`|genvar|\binput\b|\boutput\b|for \(i"
)
#: Module -> its proofs, its own benches, and those of the next larger modules.
TESTS = {
    "adams": ("adams", "adams", "stepper"),
    "axes": ("axes", "axes", "colorlight_i5"),
    "axil_slave": ("axil_slave", "axil_slave", "board_registers"),
    "banks": ("banks", "banks streamer", "override"),
    "board_registers": ("", "board_registers", "colorlight_i5"),
    "colorlight_i5": ("", "colorlight_i5", ""),
    "cu": ("", "cu", "stepper"),
    "cuk": ("cuk", "cuk", "runge_kutta"),
    "divide": ("divide_round", "divide", "cu"),
    "emergency_stop": ("emergency_stop", "emergency_stop", "colorlight_i5"),
    "exact_step": ("exact_step", "exact_step", "streamer"),
    "feed_override": ("feed_override", "feed_override", "override"),
    "feed_override_program": ("", "feed_override_program feed_override", "streamer"),
    "feed_table": ("feed_table", "feed_table", "streamer"),
    "horner": ("horner", "horner", "streamer"),
    "inputs": ("inputs", "inputs", "colorlight_i5"),
    "kout": ("kout", "kout", "slope"),
    "load_guard": ("load_guard", "load_guard", "nurbs_interpolator"),
    "multiply": ("", "multiply", "exact_step"),
    "nurbs_interpolator": ("nurbs_interpolator", "nurbs_interpolator override", ""),
    "reset_sync": ("", "reset_sync", ""),
    "runge_kutta": ("runge_kutta", "runge_kutta", "stepper"),
    "slope": ("slope", "slope", "stepper"),
    "soft_limits": ("soft_limits", "soft_limits", "streamer"),
    "square_root": ("square_root square_root_round", "square_root", "kout"),
    "step_dir": ("step_dir", "step_dir_lost step_dir", "axes"),
    "stepper": ("stepper", "stepper", "nurbs_interpolator"),
    "streamer": ("streamer", "streamer override", ""),
    "uart_bridge": ("uart_bridge", "uart_bridge", "colorlight_i5"),
    "uart_rx": ("uart_rx", "uart_rx", "uart_bridge"),
    "uart_tx": ("uart_tx", "uart_tx", "uart_bridge"),
    "ui_out": ("ui_out", "ui_out", "adams"),
    "vt": ("vt", "vt", "stepper"),
    "watchdog": ("watchdog", "watchdog", "colorlight_i5"),
}


def changes(text: str):
    """Every change: line number, the line, the line changed."""
    blank = COMMENT.sub(lambda found: re.sub(r"[^\n]", " ", found[0]), text)
    body = blank.index("\n);") + 3
    start = 0
    for number, line in enumerate(blank.splitlines(keepends=True), 1):
        if start >= body and not SKIPPED.search(line):
            for pattern, change in SWAPS:
                for found in re.finditer(pattern, line):
                    other = change
                    if change is None:
                        width, value = found[0].split("'d")
                        other = f"{width}'d{(int(value) + 1) % (1 << int(width))}"
                    at = slice(start + found.start(), start + found.end())
                    changed = line[: found.start()] + other + line[found.end() :]
                    yield number, line.strip(), changed.strip(), text[: at.start] + other + text[at.stop :]
        start += len(line)


def drawn(module: str, text: str):
    """The changes in the order in which they are tried."""
    found = list(changes(text))
    return sorted(found, key=lambda c: hashlib.sha256(f"{module} {c[1]} {c[2]}".encode()).hexdigest())


def compiles(file: Path, module: str) -> bool:
    others = [other for other in VERILOG if other.stem != module]
    models = sorted((ROOT / "rtl" / "boards" / "simulation").glob("*.v"))
    command = ["iverilog", "-g2005", "-tnull", "-s", module, *map(str, [file, *others, *models])]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


def calls(name: str):
    """The tests of a bench as calls: the first set of parameters of each, and all others."""
    module = importlib.import_module(f"cocotb_tests.test_{name}")
    first, others = [], []
    for test in [value for key, value in vars(module).items() if key.startswith("test_") and callable(value)]:
        if getattr(test, "__module__", "") != module.__name__:
            continue
        marks = [mark.args for mark in getattr(test, "pytestmark", []) if mark.name == "parametrize"]
        sets = [[(names, value) for value in values] for names, values in marks]
        works = []
        for chosen in itertools.product(*sets):
            given = {}
            for names, value in chosen:
                names = [names] if isinstance(names, str) else list(names)
                given |= dict(zip(names, value if len(names) > 1 else [value], strict=True))
            works.append(partial(test, **given))
        first, others = first + works[:1], others + works[1:]
    return first, others


def proved(name: str):
    from cocotb_tests.test_formal import PROOFS, prove

    for parameters in PROOFS[name][2]:
        with tempfile.TemporaryDirectory() as folder:
            assert prove(Path(folder), name, parameters) == "PASS"


def fails(work, file: Path, patience_s: float) -> bool:
    """Whether a test fails on this file, in a process of its own that ends in time."""
    child = os.fork()
    if not child:
        os.setsid()
        os.environ |= {"MUTANT": str(file), "SIM_BUILD": str(file.parent / "sim_build")}
        code = 1
        try:
            with Path(os.devnull).open("w") as nothing:
                os.dup2(nothing.fileno(), 1)
                os.dup2(nothing.fileno(), 2)
            with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                work()
            code = 0
        finally:
            os._exit(code)

    signal.signal(signal.SIGALRM, lambda *_: os.killpg(child, signal.SIGKILL))
    signal.alarm(ceil(patience_s))
    _, status = os.waitpid(child, 0)
    signal.alarm(0)
    return status != 0


class Judges:
    """What may notice a mutant of a module, the quickest first; each has to pass on the module as it is."""

    def __init__(self, module: str, file: Path):
        proofs, own, larger = (names.split() for names in TESTS[module])
        self.file, self.limits = file, {}
        self.tests = [(f"bench of {name}", work) for name in own for work in calls(name)[0]]
        self.tests += [(f"proof of {name}", partial(proved, name)) for name in proofs]
        if "QUICK" not in os.environ:
            self.tests += [(f"bench of {name}", work) for name in larger for work in calls(name)[0]]
            self.tests += [(f"bench of {name}", work) for name in own for work in calls(name)[1]]

    def killer(self, mutant: Path) -> str:
        """What notices the mutant, or nothing."""
        for number, (what, work) in enumerate(self.tests):
            if number not in self.limits:
                began = time.monotonic()
                right = mutant.parent / "right" / self.file.name
                right.parent.mkdir(exist_ok=True)
                shutil.copy(self.file, right)
                if fails(work, right, 1800):
                    raise RuntimeError(f"the {what} fails on the module as it is")
                self.limits[number] = 60 + 5 * (time.monotonic() - began)
            if fails(work, mutant, self.limits[number]):
                return what
        return ""


def table(found: dict) -> str:
    """Killed and tried of each module, and what survives unexplained."""
    rows = []
    for module, mutants in sorted(found.items()):
        dead = sum(bool(mutant["killed_by"]) for mutant in mutants)
        same = sum(bool(mutant.get("equivalent")) for mutant in mutants)
        rows.append(f"{module:24}{len(mutants):4} tried {dead:4} killed {same:3} equivalent")
    every = list(itertools.chain.from_iterable(found.values()))
    dead = sum(bool(mutant["killed_by"]) for mutant in every)
    same = sum(bool(mutant.get("equivalent")) for mutant in every)
    return "\n".join(
        [*rows, f"{len(every)} mutants, {dead} killed, {same} equivalent, {len(every) - dead - same} survive"]
    )


def main(modules, each):
    stored = json.loads(RESULT.read_text()) if RESULT.exists() else {}
    for file in VERILOG:
        module = file.stem
        if module not in TESTS or (modules and module not in modules):
            continue
        before = {(m["line"], m["changed"]): m for m in stored.get(module, [])}
        text, mutants, judges = file.read_text(), [], Judges(module, file)
        for number, line, changed, whole in drawn(module, text):
            if len(mutants) == each:
                break
            with tempfile.TemporaryDirectory() as folder:
                mutant = Path(folder) / file.name
                mutant.write_text(whole)
                if not compiles(mutant, module):
                    continue
                found = {"at": number, "line": line, "changed": changed, "killed_by": judges.killer(mutant)}
            same = before.get((line, changed), {}).get("equivalent")
            mutants.append(found | ({"equivalent": same} if same and not found["killed_by"] else {}))
            print(module, *found.values(), sep=" | ", flush=True)
        stored[module] = mutants
        RESULT.write_text(json.dumps(stored, indent=1, ensure_ascii=False) + "\n")
    print(table(stored))
    every = list(itertools.chain.from_iterable(stored.values()))
    alive = [m for m in every if not m["killed_by"] and not m.get("equivalent")]
    sys.exit(len(alive) > 0.05 * len(every))


if __name__ == "__main__":
    main(sys.argv[1:], int(os.environ.get("EACH", EACH)))
