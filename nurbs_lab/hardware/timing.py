"""Table 1 and Fig. 11 of the paper from counted clock cycles, beside the paper's own formulas."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab import paper
from nurbs_lab.common.checks import as_choice, as_count, as_kind
from nurbs_lab.hardware.interpolator import ARRANGEMENTS, build_program, simulate_path
from nurbs_lab.hardware.simulation import simulate_cu
from nurbs_lab.motion import plan_feed
from nurbs_lab.nurbs import NurbsCurve

#: Steps by Runge-Kutta before Adams takes over.
_STARTED = 4
#: The paper's times of a step by Runge-Kutta and by Adams, as numbers of C(u) and of clock cycles. 'cached'
#: is not in the paper: seven C(u) in a Runge-Kutta step (one in the very first), one by Adams.
_PAPER = {"serial": ((8, 0), (8, 0)), "parallel": ((4, 5), (1, 1)), "cached": ((7, 5), (1, 1))}


@dataclass(frozen=True)
class Timing:
    """Counted clock cycles of each step of the arrangements (four by Runge-Kutta), and of one C(u)."""

    cycles: dict
    cu_cycles: int
    clock_hz: float = paper.CLOCK_HZ

    def times_s(self, arrangement) -> np.ndarray:
        """Time at which each parameter is known, counted: Fig. 11."""
        as_choice("arrangement", arrangement, self.cycles)
        return np.cumsum(self.cycles[arrangement]) / self.clock_hz

    def paper_times_s(self, arrangement) -> np.ndarray:
        """The same by the paper's formulas, with its 205 µs for one C(u)."""
        as_choice("arrangement", arrangement, self.cycles)
        units = np.array([paper.CU_TIME_S, 1 / paper.CLOCK_HZ])
        start, step = _PAPER[arrangement] @ units
        each = np.where(np.arange(len(self.cycles[arrangement])) < _STARTED, start, step)
        if arrangement == "cached":
            each[0] = (1, 5) @ units
        return np.cumsum(each)

    def table(self) -> list[dict]:
        """Table 1: a row for each arrangement, cycles of a step counted and by the paper, and times in µs."""
        rows = []
        for name, cycles in self.cycles.items():
            ours, theirs = self.times_s(name), self.paper_times_s(name)
            paper_cycles = np.diff(theirs, prepend=0.0) * paper.CLOCK_HZ
            rows.append(
                {
                    "arrangement": name,
                    "runge_kutta_cycles": int(cycles[:_STARTED].max()),
                    "adams_cycles": int(cycles[_STARTED:].max()),
                    "paper_runge_kutta_cycles": round(paper_cycles[:_STARTED].max()),
                    "paper_adams_cycles": round(paper_cycles[-1]),
                    "time_us": float(ours[-1] * 1e6),
                    "paper_time_us": float(theirs[-1] * 1e6),
                    "speed_up": float(theirs[-1] / ours[-1]),
                }
            )
        return rows


def count_cycles(curve=paper.CURVE, *, steps=12) -> Timing:
    """Run the first 5 to 1000 steps in the simulated Verilog, in each arrangement, and count.

    The feed is the paper's, with ramps of 40 mm/s².
    """
    as_kind("curve", curve, NurbsCurve)
    steps, period_s = as_count("steps", steps, _STARTED + 1, 1000), paper.PERIOD_S
    feed = plan_feed(curve, speed=paper.SPEED, acceleration=40.0, tangential_only=True, period_s=period_s)
    # The run is cut short, so its last step may be as long as the curve.
    plan = build_program(curve, feed, period_s, steps, largest_step=np.ptp(curve.control_points) + 1.0)
    cycles = {}
    for name in ARRANGEMENTS:
        run = simulate_path(plan, arrangement=name)
        if len(run.u) <= steps:
            raise ValueError(f"the curve ends before step {steps}: give fewer steps or a lower speed")
        cycles[name] = np.diff(run.clocks[:steps], prepend=0)
    points = simulate_cu(curve, np.linspace(*curve.domain, 64)).cycles
    return Timing(cycles, int(points.max()))
