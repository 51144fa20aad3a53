"""``make fuzz``: hostile calls of every public name, with a table of what they came to.

The functions and their good arguments are those of ``calls*.py``, which a test keeps complete. A call gets
one or two bad arguments: nonsense, numbers far from everyday ones, arrays with bad entries, and curves and
surfaces with knots 1e-12 apart, weights 1e8 apart or coincident points. The calls of a batch run in a child
process. It ends itself when one call takes longer than the time limit, saying in which lines of Python it
was, and its parent starts the next child behind that call. An answer is wrong if it holds NaN, or is
a mesh that is open; more is asked of answers by the tests of their rooms.
"""

import argparse
import faulthandler
import json
import re
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from importlib import import_module
from pathlib import Path

import numpy as np
import trimesh

from nurbs_lab.tests.interchange.test_gcode_refused import damaged_programs
from nurbs_lab.tests.robust.calls import leaves
from nurbs_lab.tests.robust.hostile import bad, spline

SLOW_S, LIMIT_S, MEMORY = 5.0, 120.0, 6 << 30
BATCH = 2_000  # calls of one child: every off-screen window of VTK keeps 8 MB of addresses
#: Parts of what a call is given that a refusal may name instead of the argument.
WORDS = ("control_points", "weights", "knots", "curve", "surface", "shapes", "path", "items")
KINDS = ("answered", "clear refusal", "unclear refusal", "wrong answer", "hang", "slow", "process lost")


#: Room -> module beside this one, the name of its table of functions and good arguments, and its part of all
#: calls in per cent: whole reconstructions take a hundred times as long as curves.
TABLES = {
    "nurbs": ("calls", "NURBS", 24),
    "mesh": ("calls", "MESH", 18),
    "motion": ("calls", "MOTION", 12),
    "machining": ("calls", "CUTTING", 10),
    "parts": ("calls_parts", "PARTS", 2),
    "hardware": ("calls_hardware", "HARDWARE", 12),
}


def attempt(call, good, rng):
    """What one call came to: (seconds of processor time, kind, detail)."""
    given, spoiled = dict(good), []
    shape = getattr(call, "__self__", call)
    axes = {"NurbsCurve": 1, "NurbsSurface": 2}.get(type(shape).__name__)
    try:
        if axes and rng.random() < 0.5:
            hostile = spline(rng, axes)
            call = getattr(hostile, call.__name__) if shape is not call else hostile
        for argument in rng.permutation(list(good))[: rng.integers(0 if axes else 1, 3)]:
            given[argument] = bad(rng, good[argument])
            spoiled.append(str(argument))
    except ValueError:
        return 0.0, "clear refusal", ""
    start = time.process_time()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            result, kind, said = call(**given), "answered", ""
        except (ValueError, TypeError, OSError) as error:
            words = "|".join([*good, *WORDS])
            named = re.search(rf"(?<![A-Za-z0-9_])(?:{words})(?![A-Za-z0-9_])", str(error))
            kind, said = "clear refusal" if named else "unclear refusal", error
        except Exception as error:
            kind, said = "unclear refusal", f"{type(error).__name__}: {error}"
        seconds = time.process_time() - start
        if kind == "answered" and (said := wrong(result)):
            kind = "wrong answer"
    return seconds, kind, f"{spoiled}: {said}"


def wrong(result):
    """Why an answer cannot be right, or an empty string."""
    if any(leaf.dtype.kind == "f" and np.isnan(leaf).any() for leaf in leaves(result)):
        return "NaN"
    if isinstance(result, trimesh.Trimesh) and not result.is_watertight:
        return "open edges"
    return ""


def child(room, seed, first, last):
    """Calls ``first`` to ``last``, each announced before and reported after, one JSON line each."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    faulthandler.enable()
    module, name, _ = TABLES[room]
    table = getattr(import_module(f"nurbs_lab.tests.robust.{module}"), name)
    names = list(table)
    for k in range(first, last):
        rng = np.random.default_rng([seed, sum(map(ord, room)), k])
        name = str(rng.choice(names))
        print(json.dumps([k, name]), flush=True)
        faulthandler.dump_traceback_later(LIMIT_S, exit=True)
        print(json.dumps([k, name, *attempt(*table[name], rng)]), flush=True)


def batch(room, seed, first, last):
    """Reports ``(k, name, seconds, kind, detail)`` of calls, from as many children as it takes."""
    with tempfile.TemporaryFile("w+", errors="replace") as said:
        while first < last:
            said.truncate(0)
            stop = min(first + BATCH, last)
            numbers = map(str, (seed, first, stop))
            command = [sys.executable, "-m", "nurbs_lab.tests.robust.fuzz", "--child", room, *numbers]
            begun = [first, ""]
            with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=said, text=True) as run:
                for line in run.stdout:
                    if line.startswith("["):
                        begun = json.loads(line)
                        if len(begun) > 2:
                            yield begun
                            begun = [begun[0] + 1, ""]
            if begun[0] < stop:
                said.seek(0)
                words = said.read()
                kind = "hang" if "Timeout (" in words else "process lost"
                where = " < ".join(re.findall(r'(\w+\.py", line \d+ in \w+)', words)[:8])
                yield *begun, LIMIT_S, kind, f"exit code {run.returncode}: {where}"
            first = min(begun[0] + 1, stop)


def main():
    """Share the calls out over the rooms, print the table and every case that is not in order."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--calls", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rooms", nargs="*", default=None)
    parser.add_argument("--child", nargs=4)
    options = parser.parse_args()
    if options.child:
        room, *numbers = options.child
        child(room, *map(int, numbers))
        return
    rooms = options.rooms or list(TABLES)
    print("| room | calls | " + " | ".join(KINDS) + " |", "| --- |" + " --: |" * (1 + len(KINDS)), sep="\n")
    cases = []
    for room in rooms:
        found = Counter()
        calls = options.calls * TABLES[room][2] // sum(TABLES[one][2] for one in rooms)
        for k, name, seconds, kind, detail in batch(room, options.seed, 0, calls):
            found[kind] += 1
            found["slow"] += seconds > SLOW_S
            if kind not in ("answered", "clear refusal") or seconds > SLOW_S:
                place = f"{room} call {k}, seed {options.seed}"
                cases.append(f"{place}: {kind}: {name} {seconds:.1f} s {detail[:300]}")
                print(cases[-1], file=sys.stderr, flush=True)
        counts = " | ".join(str(found[kind]) for kind in KINDS)
        print(f"| {room} | {sum(found[kind] for kind in KINDS if kind != 'slow')} | {counts} |", flush=True)
    print(*cases, sep="\n")
    with tempfile.TemporaryDirectory() as folder:
        print("damaged programs:", damaged_programs(Path(folder), options.calls // 2, options.seed))


if __name__ == "__main__":
    main()
