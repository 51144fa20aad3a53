"""The paper's comparison of FPGA and CPU: the time of one parameter of Eq. (17) or (20) on a processor.

The paper means a program that evaluates C(u) eight times, one after the other, for every parameter. Here
such a program is measured. On two microcontrollers it is estimated: its floating-point operations are
counted, times published cycles; loads, stores and branches are left out, so an estimate is a range.
"""

import time
from dataclasses import dataclass

import numpy as np

from nurbs_lab import paper
from nurbs_lab.common.checks import as_choice, as_count, as_flag, as_kind
from nurbs_lab.motion import ToolPath
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.nurbs.span_kernels import find_span, kernel, point

#: The formulas of the paper, by name.
FORMULAS = ("adams", "runge-kutta")


@dataclass(frozen=True)
class Processor:
    """A microcontroller core: bits of its floating-point unit, cycles of an operation (at least, at most)."""

    name: str
    clock_hz: float
    bits: int
    add: tuple[int, int]
    multiply: tuple[int, int]
    divide: tuple[int, int]
    root: tuple[int, int]
    source: str


#: At least: operands in registers. At most: each operation also loads one from memory (2 cycles). Single
#: precision is not enough for this task: the position of a tool needs 35 bits.
CORTEX_M4F = Processor(
    "Cortex-M4F at 168 MHz", 168e6, 32, (1, 3), (1, 3), (14, 16), (14, 16),
    "Arm DDI 0439, Cortex-M4 Technical Reference Manual, FPU instruction set: VADD and VMUL 1, VDIV and "
    "VSQRT 14, VLDR 2",
)  # fmt: skip
#: At least: one operation a cycle. At most: each waits for the result of the one before.
CORTEX_M7 = Processor(
    "Cortex-M7 at 480 MHz", 480e6, 64, (1, 4), (2, 7), (30, 30), (30, 30),
    "LLVM, ARMScheduleM7.td, latencies in double precision: add 4, multiply 7, divide and root 30; Arm "
    "itself publishes no table",
)  # fmt: skip


def operations(formula, *, cached=False, degree=2, dim=2):
    """Floating-point operations of one parameter: a dict of ``add``, ``multiply``, ``divide`` and ``root``.

    A point by Cox-de Boor (The NURBS Book, A2.2 and A3.1): 2p differences, p (p + 1) / 2 times two sums, two
    products and a division, then p + 1 products and p sums a coordinate. A quotient adds the distance of two
    points, a difference of u and two divisions; the formula itself the rest.

    Parameters
    ----------
    formula : {'adams', 'runge-kutta'}
        Eq. (17) or Eq. (20).
    cached : bool
        Whether earlier points and quotients are kept ('adams' only), so that one of each is new instead of
        eight points and four quotients.
    degree, dim : int

    Examples
    --------
    >>> from nurbs_lab.hardware import operations
    >>> operations("adams", cached=True)
    {'add': 22, 'multiply': 19, 'divide': 5, 'root': 1}
    """
    as_choice("formula", formula, FORMULAS)
    if as_flag("cached", cached) and formula != "adams":
        raise ValueError(f"cached must be False with formula {formula!r}: each of its points is new")
    degree, dim = as_count("degree", degree, 1, 30), as_count("dim", dim, 2, 3)
    inner = degree * (degree + 1) // 2
    points, quotients = (1, 1) if cached else (8, 4)
    add = points * (2 * degree + 2 * inner + degree * dim) + quotients * 2 * dim + 4
    multiply = points * (2 * inner + (degree + 1) * dim) + quotients * dim + 5
    if formula == "runge-kutta":  # u and the point before moved by h for K2, K3 and K4
        add, multiply = add + 6, multiply + 3
    return {"add": add, "multiply": multiply, "divide": points * inner + 2 * quotients, "root": quotients}


def estimate_s(formula, processor, *, cached=False, degree=2, dim=2):
    """Time of one parameter on a `Processor`, an estimate: (at least, at most), in s; see `operations`.

    Examples
    --------
    >>> from nurbs_lab.hardware import CORTEX_M7, estimate_s
    >>> low, high = estimate_s("adams", CORTEX_M7)
    >>> f"{1e6 * low:.1f} to {1e6 * high:.1f} microseconds"
    '3.0 to 4.9 microseconds'
    """
    as_kind("processor", processor, Processor)
    counts = operations(formula, cached=cached, degree=degree, dim=dim)
    cycles = (sum(n * getattr(processor, kind)[side] for kind, n in counts.items()) for side in (0, 1))
    return tuple(each / processor.clock_hz for each in cycles)


@kernel
def _quotient(spans, before, after, width):
    a = point(spans, find_span(spans[0], before, 0), before)
    b = point(spans, find_span(spans[0], after, 0), after)
    return np.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2 + (b[2] - a[2]) ** 2) / width


@kernel
def _serial(spans, u, v, period, adams, out):
    """Eq. (17) as printed, or Eq. (20), mended: two points for each of four quotients."""
    for j in range(4, u.size):
        total, h, width = 0.0, 0.0, u[j] - u[j - 1]
        for i in range(4):
            if adams:
                before, after = u[j - i - 1], u[j - i]
                factor = (55.0, -59.0, 37.0, -9.0)[i] / 24.0
                total += factor * v / _quotient(spans, before, after, after - before)
            else:
                k = v / _quotient(spans, u[j - 1] + h, u[j] + h, width)
                total += (1.0, 2.0, 2.0, 1.0)[i] / 6.0 * k
                h = (0.5, 0.5, 1.0, 0.0)[i] * period * k
        out[j] = u[j] + period * total


def serial_parameters(formula, path):
    """The parameter after each of a path at constant speed, from the fifth on, by eight evaluations of C(u).

    Parameters
    ----------
    formula : {'adams', 'runge-kutta'}
    path : ToolPath
    """
    as_choice("formula", formula, FORMULAS)
    as_kind("path", path, ToolPath)
    out = np.empty(len(path.u))
    speed = float(path.feed.speed(path.t[1]))
    _serial(prepare(path.curve).spans, path.u, speed, path.period_s, formula == "adams", out)
    return out[4:]


def measure_s(formula, path, *, repeats=5):
    """Time of one parameter of `serial_parameters` on this machine's core, in s: the best of some runs."""
    repeats, times = as_count("repeats", repeats), []
    serial_parameters(formula, path)
    for _ in range(repeats):
        start = time.process_time()
        serial_parameters(formula, path)
        times.append(time.process_time() - start)
    return min(times) / (len(path.u) - 4)


def paper_times_s():
    """The paper's time of each parameter, in s, from T = 205 µs for C(u) and one clock of 0.02 µs.

    A dict: 'serial' (8 T), 'parallel runge-kutta' (4 T + 5 dt), 'parallel adams' (T + dt, as the paper has
    it), and 'parallel adams, two cycles' (T + 2 dt: Kout and ui_out take one cycle each, which the paper
    counts for Runge-Kutta but not for Adams).
    """
    cu, tick = paper.CU_TIME_S, 1.0 / paper.CLOCK_HZ
    parts = {"serial": (8, 0), "parallel runge-kutta": (4, 5), "parallel adams": (1, 1)}
    parts["parallel adams, two cycles"] = (1, 2)
    return {name: points * cu + ticks * tick for name, (points, ticks) in parts.items()}
