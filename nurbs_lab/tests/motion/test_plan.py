"""plan_feed: closed forms, limits measured on the path, an independent planner, and refusals."""

import numpy as np
import pytest

import nurbs_lab as nl
from benchmarks.motion import toppra_plan
from nurbs_lab.motion import benchmark_curves, plan
from nurbs_lab.motion.limits import Limits
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.scan import scan

LINE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0, 0), (6, 8, 0)])
ALONG_X = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0, 0), (10, 0, 0)])
CORNER = nl.NurbsCurve(1, [0, 0, 1, 2, 2], [(0, 0), (10, 0), (10, 10)])
BUTTERFLY = benchmark_curves()["butterfly"].curve
ERWINSKI = [(40.0, 500.0, 2e4), (250.0, 2000.0, 2e4), (300.0, 2500.0, 5e4)]


def assert_kept(curve, feed, *, speed, acceleration, jerk=None, chord_error=None, across=None):
    """Measured: the exact path of the feed, its chords, and differences of the sampled displacement."""
    path = nl.trace(curve, feed, stepper="exact")
    period = feed.period_s
    t = np.linspace(0.0, feed.duration, 4 * len(path.u))
    assert feed.speed(t).max() <= speed
    assert np.abs(feed.acceleration(t)).max() <= acceleration
    s = feed.displacement(path.t[path.t < feed.duration + 0.5 * period])
    noise = 4e-16 * s[-1]
    assert np.abs(np.diff(s)).max() <= speed * period + noise
    assert np.abs(np.diff(s, 2)).max() <= acceleration * period**2 + 4 * noise
    if jerk is not None:
        assert np.abs(feed.jerk(t)).max() <= jerk
        assert np.abs(np.diff(s, 3)).max() <= jerk * period**3 + 8 * noise
    if chord_error is not None:
        assert path.chord_error.max() <= chord_error * (1.0 + 1e-9)
    if across is not None:
        assert (feed.speed(path.t) ** 2 * np.abs(curve.curvature(path.u))).max() <= across * (1.0 + 1e-9)


@pytest.mark.parametrize("jerk", [None, 400.0, 1e4])
@pytest.mark.parametrize(
    ("curve", "speed", "axis_acceleration", "ideal", "ramps"),
    [
        (LINE, 4.0, None, 10 / 4 + 4 / 40, 40),
        (ALONG_X, 4.0, (20.0, 1.0, 1.0), 10 / 4 + 4 / 20, 20),
        (CORNER, 8.0, (40.0, 20.0), 2 * 10 / 8 + 8 / 40 + 8 / 20, 40 + 20),  # nearly from stop to stop
    ],
)
def test_on_lines_the_time_is_that_of_the_closed_form(curve, speed, axis_acceleration, ideal, ramps, jerk):
    """Each leg has the limit of its own axis; building up and down an acceleration takes it over the jerk."""
    limits = {"speed": speed, "acceleration": 40.0 if curve is not CORNER else 100.0, "jerk": jerk}
    feed = nl.plan_feed(curve, **limits, axis_acceleration=axis_acceleration, period_s=1e-3)
    ideal += ramps / jerk if jerk else 0.0
    assert ideal - 1e-9 - 2e-3 * (curve is CORNER) <= feed.duration <= ideal + 3e-3
    assert feed.displacement(feed.duration) == pytest.approx(curve.length(), rel=1e-12)
    assert feed.speed(0.0) == feed.speed(feed.duration) == 0.0
    assert feed.speed(0.25 * feed.duration) == pytest.approx(speed, rel=1e-3)


