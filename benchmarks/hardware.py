"""The hardware's counted clocks beside the paper's own times, both at its 50 MHz."""

import numpy as np

from benchmarks.harness import Bar, Row
from nurbs_lab import NurbsCurve, paper
from nurbs_lab.hardware import count_cycles, simulate_cu

#: A rational cubic in space; its weights fill the words.
CUBIC = NurbsCurve(
    3,
    [0, 0, 0, 0, 0.3, 0.6, 1, 1, 1, 1],
    [(0, 0, 0), (1, 2, 1), (3, 1, -1), (4, -2, 2), (6, 0, 1), (7, 3, 0)],
    [1, 0.5, 0.8, 0.3, 0.9, 1],
)


def rows() -> list[Row]:
    """One point, one step of each kind, and the first parameters in each arrangement (Fig. 11)."""
    timing = count_cycles()
    plane = simulate_cu(paper.CURVE, np.linspace(0, 1, 64)).cycles.max()
    cubic = simulate_cu(CUBIC, np.linspace(0, 1, 200)).cycles.max()
    table = {row["arrangement"]: row for row in timing.table()}
    found = [
        _row("one C(u) in the Verilog, at an assumed 50 MHz", plane, paper.CU_TIME_S, most=40),
        _row("one C(u) of a rational cubic in space", cubic, None, most=90),
    ]
    for step, what, most in (("adams", "Adams", 100), ("runge_kutta", "Runge-Kutta", 400)):
        clocks, theirs = (table["cached"][f"{whose}{step}_cycles"] for whose in ("", "paper_"))
        theirs /= paper.CLOCK_HZ
        found.append(_row(f"one {what} step, cached", clocks, theirs, most, CACHED))
    for name, cycles in timing.cycles.items():
        work = f"first {len(cycles)} parameters, {name}"
        notes = CACHED if name == "cached" else ""
        found.append(_row(work, sum(cycles), timing.paper_times_s(name)[-1], most=3000, notes=notes))
    return found


CACHED = "cached is not in the paper: its formulas, applied"


def _row(work, clocks, theirs, most, notes=""):
    """Clocks counted at the paper's frequency; a hundred times its speed is asked for."""
    seconds = {"nurbs_lab": float(clocks / paper.CLOCK_HZ)}
    if theirs:
        seconds["paper"] = float(theirs)
    figures, bars = {"clocks": int(clocks)}, (Bar("paper", 100),)
    return Row("hardware", work, seconds, bars, notes=notes, figures=figures, most={"clocks": most})
