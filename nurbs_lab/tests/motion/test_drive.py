"""Plans as a drive sees them: limits measured by SciPy's splines and by differences of positions."""

import numpy as np
import pytest
from scipy import sparse
from scipy.integrate import quad
from scipy.interpolate import BSpline
from scipy.optimize import brentq, linprog

import nurbs_lab as nl


def geometry(curve, u):
    """Unit tangent, curvature vector and its rate by arc length, from SciPy's derivatives."""
    spline = BSpline(curve.knots, curve.homogeneous, curve.degree)
    rows = [spline(u, k) if k <= curve.degree else 0.0 * spline(u) for k in range(4)]
    points, w = [row[:, :-1] for row in rows], [row[:, -1:] for row in rows]
    c0 = points[0] / w[0]
    c1 = (points[1] - w[1] * c0) / w[0]
    c2 = (points[2] - 2 * w[1] * c1 - w[2] * c0) / w[0]
    c3 = (points[3] - 3 * w[1] * c2 - 3 * w[2] * c1 - w[3] * c0) / w[0]
    s = np.linalg.norm(c1, axis=1)[:, None]
    s1 = (c1 * c2).sum(axis=1)[:, None] / s
    s2 = ((c2 * c2 + c1 * c3).sum(axis=1)[:, None] - s1**2) / s
    one, two, three = 1 / s, -s1 / s**3, (3 * s1**2 - s * s2) / s**5
    return c1 * one, c2 * one**2 + c1 * two, c3 * one**3 + 3 * c2 * one * two + c1 * three


def drawn(seed):
    """A curve with kinks from 1e-9 to 1 rad, noise, or any degree, and limits."""
    rng = np.random.default_rng(seed)
    dim, kind = int(rng.integers(2, 4)), seed % 4
    if kind == 0:
        turn = np.cumsum(10.0 ** rng.uniform(-9, 0, 8) * rng.choice([-1, 1], 8))
        steps = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])[:, :dim] * rng.uniform(
            0.3, 20, (8, 1)
        )
        points = np.vstack([np.zeros(dim), np.cumsum(steps, axis=0)])
        curve = nl.NurbsCurve(1, np.r_[0, np.arange(9), 8], points)
    elif kind == 1:
        x = np.linspace(0, 20, 50)
        points = np.column_stack([x, 5 * np.sin(x / 3), 0.1 * x])[:, :dim] + rng.normal(size=(50, dim)) * 1e-3
        curve = nl.interpolate_curve(points, 1)
    else:
        degree = int(rng.integers(2, 6))
        points = np.cumsum(rng.normal(size=(degree + 6, dim)) * 3 + np.eye(dim)[0] * 3, axis=0)
        knots = np.r_[np.zeros(degree + 1), np.sort(rng.uniform(0.05, 0.95, 5)), np.ones(degree + 1)]
        curve = nl.NurbsCurve(degree, knots, points, np.exp(0.5 * rng.normal(size=len(points))))
    speed = 10.0 ** rng.uniform(1, 2.3)
    acceleration = speed * 10.0 ** rng.uniform(0.7, 1.7)
    limits = {"speed": speed, "acceleration": acceleration, "axis_acceleration": 0.8 * acceleration}
    limits |= {"axis_speed": 0.9 * speed, "centripetal_acceleration": 0.7 * acceleration}
    if seed % 3:
        limits |= {"jerk": acceleration * 20.0, "axis_jerk": acceleration * 20.0}
    return curve, nl.Limits(**limits).in_dimensions(dim)