@pytest.mark.parametrize("slow", [1e-300, 1e-12, 1e-8])
@pytest.mark.parametrize("jerk", [None, 400.0])
def test_ends_may_be_as_slow_as_one_likes(slow, jerk):
    limits = {"speed": 4.0, "acceleration": 40.0, "jerk": jerk, "chord_error": 1e-5}
    rest = nl.plan_feed(nl.paper.CURVE, **limits, period_s=1e-3)
    feed = nl.plan_feed(nl.paper.CURVE, **limits, period_s=1e-3, start_speed=slow, end_speed=slow)
    assert feed.speed(0.0) == pytest.approx(slow, rel=1e-9)
    assert feed.speed(feed.duration) == pytest.approx(slow, rel=1e-9, abs=4e-9)
    assert feed.duration == pytest.approx(rest.duration, abs=1e-9)
    assert_kept(nl.paper.CURVE, feed, **limits)


@pytest.mark.parametrize(("speed", "acceleration", "jerk"), ERWINSKI)
@pytest.mark.parametrize("soft", [False, True])
def test_no_limit_is_exceeded_on_the_butterfly(speed, acceleration, jerk, soft):
    limits = {"speed": speed, "acceleration": acceleration, "chord_error": 1e-3}
    limits |= {"jerk": jerk} if soft else {}
    across = {"centripetal_acceleration": 0.8 * acceleration}
    feed = nl.plan_feed(BUTTERFLY, period_s=1e-3, **across, **limits)
    assert_kept(BUTTERFLY, feed, across=0.8 * acceleration, **limits)


@pytest.mark.parametrize(("speed", "acceleration", "jerk"), ERWINSKI)
def test_butterfly_times_beside_toppra(speed, acceleration, jerk):
    """Same limits: within 2 % where the jerk is free; with a limit of jerk, within 0.2 % of a finer plan."""
    limits = {"speed": speed, "acceleration": acceleration, "chord_error": 1e-3, "period_s": 1e-3}
    limits["tangential_only"] = True
    free = nl.plan_feed(BUTTERFLY, **limits)
    soft = nl.plan_feed(BUTTERFLY, jerk=jerk, **limits)
    path = scan(prepare(BUTTERFLY), Limits(**limits))
    fine = np.interp(np.linspace(0.0, 1.0, 4 * len(path.u)), np.linspace(0.0, 1.0, len(path.u)), path.lengths)
    ideal = toppra_plan(path, speed, acceleration, fine)
    assert ideal * (1.0 - 1e-4) <= free.duration <= 1.02 * ideal
    assert soft.duration >= free.duration
    finest = {40.0: 9.842, 250.0: 3.335, 300.0: 2.759}[speed]  # planned once on a grid five times finer
    assert soft.duration == pytest.approx(finest, rel=0.002)


@pytest.mark.parametrize("jerk", [None, 1e4])
def test_a_corner_slows_down_as_far_as_its_step_of_velocity_asks(jerk):
    limits = {"speed": 10.0, "acceleration": 100.0, "period_s": 1e-3, "jerk": jerk}
    for across, most in (
        ({}, 0.1 / np.sqrt(2.0)),
        ({"axis_acceleration": 50.0}, 0.05),
        ({"centripetal_acceleration": 50.0}, 0.05 / np.sqrt(2.0)),
    ):
        feed = nl.plan_feed(CORNER, **across, **limits)
        passed = feed.speed(feed.time_at(10.0))
        assert (0.6 if jerk else 0.995) * most < passed <= most
        points = nl.trace(CORNER, feed, stepper="exact").points
        second = np.diff(np.vstack([points[:1], points, points[-1:]]), 2, axis=0) / 1e-6
        assert np.linalg.norm(second, axis=1).max() <= 100.0 * (1.0 + 1e-6)
        assert np.abs(second).max() <= across.get("axis_acceleration", 100.0) * (1.0 + 1e-6)
    limits["tangential_only"] = True
    rounding = nl.plan_feed(CORNER, chord_error=1e-3, **limits)
    path = nl.trace(CORNER, rounding, stepper="exact")
    assert path.chord_error.max() <= 1e-3 * (1.0 + 1e-9)
    assert nl.plan_feed(CORNER, **limits).duration < rounding.duration < feed.duration


