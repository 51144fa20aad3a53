"""Exact slopes: Verilog, twin, and the arc length by the core's own quadrature."""

import os
import re
from dataclasses import replace
from itertools import groupby, pairwise
from pathlib import Path

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import build_exact_program, run_exact, simulate_path
from nurbs_lab.hardware.exact import advance
from nurbs_lab.hardware.feed import distances
from nurbs_lab.hardware.interpolator import close_load, steps_of_run
from nurbs_lab.motion.feed import concatenate

CURVE, PERIOD_S, SPEED = nl.paper.CURVE, nl.paper.PERIOD_S, nl.paper.SPEED
PAGE = (Path(nl.__file__).parents[1] / "rtl" / "README.md").read_text()
FROM_REST = nl.plan_feed(CURVE, speed=SPEED, acceleration=40.0, period_s=PERIOD_S)


def arc_errors(curve, feed, period_s):
    """Moved less commanded length of each period of the twin, the commanded, the last bit; in mm."""
    program = build_exact_program(curve, feed, period_s)
    run = run_exact(program)
    assert run.flags == ()
    u = np.append(program.from_positions(run.u[:-1]), curve.domain[1])
    moved = np.array([curve.length(*ends) for ends in pairwise(u)])
    commanded = np.diff(feed.displacement(period_s * np.arange(len(u))))
    return moved - commanded, commanded, 2.0**-program.point_fraction


def test_the_papers_run_from_rest_is_right_to_a_millionth():
    error, commanded, last_bit = arc_errors(CURVE, FROM_REST, PERIOD_S)
    assert np.all(np.abs(error) <= 1e-6 * commanded + last_bit)


def test_space_curves_of_degree_3_are_right_to_a_millionth():
    points = np.column_stack([np.arange(8.0), np.sin(np.arange(8.0)), np.cos(np.arange(8.0) / 2)])
    curve = nl.interpolate_curve(points)
    feed = nl.plan_feed(curve, speed=8.0, acceleration=100.0, period_s=PERIOD_S)
    error, commanded, last_bit = arc_errors(curve, feed, PERIOD_S)
    assert np.all(np.abs(error)[:-1] <= 1e-6 * commanded[:-1] + last_bit)
    assert abs(error[-1]) <= 8 * last_bit  # which collects what the pieces have left


def test_a_period_of_ten_microseconds_moves_less_than_a_bit_wrong():
    curve = CURVE.split(0.02)[0]
    feed = nl.plan_feed(curve, speed=SPEED, acceleration=40_000.0, period_s=1e-5)
    error, commanded, last_bit = arc_errors(curve, feed, 1e-5)
    assert commanded.min() < 3e-5
    assert np.abs(error).max() <= last_bit


def test_the_verilog_equals_the_twin_on_the_papers_path_in_17_cycles_a_step():
    path = nl.trace(CURVE, FROM_REST, stepper="rtl", slope="exact")
    program = build_exact_program(CURVE, FROM_REST, PERIOD_S)
    twin = run_exact(program)
    assert np.array_equal(path.points, np.ldexp(np.array(twin.points, float), -program.point_fraction))
    assert np.abs(path.arc_fluctuation[1:-1]).max() <= 1e-4  # in per cent
    assert set(path.details["cycles"][2:-1]) == {17}
    assert np.array_equal(path.points[-1], CURVE(1.0))


def test_flags_stop_twin_and_verilog_alike():
    program = build_exact_program(CURVE, FROM_REST, PERIOD_S)
    short = replace(program, feed=program.feed[:1])
    sent, expected = simulate_path(short), run_exact(short)
    assert sent.flags == expected.flags == ("too_far",)
    assert (sent.u, sent.points) == (expected.u, expected.points)


CUSPED = [(0, 0), (1, 1), (0, 1), (1, 0)]  # nearly, if the inner points are a little farther apart or nearer


@pytest.mark.parametrize(
    ("points", "open_by", "speed"),
    [([(0, 0), (1, 1), (4, 0)], 0, 600.0), *((CUSPED, gap, 20.0) for gap in (-0.15, -0.05, 0.1))],
)
def test_steps_that_one_correction_cannot_follow_are_foreseen(points, open_by, speed):
    """The builder refuses them; at shorter periods the run goes to its end."""
    degree = len(points) - 1
    moved = np.array(points, float) + np.outer([0, 1, -1, 0][: degree + 1], [open_by, 0])
    curve, ran = nl.NurbsCurve(degree, [0] * (degree + 1) + [1] * (degree + 1), moved), []
    for period_s in 1e-3 * 0.5 ** np.arange(5):
        feed = nl.plan_feed(curve, speed=speed, acceleration=100 * speed, period_s=period_s)
        try:
            program = build_exact_program(curve, feed, period_s)
        except ValueError as error:
            assert "take a shorter period" in str(error)  # noqa: PT017
            continue
        ran.append(run_exact(program).flags)
    assert 0 < len(ran) < 5
    assert not any(ran)


