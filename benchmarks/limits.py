"""What this machine can do at best: the yardstick for the distance to the limit."""

from __future__ import annotations

import numpy as np
from numba import njit

from benchmarks.harness import medians

#: Figures of a row that say the least it must move and compute.
LEAST = ("bytes", "operations")


@njit
def _multiply_add(rounds):
    """16 independent chains, so that the adders and not their latency set the pace."""
    a = np.full(16, 1.0)
    for _ in range(rounds):
        for i in range(16):
            a[i] = a[i] * 0.999999999 + 1e-9
    return a.sum()


def measure() -> dict[str, float]:
    """Copy bandwidth in bytes/s (read plus write) and one core's multiply-add rate in operations/s."""
    source = np.ones(16_000_000)
    target = np.empty_like(source)
    rounds = 4_000_000
    seconds, _ = medians(
        {"copy": lambda: np.copyto(target, source), "arithmetic": lambda: _multiply_add(rounds)}
    )
    return {
        "bytes_per_s": 2 * source.nbytes / seconds["copy"],
        "operations_per_s": 2 * 16 * rounds / seconds["arithmetic"],
    }


def share(row: dict, limits: dict[str, float]) -> float | None:
    """The least time that the row's bytes and operations could take, as a share of the time it took."""
    figures = row["figures"]
    least = [figures[name] / limits[f"{name}_per_s"] for name in LEAST if name in figures]
    return max(least) / row["seconds"]["nurbs_lab"] if least else None
