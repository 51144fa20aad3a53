"""The paper's comparison of FPGA and CPU: the time of one parameter of Eq. (17) or (20) on a processor.

The paper means a program that evaluates C(u) eight times, one after the other, for every parameter. Here
such a program is measured. On a microcontroller it is estimated: its floating-point operations are counted,
times published cycles; loads, stores and branches are left out, so an estimate is a range.
"""

import time
from typing import NamedTuple

import numpy as np

from nurbs_lab import paper
from nurbs_lab.common.checks import as_choice, as_kind
from nurbs_lab.motion import ToolPath
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.nurbs.span_kernels import find_span, kernel, point

#: Additions, products, quotients and roots of a point of the paper's curve by Cox-de Boor (The NURBS Book,
#: A2.2 and A3.1; degree 2, plane), and of a slope beyond its points.
_POINT, _SLOPE = np.array([14, 12, 3, 0]), np.array([4, 2, 2, 1])
#: The same of Eqs. (17) and (20) themselves.
_FORMULAS = {"adams": (4, 5, 0, 0), "runge-kutta": (10, 8, 0, 0)}


class Processor(NamedTuple):
    """A microcontroller core: cycles of an addition, a product, a quotient and a root, least and most."""

    name: str
    clock_hz: float
    least: tuple
    most: tuple


#: In double precision, as the place of a tool needs 35 bits. At least: one operation a cycle. At most: each
#: waits for the result of the one before. Source: LLVM, ARMScheduleM7.td; Arm itself publishes no table.
CORTEX_M7 = Processor("Cortex-M7 at 480 MHz", 480e6, (1, 2, 30, 30), (4, 7, 30, 30))


def operations(formula, *, cached=False) -> np.ndarray:
    """Additions, products, quotients and roots of one parameter: see `estimate_s`."""
    as_choice("formula", formula, _FORMULAS)
    if cached and formula != "adams":
        raise ValueError(f"cached must be False with formula {formula!r}: each of its points is new")
    points, slopes = (1, 1) if cached else (8, 4)
    return points * _POINT + slopes * _SLOPE + _FORMULAS[formula]


def estimate_s(formula, processor, *, cached=False) -> tuple:
    """Time of one parameter of the paper's curve on a `Processor`, an estimate: (at least, at most), in s.

    Parameters
    ----------
    formula : {'adams', 'runge-kutta'}
        Eq. (17) or Eq. (20).
    processor : Processor
        Such as ``CORTEX_M7``.
    cached : bool
        Whether earlier points and slopes are kept ('adams' only), so that one of each is new instead of
        eight points and four slopes.

    Examples
    --------
    >>> from nurbs_lab.hardware import CORTEX_M7, estimate_s
    >>> low, high = estimate_s("adams", CORTEX_M7)
    >>> f"{1e6 * low:.1f} to {1e6 * high:.1f} microseconds"
    '3.0 to 4.9 microseconds'
    """
    as_kind("processor", processor, Processor)
    counts = operations(formula, cached=cached)
    return tuple(float(counts @ cycles) / processor.clock_hz for cycles in (processor.least, processor.most))


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
    as_choice("formula", formula, _FORMULAS)
    as_kind("path", path, ToolPath)
    out = np.empty(len(path.u))
    speed = float(path.feed.speed(path.t[1]))
    _serial(prepare(path.curve).spans, path.u, speed, path.period_s, formula == "adams", out)
    return out[4:]


def measure_s(formula, path):
    """Time of one parameter of `serial_parameters` on this machine's core, in s: the best of some runs."""
    times = []
    for _ in range(6):
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
