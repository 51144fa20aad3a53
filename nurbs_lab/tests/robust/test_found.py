"""Calls that `make fuzz` found to be refused in the words of a library, each with its argument named."""

import re
import time

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.tests.clock import at_once_s
from nurbs_lab.tests.robust.calls import CURVE, FEED, GRID, LIMITS, LINE, SMALL
from nurbs_lab.tests.robust.calls_hardware import HARDWARE
from nurbs_lab.tests.robust.calls_parts import CALLS
from nurbs_lab.tests.robust.calls_pictures import PICTURES
from nurbs_lab.tests.robust.hostile import Broken

STOPS = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0, 0), (0, 0, 0), (1, 1, 1)])  # has no tangent at u = 0
PATH = nl.paper.CURVE  # in a plane
FOUND = [
    ("animation", "frame_s", 1e-9, "0.01 to 6"),
    ("animation", "frame_s", 100.0, "0.01 to 6"),
    ("animation", "values", Broken(), "a sequence"),
    ("finish", "tolerance", 1e-6, "at least"),
    ("finish", "floor", -1e6, "too low"),
    ("verify", "spacing", 1e-3, "too small"),
    ("waveform", "signals", {"clk": 3}, "a sequence"),
    ("waveform", "signals", {"clk": [[1], 0]}, "numbers, str or None"),
    ("build_exact_program", "period_s", 2.4e-9, "too short"),
    ("Shell.to_mesh", "tolerance", 1e-7, "needs more than"),
    ("milling", "frames", 49, "48"),
    ("leaderboard", "rows", Broken(), "a sequence"),
    ("surface", "color", np.zeros(()), "a colour"),
    ("layers", "curves", [PATH, CURVE], "in space"),
    ("curve", "curve", STOPS, "no value at u = 0"),
    ("Reconstruction.to_mesh", "tolerance", 1e-9, "needs more than"),
    ("word_length_study", "curve", [], "NurbsCurve"),
    ("load_feed", "period_s", 1e-300, "too short"),
    ("count_cycles", "steps", 100_000, "5 to 1000"),
    ("build_exact_program", "period_s", 1e-300, "too short"),
    ("build_exact_program", "feed", FEED, "but the curves are"),
    ("build_exact_program", "period_s", 9e18, "longer than the whole feed"),
    ("reconstruct", "layers", 470_873, "1 to 100000"),
    ("reconstruct by height", "layer_height", 1e-5, "more than 100000 layers"),
    ("smooth", "program_or_points", [(0, 0), (1, 1), (2, 1.5), (3, 1.8), (1e99, 2), (4, 2)], "mm apart"),
    ("trace_blocks", "override", 1e-7, "longer than 5000000 periods"),
    ("trace", "curve", np.array(["1", 2], object), "NurbsCurve"),
    ("trace", "curve", np.zeros((0, 3)), "NurbsCurve"),
    ("trace at one speed", "period_s", 1e-7, "at most 5000000"),
]


@pytest.mark.parametrize(("name", "argument", "bad", "said"), FOUND)
def test_found_calls_are_refused_by_name(name, argument, bad, said):
    call, good = (PICTURES | HARDWARE | CALLS)[name]
    good = good | {"comb": True} if name == "curve" else good
    with pytest.raises((ValueError, TypeError), match=rf"^{argument}\b.*{re.escape(said)}"):
        call(**{**good, argument: bad})


@pytest.mark.parametrize("tolerance", [1e-5, 1e-9, 1e-300])
def test_a_tolerance_that_no_smooth_patches_keep_takes_little_work(tolerance):
    start = time.process_time()
    made = nl.reconstruct(SMALL, layers=5, tolerance=tolerance)
    assert time.process_time() - start < at_once_s()
    assert made.deviation().max < 1e-7  # flat faces, exact but for rounding


def test_an_end_of_tiny_weight_is_found_where_it_is_nearest():
    """Among weights 1e7 apart the end was below the rounding of the others, which are 5e-6 mm away."""
    points = 1e3 + 1e-6 * np.array(
        [(2, 1, -1), (-1, -2, 1), (2, 0, 2), (1, 3, -2), (-1, -2, 0), (0, 1, 1), (-3, -2, -1)]
    )
    weights = [260, 1e-2, 2400, 0.065, 1.8, 390, 1.4e-4]
    curve = nl.NurbsCurve(3, [0, 0, 0, 0, 0.3, 0.64, 0.69, 1, 1, 1, 1], points, weights)
    u, distance = curve.closest_point((0.0, 0.0, 0.0))
    assert u == 1.0
    assert distance == pytest.approx(np.linalg.norm(points[-1]), rel=1e-15)


