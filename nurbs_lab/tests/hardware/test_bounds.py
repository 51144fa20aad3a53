"""The twin beside float64, within derived bounds; word lengths; counted cycles beside the paper's."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import Format, count_cycles, cu_error_bound, evaluate, load, word_length_study


def random_curve(rng, degree, dim):
    count = int(rng.integers(degree + 1, 30))
    knots = np.cumsum(rng.uniform(0.02, 1.0, count + degree + 1))
    return nl.NurbsCurve(degree, knots, rng.normal(size=(count, dim)) * 50, rng.uniform(0.1, 4.0, count))


CURVES = [nl.paper.CURVE, *(random_curve(np.random.default_rng(p), p, 2 + p % 2) for p in range(1, 6))]


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: f"degree {curve.degree} {curve.dim}-D")
@pytest.mark.parametrize("word", [21, 27, 35])
def test_cu_keeps_its_bound(curve, word):
    loaded = load(curve, Format(word))
    bound = cu_error_bound(curve, loaded)
    u = np.linspace(loaded.first_u, loaded.last_u, 400).astype(np.int64)
    points = loaded.from_points([evaluate(loaded, int(value)).point for value in u])
    exact = curve(np.clip(loaded.from_u(u), *curve.domain))
    error = np.abs(points - exact).max(axis=0)
    assert np.all(error <= bound + 1e-13 * np.abs(curve.control_points).max())
    assert np.all(bound <= 1e5 * 2.0**-loaded.point_fraction)


def test_two_bits_of_word_buy_a_factor_of_four():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    rows = word_length_study(nl.paper.CURVE, feed, 1e-3, words=(27, 31, 35))
    errors = [row.u_error for row in rows]
    slope = np.polyfit([27, 31, 35], np.log2(errors), 1)[0]
    assert slope == pytest.approx(-1.0, abs=0.35)
    assert errors[-1] <= 2e-7
    assert rows[-1].added_fluctuation <= 5e-5
    assert errors[0] > 2e-7


def test_table_1_and_figure_11():
    timing = count_cycles()
    rows = {row["arrangement"]: row for row in timing.table()}
    assert rows["serial"]["paper_adams_cycles"] == 8 * 10250
    assert rows["parallel"]["paper_adams_cycles"] == 10251
    assert rows["parallel"]["paper_runge_kutta_cycles"] == 41005
    assert rows["serial"]["paper_time_us"] == pytest.approx(19680)
    assert rows["parallel"]["paper_time_us"] == pytest.approx(4920.56, abs=0.1)
    assert timing.cu_cycles <= 40
    for name in ("parallel", "cached"):
        assert rows[name]["adams_cycles"] <= 100
        assert rows[name]["runge_kutta_cycles"] <= 400
        assert rows[name]["time_us"] <= 60
    assert all(row["speed_up"] >= 80 for row in rows.values())
    assert np.all(np.diff(timing.times_s("cached")) > 0)


@pytest.mark.parametrize("steps", [4, 12.0, True])
def test_too_few_steps_are_refused(steps):
    with pytest.raises(ValueError, match="steps"):
        count_cycles(steps=steps)
