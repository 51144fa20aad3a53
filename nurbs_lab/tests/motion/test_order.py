"""Order of accuracy of every stepper that claims one, from fitted slopes."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion.track import prepare

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
