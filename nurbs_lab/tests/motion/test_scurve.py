"""S-curves: the least time against a sequence of linear programs, ends, labels, and the work it takes."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.optimize import linprog

import nurbs_lab as nl
from nurbs_lab.motion.limits import Limits
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.scan import scan
from nurbs_lab.motion.scurve import WHOLE, s_curve

LINE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0, 0), (6, 8, 0)])
CURVE = nl.paper.CURVE
FAST = {"speed": 100.0, "acceleration": 1e4, "jerk": 1e6, "chord_error": 1e-3}


def least_time(curve, end_speed, *, speed, acceleration, jerk, chord_error, period_s, cells=800):
    """Least time by linear programs in v², the jerk limit on the tangent at the last answer."""
    path = scan(
        prepare(curve),
        Limits(speed, acceleration, jerk, chord_error, period_s=period_s, tangential_only=True),
    )
    s = np.linspace(0.0, path.lengths[-1], cells + 1)
    h = s[1]
    caps = np.interp(s, path.lengths, path.speeds) ** 2
    slope = sparse.diags([-1.0, 1.0], [0, 1], shape=(cells, cells + 1), format="csr") / h
    second = (slope[1:] - slope[:-1]) / h
    b = np.full(cells + 1, end_speed**2)
    level = [0, 1, -2, -1]  # no acceleration at the ends
    before = np.inf
    for _ in range(40):
        v = np.sqrt(b)
        gain = 2.0 * h / (v[1:] + v[:-1]) ** 2
        time = np.sum(2.0 * h / (v[1:] + v[:-1]))
        if time > before * (1.0 - 1e-5):
            break
        before = time
        cost = np.zeros(cells + 1)
        cost[1:] -= gain / (2.0 * v[1:])
        cost[:-1] -= gain / (2.0 * v[:-1])
        most = 2.0 * jerk / v[1:-1]
        tangent = sparse.diags([0.5 * most / b[1:-1]], [1], shape=(cells - 1, cells + 1), format="csr")
        rows = sparse.vstack([second + tangent, tangent - second, slope, -slope], format="csr")
        room = np.concatenate([1.5 * most, 1.5 * most, np.full(2 * cells, 2.0 * acceleration)])
        low, high = b / 3.0, np.minimum(3.0 * b, caps)
        low[level] = high[level] = end_speed**2
        unit = caps.max()
        found = linprog(
            cost * unit / before,
            (unit / (2.0 * acceleration)) * rows,
            room / (2.0 * acceleration),
            bounds=np.column_stack([low, high]) / unit,
        )
        b = unit * found.x
    return before


def test_the_time_is_the_least_that_linear_programs_find():
    """Another method on another grid, which comes down to ours as it is refined."""
    feed = nl.plan_feed(CURVE, **FAST, period_s=1e-4, start_speed=20.0, end_speed=20.0, tangential_only=True)
    assert 0.99 < feed.duration / least_time(CURVE, 20.0, **FAST, period_s=1e-4) < 1.001


@pytest.mark.parametrize(("start", "end"), [(1.0, 2.0), (4.0, 4.0), (4.0, 0.0), (1.0, 4.0)])
@pytest.mark.parametrize("jerk", [None, 400.0])
def test_end_speeds_up_to_the_limit_are_kept(start, end, jerk):
    limits = {"speed": 4.0, "acceleration": 40.0, "jerk": jerk, "period_s": 1e-3}
    feed = nl.plan_feed(CURVE, start_speed=start, end_speed=end, **limits)
    assert feed.speed(0.0) == pytest.approx(start, rel=1e-9)
    assert feed.speed(feed.duration) == pytest.approx(end, rel=1e-9)
    assert feed.peak <= 4.0 * (1.0 + 1e-7)
    assert feed.duration / 1e-3 == pytest.approx(round(feed.duration / 1e-3), abs=1e-7)


def test_a_fast_start_into_a_bend_is_planned_while_the_jerk_allows_it():
    limits = {"speed": 4.0, "acceleration": 40.0, "axis_acceleration": 20.0, "period_s": 5e-3}
    feed = nl.plan_feed(nl.paper.CURVE, start_speed=3.9, jerk=100.0, **limits)
    assert feed.speed(0.0) == pytest.approx(3.9, rel=1e-9)
    assert np.abs(feed.jerk(np.linspace(0.0, feed.duration, 999))).max() <= 100.0
    path = nl.trace(nl.paper.CURVE, feed, stepper="exact")
    assert np.abs(np.diff(path.points[:-1], 2, axis=0)).max() <= 20.0 * 1.02 * 5e-3**2
    with pytest.raises(ValueError, match=r"no S-curve fits between start_speed 3\.9 mm/s"):
        nl.plan_feed(nl.paper.CURVE, start_speed=3.9, jerk=50.0, **limits)


def test_ends_as_fast_as_a_circle_allows_are_planned():
    arc = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(10, 0), (10, 10), (0, 10)], [1, np.sqrt(0.5), 1])
    ends = {"start_speed": 99.99, "end_speed": 99.99}  # of 100 mm/s, as v² / r is the acceleration
    for jerk, period_s in ((2e4, 1e-3), (2e5, 1e-4)):
        feed = nl.plan_feed(arc, speed=200.0, acceleration=1000.0, jerk=jerk, period_s=period_s, **ends)
        assert feed.speed(0.0) == pytest.approx(99.99, rel=1e-9)


@pytest.mark.parametrize("count", [300, 1500])
def test_facets_keep_the_jerk_of_axes_while_the_speed_changes(count):
    """Third differences of positions take 3 v a times the curvature that facets stand for."""
    angles = np.linspace(0.0, 4.0 * np.pi, count + 1)
    points = np.column_stack([6.0 * np.cos(angles), 6.0 * np.sin(angles), angles])
    gone = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    feed = nl.plan_feed(
        nl.interpolate_curve(points, 1), speed=1000.0, acceleration=1e6, axis_jerk=5e7, period_s=1e-3
    )
    for motion in (feed, nl.motion.apply_override(feed, [(0.3 * feed.duration, 0.3)])):
        for phase in np.linspace(0.0, 1.0, 7):
            t = 1e-3 * (np.arange(-3.0, np.ceil(1e3 * motion.duration) + 4.0) + phase)
            s = motion.displacement(t)
            places = np.column_stack([np.interp(s, gone, axis) for axis in points.T])
            assert np.abs(np.diff(places, 3, axis=0)).max() <= 5e7 * 1e-9


def test_an_end_speed_that_needs_an_acceleration_is_refused_with_a_limit_of_jerk():
    """A quarter of a circle from 45 degrees on: without acceleration the speed takes v² sin(45°) / R of x."""
    arc = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(10, 10), (0, 20), (-10, 10)], [1, np.sqrt(0.5), 1])
    limits = {"speed": 50.0, "acceleration": 500.0, "axis_acceleration": (20.0, 500.0), "period_s": 1e-3}
    most = np.sqrt(20.0 * 10.0 * np.sqrt(2.0) / np.sqrt(0.5))
    assert nl.plan_feed(arc, **limits, start_speed=1.01 * most).speed(0.0) > most
    assert nl.plan_feed(arc, **limits, jerk=1e5, start_speed=0.99 * most).speed(0.0) < most
    with pytest.raises(ValueError, match=r"start_speed .* at most 20 mm/s, by axis_acceleration"):
        nl.plan_feed(arc, **limits, jerk=1e5, start_speed=1.01 * most)


@pytest.mark.parametrize("chord_error", [1e-5, 1e-6])
def test_a_corner_may_be_nearly_a_stop(chord_error):
    """There v² falls and rises so steeply that it must be kept from passing zero between the nodes."""
    corner = nl.NurbsCurve(1, [0, 0, 1, 2, 2], [(0, 0), (10, 0), (10, 10)])
    limits = {"speed": 10.0, "acceleration": 100.0, "chord_error": chord_error, "period_s": 1e-3}
    stops = 2 * (10.0 / 10.0 + 10.0 / 100.0)
    assert nl.plan_feed(corner, jerk=1e8, **limits).duration == pytest.approx(stops, rel=0.03)


@pytest.mark.parametrize(("seed", "jerk"), [(0, 1e4), (1, 1e3), (4, 1e4), (5, 1e3)])
def test_a_corner_at_which_the_curvature_jumps_is_one_place(seed, jerk):
    """Axes keep their jerks, by third differences of positions, at a corner between two arcs too."""
    points = 10 * np.random.default_rng(seed).normal(size=(7, 2))
    curve = nl.NurbsCurve(3, [0] * 4 + [0.5] * 3 + [1] * 4, points)
    feed = nl.plan_feed(curve, speed=100.0, acceleration=100.0, axis_jerk=jerk, period_s=1e-3)
    s = feed.displacement(1e-3 * np.arange(round(feed.duration / 1e-3) + 1))
    places = curve(curve.parameter_at(s.clip(0.0, curve.length())))
    assert np.abs(np.diff(places, 3, axis=0)).max() <= 1.001e-9 * jerk


@pytest.mark.parametrize("speed", [1e-3, 1e-5, 1e-8])
def test_ramps_of_a_creeping_motion_take_next_to_no_time(speed):
    """They are up to 1e-15 of the path; a grid too coarse for them took up to 980 times its time."""
    feed = nl.plan_feed(CURVE, speed=speed, acceleration=40.0, jerk=4000.0, period_s=1e-3)
    assert feed.peak <= speed
    assert feed.duration == pytest.approx(CURVE.length() / speed, rel=1e-4)


@pytest.mark.parametrize("curve", [LINE, CURVE])
def test_the_speed_is_kept_between_samples_too(curve):
    """Speeding up takes two periods and a half, the ramps of the acceleration a hundredth of one."""
    feed = nl.plan_feed(curve, speed=1.0, acceleration=400.0, jerk=3e7, period_s=1e-3)
    assert feed.peak <= 1.0


@settings(max_examples=5, deadline=None)
@given(st.floats(0.2, 5.0), st.floats(0.3, 0.999))
@example(0.25, 0.875)
@example(1.125, 0.90625)
@example(0.7, 0.999)
def test_no_end_speed_is_promised_that_cannot_be_reached(jerk, part):
    """From rest over 10 mm: the closed form of the S-curve decides."""
    most = np.cbrt(10.0**2 * jerk)  # s = v sqrt(v / J), as long as the acceleration is not reached
    limits = {"speed": 1e3, "acceleration": 1e3, "jerk": jerk, "period_s": 1e-3}
    feed = nl.plan_feed(LINE, end_speed=0.998 * part * most, **limits)
    assert feed.speed(feed.duration) == pytest.approx(0.998 * part * most, rel=1e-9)
    with pytest.raises(ValueError, match="end_speed"):
        nl.plan_feed(LINE, end_speed=most * (2.001 - part), **limits)


def test_each_of_many_equal_corners_takes_as_long_as_each_of_a_few():
    """The grid of a long path is no coarser at its corners, and no limit jumps from cell to cell."""
    limits = {"speed": 100.0, "acceleration": 2000.0, "jerk": 4e4, "axis_acceleration": 1500.0}
    seconds = {}
    for corners in (10, 20, 600):
        x = 5.0 * np.arange(corners + 2)
        zigzag = nl.NurbsCurve(1, np.arange(corners + 4).clip(1, corners + 2), np.column_stack([x, x % 10.0]))
        seconds[corners] = nl.plan_feed(zigzag, **limits, period_s=1e-3).duration
    each = (seconds[20] - seconds[10]) / 10.0
    assert seconds[600] == pytest.approx(seconds[20] + 580.0 * each, rel=0.025)


def test_the_first_motion_keeps_its_jerk_where_the_speed_is_highest():
    """Within a cell speed and jerk are higher than at its ends, so that the motion was planned twice."""
    points = np.cumsum(np.random.default_rng(3).normal(size=(1002, 2)) * 2.0, axis=0)
    limits = Limits(100.0, 2000.0, 5e4, period_s=1e-3)
    path = scan(prepare(nl.interpolate_curve(np.vstack([[0.0, 0.0], points]), 1)), limits)
    profile = s_curve(path, limits, np.zeros(2), WHOLE).profile
    assert np.abs(profile.segments[:, 5]).max() <= 5e4 * (1.0 + 3e-7)


def test_a_stage_that_converges_slowly_is_not_cut_short():
    """With 60 Newton steps at most, later stages found no way on, and the motion took 1.5 % longer."""
    curve = nl.interpolate_curve(np.random.default_rng(40).normal(size=(9, 2)) * 10.0)
    limits = {"acceleration": 100.0, "axis_jerk": 1e4, "chord_error": 1e-3, "period_s": 1e-3}
    assert nl.plan_feed(curve, speed=1e4, **limits).duration <= 6.571  # as long as with 1,000 mm/s


@pytest.mark.parametrize("part", [0.5, 0.9, 0.98])
@pytest.mark.parametrize("end", ["start_speed", "end_speed"])
def test_speeds_next_to_a_corner_are_planned_up_to_the_closed_form(part, end):
    """An S-curve down to rest takes v sqrt(v / J); plans were refused from 0.8 of that speed on."""
    points = np.array([(0.0, 0.0), (0.5, 0.0), (0.5, 10.0)])
    curve = nl.NurbsCurve(1, [0, 0, 1, 2, 2], points if end == "start_speed" else points[::-1])
    speed = part * np.cbrt(0.5**2 * 2e3)
    limits = {"speed": 50.0, "acceleration": 200.0, "jerk": 2e3, "period_s": 1e-3, end: speed}
    feed = nl.plan_feed(curve, **limits)
    assert feed.speed(0.0 if end == "start_speed" else feed.duration) == pytest.approx(speed, rel=1e-9)


def test_an_end_is_reached_although_the_way_there_may_nearly_rest():
    """The largest end speed is 33.3 mm/s; motions that speed up late find no way on from 27 mm/s."""
    random = np.random.default_rng(5)
    for _ in range(8):
        points, jerk = np.cumsum(random.normal(0, 2, (7, 2)), axis=0), 10 ** random.uniform(3, 4.5)
    limits = {"speed": 200.0, "acceleration": 0.03 * jerk, "jerk": jerk, "period_s": 1e-3}
    feed = nl.plan_feed(nl.interpolate_curve(points), end_speed=33.2, **limits)
    assert feed.speed(feed.duration) == pytest.approx(33.2, rel=1e-9)


@pytest.mark.parametrize("off", [1e-5, 1e-6])
@pytest.mark.parametrize("limits", [{"jerk": 2e4}, {"jerk": 2e4, "axis_jerk": 2e4}])
def test_turns_that_are_sharper_than_lengths_are_known_are_planned(off, limits):
    """The radius at u = 0.5 is off² / 100 mm."""
    curve = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), (10, 10), (off, 10), (10, 0)])
    feed = nl.plan_feed(curve, speed=80.0, acceleration=1000.0, period_s=1e-3, **limits)
    points = nl.trace(curve, feed, stepper="exact").points
    assert np.linalg.norm(np.diff(points, 2, axis=0), axis=1).max() <= 1000.0 * 1e-3**2
    assert feed.duration < 0.52
