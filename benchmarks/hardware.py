"""The hardware's counted clocks beside the paper's own times, both at its 50 MHz."""

from benchmarks.harness import Bar, Row
from nurbs_lab import paper
from nurbs_lab.hardware import count_cycles


def rows() -> list[Row]:
    """One point on the paper's curve, and its first parameters in each arrangement (Fig. 11)."""
    timing = count_cycles()
    point = {"nurbs_lab": timing.cu_cycles / timing.clock_hz, "paper": paper.CU_TIME_S}
    figures = {"clocks": timing.cu_cycles}
    found = [
        Row("hardware", "one C(u) in the Verilog, at 50 MHz", point, (Bar("paper", 100),), figures=figures)
    ]
    for name, cycles in timing.cycles.items():
        ours, theirs = timing.times_s(name)[-1], timing.paper_times_s(name)[-1]
        work = f"first {len(cycles)} parameters, {name}"
        seconds = {"nurbs_lab": float(ours), "paper": float(theirs)}
        notes = "" if name != "cached" else "cached is not in the paper: its formulas, applied"
        figures = {"clocks": int(sum(cycles))}
        found.append(Row("hardware", work, seconds, (Bar("paper", 100),), notes=notes, figures=figures))
    return found
