"""The whole path: Verilog, twin, and the same method in float64."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import (
    Format,
    build_program,
    evaluate_cu,
    load_curve,
    load_feed,
    run_twin,
    simulate_cu,
    simulate_path,
)

CURVE, PERIOD_S, SPEED = nl.paper.CURVE, nl.paper.PERIOD_S, nl.paper.SPEED
PLANS = {
    "ramps": nl.plan_feed(CURVE, speed=SPEED, acceleration=40.0, period_s=PERIOD_S),
    "triangle": nl.plan_feed(CURVE, speed=SPEED, acceleration=1.5, period_s=PERIOD_S, tangential_only=True),
    "moving ends": nl.plan_feed(
        CURVE, speed=SPEED, acceleration=40.0, period_s=PERIOD_S, start_speed=1.0, end_speed=2.0
    ),
}


@pytest.fixture(scope="module")
def cruise():
    """The paper's path at its constant speed, by the Verilog and by float64."""
    return [nl.trace(CURVE, SPEED, stepper=name, period_s=PERIOD_S) for name in ("rtl", "paper")]


def test_trace_runs_the_verilog_as_the_paper_steps(cruise):
    rtl, paper = cruise
    assert len(rtl.u) == len(paper.u) == 1987
    assert np.abs(rtl.u - paper.u).max() <= 2e-7
    assert np.abs(rtl.arc_fluctuation - paper.arc_fluctuation)[:-1].max() <= 5e-5
    assert rtl.evaluations == paper.evaluations
    assert np.array_equal(rtl.u[[0, -1]], CURVE.domain)


def test_cycles_keep_their_bars(cruise):
    cycles = cruise[0].details["cycles"]
    assert cycles.shape == (1986,)
    assert cycles[:4].max() <= 200
    assert np.median(cycles[4:]) == 41
    assert cycles[4:].max() <= 50  # where u enters another span
    assert cycles[:12].sum() <= 1100
    assert cruise[0].details["total_cycles"] >= cycles.sum()


@pytest.mark.parametrize("plan", PLANS)
def test_the_twin_follows_float64_on_every_ramp(plan):
    feed = PLANS[plan]
    paper = nl.trace(CURVE, feed, stepper="paper")
    hardware = build_program(CURVE, feed, PERIOD_S, len(paper.u) - 1)
    found = run_twin(hardware)
    assert found.flags == ()
    assert len(found.u) == len(paper.u)
    assert np.abs(hardware.curve.from_u(found.u) - paper.u).max() <= 2e-7


@pytest.mark.parametrize("arrangement", ["serial", "parallel", "cached"])
def test_the_first_twelve_parameters_take_at_most_40_microseconds(arrangement):
    plan = build_program(CURVE, PLANS["ramps"], PERIOD_S, 12, largest_step=10.0)
    clocks = simulate_path(plan, arrangement=arrangement).clocks
    assert clocks[11] <= 2000


def short(periods=40, **options):
    """Cut after some periods by a step to the curve's end, which the largest step allows."""
    feed = nl.plan_feed(CURVE, speed=SPEED, acceleration=400.0, period_s=PERIOD_S)
    return build_program(CURVE, feed, PERIOD_S, periods, largest_step=10.0, **options)


@pytest.mark.parametrize("arrangement", ["serial", "parallel", "cached"])
def test_the_verilog_equals_the_twin(arrangement):
    hardware = short()
    sent, expected = simulate_path(hardware, arrangement=arrangement), run_twin(hardware)
    assert (sent.u, sent.points, sent.flags) == (expected.u, expected.points, ())


@pytest.mark.parametrize(
    ("arrangement", "points", "rows"), [("serial", 8, 1), ("parallel", 8, 4), ("cached", 1, 1)]
)
def test_a_watched_run_is_the_same_and_tells_what_works_when(arrangement, points, rows):
    plain = simulate_path(short(), arrangement=arrangement)
    watched = simulate_path(short(), arrangement=arrangement, watch=True)
    assert (watched.points, watched.clocks, plain.work) == (plain.points, plain.clocks, [])
    begin, end = plain.clocks[8:10]
    step = [(unit, row) for cycle, unit, row in watched.work if begin <= cycle < end]
    of_a_point = simulate_cu(CURVE, [0.1, 0.101]).cycles[1] + 1  # with the cycle in which it is started
    assert sum(unit in ("newer", "older") for unit, _ in step) == points * of_a_point
    assert {row for unit, row in step if unit == "root"} == set(range(rows))


def test_a_narrow_word_costs_accuracy():
    feed = PLANS["ramps"]
    paper = nl.trace(CURVE, feed, stepper="paper")
    worst = []
    for word in (27, 31, 35):
        hardware = build_program(CURVE, feed, PERIOD_S, len(paper.u) - 1, format=Format(word))
        found = hardware.curve.from_u(run_twin(hardware).u)
        worst.append(np.abs(found - paper.u[: len(found)]).max())
    assert worst[0] > 4 * worst[1] > 16 * worst[2]