def test_derivatives_beyond_double_precision_are_refused():
    small = nl.NurbsCurve(2, [0, 0, 0, 1e-6, 1e-6, 1e-6], LINE[:3], [1, 100, 1])
    with pytest.raises(ValueError, match="order = 100: the derivatives are beyond double precision"):
        small.derivative(0.0, 100)


def test_a_part_names_the_tessellation_that_it_cannot_reach():
    surface = nl.interpolate_surface(GRID)
    with pytest.raises(ValueError, match=r"^part: tessellation = 1e-09 needs more than 3000 points"):
        nl.machining.prepare_part(surface, tessellation=1e-9)


def test_a_window_that_is_too_short_is_planned_again_only_when_it_is_longer(monkeypatch):
    """The axes take 8 million periods for what the speed would take 78; each window was planned 12 times."""
    limits = LIMITS | {"jerk": 4000.0, "axis_acceleration": 1e-9 * np.array([1.9, 1.4, 0.9])}
    whole, plans, plan = nl.plan_feed(CURVE, **limits), [], nl.motion.program.fastest_profile
    monkeypatch.setattr(
        nl.motion.program, "fastest_profile", lambda *a, **k: plans.append(a) or plan(*a, **k)
    )
    ((_, feed),) = nl.motion.plan_windows([CURVE], **limits)
    assert len(plans) <= 6  # three windows, each on a coarse and on a fine grid
    assert feed.duration == pytest.approx(whole.duration, rel=1e-3)


def test_a_flag_may_be_a_bool_of_numpy():
    PICTURES["mesh"][0](SMALL, edges=np.True_)


def test_any_time_of_a_frame_in_its_range_can_be_stored():
    call, good = PICTURES["animation"]
    assert call(**{**good, "frame_s": 2.3347983611243377}).frames == 2


def test_knots_1e_10_apart_leave_a_plan():
    """Samples beside such knots once made cells in which rounding was a jerk of 64 times the limit."""
    x = [-1, 0, 0, 2, 0, 1, 0, 1, 0, 2, -1, 0]
    y = [1, 1, 2, -1, 1, 1, 0, 0, 0, 1, -1, 0]
    weights = [1.4e-3, 0.86, 0.073, 1.1e-4, 7e-4, 0.07, 0.22, 9.4e-4, 0.039, 360, 1200, 4e-3]
    inner = 0.083 + np.array([0, 6.2e-11, 2.013e-8, 2.92e-8, 3.505e-7, 3.673e-7])
    curve = nl.NurbsCurve(5, [0.0] * 6 + inner.tolist() + [1.0] * 6, np.column_stack([x, y]), weights)
    limits = {"speed": 600.0, "acceleration": 34_000.0, "jerk": 775_000.0, "axis_speed": 70.0}
    plan = nl.plan_feed(curve, **limits, period_s=1e-5, end_speed=28.8)
    assert plan.duration < 0.1425  # twice that, or no plan at all
    assert np.abs(plan.jerk(plan.times)).max() <= limits["jerk"] * (1 + 1e-9)


def test_chord_errors_at_a_sharp_corner_are_distances_from_the_chord():
    """A path that turns back within a period passes beyond the end of the chord, not beside its line."""
    points = np.array([(-157, -406), (-250, 16), (-84, -81), (252, 70), (-195, 41.0)])
    curve = nl.NurbsCurve(1, [0, 0, 0.566, 0.642, 0.993, 1, 1], points)
    limits = {"speed": 400.0, "acceleration": 74_000.0, "period_s": 0.07, "chord_error": 0.04}
    plan = nl.plan_feed(curve, **limits, axis_acceleration=258_000.0)
    path = nl.trace(curve, plan, stepper="exact")
    for k in range(len(path.moved)):
        inside = points[1:-1][(curve.knots[2:-2] > path.u[k]) & (curve.knots[2:-2] < path.u[k + 1])]
        start, chord = path.points[k], path.points[k + 1] - path.points[k]
        part = np.clip((inside - start) @ chord / (chord @ chord), 0.0, 1.0)
        away = np.linalg.norm(inside - start - part[:, None] * chord, axis=1).max(initial=0.0)
        assert path.chord_error[k] == pytest.approx(away, rel=1e-9, abs=1e-9)
        assert away <= limits["chord_error"] * (1 + 1e-9)
