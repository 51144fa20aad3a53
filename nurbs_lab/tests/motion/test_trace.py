"""What holds for the path of every stepper."""

import numpy as np
import pytest

import nurbs_lab as nl

NAMES = list(nl.STEPPERS)


@pytest.mark.parametrize("name", NAMES)
def test_a_path_ends_exactly_at_the_end_and_never_turns_back(name):
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=2e-3)
    path = nl.trace(nl.paper.CURVE, feed, stepper=name)
    assert path.u[-1] == 1.0
    np.testing.assert_array_equal(path.points[-1], nl.paper.CURVE(1.0))
    assert (np.diff(path.u) > 0.0).all()
    assert path.arrival_time <= feed.duration
    assert len(path.t) == len(path.u) == len(path.points) == len(path.arc_fluctuation) + 1


def test_papers_experiment_in_numbers():
    path = nl.trace(nl.paper.CURVE, nl.paper.SPEED, stepper="paper", period_s=nl.paper.PERIOD_S)
    assert len(path.moved) == 1986
    assert path.length == pytest.approx(7.941806132933825, rel=1e-14)
    assert 0.001 < np.abs(path.chord_fluctuation).max() < 0.003


def test_an_unknown_stepper_is_told_the_near_names():
    with pytest.raises(ValueError, match="rk4"):
        nl.trace(nl.paper.CURVE, 4.0, stepper="rk44", period_s=1e-3)
