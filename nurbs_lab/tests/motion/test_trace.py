"""What holds for the path of every stepper, on every kind of curve."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.interpolate import BSpline

import nurbs_lab as nl


def test_the_constant_feed_of_the_paper_takes_1986_periods():
    path = nl.trace(nl.paper.CURVE, nl.paper.SPEED, stepper="exact", period_s=nl.paper.PERIOD_S)
    assert len(path.moved) == 1986
    assert path.moved.sum() == pytest.approx(7.941806132933825, rel=1e-14)
    assert path.final_lag == pytest.approx(0.0, abs=1e-14)
    assert repr(path).startswith("ToolPath(exact, 1986 steps")


@pytest.mark.parametrize("stepper", nl.motion.software_steppers())
def test_a_motion_of_one_period_is_one_step(stepper):
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (1e-6, 0)])
    plan = nl.plan_feed(line, speed=40.0, acceleration=400.0, jerk=8000.0, period_s=1e-2)
    path = nl.trace(line, plan, stepper=stepper)
    np.testing.assert_array_equal(path.points, [(0, 0), (1e-6, 0)])
    assert path.moved == pytest.approx(path.commanded)


@pytest.mark.parametrize("stepper", ["exact", "history-arc", "adams-arc"])
def test_a_motion_that_ends_at_speed_ends_on_its_schedule(stepper):
    for period_s in (2.5e-4, 1e-3, 1e-2):
        limits = {"speed": 40.0, "acceleration": 400.0, "period_s": period_s}
        feed = nl.plan_feed(nl.nurbs.circle(10.0), end_speed=25.0, **limits)
        path = nl.trace(nl.nurbs.circle(10.0), feed, stepper=stepper)
        assert path.t[-1] == pytest.approx(feed.duration, rel=1e-12)
        assert path.moved[-1] == pytest.approx(feed.length - feed.displacement(path.t[-2]), rel=0.01)


def test_statistics_tell_steps_apart_that_meet_a_knot_or_a_corner():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3, tangential_only=True)
    path = nl.trace(nl.paper.CURVE, feed, stepper="adams")
    assert path.knot_steps.sum() == 4
    assert list(np.flatnonzero(path.corner_steps)) == [100, 1985]
    assert np.count_nonzero(~path.undisturbed) == 6 * 9
    everywhere, calm = path.statistics(), path.statistics(undisturbed=True)
    errors = np.abs(path.arc_fluctuation[:-1])
    assert everywhere["max"] == errors.max()
    assert everywhere["rms"] == pytest.approx(np.linalg.norm(errors) / np.sqrt(errors.size))
    assert np.mean(errors <= everywhere["p99"]) == pytest.approx(0.99, abs=1e-3)
    assert calm["max"] < 1e-2 * everywhere["max"]
    assert path.statistics("chord")["max"] == np.abs(path.chord_fluctuation[:-1]).max()


@pytest.mark.parametrize(
    ("wrong", "kind", "words"),
    [
        ({"stepper": "rk44"}, ValueError, "did you mean 'rk4'"),
        ({"stepper": "qqq"}, ValueError, "choose from"),
        ({"period_s": None}, ValueError, "period_s"),
        ({"period_s": 5.0}, ValueError, "shorter than one step"),
        ({"feed": 1e-300}, ValueError, "the time that feed takes is"),
        ({"trials": 2}, TypeError, "'adams' has no option 'trials'; it takes none"),
        ({"stepper": "taylor3", "order": 1e101}, TypeError, "'taylor3' has no option 'order'"),
        ({"stepper": "rk4", "order": [4]}, TypeError, "'rk4' has no option 'order'"),
        ({"stepper": "chord-corrected", "trials": 21}, ValueError, "trials must be 1 to 20"),
        ({"stepper": "rtl", "format": 35}, TypeError, "format must be a Format"),
    ],
)
def test_refusals(wrong, kind, words):
    with pytest.raises(kind, match=words):
        nl.trace(nl.paper.CURVE, **{"feed": 4.0, "period_s": 1e-3, **wrong})


@pytest.mark.parametrize(
    ("curve", "words"),
    [
        (nl.NurbsCurve(2, [0, 0, 0, 1, 2, 2, 2], [(0, 0), (1, 1), (1, 1), (3, 0)]), "cusp at u = 1"),
        (nl.NurbsCurve(3, [0, 0, 0, 0, 1, 1, 1, 1], [(0, 0), (2, 2), (0, 2), (2, 0)]), "cusp at u = 0.5"),
        (  # at ((u - 0.3)², (u - 0.3)³)
            nl.NurbsCurve(
                3,
                [0, 0, 0, 0, 1, 1, 1, 1],
                [(0.09, -0.027), (-0.11, 0.063), (0.07 / 3, -0.147), (0.49, 0.343)],
            ),
            "cusp at u = 0.3",
        ),
        (nl.NurbsCurve(3, [0] * 4 + [1] * 4, [(0, 0), (1, 0), (2, 1), (2, 1)]), "double end.*take 'exact'"),
        (nl.NurbsCurve(1, [0, 0, 1, 1], [(2, 2), (2, 2)]), "no length"),
        (nl.NurbsCurve(1, [0, 0, 1, 1], [(1,), (2,)]), "2-D or 3-D"),
    ],
)
def test_curves_that_cannot_be_stepped_say_where_and_why(curve, words):
    with pytest.raises(ValueError, match=words):
        nl.trace(curve, 1.0, period_s=1e-3)


def test_a_feed_for_another_curve_is_refused():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    with pytest.raises(ValueError, match="plan the feed on this curve"):
        nl.trace(nl.motion.benchmark_curves()["circle"].curve, feed)


def test_a_plan_is_run_with_the_period_it_was_made_for():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    assert nl.trace(nl.paper.CURVE, feed, period_s=1e-3).period_s == feed.period_s
    with pytest.raises(ValueError, match=r"period_s = 0\.002 s is not that of the plan, 0\.001 s"):
        nl.trace(nl.paper.CURVE, feed, period_s=2e-3)


@pytest.mark.parametrize("name", ["history-arc", "adams-arc", "exact"])
def test_a_span_too_short_to_be_sampled_is_passed(name):
    """Two knots 1e-9 apart hold half the length of this curve."""
    curve = nl.NurbsCurve(1, [0, 0, 0.5, 0.5 + 1e-9, 1, 1], [(0, 0), (1, 0), (1, 2), (2, 2)])
    path = nl.trace(curve, 4.1, stepper=name, period_s=1e-3)
    np.testing.assert_allclose(path.moved, path.commanded, rtol=1e-4)


def test_a_step_that_moves_too_far_says_so():
    butterfly = nl.motion.benchmark_curves()["butterfly"].curve
    feed = nl.plan_feed(butterfly, speed=50.0, acceleration=500.0, period_s=1e-3, tangential_only=True)
    far, near = (nl.trace(butterfly, feed, stepper=name) for name in ("history", "history-arc"))
    assert far.arc_fluctuation[:-1].max() == pytest.approx(0.3, abs=0.01)
    assert near.arc_fluctuation[:-1].max() < 1e-3


def test_a_new_stepper_needs_one_registration():
    code = (
        "import dataclasses, nurbs_lab as nl; "
        "ours = nl.motion.register(dataclasses.replace(nl.STEPPERS['exact'], name='mine')); "
        "print(ours.name, nl.trace(nl.paper.CURVE, 4.0, stepper='mine', period_s=0.01).stepper)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["mine", "mine"]


@pytest.mark.parametrize(
    ("spoil", "refused"),
    [
        (lambda u: np.concatenate([u[:5], u[2:]]), "step 4 at .*: no forward step"),
        (lambda u: np.concatenate([u[:5], [np.nan], u[6:]]), "step 4 at .*: no forward step"),
        (lambda u: u[:-3], "the end of the curve is not reached"),
        (lambda u: np.concatenate([u[:-1], [1.01]]), "the end of the curve is not reached"),
    ],
)
def test_a_rule_that_goes_back_or_stops_short_is_refused(spoil, refused):
    def run(job):
        return nl.motion.Steps(spoil(nl.STEPPERS["rk4"].run(job).u), (0, 4, 0, 0))

    rule = nl.motion.Stepper("spoiled", "wrong on purpose", (0, 4, 0, 0), run)
    with pytest.raises(ValueError, match=refused):
        nl.trace(nl.paper.CURVE, 4.0, stepper=rule, period_s=1e-2)


def test_a_rule_may_give_a_list_but_not_bare_parameters():
    wanted = nl.trace(nl.paper.CURVE, 4.0, stepper="rk4", period_s=1e-2).u

    def traced(answer):
        rule = nl.motion.Stepper("mine", "as a reader writes it", (0, 4, 0, 0), lambda job: answer)
        return nl.trace(nl.paper.CURVE, 4.0, stepper=rule, period_s=1e-2).u

    np.testing.assert_array_equal(traced(nl.motion.Steps(wanted.tolist(), (0, 4, 0, 0))), wanted)
    with pytest.raises(TypeError, match="what 'mine' returns must be a Steps, got ndarray"):
        traced(wanted)


@pytest.mark.parametrize(
    ("u", "counts", "refused"),
    [
        ("abc", (0, 4, 0, 0), "u must hold real numbers, got 'abc'"),
        ([[0.0], [1.0]], (0, 4, 0, 0), "u must have shape"),
        (np.array([0, 1j]), (0, 4, 0, 0), "u must hold real numbers, got complex128"),
        ([], (0, 4, 0, 0), r"u of 'mine' begins with \[\]; it must begin with 0"),
        ([0.0, 1.0], (4, 0), "evaluations must have 4 coordinates, got 2"),
        ([0.1, 1.0], (0, 4, 0, 0), r"u of 'mine' begins with \[0.1\]; it must begin with 0"),
    ],
)
def test_what_a_rule_of_ones_own_returns_is_checked(u, counts, refused):
    def run(job):
        return nl.motion.Steps(u, counts)

    rule = nl.motion.Stepper("mine", "wrong on purpose", (0, 4, 0, 0), run)
    with pytest.raises((TypeError, ValueError), match=refused):
        nl.trace(nl.paper.CURVE, 4.0, stepper=rule, period_s=1e-2)
    with pytest.raises(TypeError, match="stepper must be a Stepper, got function"):
        nl.motion.register(run)


@pytest.mark.parametrize("stepper", ["adams", "rk4", "paper"])
def test_a_plan_whose_steps_leap_over_short_spans_is_refused(stepper):
    """A span of 1e-9 mm between others of 1 mm with knots as far apart: |C'| is 1e-9 of theirs."""
    x = np.append(np.arange(10.0), 9 + 1e-9 + np.arange(11.0))
    curve = nl.NurbsCurve(1, np.arange(23).clip(1, 21), np.column_stack([x, 0 * x]))
    feed = nl.plan_feed(curve, speed=50.0, acceleration=1000.0, period_s=1e-3)
    with pytest.raises(ValueError, match=rf"'{stepper}' leaps 10 mm ahead"):
        nl.trace(curve, feed, stepper=stepper)


