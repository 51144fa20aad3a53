"""Programs of many curves, planned in windows: one motion within the limits, hardly slower than a whole."""

import itertools

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion import plan_program, plan_windows
from nurbs_lab.motion.plan import fastest_profile
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.scan import scan
from nurbs_lab.motion.scurve import WHOLE

LIMITS = {"speed": 100.0, "acceleration": 2000.0, "chord_error": 1e-3, "period_s": 1e-3}
LIMITS |= {"axis_acceleration": 1500.0}


def wave(count):
    x = 2.0 * np.arange(count + 1)
    return nl.interpolate_curve(np.column_stack([x, 15.0 * np.sin(x / 12.0) + 4.0 * np.sin(x / 5.3)]))


@pytest.mark.parametrize("jerk", [None, 1e5])
def test_windows_take_hardly_longer_than_the_whole(jerk):
    curve = wave(300)
    whole = nl.plan_feed(curve, jerk=jerk, **LIMITS)
    plans = list(plan_windows(curve, jerk=jerk, **LIMITS))
    assert len(plans) > 3
    speeds, accelerations = np.zeros(2), np.zeros(2)
    for piece, feed in plans:
        t = np.linspace(0.0, feed.duration, 5001)
        assert feed.length == pytest.approx(piece.length(), rel=1e-9)
        assert feed.speed(0.0) == pytest.approx(speeds[1], abs=1e-6)
        if jerk:
            assert feed.acceleration(0.0) == pytest.approx(
                accelerations[1], abs=1e-3 * LIMITS["acceleration"]
            )
            assert np.abs(feed.jerk(t)).max() <= jerk * (1.0 + 1e-6)
        assert np.abs(feed.acceleration(t)).max() <= LIMITS["acceleration"] * (1.0 + 1e-6)
        u = piece.parameter_at(np.clip(feed.displacement(t), 0.0, piece.length()))
        first, second = piece.derivative(u), piece.derivative(u, 2)
        pace = np.linalg.norm(first, axis=1, keepdims=True)
        tangent = first / pace
        bent = (second - np.sum(second * tangent, axis=1, keepdims=True) * tangent) / pace**2
        axes = feed.acceleration(t)[:, None] * tangent + feed.speed(t)[:, None] ** 2 * bent
        assert np.abs(axes[5:-5]).max() <= LIMITS["axis_acceleration"] * (1.0 + 1e-6)
        speeds, accelerations = feed.speed(t[[0, -1]]), feed.acceleration(t[[0, -1]])
    total = sum(feed.duration for _, feed in plans)
    assert total == pytest.approx(whole.duration, rel=0.005)
    assert total / 1e-3 == pytest.approx(round(total / 1e-3), abs=1e-6)


@pytest.mark.parametrize("seed", [0, 2])
def test_no_curve_between_two_stops_takes_longer_in_a_program_than_alone(seed):
    """Where a window ends at a stop, samples at the speed of the stop stood half a second long."""
    rng = np.random.default_rng(seed)
    ends, curves = np.cumsum(rng.normal(size=(201, 3)) * 6.0, axis=0), []
    for a, b in itertools.pairwise(ends):
        inner = a + np.array([[0.25], [0.5], [0.75]]) * (b - a) + 0.5 * rng.normal(size=(3, 3))
        curves.append(nl.NurbsCurve(3, [0, 0, 0, 0, 0.5, 1, 1, 1, 1], np.vstack([a, inner, b])))
    speeds = rng.choice([50.0, 16.7, 200.0], len(curves)).tolist()
    limits = {"acceleration": 2000.0, "chord_error": 1e-3, "period_s": 1e-3}
    feeds = plan_program(curves, speeds=speeds, speed=200.0, **limits)
    alone = [nl.plan_feed(c, speed=s, **limits).duration for c, s in zip(curves, speeds, strict=True)]
    assert max(feed.duration - most for feed, most in zip(feeds, alone, strict=True)) < 2e-3