@pytest.mark.parametrize("seed", range(12))
def test_no_limit_is_exceeded_between_periods_or_from_period_to_period(seed):
    curve, limits = drawn(seed)
    feed = nl.plan_feed(curve, limits)
    t = np.linspace(0.0, feed.duration, 4 * int(feed.duration / limits.period_s) + 2000)[1:-1]
    u = curve.parameter_at(np.clip(feed.displacement(t), 0.0, curve.length()))
    knots = np.unique(curve.knots)
    near = knots[np.clip(np.searchsorted(knots, u) - np.array([[1], [0]]), 0, len(knots) - 1)]
    off = np.abs(u - near).min(axis=0) > 1e-7 * np.ptp(knots)
    v, a, j = (one(t[off])[:, None] for one in (feed.speed, feed.acceleration, feed.jerk))
    tangent, curvature, rate = geometry(curve, u[off])
    vector, change = a * tangent + v**2 * curvature, j * tangent + 3 * v * a * curvature + v**3 * rate
    assert v.max() <= limits.speed * (1 + 1e-9)
    assert np.abs(v * tangent).max() <= limits.axis_speed[0] * (1 + 1e-7)
    across = np.linalg.norm(v**2 * curvature, axis=1).max()
    assert across <= limits.centripetal_acceleration * (1 + 1e-6)
    assert np.linalg.norm(vector, axis=1).max() <= limits.acceleration * (1 + 1e-5)
    assert np.abs(vector).max() <= limits.axis_acceleration[0] * (1 + 1e-5)
    points = nl.trace(curve, feed, stepper="exact").points
    points = np.vstack([points[:1]] * 3 + [points] + [points[-1:]] * 3)
    noise = 1e-15 * np.abs(points).max()
    second = np.diff(points, 2, axis=0)
    step = limits.acceleration * limits.period_s**2
    assert np.linalg.norm(second, axis=1).max() <= step * (1 + 1e-6) + 4 * noise
    if limits.jerk is not None:
        assert np.abs(change).max() <= limits.axis_jerk[0] * (1 + 1e-5)
        third = np.diff(points, 3, axis=0)
        assert np.abs(third).max() <= limits.axis_jerk[0] * limits.period_s**3 * (1 + 1e-6) + 8 * noise


BUTTERFLY = nl.motion.benchmark_curves()["butterfly"].curve
LINE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (10, 0)])
SLANTED = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (14, 48)])
EGG = [(10.5, 0), (6.7, 3.5), (0, 7.5), (-7.4, 7.2), (-7.9, 0), (-8.1, -6.5), (0, -5), (9.7, -5), (10.5, 0)]
EGG = nl.interpolate_curve(EGG, closed=True)
LOOP = [(2.2, 6.1), (1, 4.9), (-1.4, 4.8), (-4, 1.2), (-3.7, -3.1), (-5, -5.2), (-0.9, -7.9), (-0.6, -4)]
LOOP += [(5.1, -5.1), (5.3, -4.4), (7.3, -3.2), (5.2, -1.3), (2.2, 6.1)]
LOOP = nl.interpolate_curve(LOOP, 5, closed=True)
TEETH = nl.interpolate_curve([(x, x % 3) for x in range(9)])
WAVES = 0.03 * np.arange(2001)
FACETS = np.column_stack([WAVES, 4 * np.sin(WAVES / 7) + 2 * np.sin(WAVES / 3)]).round(3)
FACETS = nl.interchange.blend(FACETS, tolerance=0.01)
ZIGZAG = nl.interpolate_curve([(0, 0), (10, 2), (20, 0), (30, 12), (31, 0)], 1)


@pytest.mark.parametrize(
    ("curve", "limits", "most"),
    [
        (BUTTERFLY, {"speed": 100.0, "acceleration": 1000.0, "axis_acceleration": 700.0}, 1e-3),
        (BUTTERFLY, {"speed": 100.0, "acceleration": 1000.0, "jerk": 2e4, "chord_error": 1e-3}, 1e-3),
        (FACETS, {"speed": 60.0, "acceleration": 1000.0, "axis_acceleration": 1000.0}, 1e-3),
        (nl.paper.CURVE, {"speed": 4.0, "acceleration": 40.0, "jerk": 800.0}, 1e-2),
        (LINE, {"speed": 5.0, "acceleration": 40.0, "jerk": 800.0}, 1e-2),
        (ZIGZAG, {"speed": 60.0, "acceleration": 1000.0, "jerk": 2e4, "axis_acceleration": 700.0}, 1e-2),
        (TEETH, {"speed": 100.0, "acceleration": 1000.0, "axis_jerk": 2e4}, 1e-2),
        (EGG, {"speed": 100.0, "acceleration": 1000.0, "axis_jerk": 2e4}, 1e-2),
    ],
)
def test_a_plan_is_as_fast_as_its_certificate_says(curve, limits, most):
    feed = nl.plan_feed(curve, **limits, period_s=1e-3)
    found = feed.certificate()
    assert found.least_s <= feed.duration + 1e-9
    assert found.gap <= most
    assert max(found.uses.values()) <= 1.0 + 1e-6
    assert found.uses.keys() <= limits.keys()


