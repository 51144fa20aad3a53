"""Table 1 and Fig. 11 of the paper: counted cycles, its formulas, processors; a study of word lengths.

For the processor the paper means a program that evaluates C(u) eight times, one after the other, for every
parameter. Here such a program is measured. On a microcontroller it is estimated: its floating-point
operations are counted, times cycles of each; loads, stores and branches are left out, and the estimate is a
range.
"""

import time
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from nurbs_lab import paper
from nurbs_lab.common.checks import as_choice, as_count, as_flag, as_integer, as_kind, as_sequence
from nurbs_lab.common.executor import map_items
from nurbs_lab.common.kernels import kernel
from nurbs_lab.hardware.arithmetic import Format
from nurbs_lab.hardware.interpolator import ARRANGEMENTS, build_program, simulate_path
from nurbs_lab.hardware.stepper import ADAMS, STARTED, run_twin
from nurbs_lab.motion import ToolPath, plan_feed, trace
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.nurbs import NurbsCurve
from nurbs_lab.nurbs.span_kernels import find_span, point

#: The paper's times of a step by Runge-Kutta and by Adams, as numbers of C(u) and of clock cycles. 'cached'
#: is not in the paper: seven C(u) in a Runge-Kutta step (one in the very first), one by Adams.
_PAPER = {"serial": ((8, 0), (8, 0)), "parallel": ((4, 5), (1, 1)), "cached": ((7, 5), (1, 1))}
#: C(u) and a clock cycle of the paper, in s.
_UNITS_S = np.array([paper.CU_TIME_S, 1 / paper.CLOCK_HZ])
#: Additions, products, quotients and roots of a point of the paper's curve by Cox-de Boor (The NURBS Book,
#: A2.2 and A3.1; degree 2, plane), of a slope beyond its points, and of Eq. (17) itself.
_POINT, _SLOPE, _FORMULA = np.array([(14, 12, 3, 0), (4, 2, 2, 1), (4, 5, 0, 0)])
#: A Cortex-M7 in double precision, as the place of a tool needs 35 bits: cycles of each, at least, by our
#: assumption (LLVM lets a product begin in every cycle, GCC in every third), and at most, where each waits
#: for the one before: the latencies of LLVM's ARMScheduleM7.td. Arm itself publishes no table.
_M7_HZ, _M7_CYCLES = 480e6, np.array([(1, 2, 30, 30), (4, 7, 30, 30)])


@dataclass(frozen=True)
class Timing:
    """Counted clock cycles of each step of the arrangements (four by Runge-Kutta)."""

    cycles: dict

    def times_s(self, arrangement) -> np.ndarray:
        """Time at which each parameter is known, counted: Fig. 11."""
        as_choice("arrangement", arrangement, self.cycles)
        return np.cumsum(self.cycles[arrangement]) / paper.CLOCK_HZ

    def paper_times_s(self, arrangement) -> np.ndarray:
        """The same by the paper's formulas, with its 205 µs for one C(u)."""
        as_choice("arrangement", arrangement, self.cycles)
        start, step = _PAPER[arrangement] @ _UNITS_S
        each = np.where(np.arange(len(self.cycles[arrangement])) < STARTED, start, step)
        if arrangement == "cached":
            each[0] = (1, 5) @ _UNITS_S
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
                    "runge_kutta_cycles": int(cycles[:STARTED].max()),
                    "adams_cycles": int(cycles[STARTED:].max()),
                    "paper_runge_kutta_cycles": round(paper_cycles[:STARTED].max()),
                    "paper_adams_cycles": round(paper_cycles[-1]),
                    "time_us": float(ours[-1] * 1e6),
                    "paper_time_us": float(theirs[-1] * 1e6),
                }
            )
        return rows


def count_cycles(curve=paper.CURVE, *, steps=12) -> Timing:
    """Run the first 5 to 1000 steps in the simulated Verilog, in each arrangement, and count.

    The feed is the paper's, with ramps of 40 mm/s².
    """
    as_kind("curve", curve, NurbsCurve)
    steps, period_s = as_count("steps", steps, STARTED + 1, 1000), paper.PERIOD_S
    feed = plan_feed(curve, speed=paper.SPEED, acceleration=40.0, tangential_only=True, period_s=period_s)
    # The run is cut short, so its last step may be as long as the curve.
    plan = build_program(curve, feed, period_s, steps, largest_step=np.ptp(curve.control_points) + 1.0)
    cycles = {}
    for name in ARRANGEMENTS:
        run = simulate_path(plan, arrangement=name)
        if len(run.u) <= steps:
            raise ValueError(f"the curve ends before step {steps}: give fewer steps or a lower speed")
        cycles[name] = np.diff(run.clocks[:steps], prepend=0)
    return Timing(cycles)


