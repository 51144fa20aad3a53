"""A long program planned in windows, in a process of its own: ``python -m benchmarks.long_program 131``."""

from __future__ import annotations

import re
import sys
import time
from functools import reduce
from pathlib import Path

import numpy as np

import nurbs_lab as nl

LIMITS = {"speed": 100.0, "acceleration": 2000.0, "jerk": 1e5, "chord_error": 1e-3, "period_s": 1e-3}
LIMITS |= {"axis_acceleration": 1500.0}


def measure(count):
    """Figures of a program of so many curves.

    They are: periods, seconds, seconds to the first window, peak memory in MB, and by what part the motion of
    a short program lasts longer than planned as one.
    """
    short, *_ = _planned(4)
    figures = *_planned(count), _peak_memory()
    whole = nl.plan_feed(reduce(nl.NurbsCurve.join, _waves(4)), **LIMITS)
    return *figures, short * LIMITS["period_s"] / whole.duration - 1


def _planned(count):
    """Periods of a plan in windows, and how long it takes: in all, and up to the end of the first window."""
    start, first, periods = time.perf_counter(), None, 0.0
    for _, feed in nl.motion.plan_windows(_waves(count), **LIMITS):
        first = first or time.perf_counter() - start
        periods += feed.duration / LIMITS["period_s"]
    return periods, time.perf_counter() - start, first


def _peak_memory():
    return int(re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[1]) / 1024


def _waves(count):
    """Curves of 300 spans, one after the other with equal tangents."""
    x, slope = 2.0 * np.arange(301), np.pi * (15.0 / 60.0 + 4.0 / 15.0)
    y = 15.0 * np.sin(np.pi * x / 60.0) + 4.0 * np.sin(np.pi * x / 15.0)
    for k in range(count):
        yield nl.interpolate_curve(
            np.column_stack([x + 600.0 * k, y]), tangents=dict.fromkeys((0, -1), (1.0, slope))
        )


if __name__ == "__main__":
    print(*measure(int(sys.argv[1])))