def test_where_axes_need_what_the_vector_leaves_a_linear_program_is_as_fast():
    """The largest sum of v² along the path, under the limits in the middle of every cell."""
    speed, most, axes, cells = 90.0, 3000.0, np.array([1200.0, 3200.0]), 1500
    s = np.linspace(0.0, LOOP.length(), cells + 1)
    tangent, curvature, _ = geometry(LOOP, LOOP.parameter_at(0.5 * (s[1:] + s[:-1])))
    angle = np.arange(48) * np.pi / 24
    ways = np.column_stack([np.cos(angle), np.sin(angle)]) / most
    ways = np.vstack([ways, np.diag(1 / axes), -np.diag(1 / axes)])
    slope, level = (sparse.diags([sign, 0.5], [0, 1], shape=(cells, cells + 1)) for sign in (-0.5, 0.5))
    rows = [
        sparse.diags(tangent @ way) @ slope / s[1] + sparse.diags(curvature @ way) @ level for way in ways
    ]
    bounds = [(0, 0)] + [(0, speed**2)] * (cells - 1) + [(0, 0)]
    found = linprog(-np.ones(cells + 1), sparse.vstack(rows), np.ones(cells * len(ways)), bounds=bounds)
    v = np.sqrt(np.maximum(found.x, 0.0))
    feed = nl.plan_feed(LOOP, speed=speed, acceleration=most, axis_acceleration=axes, period_s=1e-4)
    assert feed.duration == pytest.approx(np.sum(2 * s[1] / (v[1:] + v[:-1])), rel=3e-3)


def _least_of_an_arc(angle, radius, acceleration):
    """Where all of the vector is used, v² = r a sin(2 s / r) from both ends."""
    whole = quad(lambda x: 2 * x / np.sqrt(np.sin(x * x)), 0, np.sqrt(angle))[0]
    return whole * np.sqrt(radius / acceleration)


@pytest.mark.parametrize(
    ("curve", "limits", "seconds"),
    [
        (LINE, {"speed": 5, "acceleration": 40, "jerk": 800}, 10 / 5 + 5 / 40 + 40 / 800),
        (LINE, {"speed": 9, "acceleration": 1, "jerk": 1000}, 6.325555399),
        (SLANTED, {"speed": 50, "acceleration": 500, "axis_jerk": (100, 400)}, 1 + 2 * np.sqrt(0.14)),
        (nl.nurbs.arc(10, 0, 1.5, (0, 0)), {"speed": 99, "acceleration": 40}, _least_of_an_arc(1.5, 10, 40)),
    ],
)
def test_the_closed_form_lies_between_the_certificate_and_the_plan(curve, limits, seconds):
    feed = nl.plan_feed(curve, **limits, period_s=1e-3)
    assert feed.certificate().least_s - 1e-3 <= seconds <= feed.duration + 1e-9
    assert feed.duration <= seconds * (1.0 + 1e-3) + 1e-3


def test_the_jerk_does_not_chatter_along_a_centripetal_phase():
    """A plan from a scan ten times finer and a solution ten times nearer to the least time varies as much."""
    limits = nl.Limits(
        50.0, 500.0, 2e4, chord_error=1e-3, centripetal_acceleration=500.0, tangential_only=True
    )
    feed = nl.plan_feed(BUTTERFLY, limits)
    jerk = feed.jerk(np.arange(0.0, feed.duration, 1e-3))
    assert feed.duration == pytest.approx(8.688, abs=2e-3)
    assert np.abs(np.diff(jerk)).sum() <= 1.1 * 155.0 * 2e4  # 176 with jumps of the widths of cells


@pytest.mark.parametrize("seed", [4, 5])
def test_no_axis_takes_more_jerk_within_a_segment_than_at_its_ends(seed):
    """Where the curvature peaks within a phase of constant jerk, an axis took 1e-3 more than its limit."""
    points = 2.0 * np.random.default_rng(seed).normal(size=(11, 2))
    curve = nl.NurbsCurve(3, np.r_[0, 0, 0, np.linspace(0, 1, 9), 1, 1, 1], points)
    limits = {"speed": 6.0, "acceleration": 1900.0, "axis_jerk": 3e4, "period_s": 2e-3}
    (feed,) = nl.motion.plan_program([curve], **limits)
    t = np.concatenate([feed.times[:-1] + part * np.diff(feed.times) for part in np.linspace(0.02, 0.98, 13)])
    u = curve.parameter_at(np.clip(feed.displacement(t), 0.0, curve.length()))
    t, u = (row[np.abs(u[:, None] - np.linspace(0, 1, 9)).min(axis=1) > 1e-7] for row in (t, u))
    tangent, curvature, rate = geometry(curve, u)
    v, a, j = (one(t)[:, None] for one in (feed.speed, feed.acceleration, feed.jerk))
    assert np.abs(j * tangent + 3.0 * v * a * curvature + v**3 * rate).max() <= 3e4 * (1.0 + 1e-6)


