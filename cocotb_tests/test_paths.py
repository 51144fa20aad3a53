"""Whole tool paths through nurbs_interpolator in Icarus alone: every period equals that of the twin."""

from functools import cache

import pytest

from nurbs_lab import paper, plan_feed
from nurbs_lab.hardware import build_program, run_twin, simulate_path
from nurbs_lab.motion import benchmark_curves

BUILDS = [("cached", "quotient"), ("cached", "history"), ("serial", "quotient"), ("parallel", "quotient")]


@cache
def plan(name, trials):
    """The paper's curve at its feed; the butterfly, 51 points with weights and cusps, at 20 mm/s."""
    if name == "paper":
        curve, speed, acceleration, periods = paper.CURVE, paper.SPEED, 40.0, 2086
    else:
        curve, speed, acceleration, periods = benchmark_curves()[name].curve, 20.0, 2000.0, 20_000
    feed = plan_feed(curve, speed=speed, acceleration=acceleration, period_s=1e-3)
    return build_program(curve, feed, 1e-3, periods, trials=trials)


def points_sent(hardware, arrangement, slope):
    """Compare the run with the twin's; return how many points came, and the flags."""
    sent = simulate_path(hardware, arrangement=arrangement, slope=slope)
    expected = run_twin(hardware, history=slope == "history")
    assert (sent.u, sent.points, sent.flags) == (expected.u, expected.points, expected.flags)
    return len(sent.u), sent.flags


@pytest.mark.parametrize("trials", [0, 1])
@pytest.mark.parametrize(("arrangement", "slope"), BUILDS)
def test_the_papers_path(arrangement, slope, trials):
    assert points_sent(plan("paper", trials), arrangement, slope) == (2087, ())


@pytest.mark.parametrize(
    ("slope", "trials", "points", "flags"),
    [
        # At the sharpest cusp the quotient is so far behind that a step exceeds the largest one allowed.
        ("quotient", 0, 14_279, ("too_far",)),
        # Points kept from before a cusp can point back: the run says so and stops.
        ("history", 0, 4880, ("backward",)),
        ("history", 1, 4882, ("backward",)),
    ],
)
def test_the_butterfly(slope, trials, points, flags):
    assert points_sent(plan("butterfly", trials), "cached", slope) == (points, flags)
