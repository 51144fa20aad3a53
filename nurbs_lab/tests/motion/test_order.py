"""Order of accuracy of every stepper that claims one, from fitted slopes."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion.track import prepare

#: One smooth span whose |C'| varies by a factor of three.
SMOOTH = nl.NurbsCurve(3, [0, 0, 0, 0, 1, 1, 1, 1], [(0, 0), (1, 1), (3, 2), (6, 2)])
ORDERED = [name for name, stepper in nl.STEPPERS.items() if stepper.order is not None]


@pytest.mark.parametrize("name", ORDERED)
def test_halving_the_period_divides_the_error_by_two_to_the_order(name):
    order = nl.STEPPERS[name].order
    length = prepare(SMOOTH).length
    steps = np.array([160, 320, 640])
    errors = []
    for count in steps:
        path = nl.trace(SMOOTH, 4.0, stepper=name, period_s=length / 4.0 / count)
        middle = 3 * count // 4
        errors.append(abs(path.lag[middle]))
    slope = np.polyfit(np.log(1.0 / steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.15)