def test_where_a_limit_binds_within_a_cell_alone_the_plan_is_lowered_until_it_holds():
    """A turn of 56 nm, in whose cells an axis takes 0.1 % more jerk than at their ends, was refused."""
    rng = np.random.default_rng(10)
    count, degree = int(rng.integers(5, 12)), int(rng.integers(3, 5))
    steps = rng.normal((2, 0), 3, (count, 2))
    curve = nl.interpolate_curve(np.cumsum(steps, axis=0), degree)
    feed = nl.plan_feed(
        curve, speed=60.0, acceleration=800.0, jerk=2e4, axis_acceleration=600.0, axis_jerk=2e4, period_s=1e-3
    )
    assert max(feed.certificate().uses.values()) <= 1.0 + 1e-6


@pytest.mark.parametrize("degrees", [90.0, 30.0, 6.0, 1.0])
@pytest.mark.parametrize("period_s", [1e-3, 4e-3])
def test_a_plan_through_a_corner_is_no_slower_than_a_stop_there(degrees, period_s):
    """Third differences of the points, stops included, keep the jerk of axes."""
    limits = {"speed": 80.0, "acceleration": 1000.0, "axis_jerk": 1.5e4, "period_s": period_s}
    turn = np.radians(degrees)
    corners = np.array([(0, 0), (5, 0), (5 + 5 * np.cos(turn), 5 * np.sin(turn))])
    curve = nl.NurbsCurve(1, [0, 0, 1, 2, 2], corners)
    lines = [nl.NurbsCurve(1, [0, 0, 1, 1], corners[k : k + 2]) for k in (0, 1)]
    feed, stops = nl.plan_feed(curve, **limits), nl.plan_feed(lines, **limits)
    assert feed.duration <= sum(one.duration for one in stops) + 1e-9
    points = nl.trace(curve, feed, stepper="exact").points
    points = np.vstack([[points[0]] * 3, points, [points[-1]] * 3])
    assert np.abs(np.diff(points, 3, axis=0)).max() <= limits["axis_jerk"] * period_s**3


@pytest.mark.parametrize("period_s", [2e-3, 4e-3])
@pytest.mark.parametrize("more", [{}, {"axis_acceleration": 700.0}])
def test_without_jerk_teeth_take_no_longer_than_a_stop_at_each(more, period_s):
    """Sharp teeth of 5 mm; second differences of the points keep the accelerations."""
    teeth = [(x, 5.0 * (x % 2)) for x in range(12)]
    curve = nl.interpolate_curve(teeth, 1)
    feed = nl.plan_feed(curve, speed=80.0, acceleration=1000.0, period_s=period_s, **more)
    least = min(1000.0, more.get("axis_acceleration", 1000.0) / (5.0 / np.sqrt(26.0)))
    assert feed.duration <= 11 * 2.0 * np.sqrt(np.sqrt(26.0) / least) * 1.002 + period_s
    points = nl.trace(curve, feed, stepper="exact").points
    second = np.diff(np.vstack([[points[0]] * 2, points, [points[-1]] * 2]), 2, axis=0) / period_s**2
    assert np.linalg.norm(second, axis=1).max() <= 1000.0 * (1.0 + 1e-6)
    assert np.abs(second).max() <= more.get("axis_acceleration", 1000.0) * (1.0 + 1e-6)


@pytest.mark.parametrize("jerk", [None, 2e4])
@pytest.mark.parametrize("degrees", [178.0, 90.0, 30.0, 3.0])
def test_no_way_through_a_corner_is_shorter_than_the_certificate_says(degrees, jerk):
    """Neither a stop there, nor S-curves or ramps to the speed that the corner allows, held at it alone."""
    turn, period, most = np.radians(degrees), 4e-3, 1000.0
    curve = nl.NurbsCurve(1, [0, 0, 1, 2, 2], [(0, 0), (5, 0), (5 + 5 * np.cos(turn), 5 * np.sin(turn))])
    feed = nl.plan_feed(curve, speed=80.0, acceleration=most, jerk=jerk, period_s=period)
    corner = min(80.0, most * period / (2 * np.sin(turn / 2)))

    def half(slow):
        """5 mm from rest to a speed: the closed form, the top speed by bisection."""

        def ramp(gain):
            peak = most if jerk is None else min(most, np.sqrt(jerk * gain))
            return gain / peak + (0.0 if jerk is None else peak / jerk)

        def left(top):
            return 5.0 - 0.5 * top * ramp(top) - 0.5 * (top + slow) * ramp(top - slow) if top > slow else 5.0

        top = brentq(left, slow, 80.0) if left(80.0) < 0.0 else 80.0
        return ramp(top) + ramp(top - slow) + left(top) / top

    least = feed.certificate().least_s
    assert least - period <= 2.0 * half(corner) <= min(feed.duration, 2.0 * half(1e-6)) + 1e-9
    assert least >= 0.995 * 2.0 * half(corner)