def operations(*, cached=False) -> np.ndarray:
    """Additions, products, quotients and roots of one parameter: see `estimate_s`."""
    points, slopes = (1, 1) if as_flag("cached", cached) else (8, 4)
    return points * _POINT + slopes * _SLOPE + _FORMULA


def estimate_s(*, cached=False) -> tuple:
    """Least and most time of one parameter of the paper's curve, Eq. (17), on a Cortex-M7 at 480 MHz, in s.

    ``cached`` keeps earlier points and slopes, so that one of each is new instead of eight points and four
    slopes.

    Examples
    --------
    >>> from nurbs_lab.hardware import estimate_s
    >>> low, high = estimate_s()
    >>> f"{1e6 * low:.1f} to {1e6 * high:.1f} microseconds"
    '3.0 to 4.9 microseconds'
    """
    return tuple((_M7_CYCLES @ operations(cached=cached) / _M7_HZ).tolist())


@kernel
def _serial(spans, u, v, period, out):
    """Eq. (17) as printed: two points for each of four quotients."""
    for j in range(4, u.size):
        total = 0.0
        for i in range(4):
            before, after = u[j - i - 1], u[j - i]
            a = point(spans, find_span(spans[0], before, 0), before)
            b = point(spans, find_span(spans[0], after, 0), after)
            chord = np.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2)
            total += ADAMS[i] / 24.0 * v / (chord / (after - before))
        out[j] = u[j] + period * total


def serial_parameters(path):
    """The parameter after each of a `ToolPath` at constant speed, from the fifth on, by eight C(u)."""
    as_kind("path", path, ToolPath)
    out = np.empty(len(path.u))
    _serial(prepare(path.curve).spans, path.u, float(path.feed.speed(path.t[1])), path.period_s, out)
    return out[4:]


def measure_s(path):
    """Time of one parameter of `serial_parameters` on this machine's core, in s: the best of some runs."""
    times = []
    for _ in range(6):
        start = time.process_time()
        serial_parameters(path)
        times.append(time.process_time() - start)
    return min(times) / (len(path.u) - 4)


class Accuracy(NamedTuple):
    """The path of one word length beside float64 by the same method."""

    word: int
    #: Largest difference of u at the same step, as a part of the domain; infinite if the run raised a flag.
    u_error: float
    #: Most that the fluctuation of a step, by chord, is worse than in float64; the last step is left out.
    added_fluctuation: float


def word_length_study(curve, feed, period_s, words=range(23, 37, 2), *, executor=None) -> list[Accuracy]:
    """Run the twin of the paper's scheme for several word lengths, on an executor if one is given.

    Two bits of word buy a factor of about four. With 35 the paper's path is below 1e-8 in u, and four
    18 x 18 multipliers take no more bits: that is why 35 is shipped.
    """
    formats = [Format(as_integer("words", word)) for word in as_sequence("words", words)]
    reference = trace(curve, feed, stepper="paper", period_s=period_s)
    run = partial(_accuracy, curve, feed, period_s, reference)
    return map_items(run, formats, executor, what="word length")


def _accuracy(curve, feed, period_s, reference, format):
    first, last = curve.domain
    plan = build_program(curve, feed, period_s, len(reference.moved), format=format)
    result = run_twin(plan)
    u = np.clip(plan.curve.from_u(result.u), first, last)
    common = min(len(u), len(reference.u)) - 1
    chord = np.linalg.norm(np.diff(curve(u[:common]), axis=0), axis=1)
    worse = np.abs(chord - reference.chord[: common - 1]) / reference.commanded[: common - 1]
    error = np.inf if result.flags else np.abs(u[:common] - reference.u[:common]).max() / (last - first)
    return Accuracy(format.word, float(error), float(worse.max(initial=0.0)))
