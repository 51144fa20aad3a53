"""``python -m benchmarks [room ...]``: run the tables of these rooms, or of all, into ``results.json``."""

from __future__ import annotations

import argparse
import json
import platform
import time
from dataclasses import asdict
from importlib import import_module, metadata
from pathlib import Path

from benchmarks import first_calls, page

ROOMS = ("nurbs", "mesh", "motion", "machining", "programs", "hardware", "scale", "files")
ALL = (*ROOMS, "first calls")
PEERS = (
    "numpy",
    "scipy",
    "numba",
    "trimesh",
    "vtk",
    "geomdl",
    "splipy",
    "toppra",
    "ruckig",
    "opencamlib",
    "cadquery-ocp-novtk",
)
RESULTS = Path(__file__).with_name("results.json")


def versions() -> dict[str, str]:
    """Installed version of every package that takes part."""
    return {name: metadata.version(name) for name in PEERS}


def machine() -> dict[str, str]:
    """What a reader needs to judge the times."""
    model = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        names = [line for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        model = names[0].split(":")[1].strip() if names else model
    return {"processor": model, "system": platform.system(), "python": platform.python_version()}


def line(row) -> str:
    """One row as text: our time, each peer's as a multiple of it, the bars that are missed."""
    peers = [f"{name} {row.ratio(name):.3g} x" for name in row.seconds if name != "nurbs_lab"]
    missed = [f"MISSED: {bar}" for bar in row.missed()]
    return f"  {row.work}: {row.seconds['nurbs_lab'] * 1e3:.4g} ms; {', '.join(peers + missed)}"


def main(rooms) -> None:
    """Run the tables of the named rooms; each is stored as soon as it is done."""
    results = json.loads(RESULTS.read_text()) | {"machine": machine(), "versions": versions()}
    for room in rooms:
        print(room, flush=True)
        start = time.perf_counter()
        if room == "first calls":
            results["first_calls"] = first_calls.measure()
        else:
            kept = [stored for stored in results["rows"] if stored["room"] != room]
            rows = [asdict(row) for row in _printed(import_module(f"benchmarks.{room}").rows())]
            results["rows"] = sorted(kept + rows, key=lambda stored: ROOMS.index(stored["room"]))
        results["minutes"][room] = (time.perf_counter() - start) / 60
        RESULTS.write_text(json.dumps(results, indent=1) + "\n")
    print("; ".join(f"{name} {minutes:.1f} min" for name, minutes in results["minutes"].items()))
    page.main()


def _printed(rows):
    for row in rows:
        print(line(row), flush=True)
        yield row


if __name__ == "__main__":
    arguments = argparse.ArgumentParser("python -m benchmarks", description="Run tables into results.json.")
    arguments.add_argument("rooms", nargs="*", default=ALL, metavar="room", help=", ".join(ALL))
    rooms = arguments.parse_args().rooms
    if not set(rooms) <= set(ALL):
        arguments.error(f"rooms are {rooms}, should be of {', '.join(ALL)}")
    main(rooms)
