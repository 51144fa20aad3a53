"""The harness under a clock of its own: contestants of known cost, so every figure is known in advance."""

import pytest

from benchmarks import harness
from benchmarks.harness import Bar, compare, medians


class Clock:
    """Time passes only while a contestant works."""

    def __init__(self):
        self.now = 0.0
        self.calls = []

    def contestant(self, name, *costs):
        """Takes ``costs`` in turn, then the last one for ever."""
        left = list(costs)

        def work():
            self.calls.append(name)
            self.now += left.pop(0) if len(left) > 1 else left[0]

        return work


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(harness.time, "perf_counter", lambda: clock.now)
    monkeypatch.setattr(harness.gc, "collect", lambda: None)  # late in a long test run it takes a second
    return clock


def test_median_and_first_call(clock):
    seconds, first = medians({"a": clock.contestant("a", 3.0, 0.1, 0.2, 0.9, 0.3, 0.4)}, repeats=5)
    assert first["a"] == pytest.approx(3.0)
    assert seconds["a"] == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("each_s", "turn"), [(2.0, "abc"), (0.5, "aabbcc"), (0.125, "a" * 5 + "b" * 5 + "c" * 5)]
)
def test_contestants_take_turns(clock, each_s, turn):
    medians({name: clock.contestant(name, each_s) for name in "abc"}, repeats=3)
    assert (
        "".join(clock.calls) == "aabbcc" + turn * 2
    )  # a cold and a warm call, then in turn, short ones warmed


def test_bars(clock):
    contestants = {"nurbs_lab": clock.contestant("us", 0.1), "peer": clock.contestant("peer", 0.3)}
    bars = [Bar("peer", 2), Bar("peer", 4), Bar("absent", 9)]
    most = {"seconds": 0.05, "error": 1.0, "gap": 1.0}
    judges = {"peer": lambda result: 7.0 if result is None and clock.calls[-1] == "peer" else 0.0}
    figures = {"error": 2.0, "gap": 0.5}
    row = compare("room", "work", contestants, bars, judges=judges, figures=figures, most=most)
    assert row.answers == {"peer": 7.0}
    assert row.ratio("peer") == pytest.approx(3.0)
    assert row.missed() == [
        "peer 3 × instead of 4 ×",
        "seconds 0.1 instead of at most 0.05",
        "error 2 instead of at most 1",
    ]
