"""Whole tool paths through nurbs_interpolator in Icarus alone: every period equals that of the twin."""

import pytest

from nurbs_lab import paper, plan_feed
from nurbs_lab.hardware import build_program, run_twin, simulate_path
from nurbs_lab.motion import benchmark_curves

#: Arrangement, speed in mm/s, acceleration in mm/s², and points sent.
RUNS = [("cached", 4.0, 40.0, 2087), ("serial", 16.0, 400.0, 537), ("parallel", 16.0, 400.0, 537)]


def points_sent(curve, feed, periods, arrangement, period_s=1e-3):
    """Compare the run with the twin's; return how many points came."""
    hardware = build_program(curve, feed, period_s, periods)
    sent = simulate_path(hardware, arrangement=arrangement)
    expected = run_twin(hardware)
    assert (sent.u, sent.points, sent.flags) == (expected.u, expected.points, ())
    return len(sent.u)


@pytest.mark.parametrize(("arrangement", "speed", "acceleration", "points"), RUNS)
def test_the_papers_path(arrangement, speed, acceleration, points):
    feed = plan_feed(paper.CURVE, speed=speed, acceleration=acceleration, period_s=1e-3, tangential_only=True)
    assert points_sent(paper.CURVE, feed, points - 1, arrangement) == points


def test_the_butterfly():
    """51 points with weights and cusps, up to 200 mm/s: the chord error slows the feed at the cusps."""
    curve, limits = benchmark_curves()["butterfly"].curve, {"acceleration": 10_000.0, "chord_error": 1e-3}
    feed = plan_feed(curve, speed=200.0, **limits, period_s=1e-3, tangential_only=True)
    assert points_sent(curve, feed, 20_000, "cached") == 2106
