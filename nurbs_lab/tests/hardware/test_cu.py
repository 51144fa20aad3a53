"""The twin of ``cu`` beside the curve in float64, and the simulated module beside its twin."""

import numpy as np
import pytest

from nurbs_lab import NurbsCurve, paper
from nurbs_lab.hardware import Format, evaluate_cu, load_curve, simulate_cu, watch_cu

ARC = NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(1, 0, 0), (1, 1, 0.5), (0, 1, 1)], [1, np.sqrt(0.5), 1])


@pytest.mark.parametrize("curve", [paper.CURVE, ARC], ids=["paper", "arc"])
@pytest.mark.parametrize("word", [23, 35])
def test_the_verilog_equals_the_twin(curve, word):
    loaded = load_curve(curve, Format(word))
    u = np.linspace(*curve.domain, 101)
    points, cycles = simulate_cu(curve, u, Format(word))
    expected = [evaluate_cu(loaded, int(word)).point for word in loaded.to_u(u)]
    assert np.array_equal(points, loaded.from_points(expected))
    assert cycles.shape == u.shape
    assert cycles.max() <= (23 if curve is paper.CURVE else 60)


def test_what_goes_on_inside_can_be_watched():
    loaded, format = load_curve(paper.CURVE), Format()
    signals = watch_cu(paper.CURVE, 0.3)
    assert {len(values) for values in signals.values()} == {simulate_cu(paper.CURVE, 0.3).cycles + 4}
    assert sum(signals["start"]) == signals["start"][0] == sum(signals["done"]) == signals["done"][-4] == 1
    assert (signals["x"][-1], signals["y"][-1]) == evaluate_cu(loaded, int(loaded.to_u(0.3))).point
    assert signals["x"][0] is None
    assert [name for name in signals["state"] if name == "SUM"] == ["SUM"] * 6
    shares = [signals[name][-1] for name in ("N0", "N1", "N2")]
    assert sum(shares) == format.one
    assert np.allclose(np.array(shares) / format.one, (0.125, 0.75, 0.125), atol=1e-9)


def test_a_second_point_of_a_span_needs_no_search():
    state = watch_cu(paper.CURVE, [0.3, 0.31])["state"]
    second = state[len(watch_cu(paper.CURVE, 0.3)["state"]) :]
    assert "COMPARE" in state
    assert "COMPARE" not in second
    assert len(second) == 18  # 14, and 4 after done
