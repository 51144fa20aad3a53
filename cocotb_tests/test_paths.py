"""Whole tool paths through nurbs_interpolator in Icarus alone: every period equals that of the twin."""

import pytest

from nurbs_lab import paper, plan_feed
from nurbs_lab.hardware import build_program, run_twin, simulate_path
from nurbs_lab.motion import benchmark_curves

#: Arrangement, slope, points that the corrector tries, speed in mm/s, acceleration in mm/s², and points sent.
#: Long runs are made at more than the paper's speed; the corrector is the same in all arrangements.
RUNS = [
    ("cached", "quotient", 0, 4.0, 40.0, 2087),
    ("cached", "quotient", 1, 8.0, 40.0, 1193),
    ("cached", "history", 0, 16.0, 400.0, 538),
    ("cached", "history", 1, 16.0, 400.0, 538),
    ("serial", "quotient", 0, 16.0, 400.0, 537),
    ("parallel", "quotient", 0, 16.0, 400.0, 537),
]


def points_sent(curve, feed, periods, arrangement, slope, trials, period_s=1e-3):
    """Compare the run with the twin's; return how many points came, and the flags."""
    hardware = build_program(curve, feed, period_s, periods, trials=trials)
    sent = simulate_path(hardware, arrangement=arrangement, slope=slope)
    expected = run_twin(hardware, history=slope == "history")
    assert (sent.u, sent.points, sent.flags) == (expected.u, expected.points, expected.flags)
    return len(sent.u), sent.flags


@pytest.mark.parametrize(("arrangement", "slope", "trials", "speed", "acceleration", "points"), RUNS)
def test_the_papers_path(arrangement, slope, trials, speed, acceleration, points):
    feed = plan_feed(paper.CURVE, speed=speed, acceleration=acceleration, period_s=1e-3, tangential_only=True)
    assert points_sent(paper.CURVE, feed, points - 1, arrangement, slope, trials) == (points, ())


@pytest.mark.parametrize(
    ("slope", "trials", "faster", "points", "flags"),
    [
        ("quotient", 0, 1, 2106, ()),
        ("quotient", 2, 2, 774, ()),
        ("history", 1, 1, 2108, ()),
        # Points kept from before a cusp can point back: the run says so and stops.
        ("history", 0, 1, 47, ("backward",)),
    ],
)
def test_the_butterfly(slope, trials, faster, points, flags):
    """51 points with weights and cusps, up to 400 mm/s: the chord error slows the feed at the cusps."""
    curve, period_s = benchmark_curves()["butterfly"].curve, faster * 1e-3
    feed = plan_feed(
        curve,
        speed=faster * 200.0,
        acceleration=10_000.0,
        chord_error=faster**2 * 1e-3,
        period_s=period_s,
        tangential_only=True,
    )
    assert points_sent(curve, feed, 20_000, "cached", slope, trials, period_s) == (points, flags)
