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
        1: {"taylor1", "adams-quotient", "rk4-quotient", "rk4-newer", "paper"},
        2: {"taylor2", "rk2"},
        3: {"taylor3"},
        4: {"adams", "abm4", "rk4", "history", "history-arc", "adams-arc"},
    }
    for order, names in known.items():
        assert {nl.STEPPERS[name].order for name in names} == {order}


def fitted(errors, steps):
    """Slope of the errors over the period on logarithmic axes."""
    return np.polyfit(np.log(1.0 / np.array(steps)), np.log(errors), 1)[0]


@pytest.mark.parametrize("ramp", [False, True])
@pytest.mark.parametrize("name", ORDERED)
def test_halving_the_period_divides_the_error_by_two_to_the_order(name, ramp):
    """On a planned ramp v changes within the period: its derivatives, or samples of it, keep the order."""
    length, steps, errors = prepare(SMOOTH).length, (160, 320, 640), []
    terms = [[0.0, 0.5, length / 8 - 0.125, length / 16 - 0.0625]]
    for count in steps:
        feed = nl.motion.FeedProfile([0.0, 2.0], terms, 2.0 / count) if ramp else length
        path = nl.trace(SMOOTH, feed, stepper=name, period_s=2.0 / count if ramp else 1.0 / count)
        assert path.feed.length == pytest.approx(length)
        errors.append(abs(path.lag[3 * count // 4]))
    assert fitted(errors, steps) == pytest.approx(nl.STEPPERS[name].order, abs=0.15)


@pytest.mark.parametrize("name", ["paper", "adams-quotient"])
def test_steps_with_quotients_are_those_of_eq_17(name):
    path = nl.trace(nl.paper.CURVE, 4.0, stepper=name, period_s=0.01)
    u, points = path.u[:-1], path.points[:-1]
    slopes = 4.0 * np.diff(u) / np.linalg.norm(np.diff(points, axis=0), axis=1)  # from u_1 on
    expected = 0.01 / 24.0 * np.convolve(slopes, [55, -59, 37, -9], "valid")
    np.testing.assert_allclose(np.diff(u)[4:], expected[:-1], rtol=1e-10)


#: Eq. (20), read four ways: the quotient that stands for |C'(u + h)|, of the points before and now.
READINGS = {
    "rk4-quotient": lambda C, a, b, h: (C(b + h) - C(a + h), b - a),
    "rk4-newer": lambda C, a, b, h: (C(b + h) - C(a), b - a + h),
    "rk4-plus": lambda C, a, b, h: (C(b) - C(a + h), b - a + h),
    "rk4-minus": lambda C, a, b, h: (C(b) - C(a + h), b - a - h),
}


@pytest.mark.parametrize("name", READINGS)
def test_steps_of_eq_20_are_those_of_its_four_readings(name):
    period = 0.01
    u = nl.trace(SMOOTH, 4.0, stepper=name, period_s=period).u
    before, now = u[:-3], u[1:-2]

    def slope(h):
        top, bottom = READINGS[name](SMOOTH, before, now, np.broadcast_to(h, now.shape))
        return 4.0 * np.abs(bottom) / np.linalg.norm(top, axis=1)

    k1 = 4.0 * (now - before) / np.linalg.norm(SMOOTH(now) - SMOOTH(before), axis=1)
    inside = now + period * k1 < 1.0 - period
    with np.errstate(invalid="ignore", divide="ignore"):
        k2 = slope(np.where(inside, 0.5 * period * k1, 0.0))
        k3 = slope(np.where(inside, 0.5 * period * k2, 0.0))
        inside &= now + period * k3 < 1.0
        k4 = slope(np.where(inside, period * k3, 0.0))
    expected = period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    assert inside.sum() > 1
    np.testing.assert_allclose((u[2:-1] - now)[inside], expected[inside], rtol=1e-9)


def test_plus_signs_make_the_second_slope_three_times_too_large_on_a_line():
    """|C'| = 1: K1 = v, then |C(u_j) - C(u_{j-1} + h)| = h and u_j - u_{j-1} + h = 3 h, for h = T/2 v."""
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (1, 0)])
    path = nl.trace(line, 1.0, stepper="rk4-plus", period_s=1e-3)
    k1, k2 = 1.0, 3.0
    k3 = (1.0 + 0.5 * k2) / abs(1.0 - 0.5 * k2)
    k4 = (1.0 + k3) / abs(1.0 - k3)
    assert path.moved[0] == pytest.approx(1e-3)  # by the exact end derivative
    assert path.moved[1] == pytest.approx(1e-3 / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4))
    with pytest.raises(ValueError, match="no forward step"):
        nl.trace(line, 1.0, stepper="rk4-minus", period_s=1e-3)  # K4 = 0 / 0