def _differences(points, starts, feed, order, period_s):
    """Differences of positions a period apart along a polyline, by linear interpolation over its length."""
    at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    lengths = feed.displacement(starts[:, None] + period_s * np.arange(order + 1))
    places = np.stack([np.interp(lengths, at, axis) for axis in points.T], axis=2)
    return np.diff(places, order, axis=1)[:, 0] / period_s**order


WAVE = np.array([0.0, 0.0, 1.0, 1.0])[np.arange(60) % 4]
ACROSS = {
    "1e-9 mm": (np.array([(0, 0), (10, 0), (10, 1e-9), (20, 1e-9)]), 1.0),
    "1e-6 mm": (np.array([(0, 0), (10, 0), (10, 1e-6), (20, 1e-6)]), 1.0),
    "a fine circle": (3.0 * np.column_stack([f(np.linspace(0.0, 6.0, 3000)) for f in (np.cos, np.sin)]), 2.5),
    "steps at random": (
        np.column_stack([0.0095 * np.arange(60), 1e-3 * np.random.default_rng(4).integers(0, 2, 60)]),
        np.inf,
    ),
    "steps in pairs": (np.column_stack([0.02 * np.arange(60), 2e-3 * WAVE]), np.inf),
}


@pytest.mark.parametrize("jerks", [{}, {"jerk": 2e4}, {"axis_acceleration": 900.0, "axis_jerk": 2.5e4}])
@pytest.mark.parametrize("shape", ACROSS)
def test_corners_of_one_period_are_added_as_vectors(shape, jerks):
    """Corners that cancel cost no time, and no phase of the periods sees more than a limit allows."""
    (points, most), period = ACROSS[shape], 1e-3
    limits = {"speed": 100.0, "acceleration": 1000.0, "period_s": period} | jerks
    curve = nl.NurbsCurve(1, np.arange(len(points) + 2).clip(1, len(points)), points)
    feed = nl.plan_feed(curve, **limits)
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (curve.length(), 0)])
    assert feed.duration <= most * nl.plan_feed(line, **limits).duration + 2 * period
    at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    met = np.concatenate([feed.time_at(at), np.arange(0.0, feed.duration, 0.13 * period)])
    for order in (2, 3):
        starts = (met[:, None] - period * np.arange(order + 1)).ravel()
        starts = starts[(starts >= 0.0) & (starts <= feed.duration - order * period)]
        found = _differences(points, starts, feed, order, period)
        if order == 2:
            assert np.linalg.norm(found, axis=1).max() <= limits["acceleration"] * (1.0 + 1e-6)
        name = "axis_acceleration" if order == 2 else "axis_jerk"
        assert np.abs(found).max() <= limits.get(name, np.inf) * (1.0 + 1e-6)


def test_a_corner_leaves_room_for_what_speeds_up_in_the_last_cell_of_its_zone():
    """One of eight was 1.5e-4 beyond the acceleration of an axis in the two periods around it."""
    steps = np.random.default_rng(3).normal(size=(9, 2)) * 2.0
    points = np.cumsum(np.vstack([[0.0, 0.0], steps]), axis=0)
    limits = {"speed": 100.0, "acceleration": 2000.0, "jerk": 2e5, "axis_acceleration": 150.0}
    period, curve = 1e-3, nl.interpolate_curve(points, 1)
    feed = nl.plan_feed(curve, **limits, period_s=period)
    at = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    starts = feed.time_at(at[1:-1]) - period
    found = np.abs(_differences(points, starts, feed, 2, period)).max()
    assert 0.99 * limits["axis_acceleration"] <= found <= (1.0 + 1e-6) * limits["axis_acceleration"]