@pytest.mark.parametrize("jerk", [None, 5e4])
def test_blended_facets_take_as_long_as_a_whole_as_in_windows(jerk):
    """Their blends are down to a millionth of a facet long, where rounding must not pass for an excess."""
    x = 0.06 * np.arange(4001)
    points = np.column_stack([x, 15.0 * np.sin(x / 12.0) + 4.0 * np.sin(x / 5.3)])
    facets = nl.interchange.blend(points, tolerance=0.01)
    limits = LIMITS | {"speed": 60.0, "acceleration": 1000.0, "axis_acceleration": 1000.0, "jerk": jerk}
    whole = nl.plan_feed(facets, **limits).duration
    assert sum(feed.duration for _, feed in plan_windows(facets, **limits)) == pytest.approx(whole, rel=2e-3)


@pytest.mark.parametrize("jerk", [None, 1e4])
def test_a_line_in_parts_is_the_line(jerk):
    lines = [nl.NurbsCurve(1, [0, 0, 1, 1], [(x, 0), (x + 5, 0)]) for x in range(0, 40, 5)]
    limits = {"speed": 10.0, "acceleration": 100.0, "jerk": jerk, "period_s": 1e-3}
    feeds = plan_program(lines, **limits)
    ideal = 40.0 / 10.0 + 10.0 / 100.0 + (100.0 / jerk if jerk else 0.0)
    assert sum(feed.duration for feed in feeds) == pytest.approx(ideal, abs=2e-3 + 1e-4 * ideal)
    assert min(feed.speed(0.0) for feed in feeds[1:]) > 9.99


def test_a_corner_between_curves_slows_down_as_one_within_a_curve_does():
    legs = [nl.NurbsCurve(1, [0, 0, 1, 1], p) for p in ([(0, 0), (10, 0)], [(10, 0), (10, 10)])]
    limits = {"speed": 8.0, "acceleration": 100.0, "period_s": 1e-3, "axis_acceleration": 40.0}
    first, second = plan_program(legs, **limits)
    assert first.speed(first.duration) == pytest.approx(40.0 * 1e-3, rel=5e-3)
    assert second.speed(0.0) == pytest.approx(first.speed(first.duration), rel=1e-9)
    whole = nl.plan_feed(legs[0].join(legs[1]), **limits)
    assert first.duration + second.duration == pytest.approx(whole.duration, abs=3e-3)


@pytest.mark.parametrize("stepper", ["exact", "history-arc"])
def test_the_pieces_of_a_program_are_followed_as_one_motion(stepper):
    """Of any degree and parameter, some shorter than a step; every sample beside the piece that holds it."""
    rng, curves, end = np.random.default_rng(5), [], np.zeros(3)
    for degree, size in zip([1, 3, 2, 5, 1, 1, 3], [1.0, 1.0, 1e-3, 1.0, 1e-3, 1e-3, 2.0], strict=True):
        steps = np.pad(rng.normal((1.0, 0.0, 0.0), size=(degree, 3)), ((1, 0), (0, 0)))
        points = end + size * np.cumsum(steps, axis=0)
        knots = np.repeat([0.0, 10.0 ** rng.uniform(-2, 2)], degree + 1)
        curves.append(nl.NurbsCurve(degree, knots, points))
        end = points[-1]
    feeds = plan_program(curves, speed=20.0, acceleration=400.0, period_s=1e-3)
    feed = feeds[0].join(*feeds[1:])
    path = nl.trace(feed.curve, feed, stepper=stepper)
    starts = np.cumsum([0.0, *(one.duration for one in feeds)])
    assert len(path) == 1 + round(starts[-1] / 1e-3)
    which = np.searchsorted(starts[1:-1], path.t, side="right")
    for t, k, point in zip(path.t, which, path.points, strict=True):
        way = min(feeds[k].displacement(t - starts[k]), curves[k].length())
        assert point == pytest.approx(
            curves[k](curves[k].parameter_at(way)), abs=1e-9 if stepper == "exact" else 2e-5
        )
    with pytest.raises(ValueError, match="go on as the feed before ends"):
        feeds[0].join(feeds[2])


