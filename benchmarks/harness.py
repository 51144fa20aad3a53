"""Timing that can be trusted on a noisy machine: interleaved repeats in one run, medians, ratios.

A room's file (``nurbs.py``, ``mesh.py``, ``motion.py``, ``hardware.py``) offers ``rows() -> list[Row]``;
``python -m benchmarks`` runs them all and writes ``results.json``.
"""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median

#: One timing lasts at least so long, in s.
SHORTEST_S = 5e-3
#: Before each timing of a call that lasts no longer, in s, it is called again and again for half that time.
SHORT_S = 1.0
#: A call that lasts longer is its own warm-up, in s: what it loads and compiles is a small part of it.
LONGEST_S = 10.0


@dataclass(frozen=True)
class Bar:
    """What a ratio must reach: ``peer`` takes at least ``factor`` times as long as we do."""

    peer: str
    factor: float


@dataclass(frozen=True)
class Row:
    """One line of a table: some work, our time, the peers' times, and the bars.

    Attributes
    ----------
    room, work : str
        Where it belongs and what is done.
    seconds : dict
        Median wall time in s, by contestant; ours is ``"nurbs_lab"``.
    bars : tuple of Bar
        The ratios asked for.
    first_call : float or None
        Time of our first call in this process, in s: it includes loading cached kernels.
    notes : str
        What a fair reader must know: a peer's worse answer, fewer repeats, a missing package.
    reason : str
        Why a bar is missed, if one may be.
    answers : dict
        How good each contestant's answer is, by contestant: ``measure`` says in what.
    figures : dict
        Other measured numbers (errors, counts), by name with unit.
    most : dict
        How large a figure may be at most, by its name; ``"seconds"`` is our time.
    """

    room: str
    work: str
    seconds: dict[str, float]
    bars: tuple[Bar, ...] = ()
    first_call: float | None = None
    notes: str = ""
    reason: str = ""
    measure: str = ""
    answers: dict[str, float] = field(default_factory=dict)
    figures: dict[str, float] = field(default_factory=dict)
    most: dict[str, float] = field(default_factory=dict)

    def ratio(self, peer: str) -> float:
        """How many times longer the peer takes."""
        return self.seconds[peer] / self.seconds["nurbs_lab"]

    def missed(self) -> list[str]:
        """The bars not reached, of the peers that took part and of the figures."""
        figures = self.figures | {"seconds": self.seconds["nurbs_lab"]}
        slow = [bar for bar in self.bars if bar.peer in self.seconds and self.ratio(bar.peer) < bar.factor]
        large = [name for name, most in self.most.items() if not figures[name] <= most]
        return [
            *(f"{bar.peer} {self.ratio(bar.peer):.3g} × instead of {bar.factor:g} ×" for bar in slow),
            *(f"{name} {figures[name]:.3g} instead of at most {self.most[name]:g}" for name in large),
        ]


def medians(contestants: dict[str, Callable[[], object]], *, repeats: int = 7, budget_s: float = 20.0):
    """Median wall time of each callable, run in turn A B C A B C ... so that drift hits all alike.

    A short call is repeated back to back until one timing lasts `SHORTEST_S`, and one of up to `SHORT_S` is
    called for half a second before it is timed: else it would measure the cold caches, and the memory given
    back to the system, that the previous contestant left. A long one is timed less often: each gets about
    ``budget_s`` in all, but always one warm-up call, which is not counted, and one that is. A call of more
    than `LONGEST_S` is both.

    Returns
    -------
    seconds : dict
        Median of one call per name.
    first : dict
        The first, cold call per name.
    """
    first, loops, times = {}, {}, {}
    for name, call in contestants.items():
        first[name] = _timing(call)
        loops[name], seconds = _calibrate(call) if first[name] <= LONGEST_S else (1, first[name])
        times[name] = [seconds]
    for _ in range(repeats - 1):
        for name, call in contestants.items():
            done = times[name]
            if loops[name] * (sum(done) + sum(done) / len(done)) <= budget_s:
                if first[name] <= SHORT_S:
                    _warm(call)
                done.append(_timing(call, loops[name]))
    return {name: median(values) for name, values in times.items()}, first


def compare(room, work, contestants, bars=(), *, judges=None, repeats=7, budget_s=20.0, **rest) -> Row:
    """Time the contestants (``"nurbs_lab"`` and its peers); ``rest`` are further fields of their `Row`.

    ``judges`` say how good the results are, by contestant; they are asked after the timing, so that our first
    call stays the first.
    """
    seconds, first = medians(contestants, repeats=repeats, budget_s=budget_s)
    answers = {name: judge(contestants[name]()) for name, judge in (judges or {}).items()}
    return Row(room, work, seconds, tuple(bars), first.get("nurbs_lab"), answers=answers, **rest)


def _warm(call):
    begun = time.perf_counter()
    while time.perf_counter() - begun < SHORT_S / 2:
        call()


def _calibrate(call) -> tuple[int, float]:
    """How many calls in a row last `SHORTEST_S`, and the time of one of them."""
    loops, seconds = 1, _timing(call)
    while loops * seconds < SHORTEST_S:
        loops = math.ceil(1.2 * SHORTEST_S / seconds)
        seconds = _timing(call, loops)
    return loops, seconds


def _timing(call, loops=1) -> float:
    """Wall time of one of ``loops`` calls in a row; the garbage collector waits meanwhile, as in `timeit`."""
    gc.collect()
    gc.disable()
    try:
        start = time.perf_counter()
        for _ in range(loops):
            call()
        return (time.perf_counter() - start) / loops
    finally:
        gc.enable()
