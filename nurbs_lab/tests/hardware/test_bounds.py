"""The twin beside float64, within derived bounds; word lengths; counted cycles beside the paper's."""

from bisect import bisect_right
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab.hardware import (
    Format,
    count_cycles,
    cu_error_bound,
    evaluate_cu,
    load_curve,
    simulate_cu,
    word_length_study,
)


def random_curve(rng, degree, dim):
    count = int(rng.integers(degree + 1, 30))
    knots = np.cumsum(rng.uniform(0.02, 1.0, count + degree + 1))
    return nl.NurbsCurve(degree, knots, rng.normal(size=(count, dim)) * 50, rng.uniform(0.1, 4.0, count))


CURVES = [nl.paper.CURVE, *(random_curve(np.random.default_rng(p), p, 2 + p % 2) for p in range(1, 6))]


def exact_point(curve, loaded, u):
    """C(u) by de Boor's algorithm in fractions, from the curve as it was before any rounding."""
    degree, knots = curve.degree, [Fraction(knot) for knot in curve.knots]
    u = Fraction(loaded.knot_origin) + Fraction(loaded.knot_scale) * Fraction(u, loaded.format.one)
    u = min(max(u, knots[degree]), knots[-degree - 1])
    last = len(curve.control_points) - 1
    span = bisect_right(knots, u, degree + 1, last + 1) - 1
    rows = [
        [Fraction(weight) * Fraction(x) for x in (*point, 1.0)]
        for point, weight in zip(curve.control_points, curve.weights, strict=True)
    ][span - degree : span + 1]
    for level in range(degree, 0, -1):
        starts = range(span + 1 - level, span + 1)
        shares = [(u - knots[i]) / (knots[i + level] - knots[i]) for i in starts]
        rows = [
            [x + share * (y - x) for x, y in zip(*pair, strict=True)]
            for share, pair in zip(shares, pairwise(rows), strict=True)
        ]
    *point, weight = rows[0]
    return [x / weight for x in point]


@pytest.mark.parametrize("curve", CURVES, ids=lambda curve: f"degree {curve.degree} {curve.dim}-D")
@pytest.mark.parametrize("word", [21, 27, 35])
def test_cu_keeps_its_bound_and_the_bound_is_not_loose(curve, word):
    loaded = load_curve(curve, Format(word))
    bound = cu_error_bound(curve, loaded)
    spread = np.linspace(loaded.first_u, loaded.last_u, 200).astype(np.int64).tolist()
    knots = {knot - step for knot in loaded.knots for step in (0, 1)}
    worst = np.zeros(curve.dim)
    for u in (*spread, *(u for u in knots if loaded.first_u <= u <= loaded.last_u)):
        pairs = zip(evaluate_cu(loaded, u).point, exact_point(curve, loaded, u), strict=True)
        unit = Fraction(2) ** -loaded.point_fraction
        worst = np.maximum(worst, [abs(float(x * unit - exact)) for x, exact in pairs])
    assert np.all(worst <= bound)
    # The weights of the random curves differ 40 times, their knot spans 50 times.
    assert np.all(bound <= (5 if curve is nl.paper.CURVE else 250) * worst)


def test_a_span_of_one_last_place_has_no_bound():
    knots = [0, 0, 0, 0, 0.5, 0.5 + 2.0**-15, 0.7, 0.8, 1, 1, 1, 1]
    curve = nl.NurbsCurve(3, knots, np.column_stack([np.arange(8.0), np.arange(8) % 2]))
    assert np.all(np.isinf(cu_error_bound(curve, load_curve(curve, Format(17)))))


def test_two_bits_of_word_buy_a_factor_of_four():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    words = range(21, 36, 2)
    rows = word_length_study(nl.paper.CURVE, feed, 1e-3, words=words)
    errors = [row.u_error for row in rows]
    slope, offset = np.polyfit(words, np.log2(errors), 1)
    assert slope == pytest.approx(-1.0, abs=0.1)
    assert np.abs(slope * np.array(words) + offset - np.log2(errors)).max() <= 1.5
    assert errors[-1] <= 2e-7
    assert rows[-1].added_fluctuation <= 5e-5
    assert errors[words.index(27)] > 2e-7


def test_table_1_and_figure_11():
    timing = count_cycles()
    rows = {row["arrangement"]: row for row in timing.table()}
    assert rows["serial"]["paper_adams_cycles"] == 8 * 10250
    assert rows["parallel"]["paper_adams_cycles"] == 10251
    assert rows["parallel"]["paper_runge_kutta_cycles"] == 41005
    assert rows["serial"]["paper_time_us"] == pytest.approx(19680)
    assert rows["parallel"]["paper_time_us"] == pytest.approx(4920.56, abs=0.1)
    assert simulate_cu(nl.paper.CURVE, np.linspace(0.0, 1.0, 64)).cycles.max() <= 23
    assert rows["cached"]["adams_cycles"] <= 41
    for name in ("parallel", "cached"):
        assert rows[name]["adams_cycles"] <= 50
        assert rows[name]["runge_kutta_cycles"] <= 200
        assert rows[name]["time_us"] <= 25
    assert all(row["paper_time_us"] >= 80 * row["time_us"] for row in rows.values())
    assert np.all(np.diff(timing.times_s("cached")) > 0)
    page = (Path(nl.__file__).parents[1] / "rtl" / "README.md").read_text()
    for name, row in rows.items():
        theirs = "–" if name == "cached" else f"{row['paper_time_us']:,.0f}"
        later = ", then 42" if name == "parallel" else ""  # after the step that Runge-Kutta hands over to
        counted = f"{row['runge_kutta_cycles']} | {row['adams_cycles']}{later} | {row['time_us']:.1f}"
        assert f"| {name} | {counted} | {theirs} |" in page


def test_the_clocks_of_the_page_are_those_of_the_benches():
    u = np.linspace(0, 1, 64)
    weighted = nl.NurbsCurve(3, [0] * 4 + [1] * 4, np.eye(4)[:, :3], [1, 0.5, 0.8, 1])
    plane, space = (simulate_cu(curve, u).cycles.min() for curve in (nl.paper.CURVE, weighted))
    page = (Path(nl.__file__).parents[1] / "rtl" / "README.md").read_text()
    assert f"{plane} (p = 2, plane), {space} (p = 3, space, weights)" in page
    divide, root = (35 + 3) // 4 + 1, (35 + 4) // 4 + 1  # as test_divide.py and test_square_root.py count
    assert f"| `divide` | quotient, four bits a cycle | {divide} |" in page
    assert f"| `square_root` | root, four bits a cycle | {root} |" in page
    assert f"| DIM + {2 + divide + root} = {2 + 2 + divide + root} in the plane |" in page  # test_kout.py
