"""Answers carry certificates on the neighbourhoods of what was once wrong, hung or was refused in riddles.

Curves and surfaces have weights 1e8 apart, knots 1e-12 apart, coincident points and sizes from 1e-9 to 1e9,
far away from the origin.
"""

import re
import time

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import nurbs_lab as nl
from nurbs_lab.tests.clock import at_once_s
from nurbs_lab.tests.robust.calls import BLOCK, CURVE, SURFACE
from nurbs_lab.tests.robust.certificates import wrong
from nurbs_lab.tests.robust.hostile import mesh, spline

WHOLE = {"u0": None, "u1": None}


def answered(call, given, names):
    """Whether a call answers, with its certificate, and not with a refusal by one of the names, in time."""
    start, said = time.process_time(), ""
    try:
        assert wrong(call, given, call(**given)) == ""
    except ValueError as error:
        said = str(error)
        assert re.match(rf"(.*\b)?({names})\b", said), said
    assert time.process_time() - start < at_once_s()
    return not said


@given(st.integers(0, 10**6))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_lengths_and_their_inverses(seed):
    curve = spline(np.random.default_rng(seed), 1)
    total = curve.length()
    assert wrong(curve.length, WHOLE, total) == ""
    answered(curve.parameter_at, {"length": np.linspace(0.0, total, 5)}, "length|curve")


@given(st.integers(0, 10**6))
@settings(max_examples=10, deadline=None, derandomize=True)
def test_plans_keep_what_is_asked_of_them(seed):
    """Limits from those of a snail to those of light; the ends move or not."""
    rng = np.random.default_rng(seed)
    curve = spline(rng, 1)
    speed, acceleration, jerk, centripetal = curve.length() * 10.0 ** rng.uniform(-3, 6, 4)
    asked = {"speed": speed, "acceleration": acceleration, "centripetal_acceleration": centripetal}
    asked |= {"jerk": jerk if rng.random() < 0.5 else None, "start_speed": rng.choice([0.0, 0.1]) * speed}
    names = "speed|acceleration|jerk|period_s|start_speed|centripetal_acceleration|curve"
    answered(nl.plan_feed, {"curve": curve, **asked, "period_s": 1e-3}, names)


@pytest.mark.parametrize(("start", "end", "length"), [(1.89, 0.5, 27.8), (26.5, 40.5, 57.5)])
def test_plans_that_exist_are_found(start, end, length):
    """Both were once refused: 'no S-curve fits'."""
    angle = np.linspace(0.0, 2.0, 9)
    curve = nl.interpolate_curve(np.column_stack([np.cos(angle), 0.5 * np.sin(angle), 0.1 * angle]))
    curve = curve.scale(length / curve.length())
    asked = {"speed": 60.0, "acceleration": 736.9, "jerk": 5254.0, "chord_error": 1e-3, "period_s": 1e-3}
    asked |= {"start_speed": start, "end_speed": end, "centripetal_acceleration": 700.0}
    assert answered(nl.plan_feed, {"curve": curve, **asked}, "none")


def hairpin(width):
    return nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0), (1379, width), (0, 2 * width)])


@pytest.mark.parametrize("width", [1.0, 0.1, 1e-2])
def test_a_peak_of_curvature_between_samples_limits_the_speed(width):
    """A random curve of 2,758 mm once went round such a peak with 9.85 times the limit."""
    curve, limit = hairpin(width), 34_326.0
    feed = nl.plan_feed(
        curve, speed=109.0, acceleration=11_298.0, centripetal_acceleration=limit, period_s=1e-3
    )
    u = 0.5 + np.outer([-1, 1], np.geomspace(1e-9, 0.1, 300)).ravel()
    speed = feed.speed(feed.time_at([curve.length(None, one) for one in u]))
    assert (speed**2 * curve.curvature(u)).max() <= limit


@pytest.mark.parametrize("name", ["centripetal_acceleration", "axis_acceleration"])
@pytest.mark.parametrize("width", [1e-3, 1e-5])
def test_a_peak_of_curvature_beyond_double_precision_is_refused(width, name):
    """It was once passed with up to a hundred times the limit."""
    with pytest.raises(ValueError, match=rf"radius of \S+ mm at u = 0\.5.* {name} cannot be kept"):
        nl.plan_feed(hairpin(width), speed=109.0, acceleration=11_298.0, period_s=1e-3, **{name: 1e3})


CHANGES = {
    "split": {"u": 0.25},
    "insert_knot": {"u": 0.25},
    "refine": {"parameters": [0.25]},
    "elevate_degree": {},
    "reverse": {},
}


@pytest.mark.parametrize("name", CHANGES)
def test_changes_of_huge_shapes_speak_of_no_rows(name):
    """Near 1e99 they once said that 'rows must end in the weights'; the user gave no rows."""
    for size in (1e98, 9e98):
        curve = nl.NurbsCurve(CURVE.degree, CURVE.knots, size * CURVE.control_points / 4, CURVE.weights)
        answered(getattr(curve, name), CHANGES[name], "control_points|weights|curve")
        surface = nl.NurbsSurface(SURFACE.degrees, SURFACE.knots, size * SURFACE.control_points / 5)
        given = {"at" if key == "u" else key: value for key, value in CHANGES[name].items()}
        answered(getattr(surface, name), given, "control_points|weights|surface")


@given(st.integers(0, 10**6))
@settings(max_examples=8, deadline=None, derandomize=True)
def test_damaged_meshes_are_reconstructed_or_refused(seed):
    spoiled = mesh(np.random.default_rng(seed), BLOCK)
    answered(nl.reconstruct, {"mesh": spoiled, "layers": 3, "tolerance": 0.05}, "mesh|tolerance|triangles")


@given(st.integers(0, 10**6))
@settings(max_examples=25, deadline=None, derandomize=True)
def test_distances_are_those_of_the_points_found(seed):
    rng = np.random.default_rng(seed)
    for shape in (spline(rng, 1), spline(rng, 2)):
        vectors = [shape.knots] if isinstance(shape, nl.NurbsCurve) else shape.knots
        counts = [np.unique(k, return_counts=True)[1] for k in vectors]
        assume(all(count[1:-1].max(initial=0) < count[0] - 1 for count in counts))  # the shape has no gaps
        points = shape.control_points.reshape(-1, shape.dim)[:5] + rng.normal(size=shape.dim)
        assert wrong(shape.closest_point, {"points": points}, shape.closest_point(points)) == ""


@pytest.mark.parametrize("stretch", [1e-9, 1e-3, 1.0, 1e3, 1e9])
@pytest.mark.parametrize("size", [1e-100, 1e-9, 1.0, 1e9, 1e90])
def test_normals_are_unit_vectors_whatever_the_sizes_and_ranges(stretch, size):
    ball = nl.nurbs.sphere(size)
    knots = (ball.knots[0] * stretch, ball.knots[1])
    long = nl.NurbsSurface(ball.degrees, knots, ball.control_points, ball.weights)
    u, v = np.linspace(0.0, stretch, 9)[:, None], np.linspace(0.0, 1.0, 9)
    normals = long.normal(u, v)
    assert wrong(long.normal, {}, normals) == ""
    np.testing.assert_allclose(normals, long(u, v) / size, atol=1e-9)
