"""``make fuzz``: hostile calls of every public name, with a table of what they came to.

The functions and their good arguments are those of ``calls*.py``, which a test keeps complete. A call gets
one or two bad arguments: nonsense, numbers far from everyday ones, arrays with bad entries, and curves and
surfaces with knots 1e-12 apart, weights 1e8 apart or coincident points. The calls of a batch run in a child
process. Its parent ends it when one call takes longer than the time limit, and starts the next child behind
that call. Answers are held against certificates that need no second implementation.
"""

import argparse
import json
import queue
import re
import resource
import subprocess
import sys
import threading
import time
import warnings
from collections import Counter

import numpy as np
import psutil

SLOW_S, LIMIT_S, START_S, MEMORY = 10.0, 30.0, 120.0, 6 << 30
IDLE = 20  # times its limit of processor time that a call may take by the clock on the wall
KINDS = ("answered", "clear refusal", "unclear refusal", "wrong answer", "hang", "slow", "process lost")


def tables():
    """Room -> name -> (function, good arguments)."""
    from nurbs_lab.tests.robust import calls, calls_files, calls_hardware, calls_parts, calls_pictures

    return {
        "nurbs": calls.NURBS,
        "mesh": calls.MESH,
        "motion": calls.MOTION,
        "machining": calls.CUTTING,
        "parts": calls_parts.PARTS,
        "hardware": calls_hardware.HARDWARE,
        "plotting": calls_pictures.PICTURES,
        "interchange": calls_files.FILES,
    }


def spline(rng, axes):
    """A random curve or surface, as hostile as the constructors accept."""
    import nurbs_lab as nl

    degrees, counts = rng.integers(1, 6, axes), []
    knots = []
    for degree in degrees:
        count = int(degree + rng.integers(1, 8))
        inner = np.sort(rng.uniform(0, 1, count - degree - 1))
        if rng.random() < 0.3 and len(inner) > 1:
            inner[1:] = inner[0] + np.cumsum(10.0 ** rng.uniform(-12, -6, len(inner) - 1))
        vector = np.concatenate([np.zeros(degree + 1), np.minimum(inner, 1 - 1e-9), np.ones(degree + 1)])
        knots.append(vector * 10.0 ** rng.integers(-3, 4))
        counts.append(count)
    points = rng.normal(size=(*counts, int(rng.choice([2, 3])) if axes == 1 else 3))
    if rng.random() < 0.3:
        points = np.round(points)
    points = points * 10.0 ** rng.uniform(-9, 9) + rng.choice([0.0, 1e3, 1e6])
    if rng.random() < 0.2:
        points[-1] = points[0]
    weights = 10.0 ** rng.uniform(-4, 4, counts) if rng.random() < 0.4 else None
    kind = nl.NurbsCurve if axes == 1 else nl.NurbsSurface
    return kind(*((int(degrees[0]), knots[0]) if axes == 1 else (degrees.tolist(), knots)), points, weights)


def bad(rng, value):
    """Something hostile in the place of a good value."""
    import nurbs_lab as nl
    from nurbs_lab.tests.robust import test_inputs

    if isinstance(value, bytes):
        return damaged(rng, value)
    if isinstance(value, (nl.NurbsCurve, nl.NurbsSurface)) and rng.random() < 0.8:
        return spline(rng, 1 if isinstance(value, nl.NurbsCurve) else 2)
    if isinstance(value, (int, float)) and not isinstance(value, bool) and rng.random() < 0.7:
        return type(value)(np.clip(value * 10.0 ** rng.uniform(-9, 9), -1e18, 1e18))
    if isinstance(value, np.ndarray) and value.size and rng.random() < 0.8:
        spoiled = value.astype(float)
        way = rng.integers(6)
        if way == 0:
            spoiled.flat[rng.integers(value.size)] = test_inputs.SPOILS[rng.integers(len(test_inputs.SPOILS))]
        elif way == 1:
            spoiled = spoiled * 10.0 ** rng.uniform(-12, 12)
        elif way == 2:
            spoiled = spoiled[rng.integers(0, len(spoiled), rng.integers(1, 2 * len(spoiled) + 1))]
        elif way == 3:
            spoiled[rng.integers(len(spoiled))] = spoiled[0]
        elif way == 4:
            spoiled = spoiled + rng.normal(size=spoiled.shape) * 10.0 ** rng.uniform(-12, 3)
        else:
            spoiled = spoiled[: rng.integers(len(spoiled) + 1)]
        return spoiled
    words = [*test_inputs.WORDS, *test_inputs.NUMBERS, *test_inputs.SHAPES]
    return words[rng.integers(len(words))]