@pytest.mark.parametrize("leg", [2.0, 5.0, 10.0, 12.0])
def test_the_speed_of_a_corner_is_held_to_the_end_on_long_paths_too(leg):
    way = np.cumsum(np.tile([0.03, -0.03], 30))
    points = np.cumsum(leg * np.column_stack([np.cos(way), np.sin(way)]), axis=0)
    most = np.array([300.0, 40.0])
    feed = nl.plan_feed(
        nl.interpolate_curve(points, 1), speed=60.0, acceleration=400.0, axis_acceleration=most, period_s=1e-3
    )
    path = nl.trace(feed.curve, feed, stepper="exact")
    assert (np.abs(np.diff(path.points, 2, axis=0)) / 1e-6 / most).max() == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("jerk", [None, 5e4])
@pytest.mark.parametrize("turn", [0.0, 1e-9, 2e-6, 1e-3, 1.0])
def test_a_kink_costs_what_its_step_of_velocity_costs(turn, jerk):
    """Two lines of 50 mm at 60 mm/s: a kink below 1/60 of a radian costs nothing, one of 1 nearly a stop."""
    points = [(0, 0), (50, 0), (50 + 50 * np.cos(turn), 50 * np.sin(turn))]
    kink = nl.NurbsCurve(1, [0, 0, 1, 2, 2], points)
    limits = nl.Limits(60.0, 1000.0, jerk, centripetal_acceleration=1000.0)
    feed = nl.plan_feed(kink, limits)
    ramps = 60.0 / 1000.0 + (1000.0 / jerk if jerk else 0.0)
    stop = ramps if turn == 1.0 else 0.0
    assert feed.duration == pytest.approx(100.0 / 60.0 + ramps + stop, abs=4e-3)
    most = min(60.0, 0.5 / np.sin(max(turn, 1e-9) / 2))
    assert 0.9 * most < feed.speed(feed.time_at(50.0)) <= most


@pytest.mark.parametrize("more", [{}, {"jerk": 5e4}, {"axis_acceleration": 900.0}])
def test_a_kink_between_arcs_shares_the_acceleration_with_their_curvature(more):
    """Arcs of 5 mm radius that meet at the speed of 70 mm/s at which each takes all of the acceleration."""
    arcs, end = [], np.zeros(2)
    for way in ([0.0, 1.0], [1.01, 0.01]):
        legs = 5.0 * np.tan(0.5) * np.column_stack([np.cos(way), np.sin(way)])
        points = end + np.vstack([[0.0, 0.0], np.cumsum(legs, axis=0)])
        arcs.append(nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], points, [1.0, np.cos(0.5), 1.0]))
        end = points[-1]
    limits = {"speed": 100.0, "acceleration": 1000.0, "period_s": 1e-3}
    curve = arcs[0].join(arcs[1])
    path = nl.trace(curve, nl.plan_feed(curve, **limits, **more), stepper="exact")
    second = np.diff(path.points, 2, axis=0) / 1e-6
    assert 0.9 < np.linalg.norm(second, axis=1).max() / 1000.0 <= 1.0 + 1e-6
    assert np.abs(second).max() <= more.get("axis_acceleration", 1000.0) * (1.0 + 1e-6)


def test_an_end_that_moves_and_axes_that_accelerate_little_go_together():
    """Slowed down for whole periods, axes must accelerate less too."""
    limits = {"speed": 67.0, "acceleration": 263.0, "period_s": 2.1e-3, "axis_acceleration": [157.0, 18.5]}
    circle = benchmark_curves()["circle"].curve
    rest = nl.plan_feed(circle, **limits)
    for slow in (5e-3, 0.5):
        feed = nl.plan_feed(circle, start_speed=slow, **limits)
        assert feed.speed(0.0) == pytest.approx(slow, rel=1e-9)
        assert feed.duration <= 1.01 * rest.duration


