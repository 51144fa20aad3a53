"""What the hardware cannot hold or run is refused in words that name the cause."""

import numpy as np
import pytest

from nurbs_lab import NurbsCurve, interpolate_curve, paper, plan_feed, trace
from nurbs_lab.hardware import (
    Format,
    build_exact_program,
    build_program,
    count_cycles,
    estimate_s,
    load_curve,
    load_feed,
    run_exact,
    simulate_cu,
    word_length_study,
)
from nurbs_lab.hardware.interpolator import register_writes

CURVE, PERIOD_S = paper.CURVE, paper.PERIOD_S
FEED = plan_feed(CURVE, speed=paper.SPEED, acceleration=40.0, period_s=PERIOD_S)
BACK = NurbsCurve(2, [0, 0, 0, 1, 1, 1], [[0, 0], [1, 0], [0, 0]])
U = np.linspace(0.0, 1.0, 400)
WAVES = interpolate_curve(np.column_stack([U, 0.01 * np.sin(300.0 * U)]))
WAVY = plan_feed(WAVES, speed=1.0, acceleration=1000.0, chord_error=1e-7, period_s=1e-4)
LOW = CURVE.control_points.min(axis=0) - 1.0
MANY = interpolate_curve(np.column_stack([U, np.sin(9.0 * U)])[::6])
LONG = plan_feed(MANY, speed=1.0, acceleration=10.0, period_s=PERIOD_S)
LIMITS = np.column_stack([LOW, LOW + 2.0])


def line(count=3, degree=2, dim=2, **changes):
    knots = np.r_[np.zeros(degree), np.linspace(0, 1, count - degree + 1), np.ones(degree)]
    points = np.outer(np.arange(count), np.ones(dim))
    return NurbsCurve(**{"degree": degree, "knots": knots, "control_points": points, **changes})


def traced(speed=paper.SPEED, curve=CURVE, **options):
    return trace(curve, speed, stepper="rtl", period_s=PERIOD_S, **options)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Format(34), "odd"),
        (lambda: load_curve(line(count=7, degree=6)), "degree 1 to 5"),
        (lambda: load_curve(line(count=65)), "64 control points"),
        (lambda: load_curve(line(weights=[1, 2000, 1])), "weights"),
        (lambda: load_curve(line(count=4, knots=[0, 0, 0, 1e-5, 1, 1, 1])), "knot spans"),
        (lambda: load_curve(line(count=4, knots=[0, 1, 2, 2, 3, 4, 5])), "last span"),
        (lambda: load_feed(WAVY, 1e-4, 10_000, 31, Format()), "more than 255 segments"),
        (lambda: load_feed(FEED, 1.0, 3, 31, Format()), "lower the speed"),
        (lambda: simulate_cu(CURVE, []), "u is empty"),
        (lambda: count_cycles(steps=4), "steps"),
        (lambda: traced(slope="fast"), "slope"),
        (lambda: build_program(CURVE, FEED, PERIOD_S, 2086, axis_limits=LIMITS[:1]), "axis_limits"),
        (lambda: build_program(CURVE, FEED, PERIOD_S, 99, axis_limits=LIMITS[:, ::-1]), "lowest, then"),
        (lambda: build_exact_program(CURVE, FEED, PERIOD_S, axis_limits=LIMITS[:, ::-1]), "lowest, then"),
        (lambda: register_writes(build_exact_program(MANY, LONG, PERIOD_S)), "banks.* batch_writes"),
        (lambda: register_writes(3), "program must be a Program, got int"),
        (lambda: build_exact_program(CURVE, FEED, PERIOD_S, outputs=np.int64(16)), "outputs must be 0 to 15"),
        (lambda: build_program(BACK, FEED, PERIOD_S, 99), "feed covers .* curves are .* mm long"),
        (lambda: run_exact(build_exact_program(CURVE, FEED, PERIOD_S), [0.9]), "rates must be an integer"),
        (lambda: run_exact(build_exact_program(CURVE, FEED, PERIOD_S), [512]), "rates must be 0 to 511"),
        (lambda: build_exact_program([], FEED, PERIOD_S), "one or more, .* got none"),
        (lambda: build_exact_program(CURVE, FEED, PERIOD_S, outputs=[1, 2]), "together are 3"),
        (lambda: build_exact_program([CURVE, line(dim=3)], FEED, PERIOD_S), "all in the plane"),
        (lambda: build_exact_program(BACK, FEED, PERIOD_S), "nearly stops"),
        (lambda: build_exact_program(CURVE, FEED, PERIOD_S, format=Format(23)), "25 to 35 bits"),
        (lambda: build_exact_program(CURVE, FEED, PERIOD_S).from_positions([np.inf]), "positions must be"),
        (lambda: build_exact_program(CURVE, FEED, PERIOD_S).from_positions([1 << 50]), "positions must lie"),
        (lambda: estimate_s(cached=[]), "cached must be"),
        (lambda: word_length_study(CURVE, FEED, PERIOD_S, words=[None]), "words must be"),
        (
            lambda: traced(40.0, line(degree=1, control_points=[[0, 0], [1e-7, 0], [1, 0]]), slope="exact"),
            "curves hold a piece",
        ),
        (
            lambda: build_exact_program([CURVE, CURVE], FEED, PERIOD_S),
            r"curves\[1\] begins .* from the end of curves\[0\]",
        ),
    ],
)
def test_what_the_hardware_cannot_do_is_refused(call, message):
    with pytest.raises((ValueError, TypeError), match=message):
        call()
