"""plan_feed against closed forms, and its refusals."""

import numpy as np
import pytest

import nurbs_lab as nl

LINE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0, 0), (6, 8, 0)])


def test_trapezoid_on_a_line_takes_the_closed_form_time():
    feed = nl.plan_feed(LINE, speed=4.0, acceleration=40.0, period_s=1e-3)
    ideal = 10.0 / 4.0 + 4.0 / 40.0
    assert ideal <= feed.duration < ideal + 1e-3
    assert feed.displacement(feed.duration) == pytest.approx(10.0, rel=1e-12)
    assert feed.speed(0.0) == 0.0
    assert feed.speed(feed.duration) == 0.0


def test_duration_is_a_whole_number_of_periods():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, chord_error=1e-3, period_s=1e-3)
    periods = feed.duration / 1e-3
    assert periods == pytest.approx(round(periods), abs=1e-9)


def test_bends_hold_the_speed_down_where_they_are():
    feed = nl.plan_feed(nl.paper.CURVE, speed=40.0, acceleration=4000.0, chord_error=1e-5, period_s=1e-3)
    t = np.linspace(0.0, feed.duration, 1001)
    assert {"chord_error", "acceleration"} <= set(feed.limiting(t))
    path = nl.trace(nl.paper.CURVE, feed, stepper="rk4")
    assert path.chord_error.max() <= 1e-5


@pytest.mark.parametrize(
    ("wrong", "kind"),
    [
        ({"speed": 0.0}, ValueError),
        ({"speed": "fast"}, TypeError),
        ({"acceleration": np.nan}, ValueError),
        ({"period_s": -1e-3}, ValueError),
        ({"jerk": 0.0}, ValueError),
        ({"chord_error": np.inf}, ValueError),
        ({"start_speed": 5.0}, ValueError),
        ({"end_speed": 50.0}, ValueError),
        ({"axis_speed": [1.0, 2.0]}, ValueError),
    ],
)
def test_refusals_name_the_argument(wrong, kind):
    given = {"speed": 4.0, "acceleration": 40.0, "period_s": 1e-3} | wrong
    with pytest.raises(kind, match=next(iter(wrong))):
        nl.plan_feed(LINE, **given)