@pytest.mark.parametrize("more", [{}, {"jerk": 5e4, "start_speed": 5.0, "end_speed": 3.0}])
def test_a_plan_tightened_after_it_was_slowed_down_lasts_whole_periods_too(more, monkeypatch):
    """The second profile, the first one slowed down, is said to exceed a limit by 5 % in speed."""
    seen, place = [], np.array([0.0])

    def once_more(measured):
        def look(path, limits, profile):
            seen.append(profile.duration)
            excess = "axis_acceleration", place, place + path.length, place + 1.05
            return measured(path, limits, profile) + [excess] * (len(seen) == 2)

        return look

    for name in ("excesses", "chord_excesses"):
        monkeypatch.setattr(plan, name, once_more(getattr(plan, name)))
    limits = {"speed": 60.0, "acceleration": 900.0, "axis_acceleration": 900.0, "period_s": 1e-3}
    feed = nl.plan_feed(nl.nurbs.arc(10, 0, 1.5, (0, 0)), **limits, **more)
    assert feed.duration > seen[1] + 1e-3
    assert feed.duration / 1e-3 == pytest.approx(round(feed.duration / 1e-3), abs=1e-6)


def test_a_chain_of_arcs_is_slow_only_where_it_must_be():
    """Two rounded corners between long legs: there the motion brakes with axes at their limits."""
    x = np.array([0.0, 20.0, 20.0, 0.0])
    corners = np.column_stack([x, [0.0, 0.0, 0.3, 0.3]])
    curve = nl.interchange.blend(corners, tolerance=0.01)
    limits = {"speed": 100.0, "acceleration": 1000.0, "axis_acceleration": 1000.0, "period_s": 1e-3}
    limits["tangential_only"] = True
    feed = nl.plan_feed(curve, **limits)
    leg = nl.plan_feed(nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (20, 0)]), **limits)
    assert feed.duration < 2.1 * leg.duration


def test_limits_hold_next_to_a_knot_where_the_curvature_jumps():
    """Found by random curves: the limit was exceeded within a millionth of the length beside the knot."""
    points = [(0, 0), (1, 0.2), (1.5, 1.5), (3, 1.5)]
    curve = nl.NurbsCurve(2, [0, 0, 0, 0.6, 1, 1, 1], points, [0.1, 3.0, 0.2, 1.0])
    for jerk in (None, 3.0):
        feed = nl.plan_feed(
            curve, speed=1.0, acceleration=0.5, jerk=jerk, period_s=0.01, centripetal_acceleration=0.01
        )
        u = np.concatenate([0.6 + sign * 0.4 * np.geomspace(1e-12, 0.9, 4000) for sign in (-1.0, 1.0)])
        lengths = np.array([curve.length(None, one) for one in u])
        speeds = feed.speed(feed.time_at(lengths))
        assert (speeds**2 * curve.curvature(u)).max() <= 0.01 * (1.0 + 1e-7)


def test_a_turn_sharper_than_rounding_of_the_length_is_a_stop():
    """A cut of a roughing program goes to and fro on a line; the time is that of two lines."""
    x = [13.5, 17.607480620915418, 21.784992359463867, 26.2898329134252]
    x += [25.583407870019276, 21.33297494541409, 17.250244156140457, 13.5]
    y = 12.5 + 1e-15 * np.array([0, -59, 71, -28, 4, 9, -14, 0])
    z = 8.300003 + 1e-15 * np.array([0, 11, 0, -2, -16, 52, -44, 0])
    knots = [0, 0, 0, 0, 12.25, 12.75, 13.25, 14.25, 25.5, 25.5, 25.5, 25.5]
    curve = nl.NurbsCurve(3, knots, np.column_stack([x, y, z]))
    feed = nl.plan_feed(curve, speed=50.0, acceleration=1000.0, period_s=5e-4)
    assert 0.0 <= feed.duration - (curve.length() / 50.0 + 2 * 0.05) < 1e-3