def damaged(rng, data):
    """A file of which some bytes were changed, lost, doubled or exchanged, up to four times."""
    for _ in range(rng.integers(1, 5)):
        a, b = np.sort(rng.integers(0, len(data) + 1, 2))
        b = rng.choice([b, min(b, a + 20)])
        piece = data[a:b]
        way = rng.integers(4)
        if way == 0:
            piece = rng.bytes(rng.integers(1, 9))
        elif way == 1:
            piece = b""
        elif way == 2:
            piece *= 2
        else:
            piece = piece.replace(*rng.choice([(b"1", b"nan"), (b".", b"e9"), (b"0", b"-1")]))
        data = data[:a] + piece + data[b:]
    return data


def wrong(call, given, result):
    """Why an answer cannot be right, or an empty string."""
    from nurbs_lab.tests.robust.calls import leaves

    if {"Figure", "Plotter", "VBox", "Animation"} & {kind.__name__ for kind in type(result).__mro__}:
        return ""
    if any(leaf.dtype.kind == "f" and np.isnan(leaf).any() for leaf in leaves(result)):
        return "NaN"
    shape, name = getattr(call, "__self__", None), getattr(call, "__name__", "")
    if name == "length":
        ends = zip(("u0", "u1"), shape.domain, strict=True)
        low, high = (end if given.get(u) is None else given[u] for u, end in ends)
        chord = np.linalg.norm(np.diff(shape(np.linspace(low, high, 400)), axis=0), axis=1).sum()
        scale = np.abs(shape.control_points).max()
        if abs(result) < chord * (1 - 1e-9) - 1e-13 * scale:
            return f"shorter than its chords, {chord}"
        polygon = np.linalg.norm(np.diff(shape.clamped().control_points, axis=0), axis=1).sum()
        inside = shape.domain[0] <= min(low, high) and max(low, high) <= shape.domain[1]
        if inside and abs(result) > polygon * (1 + 1e-9) + 1e-13 * scale:
            return f"longer than its polygon, {polygon}"
    if name in ("normal", "tangent", "binormal"):
        off = np.abs(np.linalg.norm(result, axis=-1) - 1).max(initial=0)
        return "not of unit length" if off > 1e-9 else ""
    if name == "parameter_at":
        reached = [shape.length(None, u) for u in np.ravel(result)]
        if np.abs(reached - np.ravel(given["length"])).max(initial=0) > 2e-9 * shape.length():
            return "misses the length"
    if name == "closest_point":
        at = result[0]
        points = shape(*np.moveaxis(at, -1, 0)) if shape.control_points.ndim == 3 else shape(at)
        apart = np.linalg.norm(points - np.asarray(given["points"], float), axis=-1)
        size = np.abs(shape.control_points).max() + np.abs(given["points"]).max(initial=0)
        if np.abs(apart - result[1]).max(initial=0) > 1e-9 * size:
            return "the distance is not that of the point"
    if name == "there_and_back":
        one, (other,) = given["curve"], result
        u = np.linspace(*one.domain, 50)
        apart = np.abs(one(u) - other(np.linspace(*other.domain, 50))[:, : one.dim]).max()
        return "" if apart <= 1e-9 * np.abs(one.control_points).max() else f"comes back {apart} apart"
    if name == "plan_feed":
        length, backward = given["curve"].length(), np.diff(result.terms[:, 0]).min(initial=0)
        if abs(result.length - length) > 1e-6 * length or backward < -1e-9 * length:
            return "goes back or has another length than the curve"
        wanted = [given.get("start_speed", 0), given.get("end_speed", 0)]
        if np.abs(result.speed([0.0, result.duration]) - wanted).max() > 1e-6 * given["speed"]:
            return "does not keep the speeds of its ends"
    return ""