@pytest.mark.parametrize("jerk", [None, 5e4])
@pytest.mark.parametrize("corners", [0.0, 5.0])
def test_each_curve_may_have_a_speed_of_its_own(jerk, corners):
    """No sample of a curve is faster, and long ones are as fast; between them are corners, or none."""
    rng = np.random.default_rng(1)
    steps = rng.uniform(0.05, 1.0, (30, 1)) * (20.0, 0.0, 0.0) + corners * rng.normal(size=(30, 3))
    points, speeds = np.cumsum(steps, axis=0), rng.choice([2.0, 5.0, 20.0], 29)
    lines = [nl.NurbsCurve(1, [0, 0, 1, 1], pair) for pair in itertools.pairwise(points)]
    lines[3] = lines[3].elevate_degree(2)
    limits = {"speed": 100.0, "acceleration": 2000.0, "jerk": jerk, "period_s": 1e-3}
    feeds = plan_program(lines, speeds=speeds, **limits)
    peaks = np.array([feed.speed(np.linspace(0.0, feed.duration, 2001)).max() for feed in feeds])
    assert (peaks / speeds).max() <= 1.0 + 1e-9
    least = sum(line.length() / speed for line, speed in zip(lines, speeds, strict=True))
    assert least < sum(feed.duration for feed in feeds) < 1.15 * least
    with pytest.raises(ValueError, match=r"speeds has none above 0 for curves\[28\]"):
        plan_program(lines, speeds=speeds[:-1], **limits)
    with pytest.raises(ValueError, match=r"speeds\[1\] is nan"):
        plan_program(lines, speeds=[*speeds[:1], np.nan, *speeds[2:]], **limits)
    with pytest.raises(ValueError, match=r"curves\[3\] has 2 coordinates, those before have 3"):
        plan_program([*lines[:3], lines[3].transform(np.eye(2, 3))], **limits)


@pytest.mark.parametrize("seed", [5000, 5027, 5039])
def test_a_window_may_keep_a_chord_error_by_being_slower(seed):
    """A slow copy was measured at the same points, and refused; more curves follow, so no end is known."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(5, 12))
    knots = [0] * 4 + [*range(1, count - 3)] + [count - 3] * 4
    curve = nl.NurbsCurve(3, knots, np.cumsum(rng.normal(size=(count, 2)), axis=0) * 3.0)
    error, period = float(rng.choice([1e-4, 1e-3, 1e-2])), float(rng.choice([4e-3, 1e-2, 2e-2]))
    limits = nl.Limits(speed=100.0, acceleration=2000.0, chord_error=error, period_s=period)
    path = scan(prepare(curve), limits)
    window = fastest_profile(path, limits, np.zeros(2), WHOLE, gone=None)
    assert window.duration < nl.plan_feed(curve, limits).duration + period


def test_a_program_is_read_only_as_far_as_it_is_planned():
    read = []

    def lines():
        for x in range(0, 5000, 5):
            read.append(x)
            yield nl.NurbsCurve(1, [0, 0, 1, 1], [(x, 0), (x + 5, 0)])

    next(iter(plan_windows(lines(), speed=10.0, acceleration=100.0, period_s=1e-3)))
    assert len(read) < 20


@pytest.mark.parametrize(("speed", "period_s"), [(1e-12, 1e-3), (1e-30, 1e-30), (10.0, 1e-30)])
def test_periods_that_cannot_be_counted_are_refused_by_their_cure(speed, period_s):
    """A thousand times fewer are planned."""
    lines = [nl.NurbsCurve(1, [0, 0, 1, 1], ends) for ends in ([(0, 0), (10, 0)], [(10, 0), (20, 5)])]
    limits = {"acceleration": 100.0, "jerk": 1e4}
    with pytest.raises(ValueError, match="more periods than can be counted; take a higher speed or"):
        plan_program(lines, speed=speed, period_s=period_s, **limits)
    assert sum(feed.duration for feed in plan_program(lines, speed=1e-9, period_s=1e-3, **limits)) > 2e10