@pytest.mark.parametrize("speed", [0.1, 5.0, 20.0])
@pytest.mark.parametrize("seed", range(5))
def test_ends_that_move_are_planned_on_any_smooth_curve(seed, speed):
    points = np.random.default_rng(seed).normal(size=(8, 2)) * 10.0
    curve = nl.interpolate_curve(points, closed=bool(seed % 2))
    limits = {"speed": 100.0, "acceleration": 1000.0, "period_s": 1e-3}
    feed = nl.plan_feed(curve, **limits, start_speed=speed, end_speed=speed)
    assert feed.duration <= nl.plan_feed(curve, **limits).duration + 1.5e-3
    assert [feed.speed(0.0), feed.speed(feed.duration)] == pytest.approx([speed, speed])
    second = np.diff(nl.trace(curve, feed, stepper="exact").points[:-1], 2, axis=0) / 1e-6
    assert np.linalg.norm(second, axis=1).max() <= 1000.0 * (1.0 + 1e-6)


@pytest.mark.parametrize("seed", [0, 40])
def test_a_limit_of_speed_that_says_nothing_is_none_at_points_of_inflection(seed):
    """The curvature allows any speed there: cells were halved down to rounding, and the curve was refused."""
    curve = nl.interpolate_curve(np.random.default_rng(seed).normal(size=(9, 2)) * 10.0)
    limits = {"acceleration": 100.0, "period_s": 1e-3}
    enough = nl.plan_feed(curve, speed=1e3, **limits).duration
    assert nl.plan_feed(curve, speed=1e9, **limits).duration == pytest.approx(enough, abs=1.1e-3)


def test_the_plan_of_another_curve_of_the_same_length_is_refused():
    curve = nl.interpolate_curve([(0, 0), (10, 25), (25, -10), (40, 30)])
    feed = nl.plan_feed(curve, speed=50.0, acceleration=500.0, period_s=1e-3)
    with pytest.raises(ValueError, match="another curve"):
        nl.trace(curve.reverse(), feed, stepper="exact")
    same = nl.trace(curve.insert_knot(0.3), feed, stepper="exact")
    assert np.abs(same.points - nl.trace(curve, feed, stepper="exact").points).max() < 1e-9


@pytest.mark.parametrize("jerk", [None, 1e4])
@pytest.mark.parametrize("inner", [((0, 0), (50, 0)), ((0, 0), (25, 40)), ((20, 9), (50, 0)), ((0, 0),) * 2])
def test_double_and_triple_end_points_are_planned_and_followed(inner, jerk):
    """C' vanishes there, but the path has a tangent: the parameter starts or stops, not the tool."""
    curve = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), *inner, (50, 0)])
    limits = {"speed": 10.0, "acceleration": 100.0, "jerk": jerk}
    feed = nl.plan_feed(curve, **limits, period_s=1e-3)
    assert_kept(curve, feed, **limits)
    assert feed.length == pytest.approx(curve.length(), abs=1e-7)
    path = nl.trace(curve, feed, stepper="history-arc")
    assert np.abs(path.points[[0, -1]] - curve.control_points[[0, -1]]).max() < 1e-7
    assert np.abs(path.arc_fluctuation[:-1]).max() < 1e-3
    if inner == ((0, 0), (50, 0)):
        assert feed.duration == pytest.approx(5.1 + (100.0 / jerk if jerk else 0.0), abs=2e-3)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"speed": 1.0, "accel": 9.0}, "^accel is no limit; of speed, acceleration, .* give speed, acc"),
        ({"speed": 1.0, "acceleration": 9.0}, "^period_s is missing; of speed, acceleration, .*"),
        ({"acceleration": 9.0, "period_s": 1e-3}, "^speed is missing; of speed, acceleration, .*"),
    ],
)
def test_a_misspelt_limit_is_named_before_the_missing_one(given, said):
    with pytest.raises(TypeError, match=said):
        nl.plan_feed(nl.paper.CURVE, **given)