@pytest.mark.parametrize("short", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("stepper", ["chord-corrected", "history-arc"])
def test_steppers_with_a_guard_pass_short_spans(stepper, short):
    x = np.append(np.arange(10.0), 9 + short + np.arange(11.0))
    curve = nl.NurbsCurve(1, np.arange(23).clip(1, 21), np.column_stack([x, 0 * x]))
    feed = nl.plan_feed(curve, speed=50.0, acceleration=1000.0, period_s=1e-3)
    path = nl.trace(curve, feed, stepper=stepper)
    moved = np.diff(np.interp(path.u, np.arange(1, 22), x))
    np.testing.assert_allclose(moved, np.diff(feed.displacement(path.t)), atol=1e-10)


def test_a_stepper_that_is_early_by_a_twentieth_of_a_plan_is_refused():
    x = np.cumsum([0.0, *[1.0, 0.2] * 10])
    curve = nl.NurbsCurve(1, np.arange(23).clip(1, 21), np.column_stack([x, 0 * x]))
    feed = nl.plan_feed(curve, speed=50.0, acceleration=1000.0, period_s=4e-4)
    with pytest.raises(ValueError, match=r"'adams' leaps .* steps for"):
        nl.trace(curve, feed, stepper="adams")


LONG_STEPS = {
    "a corner": (1, [0, 0, 1, 2, 2], [(0, 0), (10, 0), (13, 8)]),
    "a short span": (4, [0] * 5 + [1e-2] + [1] * 5, [(0, 0), (5, 9), (9, 1), (4, -8), (12, -3), (20, 4)]),
    "many turns": (6, [0] * 7 + [0.3, 0.5, 0.6] + [1] * 7, [(3 * k, 9 * (-1) ** k) for k in range(10)]),
}


@pytest.mark.parametrize("shape", LONG_STEPS.values(), ids=LONG_STEPS)
def test_the_chord_error_of_a_long_step_is_never_too_large(shape):
    """SciPy's curve at 20,001 places of each of 40 steps, and at its knots."""
    degree, knots, points = shape
    curve = nl.NurbsCurve(*shape)
    path = nl.trace(curve, curve.length() / 40.3, stepper="exact", period_s=1.0)
    spline = BSpline(np.array(knots, dtype=float), np.array(points, dtype=float), degree)
    for start, stop, measured in zip(path.u[:-1], path.u[1:], path.chord_error, strict=True):
        inside = [knot for knot in knots if start < knot < stop]
        arc = spline(np.sort(np.append(np.linspace(start, stop, 20_001), inside))) - spline(start)
        chord = arc[-1] / np.linalg.norm(arc[-1])
        largest = np.abs(arc[:, 0] * chord[1] - arc[:, 1] * chord[0]).max()
        assert 0.97 * largest - 1e-12 <= measured <= largest * (1.0 + 1e-6) + 1e-12
