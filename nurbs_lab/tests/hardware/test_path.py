"""The whole path: Verilog, twin, and the same method in float64."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import Format, LoadedFeed, build_program, load_feed, run_twin, simulate_path

CURVE, PERIOD_S, SPEED = nl.paper.CURVE, nl.paper.PERIOD_S, nl.paper.SPEED
PLANS = {
    "ramps": nl.plan_feed(CURVE, speed=SPEED, acceleration=40.0, period_s=PERIOD_S),
    "triangle": nl.plan_feed(CURVE, speed=SPEED, acceleration=1.5, period_s=PERIOD_S),
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
    assert cycles[:4].max() <= 400
    assert cycles[4:].max() <= 100
    assert cycles[:12].sum() <= 3000
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
def test_the_first_twelve_parameters_take_at_most_60_microseconds(arrangement):
    clocks = simulate_path(build_program(CURVE, PLANS["ramps"], PERIOD_S, 12), arrangement=arrangement).clocks
    assert clocks[11] <= 3000


def short(periods=40, **options):
    feed = nl.plan_feed(CURVE, speed=SPEED, acceleration=400.0, period_s=PERIOD_S)
    return build_program(CURVE, feed, PERIOD_S, periods, **options)


@pytest.mark.parametrize(
    ("arrangement", "slope"),
    [("cached", "quotient"), ("serial", "quotient"), ("parallel", "quotient"), ("cached", "history")],
)
@pytest.mark.parametrize("trials", [0, 2])
def test_the_verilog_equals_the_twin(arrangement, slope, trials):
    hardware = short(trials=trials)
    sent = simulate_path(hardware, arrangement=arrangement, slope=slope)
    expected = run_twin(hardware, history=slope == "history")
    assert (sent.u, sent.points, sent.flags) == (expected.u, expected.points, ())


def constant(trials=0):
    feed = nl.trace(CURVE, SPEED, stepper="paper", period_s=PERIOD_S).feed
    return build_program(CURVE, feed, PERIOD_S, 2100, trials=trials)


def chord_fluctuation(hardware, **options):
    """Of every step but the last, and whether the step lies well inside a span."""
    u = hardware.curve.from_u(run_twin(hardware, **options).u)
    chord = np.linalg.norm(np.diff(CURVE(np.clip(u, 0, 1)), axis=0), axis=1)
    inside = np.ones(len(u) - 2, dtype=bool)
    # For ten steps after the start and each knot the stored points and slopes still reach across it.
    for step in (1, *np.searchsorted(u, np.unique(CURVE.knots)[1:-1])):
        inside[step - 1 : step + 10] = False
    return np.abs(chord[:-1] / (SPEED * PERIOD_S) - 1), inside


def test_history_and_corrector_gain_forty_times():
    quotient, quotient_inside = chord_fluctuation(constant())
    history, history_inside = chord_fluctuation(constant(), history=True)
    corrected, _ = chord_fluctuation(constant(trials=1))
    assert quotient[quotient_inside].max() >= 40 * history[history_inside].max()
    assert quotient.max() >= 40 * corrected.max()


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
    still = replace(hardware, feed=replace(hardware.feed, rise_by=0, rise_from=0))
    wild = replace(hardware, first_chord=1)
    for broken, flag in ((still, "by_zero"), (wild, "overflow")):
        sent, expected = simulate_path(broken), run_twin(broken)
        assert sent.flags == expected.flags == (flag,)
        assert sent.u == expected.u


def test_a_curve_never_loaded_is_refused_by_the_hardware():
    hardware = short(20)
    no_periods = replace(hardware, feed=replace(hardware.feed, periods=0))
    sent = simulate_path(no_periods)
    assert sent.u == []
    assert sent.flags == ("bad curve",)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"arrangement": "fast"}, "arrangement"),
        ({"slope": "exact"}, "slope"),
        ({"slope": "history", "arrangement": "serial"}, "cached"),
        ({"trials": 8}, "trials"),
    ],
)
def test_options_are_checked(options, message):
    with pytest.raises(ValueError, match=message):
        nl.trace(CURVE, SPEED, stepper="rtl", period_s=PERIOD_S, **options)


def test_feeds_that_vt_cannot_make_are_refused():
    smooth = nl.plan_feed(CURVE, speed=SPEED, acceleration=40.0, jerk=4000.0, period_s=PERIOD_S)
    with pytest.raises(ValueError, match="one ramp up"):
        nl.trace(CURVE, smooth, stepper="rtl")
    with pytest.raises(ValueError, match="lower the speed"):
        load_feed(PLANS["ramps"], 1.0, 3, 31, Format())


@pytest.mark.parametrize("word", [17, 35])
@pytest.mark.parametrize("line", ["rise_from", "rise_by", "cruise", "fall_from", "fall_by", "end_speed"])
def test_a_speed_that_rounds_beyond_its_word_is_refused(word, line):
    format = Format(word)
    lines = {**dict.fromkeys(("rise_from", "rise_by", "cruise", "fall_from", "fall_by", "end_speed"), 0)}
    most = (1 << word + 15) - (1 << 15) - 1
    feed = LoadedFeed(format, fall_at=9, periods=9, **{**lines, line: most})
    assert max(islice(feed.samples(), 20)) <= format.largest
    for wrong in (most + 1, -1):
        with pytest.raises(ValueError, match=f"{line} must be from 0 to {most}"):
            replace(feed, **{line: wrong})


def test_ramps_too_steep_for_their_register_are_refused():
    steep = nl.plan_feed(CURVE, speed=SPEED, acceleration=1e9, period_s=PERIOD_S)
    with pytest.raises(ValueError, match=r"rise_by .* lower"):
        build_program(CURVE, steep, PERIOD_S, 2000)