def test_flags_stop_twin_and_verilog_alike():
    hardware = short(20)
    still = replace(hardware, feed=replace(hardware.feed, records=(), end_speed=0))
    wild = replace(hardware, first_chord=1)
    for broken, flag in ((still, "by_zero"), (wild, "overflow")):
        sent, expected = simulate_path(broken), run_twin(broken)
        assert sent.flags == expected.flags == (flag,)
        assert sent.u == expected.u


def test_a_run_that_stops_says_what_may_pass():
    """At a corner of 174 degrees the next u would lie behind; both cures pass it."""
    corner = nl.NurbsCurve(1, [0, 0, 1, 2, 2], [(0, 0), (10, 0), (0, 1)])
    coarse, fine = (nl.plan_feed(corner, speed=20, acceleration=200, period_s=t) for t in (1e-2, 2e-3))
    with pytest.raises(ValueError, match="points: backward; a shorter period or slope='exact' may pass it"):
        nl.trace(corner, coarse, stepper="rtl")
    for feed, slope in ((fine, "quotient"), (coarse, "exact")):
        assert nl.trace(corner, feed, stepper="rtl", slope=slope).u[-1] == 2.0


def test_a_curve_never_loaded_is_refused_by_the_hardware():
    hardware = short(20)
    no_periods = replace(hardware, feed=replace(hardware.feed, periods=0))
    sent = simulate_path(no_periods)
    assert sent.u == []
    assert sent.flags == ("bad curve",)


#: Arrangement -> a plan that these limits bind; the arrangements share the module that reads its table.
LIMITED = {
    arrangement: (limits, nl.plan_feed(CURVE, speed=40.0, acceleration=2000.0, period_s=PERIOD_S, **options))
    for arrangement, limits, options in (
        ("serial", ("speed", "acceleration", "jerk"), {"jerk": 4e5}),
        ("parallel", ("chord_error", "acceleration"), {"chord_error": 5e-5}),
        ("cached", ("speed", "chord_error", "acceleration", "jerk"), {"jerk": 4e5, "chord_error": 5e-5}),
    )
}


@pytest.mark.parametrize("arrangement", LIMITED)
def test_plans_limited_by_jerk_and_curvature_run_bit_for_bit(arrangement):
    limits, feed = LIMITED[arrangement]
    assert set(limits) <= set(feed.limited_by)
    paper = nl.trace(CURVE, feed, stepper="paper")
    hardware = build_program(CURVE, feed, PERIOD_S, len(paper.u) - 1)
    sent, expected = simulate_path(hardware, arrangement=arrangement), run_twin(hardware)
    assert (sent.u, sent.points, sent.flags) == (expected.u, expected.points, ())
    assert np.abs(hardware.curve.from_u(sent.u) - paper.u).max() <= 1e-8


def test_every_speed_of_a_table_is_that_of_the_plan():
    for feed in (*(feed for _, feed in LIMITED.values()), *PLANS.values()):
        loaded = load_feed(feed, PERIOD_S, 10_000, 31, Format())
        times = np.arange(0.0, feed.duration, PERIOD_S / 2)
        speeds = np.array(list(islice(loaded.samples(), len(times)))) / (PERIOD_S / 24 * 2.0**39)
        assert np.abs(speeds - feed.speed(times)).max() <= 1e-6 * feed.peak + 1e-9
        assert len(loaded.records) < 256


def test_a_path_that_ends_early_is_no_jump_but_a_flag():
    """The paper's curve with 1986 instead of 2086 periods once jumped 204 um at its end."""
    hardware = build_program(CURVE, PLANS["ramps"], PERIOD_S, 1986)
    sent, expected = simulate_path(hardware), run_twin(hardware)
    assert sent.flags == expected.flags == ("too_far",)
    assert sent.points == expected.points
    assert np.abs(np.diff(sent.points, axis=0)).max() <= hardware.largest_step


def test_limits_of_the_axes_are_checked():
    low = CURVE.control_points.min(axis=0) - 1.0
    limits = np.column_stack([low, low + 2.0])
    hardware = build_program(CURVE, PLANS["ramps"], PERIOD_S, 2086, axis_limits=limits)
    sent = simulate_path(hardware)
    assert sent.flags == run_twin(hardware).flags == ("beyond",)
    assert np.all(hardware.curve.from_points(sent.points) <= limits[:, 1])


def test_small_weights_leave_room_for_their_division():
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [[0.0, 0.0], [7.99999999, 1.0]], [1.0, 1 / 1023.7])
    loaded = load_curve(line)
    for u in range(loaded.last_u - 200, loaded.last_u + 1):
        assert not evaluate_cu(loaded, u).overflow