def attempt(call, good, rng):
    """What one call came to: (kind, detail)."""
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
        return "clear refusal", ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with np.errstate(all="ignore"):
                result = call(**given)
                why = wrong(call, given, result)
    except (ValueError, TypeError, OSError) as error:
        words = [*good, "control_points", "weights", "knots", "curve", "surface", "shapes", "path", "items"]
        named = re.search(rf"(?<![A-Za-z0-9_])(?:{'|'.join(words)})(?![A-Za-z0-9_])", str(error))
        return "clear refusal" if named else "unclear refusal", f"{spoiled}: {error}"
    except Exception as error:
        return "unclear refusal", f"{spoiled}: {type(error).__name__}: {error}"
    return "wrong answer" if why else "answered", f"{spoiled}: {why}"


def child(room, seed, first, last):
    """Calls ``first`` to ``last``, each announced before and reported after, one JSON line each."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    table = tables()[room]
    for k in range(first, last):
        rng = np.random.default_rng([seed, sum(map(ord, room)), k])
        name = str(rng.choice(list(table)))
        print(json.dumps([k, name]), flush=True)
        start = time.process_time()
        kind, detail = attempt(*table[name], rng)
        print(json.dumps([k, name, time.process_time() - start, kind, detail]), flush=True)


def batch(room, seed, first, last):
    """Reports ``(k, name, seconds, kind, detail)`` of calls, from as many children as it takes."""
    while first < last:
        numbers = map(str, (seed, first, last))
        command = [sys.executable, "-m", "nurbs_lab.tests.robust.fuzz", "--child", room, *numbers]
        run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        lines = queue.Queue()
        threading.Thread(target=_forward, args=(run.stdout, lines)).start()
        begun, limit = [first, ""], START_S
        while line := _next(lines, limit, psutil.Process(run.pid)):
            if line == "hang":
                yield *begun, LIMIT_S, "hang", ""
                break
            limit = LIMIT_S
            if line.startswith("["):
                begun = json.loads(line)
                if len(begun) > 2:
                    yield begun
                    begun = [begun[0] + 1, ""]
        if not line and begun[0] < last:
            yield *begun, 0.0, "process lost", f"exit code {run.wait()}"
        run.kill()
        run.wait()
        first = begun[0] + 1


def _forward(stream, lines):
    for line in stream:
        lines.put(line)
    lines.put("")


def _next(lines, limit, process):
    """The next line of a child; "hang" if it takes too long, by its own clock, which others do not slow."""
    start = spent(process)
    for _ in range(int(IDLE * limit)):
        try:
            return lines.get(timeout=1.0)
        except queue.Empty:
            if spent(process) - start > limit:
                break
    return "hang"


def spent(process):
    """Seconds of processor time that a child has taken; zero of one that has ended."""
    try:
        return sum(process.cpu_times()[:2])
    except psutil.Error:
        return 0.0


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
    rooms = options.rooms or list(tables())
    print("| room | calls | " + " | ".join(KINDS) + " |", "| --- |" + " --: |" * (1 + len(KINDS)), sep="\n")
    cases = []
    for room in rooms:
        found = Counter()
        for k, name, seconds, kind, detail in batch(room, options.seed, 0, options.calls // len(rooms)):
            found[kind] += 1
            found["slow"] += seconds > SLOW_S
            if kind not in ("answered", "clear refusal") or seconds > SLOW_S:
                place = f"{room} call {k}, seed {options.seed}"
                cases.append(f"{place}: {kind}: {name} {seconds:.1f} s {detail[:300]}")
        counts = " | ".join(str(found[kind]) for kind in KINDS)
        print(f"| {room} | {sum(found[kind] for kind in KINDS if kind != 'slow')} | {counts} |", flush=True)
    print(*cases, sep="\n")


if __name__ == "__main__":
    main()