def test_a_circle_is_a_circle_within_a_millionth_of_its_size():
    """The pieces are counted, the places compared with the radius, the steps with the feed."""
    for period_s, speed in ((1e-3, 40.0), (1e-4, 400.0)):
        circle = nl.nurbs.circle(10.0)
        feed = nl.plan_feed(circle, speed=speed, acceleration=400 * speed, period_s=period_s)
        program = build_exact_program(circle, feed, period_s)
        assert len(program.pieces) == 36
        points = np.ldexp(np.array(run_exact(program).points, float), -program.point_fraction)
        assert np.abs(np.hypot(*points.T[:2]) - 10.0).max() <= 1e-6 * 20.0
        turned = np.diff(np.unwrap(np.arctan2(points[:, 1], points[:, 0])))
        moved = np.diff(feed.displacement(period_s * np.arange(len(points))))
        assert np.abs(10.0 * turned - moved).max() <= 1e-6 * 20.0
    path = nl.trace(circle, feed, stepper="rtl", slope="exact")
    assert np.abs(path.points - circle(path.u)).max() <= 1e-6 * 20.0
    assert set(path.details["cycles"][3:-1]) == {24}


@pytest.mark.parametrize("weights", [None, [1.0, 3.0, 0.5, 1.0, 2.0], [0.02, 30.0, 0.5, 0.01, 2.0]])
def test_weights_and_high_degrees_run_within_a_millionth_of_the_size(weights):
    points = [[0, 0, 0], [1, 2, 1], [3, 2, 0], [5, -1, 2], [6, 0, 0]]
    curve = nl.NurbsCurve(4, [0] * 5 + [1] * 5, points, weights)
    feed = nl.plan_feed(curve, speed=20.0, acceleration=500.0, period_s=PERIOD_S)
    program = build_exact_program(curve, feed, PERIOD_S)
    run = run_exact(program)
    assert run.flags == ()
    _, away = curve.closest_point(np.ldexp(np.array(run.points, float), -program.point_fraction))
    assert away.max() <= 1e-6 * np.linalg.norm(np.ptp(points, axis=0))


@pytest.mark.parametrize("weight", [0.1, 1e-3])
def test_the_parameters_of_a_path_are_those_of_its_points(weight):
    weights = np.where(np.arange(7) % 2, weight, 1.0)
    points = np.column_stack([np.arange(7) * 10.0, np.where(np.arange(7) % 2, 12.0, 0.0)])
    curve = nl.NurbsCurve(3, [0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1], points, weights)
    feed = nl.plan_feed(curve, speed=40.0, acceleration=400.0, period_s=4e-3)
    program = build_exact_program(curve, feed, 4e-3)
    steps = steps_of_run(program, curve, run_exact(program), (0, 0), {})
    nearest, away = curve.closest_point(steps.points)
    assert np.abs(steps.u - nearest).max() <= 1e-8
    assert np.abs(np.linalg.norm(curve(steps.u) - steps.points, axis=1) - away)[1:-1].max() <= 1e-12 * 60


def chain(count):
    """Arcs that follow each other, one after another, and their feed."""
    curves, here, angle = [], np.zeros(2), 0.0
    for n in range(count):
        turned = angle + (0.3 if n // 10 % 2 else -0.3)
        ways = [(np.cos(a), np.sin(a)) for a in (angle, turned)]
        curves.append(nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], here + 0.05 * np.cumsum([(0, 0), *ways], axis=0)))
        here, angle = curves[-1].control_points[2], turned + (1.0 if n % 10 == 9 else 0.0)
    plan = nl.motion.plan_windows(curves, speed=8.0, acceleration=2000.0, period_s=PERIOD_S)
    return curves, concatenate([feed for _, feed in plan])


