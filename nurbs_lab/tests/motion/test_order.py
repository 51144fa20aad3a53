"""Order of accuracy of every stepper that claims one, from fitted slopes."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion.prepared_curve import prepare

#: One smooth span whose |C'| is far from constant.
SMOOTH = nl.NurbsCurve(3, [0, 0, 0, 0, 1, 1, 1, 1], [(0, 0), (1, 1), (3, 2), (6, 2)])
ORDERED = [name for name, stepper in nl.STEPPERS.items() if stepper.order is not None]


def test_the_claims_are_the_known_ones():
    known = {
        1: {"adams1", "taylor1", "adams-quotient", "rk4-quotient", "paper"},
        2: {"adams2", "taylor2", "rk2"},
        3: {"adams3", "taylor3"},
        4: {"adams", "abm4", "rk4", "history"},
        5: {"adams5"},
    }
    for order, names in known.items():
        assert {nl.STEPPERS[name].order for name in names} == {order}


@pytest.mark.parametrize("name", ORDERED)
def test_halving_the_period_divides_the_error_by_two_to_the_order(name):
    order = nl.STEPPERS[name].order
    length = prepare(SMOOTH).length
    steps = np.array([160, 320, 640])
    errors = []
    for count in steps:
        path = nl.trace(SMOOTH, 4.0, stepper=name, period_s=length / 4.0 / count)
        errors.append(abs(path.lag[3 * count // 4]))
    slope = np.polyfit(np.log(1.0 / steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("name", ORDERED)
def test_the_order_holds_on_a_planned_ramp_too(name):
    """v changes within the period: its derivatives, or samples of it, keep the order."""
    order = nl.STEPPERS[name].order
    length = prepare(SMOOTH).length
    steps, errors = np.array([160, 320, 640]), []
    for count in steps:
        ramp = nl.motion.FeedProfile([0.0, 2.0], [[0.0, 0.5, length / 8 - 0.125, length / 16 - 0.0625]], 1e-3)
        assert ramp.length == pytest.approx(length)
        path = nl.trace(SMOOTH, ramp, stepper=name, period_s=2.0 / count)
        errors.append(abs(path.lag[3 * count // 4]))
    slope = np.polyfit(np.log(1.0 / steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.15)


def test_halving_the_period_divides_the_first_error_of_arc_corrected_by_two_to_the_eighth():
    """Only the tangent predicts the first step, off by period²; the series is off by that to the fourth."""
    arch = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(0, 0), (1, 2), (4, 1)], [1, 2, 0.7])
    steps, errors = np.array([20, 40, 80]), []
    for count in steps:
        path = nl.trace(arch, prepare(arch).length, stepper="arc-corrected", period_s=1.0 / count)
        errors.append(abs(path.moved[0] - path.commanded[0]))
    assert np.polyfit(np.log(1.0 / steps), np.log(errors), 1)[0] == pytest.approx(8, abs=0.2)


@pytest.mark.parametrize("name", ["paper", "adams-quotient"])
def test_steps_with_quotients_are_those_of_eq_17(name):
    path = nl.trace(nl.paper.CURVE, 4.0, stepper=name, period_s=0.01)
    u, points = path.u[:-1], path.points[:-1]
    slopes = 4.0 * np.diff(u) / np.linalg.norm(np.diff(points, axis=0), axis=1)  # from u_1 on
    expected = 0.01 / 24.0 * np.convolve(slopes, [55, -59, 37, -9], "valid")
    np.testing.assert_allclose(np.diff(u)[4:], expected[:-1], rtol=1e-10)


def test_steps_with_shifted_quotients_are_those_of_eq_20():
    curve, period = nl.paper.CURVE, 0.01
    u = nl.trace(curve, 4.0, stepper="rk4-quotient", period_s=period).u
    before, now = u[:-3], u[1:-2]

    def slope(h):
        return 4.0 * (now - before) / np.linalg.norm(curve(now + h) - curve(before + h), axis=1)

    k1 = slope(0.0)
    k2 = slope(0.5 * period * k1)
    k3 = slope(0.5 * period * k2)
    k4 = slope(period * k3)
    expected = period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    np.testing.assert_allclose(u[2:-1] - now, expected, rtol=1e-10)
