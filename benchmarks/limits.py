"""What one core of this machine can do at best: the yardsticks for the distance to the limit.

A row's figures state what its work must do at least:

``bytes``
    what is read and written, each pass over the data counted once: held against a long copy;
``operations``
    additions, multiplications and divisions that may run side by side: against vectorized multiply-adds;
``chained``, ``roots``
    additions and multiplications, divisions and square roots of which each waits for the one before: against
    the same in one dependent chain;
``walk_s``
    a time measured by the row itself, of the bare reads that each wait for the one before.

The least time is the longest of copying, arithmetic, chain and walk: they can overlap.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

from benchmarks.harness import medians

#: Figures of a row that say the least it must do.
LEAST = ("bytes", "operations", "chained", "roots", "walk_s")


@njit
def _multiply_add(values, rounds):
    """Sixteen multiply-adds on every value: the values side by side, so that their latency hides."""
    for _ in range(rounds):
        for i in range(values.size):
            x = values[i]
            for _ in range(16):
                x = x * 0.999 + 1e-3
            values[i] = x


@njit
def _chain(x, rounds):
    for _ in range(rounds):
        x = x * 0.999 + 1e-3
    return x


@njit(error_model="numpy")
def _root_chain(x, rounds):
    for _ in range(rounds):
        x = sqrt(2.0 / x)
    return x


def measure() -> dict[str, float]:
    """Bytes (read and written), operations, chained operations and chained roots a second, of one core."""
    source = np.ones(16_000_000)
    target = np.empty_like(source)
    values = np.ones(256)
    seconds, _ = medians(
        {
            "copy": lambda: np.copyto(target, source),
            "arithmetic": lambda: _multiply_add(values, 10_000),
            "chain": lambda: _chain(2.0, 5_000_000),
            "roots": lambda: _root_chain(3.0, 1_000_000),
        },
        repeats=15,
    )
    return {
        "bytes_per_s": 2 * source.nbytes / seconds["copy"],
        "operations_per_s": 2 * 16 * values.size * 10_000 / seconds["arithmetic"],
        "chained_per_s": 2 * 5_000_000 / seconds["chain"],
        "roots_per_s": 2 * 1_000_000 / seconds["roots"],
    }


def least_times(figures: dict[str, float], limits: dict[str, float]) -> dict[str, float]:
    """The least time in s by each limit that the row's figures state."""
    need = {name: figures[name] / limits[f"{name}_per_s"] for name in LEAST[:4] if name in figures}
    times = {}
    if "bytes" in need:
        times["copying"] = need["bytes"]
    if "operations" in need:
        times["arithmetic"] = need["operations"]
    if "chained" in need:
        times["chain"] = need["chained"] + need["roots"]
    if "walk_s" in figures:
        times["walk"] = figures["walk_s"]
    return times
