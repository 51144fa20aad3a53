"""The paper's comparison of FPGA and CPU: the time of one parameter of Eq. (17) or (20) on a processor.

The paper means a program that evaluates C(u) eight times, one after the other, for every parameter. On the
machine at hand such a program is measured. On two microcontrollers it is estimated: the floating-point
operations are counted and multiplied by published cycles. The count leaves out loads, stores and branches,
so every estimate is a range.
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
    """A microcontroller core with a floating-point unit.

    Attributes
    ----------
    name : str
    clock_hz : float
    bits : int
        Of the floating-point numbers that its unit computes with.
    add, multiply, divide, root : tuple of int
        Cycles of an operation: at least and at most.
    source : str
    """

    name: str
    clock_hz: float
    bits: int
    add: tuple[int, int]
    multiply: tuple[int, int]
    divide: tuple[int, int]
    root: tuple[int, int]
    source: str


#: At least: operands in registers. At most: each operation also loads one from memory (2 cycles).
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
    """Floating-point operations of one parameter.

    As the paper counts, eight evaluations of C(u) are made one after the other. A program may also keep what
    it knows: Eq. (17) then needs one new point and one new quotient.

    A point by Cox-de Boor (The NURBS Book, A2.2 and A3.1): 2p differences, p (p + 1) / 2 times two sums, two
    products and a division, then p + 1 products and p sums a coordinate. A quotient adds the distance of two
    points, a difference of u and two divisions; the formula itself the rest.

    Parameters
    ----------
    formula : {'adams', 'runge-kutta'}
        Eq. (17) or Eq. (20).
    cached : bool
        Whether the points and quotients of earlier steps are kept; with 'adams' only.
    degree, dim : int

    Returns
    -------
    dict
        ``add``, ``multiply``, ``divide`` and ``root``.

    Examples
    --------
    >>> from nurbs_lab.hardware import operations
    >>> operations("adams")
    {'add': 132, 'multiply': 109, 'divide': 32, 'root': 4}
    >>> operations("adams", cached=True)
    {'add': 22, 'multiply': 19, 'divide': 5, 'root': 1}
    """
    as_choice("formula", formula, FORMULAS)
    if as_flag("cached", cached) and formula != "adams":
        raise ValueError(f"cached must be False with formula {formula!r}: each of its points is new")
    degree, dim = as_count("degree", degree, 1, 30), as_count("dim", dim, 2, 3)
    inner = degree * (degree + 1) // 2
    point_add = 2 * degree + 2 * inner + degree * dim
    point_multiply = 2 * inner + (degree + 1) * dim
    points, quotients = (1, 1) if cached else (8, 4)
    add = points * point_add + quotients * 2 * dim + 4
    multiply = points * point_multiply + quotients * dim + 5
    if formula == "runge-kutta":  # u and the point before moved by h for K2, K3 and K4
        add, multiply = add + 6, multiply + 3
    return {"add": add, "multiply": multiply, "divide": points * inner + 2 * quotients, "root": quotients}


def estimate_s(formula, processor, *, cached=False, degree=2, dim=2):
    """Time of one parameter on a microcontroller, an estimate: (at least, at most), in s.

    Parameters
    ----------
    formula : {'adams', 'runge-kutta'}
    processor : Processor
    cached : bool
    degree, dim : int
        As for ``operations``.

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
def _adams(spans, u, j, v, period):
    """Eq. (17) as it is printed: two points for each of its four quotients."""
    total = 0.0
    for i, factor in enumerate((55.0, -59.0, 37.0, -9.0)):
        before, after = u[j - i - 1], u[j - i]
        total += factor * v / _quotient(spans, before, after, after - before)
    return u[j] + period / 24.0 * total


@kernel
def _runge_kutta(spans, u, j, v, period):
    """Eq. (20), mended: two points for each of its four quotients."""
    width = u[j] - u[j - 1]
    k1 = v / _quotient(spans, u[j - 1], u[j], width)
    h = 0.5 * period * k1
    k2 = v / _quotient(spans, u[j - 1] + h, u[j] + h, width)
    h = 0.5 * period * k2
    k3 = v / _quotient(spans, u[j - 1] + h, u[j] + h, width)
    h = period * k3
    k4 = v / _quotient(spans, u[j - 1] + h, u[j] + h, width)
    return u[j] + period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@kernel
def _serial(spans, u, v, period, adams, out):
    for j in range(4, u.size):
        out[j] = _adams(spans, u, j, v, period) if adams else _runge_kutta(spans, u, j, v, period)


def serial_parameters(formula, path):
    """The parameter that follows each of a path at constant speed, by eight serial evaluations of C(u).

    Parameters
    ----------
    formula : {'adams', 'runge-kutta'}
    path : ToolPath
        At constant speed; the first four parameters have too little past.

    Returns
    -------
    ndarray, shape (n,)
        For the parameters from the fifth on.
    """
    as_choice("formula", formula, FORMULAS)
    as_kind("path", path, ToolPath)
    out = np.empty(len(path.u))
    speed = float(path.feed.speed(path.t[1]))
    _serial(prepare(path.curve).spans, path.u, speed, path.period_s, formula == "adams", out)
    return out[4:]


def measure_s(formula, path, *, repeats=5):
    """Time of one parameter on this machine's core, in s: the best of some runs over the whole path.

    Parameters
    ----------
    formula : {'adams', 'runge-kutta'}
    path : ToolPath
    repeats : int
    """
    repeats, times = as_count("repeats", repeats), []
    serial_parameters(formula, path)
    for _ in range(repeats):
        start = time.process_time()
        serial_parameters(formula, path)
        times.append(time.process_time() - start)
    return min(times) / (len(path.u) - 4)


def paper_times_s():
    """The paper's time of each parameter, in s, from T = 205 µs for C(u) and one clock of 0.02 µs.

    Returns
    -------
    dict
        'serial' (8 T), 'parallel runge-kutta' (4 T + 5 dt), 'parallel adams' (T + dt, as the paper has it),
        and 'parallel adams, two cycles' (T + 2 dt: Kout and ui_out take one cycle each, which the paper
        counts for Runge-Kutta but not for Adams).

    Examples
    --------
    >>> from nurbs_lab.hardware import paper_times_s
    >>> [round(1e6 * time, 2) for time in paper_times_s().values()]
    [1640.0, 820.1, 205.02, 205.04]
    """
    cu, tick = paper.CU_TIME_S, 1.0 / paper.CLOCK_HZ
    return {
        "serial": 8 * cu,
        "parallel runge-kutta": 4 * cu + 5 * tick,
        "parallel adams": cu + tick,
        "parallel adams, two cycles": cu + 2 * tick,
    }