def test_a_job_of_many_curves_streams_bit_for_bit():
    """Of 70 curves, or of CURVES=1000."""
    count = int(os.environ.get("CURVES", "70"))
    curves, feed = chain(count)
    outputs = [7 * n % 16 for n in range(count)]
    program = build_exact_program(curves, feed, PERIOD_S, outputs=outputs)
    sent, expected = simulate_path(program), run_exact(program)
    assert len(program.batches()) == -(-count // 32)
    assert (sent.u, sent.points, sent.flags) == (expected.u, expected.points, ())
    assert sent.outputs == expected.outputs
    assert [bits for bits, _ in groupby(sent.outputs[1:])] == outputs
    points = np.ldexp(np.array(sent.points, float), -program.point_fraction)
    assert np.allclose(points[-1], curves[-1](1.0), rtol=0, atol=2.0**-program.point_fraction)
    assert len(points) == round(feed.duration / PERIOD_S) + 1


def test_a_short_period_misses_the_feed_by_what_its_tables_need():
    """The records of this plan would fill a bank in less than a stop takes."""
    feed = nl.plan_feed(CURVE, speed=40.0, acceleration=400.0, period_s=1e-4)
    run = run_exact(program := build_exact_program(CURVE, feed, 1e-4))
    assert run.flags == ()
    moves = np.array([*distances(program.feed)]) * 2.0 ** -(program.step_fraction + 28)
    assert (
        np.abs(np.diff(feed.displacement(1e-4 * np.arange(len(run.u)))) - moves).max() <= 1e-5 * 40.0 * 1e-4
    )
    assert np.abs(np.diff(moves)).max() <= 1.01 * 400.0 * 1e-8


def test_a_job_whose_banks_hold_less_than_a_stop_is_refused():
    """The tool rests before an empty bank. With more acceleration the same lines are a job."""

    def lines(each, speed, acceleration, period_s):
        starts = each * np.arange(100.0)
        curves = [nl.NurbsCurve(1, [0, 0, 1, 1], [[x, 0.0], [x + each, 0.0]]) for x in starts]
        path = nl.NurbsCurve(1, [0, 0, 1, 1], [[0.0, 0.0], [100 * each, 0.0]])
        feed = nl.plan_feed(path, speed=speed, acceleration=acceleration, period_s=period_s)
        return build_exact_program(curves, feed, period_s)

    with pytest.raises(ValueError, match=r"a stop may take \d+ periods, but \d+ fill a bank"):
        lines(0.05, 30.0, 200.0, PERIOD_S)
    with pytest.raises(ValueError, match="but 65535 fill a bank"):  # which is all that can be loaded
        lines(100.0, 900.0, 400.0, 3e-5)
    program = lines(0.05, 30.0, 2000.0, PERIOD_S)
    starts = [period for _, period in program.cuts()[:-1]]
    assert min(b - a for a, b in pairwise(starts[1:])) >= program.override.reserve


def test_a_piece_of_more_periods_than_its_length_has_bits_is_loaded_with_fewer():
    corner = nl.NurbsCurve(1, [0, 0, 1, 2, 2], [[0, 0], [600, 0], [600, 1]])
    feed = nl.plan_feed(corner, speed=0.9, acceleration=400.0, period_s=1e-3)
    program = build_exact_program(corner, feed, 1e-3)
    longest = max(piece.length for piece in program.pieces)
    assert longest < 1 << 63
    assert longest * 2.0 ** -(program.step_fraction + 12) == pytest.approx(600.0, rel=1e-12)


def test_the_package_loads_the_words_of_the_page():
    """The page has those of the formulas; a plan's feed differs from them by its rounding."""
    curve = nl.NurbsCurve(3, [0] * 4 + [1] * 4, [[0, 0], [4, 0], [8, 2], [11, 6]])
    feed = nl.plan_feed(curve, speed=20.0, acceleration=400.0, period_s=1e-3, tangential_only=True)
    rows = re.findall(r"^\| (\d) \| (\d+) \| (-?\d[-\d, ]*) \|$", PAGE, re.MULTILINE)
    words = [(int(a), int(b) + i, int(x)) for a, b, row in rows for i, x in enumerate(row.split(", "))]
    assert words.pop() == close_load(words)
    (loaded,) = build_exact_program(curve, feed, 1e-3).batches()
    told, made = ({word[:2]: word[2] for word in some} for some in (words, loaded))
    assert told.keys() == made.keys()
    for at, word in told.items():
        exact = at[0] != 1 and abs(word) < 1e15
        assert abs(made[at] - word) <= (0 if exact else 3e6), at  # of distances up to 1.5e18


def test_a_step_overflows_where_the_page_says():
    """What the guard compares is |C'|² at the foreseen midpoint of a step with that at its start."""
    (most,) = map(float, re.findall(r"On the paper's curve steps up to ([\d.]+) mm never overflow", PAGE))
    program = build_exact_program(CURVE, FROM_REST, PERIOD_S)
    for ds, overflows in ((most, False), (most + 0.001, True)):
        step, changes = round(np.ldexp(ds, program.step_fraction)), []
        for piece in program.pieces:
            slopes = [
                np.polynomial.Polynomial(np.ldexp(x, -program.point_fraction)).deriv() for x in piece.points
            ]
            for t in np.linspace(0.0, 1.0, 200, endpoint=False):
                speed = np.hypot(*(slope(t) for slope in slopes))
                middle = np.hypot(*(slope(min(t + ds / speed / 2, 1.0)) for slope in slopes))
                scale = 2.0 ** (piece.shift + 16 - program.step_fraction)
                root = round(2.0**30 * scale / speed)
                _, _, guard = advance(piece, int(t * 2**46), root, step, 34, cubic=False)
                changes.append(abs((middle / speed) ** 2 - 1.0))
                assert abs(abs(guard) * 2.0**-30 - changes[-1]) <= 1e-6
        assert (max(changes) >= 1 / 16) == overflows
