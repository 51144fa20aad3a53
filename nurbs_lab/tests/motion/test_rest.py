"""From rest to rest round the unit circle, on a feed written by hand: its closed form is the angle itself."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.motion import benchmark_curves

TURN = 2.0 * np.pi
#: Largest angle that a path of 200 steps may be wrong by: about twice what was seen.
ANGLES = {
    **dict.fromkeys(("taylor1",), 5e-2),  # of order 1 in the feed too
    **dict.fromkeys(("adams-quotient", "rk4-quotient", "rk4-newer", "rk4-minus", "paper"), 5e-3),
    **dict.fromkeys(("adams",), 2e-3),  # which span the knots, where C'' jumps
    **dict.fromkeys(("taylor2", "taylor3"), 9e-4),
    **dict.fromkeys(("rk2", "abm4"), 4e-4),
    **dict.fromkeys(("rk4",), 5e-5),
    "chord-corrected": 8e-4,  # an arc is longer than its chord
    **dict.fromkeys(("history", "history-arc", "adams-arc"), 2e-5),
    "exact": 1e-14,
}


@pytest.mark.parametrize("name", ANGLES)
def test_to_rest_as_the_closed_form_says(name):
    """After t of one second ``t² (3 - 2 t)`` of the way is gone, written as two cubics."""
    terms = TURN * np.array([[0.0, 0.0, 3.0, -2.0], [0.5, 1.5, 0.0, -2.0]])
    feed = nl.motion.FeedProfile([0.0, 0.5, 1.0], terms, 5e-3)
    path = nl.trace(benchmark_curves()["circle"].curve, feed, stepper=name)
    assert 199 <= len(path.moved) <= 200
    angle, t = np.unwrap(np.arctan2(path.points[:, 1], path.points[:, 0])), path.t
    assert np.abs(angle - TURN * t * t * (3.0 - 2.0 * t))[:-1].max() < ANGLES[name]
    half = np.diff(angle) / 2.0
    np.testing.assert_allclose(angle[:-1], feed.displacement(t[:-1]) - path.lag, atol=1e-12)
    np.testing.assert_allclose(path.chord, 2.0 * np.sin(half), atol=1e-12)
    np.testing.assert_allclose(path.chord_error, 1.0 - np.cos(half), rtol=2e-4, atol=1e-14)
    per_step = path.evaluations_by_order / len(path.moved)
    behind_knots = 0.6 if name in ("history", "history-arc", "adams-arc") else 0.1  # in 200 steps, of C'
    np.testing.assert_allclose(per_step, nl.STEPPERS[name].evaluations, rtol=0.02, atol=behind_knots)
    assert path.evaluations == path.evaluations_by_order.sum()


def test_a_ramp_of_the_acceleration_may_be_far_shorter_than_a_period():
    """A jerk of 1e11 mm/s³ for a nanosecond: with a period of it, the tool would move 16 mm at once."""
    terms = [[0.0, 5.0, 0.0, 1e11 / 6.0], [5e-9, 5.0, 50.0, 0.0]]
    feed = nl.motion.FeedProfile([0.0, 1e-9, 0.1], terms, 1e-3)
    line = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0), (feed.length, 0)])
    path = nl.trace(line, feed, stepper="taylor3")
    assert np.abs(path.lag).max() < 1e-4  # A T²/2, as for an acceleration that steps
