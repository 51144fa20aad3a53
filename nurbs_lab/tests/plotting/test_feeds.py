"""Pictures of feed planning show the geometry and the causes that they were given."""

import numpy as np
import pytest

import nurbs_lab as nl


def test_the_chord_error_is_as_pythagoras_says():
    figure = nl.plotting.chord_error()
    named = {line.get_label(): np.array(line.get_data()) for line in figure.axes[0].lines}
    assert np.ptp(named["chord of one period"][0]) == pytest.approx(1.1)
    assert np.ptp(named["chord error ε"][1]) == pytest.approx(1 - np.sqrt(1 - 0.55**2))
    assert np.hypot(*named["curve"]) == pytest.approx(np.ones(200))


def test_every_chord_is_drawn_once_under_the_limit_that_binds():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4, acceleration=40, period_s=0.01)
    path = nl.trace(nl.paper.CURVE, feed, stepper="rk4")
    ax = nl.plotting.binding(path).axes[0]
    limits = feed.limiting(path.t[1:])
    names = [line.get_label().split(", ")[0] for line in ax.lines]
    assert names == ["speed", "acceleration"]
    for line, name in zip(ax.lines, names, strict=True):
        mine = limits == name
        assert line.get_label() == f"{name}, {100 * mine.mean():.0f} %"
        np.testing.assert_array_equal(line.get_xydata()[0::3], path.points[:-1][mine])
        np.testing.assert_array_equal(line.get_xydata()[1::3], path.points[1:][mine])
    assert ax.get_xlabel() == "x [mm]"
