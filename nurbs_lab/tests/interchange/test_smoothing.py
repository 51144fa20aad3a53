"""Facets made smooth: within the tolerance both ways, corners kept, arcs found, fewer blocks."""

import itertools

import numpy as np
import pytest
from scipy.spatial import cKDTree

import nurbs_lab as nl
from nurbs_lab.interchange._moves import polyline
from nurbs_lab.machining.program import Move, Program
from nurbs_lab.tests.interchange.shapes import milling, text_of, wave


def between(points, times):
    """The polyline at ``times`` places of every segment."""
    part = np.arange(times)[:, None, None] / times
    return np.vstack(
        [(points[:-1] + part * np.diff(points, axis=0)).reshape(-1, points.shape[1]), points[-1:]]
    )


def farthest(curves, points, times=10):
    """Largest distance of the polyline from the curves, and of the curves from the polyline."""
    dense = np.concatenate([c(np.linspace(*c.domain, 20 * times * len(c.control_points))) for c in curves])
    there = np.min([c.closest_point(between(points, times))[1] for c in curves], axis=0)
    return there.max(), cKDTree(between(points, 50 * times)).query(dense)[0].max()


@pytest.mark.parametrize("tolerance", [0.002, 0.01, 0.05])
def test_both_ways_within_the_tolerance(tolerance):
    points = wave(300)
    curve = nl.smooth(points, tolerance=tolerance)
    there, back = farthest([curve], points)
    assert there <= tolerance
    assert back <= tolerance + 1e-4  # the comb of samples is as fine as that
    assert curve.closest_point(points)[1].max() <= tolerance
    assert len(curve.control_points) < len(points) / 5


@pytest.mark.parametrize("sag", [0.003, 0.01, 0.03])
def test_chords_as_far_from_their_curve_as_the_tolerance_become_one_curve(sag):
    """A spline through the ends of such chords is as far from their middles as the arcs are."""
    count = int(np.ceil(4 / np.arccos(1 - sag / 20)))  # chords of a spiral of radius 15 to 25
    angle = np.linspace(0, 8, count)
    points = (20 + 5 * np.sin(angle / 5))[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    curve = nl.smooth(points, tolerance=0.01)
    assert max(farthest([curve], points)) <= 0.0101
    assert np.unique(curve.knots, return_counts=True)[1][1:-1].max() == 1  # no corner
    limits = {"speed": 60.0, "acceleration": 1000.0, "period_s": 1e-3}
    assert (
        nl.plan_feed(curve, **limits).duration
        < 1.1 * nl.plan_feed(nl.interchange.blend(points, tolerance=0.01), **limits).duration
    )


@pytest.mark.parametrize(("spike", "noise"), [(0.02, 0.0), (0.03, 0.0), (0.0, 0.008)])
def test_points_that_stick_out_are_within_the_tolerance_of_the_curve(spike, noise):
    """The curve beneath a narrow spike is near to both of its sides, and far from its tip."""
    x = 0.006 * np.arange(400)
    points = np.column_stack([x, 0.5 * np.sin(x / 0.3)])
    points += np.random.default_rng(4).normal(0.0, noise, points.shape)
    points[200, 1] += spike
    curve = nl.smooth(points, tolerance=0.01)
    assert curve.degree == 3
    dense = cKDTree(curve(np.linspace(*curve.domain, 300_000)))
    assert dense.query(points)[0].max() <= 0.01 + 1e-6


def test_a_spline_has_no_kink_of_curvature():
    curve = nl.smooth(wave(300), tolerance=0.01)
    knots = np.unique(curve.knots)[1:-1]
    for order in (1, 2):
        left, right = curve.derivative(knots - 1e-9, order), curve.derivative(knots, order)
        np.testing.assert_allclose(left, right, atol=1e-6 * np.abs(right).max())


def test_corners_are_kept_to_the_micrometre():
    side = np.linspace(0, 1, 40)[:-1, None]
    corners = np.array([(0, 0), (20, 0), (20, 15), (5, 12), (0, 0)], dtype=float)
    square = np.concatenate([a + side * (b - a) for a, b in itertools.pairwise(corners)])
    curve = nl.smooth(np.vstack([square, corners[:1]]), tolerance=0.05)
    assert curve.closest_point(corners)[1].max() < 1e-6
    assert curve.length() == pytest.approx(np.linalg.norm(np.diff(corners, axis=0), axis=1).sum(), abs=1e-6)


def test_arcs_are_recognized():
    angle = np.linspace(-np.pi / 2, np.pi / 2, 60)
    turn = 10 * np.column_stack([np.cos(angle), np.sin(angle)])
    slot = np.concatenate([[(0, -10)], turn + np.array([50, 0]), -turn, [(0, -10)]])
    curve = nl.smooth(slot, tolerance=0.01)
    assert curve.rational
    assert len(curve.control_points) == 13  # two half circles of five, two lines, four joints shared
    assert curve.length() == pytest.approx(2 * 50 + 2 * np.pi * 10, rel=1e-7)
    tilted = turn @ np.array([(1, 0, 1), (0, np.sqrt(2), 0)]) / np.sqrt(2)
    assert nl.smooth(tilted, tolerance=0.01).curvature(5.0) == pytest.approx(0.1, rel=1e-6)
    circle = np.column_stack([np.cos(2 * angle), np.sin(2 * angle)])
    assert nl.smooth(circle, tolerance=0.01).length() == pytest.approx(2 * np.pi, rel=1e-3)


def test_moves_join_exactly_wherever_a_plane_lies():
    """The plane nearest to noisy points misses their ends; a circle in space may close, or nearly so."""
    rng, found = np.random.default_rng(3), 0
    for turn in [*rng.uniform(0.3, 1.0, 60), 2 * np.pi, 2 * np.pi + 1e-4]:
        size = rng.integers(4, 9) if turn < 6 else 90
        angle, (frame, _) = np.linspace(0, turn, size), np.linalg.qr(rng.normal(size=(3, 3)))
        flat = rng.uniform(5, 30) * np.column_stack([np.cos(angle), np.sin(angle)])
        points = flat @ frame[:2] + 0.002 * rng.normal(size=(size, 3))
        points = np.vstack([points, points[-1] + 5 * frame[2]]).round(3)
        tolerance = rng.choice([0.01, 0.05])
        program = Program([Move("cut", polyline(a, b), 10.0) for a, b in itertools.pairwise(points)])
        curves = [move.curve for move in nl.smooth(program, tolerance=tolerance).moves]
        ends = np.array([curve(curve.domain) for curve in curves])
        np.testing.assert_array_equal(ends[1:, 0], ends[:-1, 1])
        np.testing.assert_array_equal(ends[[0, -1], [0, 1]], points[[0, -1]])
        found += curves[0].rational
        if curves[0].rational:
            assert max(farthest(curves, points)) <= tolerance + 0.003  # the comb of samples
        assert len(nl.smooth(points, tolerance=tolerance).control_points)
    assert found > 15


def test_corners_of_noise_are_none_and_real_ones_stay():
    """2 µm of noise turns segments of 0.03 mm by 20 degrees and more; of the 47 corners none is real."""
    x = 0.03 * np.arange(1001)
    points = np.column_stack([x, 4 * np.sin(x / 7) + 2 * np.sin(x / 3)])
    points += np.random.default_rng(1).uniform(-0.002, 0.002, points.shape)
    curve = nl.smooth(points, tolerance=0.01)
    assert np.unique(curve.knots, return_counts=True)[1][1:-1].max() == 1
    assert max(farthest([curve], points)) <= 0.0101
    turned = np.vstack([points, points[-1] + np.outer(x[1:], (0.0, 1.0))])
    assert nl.smooth(turned, tolerance=0.01).closest_point(points[-1])[1] < 1e-6


def test_collinear_points_are_one_line():
    points = np.column_stack([np.r_[0, 10, np.linspace(11, 20, 30), 30], np.zeros(33)]) @ [[0.6, 0.8], [0, 0]]
    np.testing.assert_allclose(nl.smooth(points.round(3), tolerance=0.01).control_points, [(0, 0), (18, 24)])


def test_a_program_keeps_what_is_no_facet(tmp_path):
    points = wave(400, rows=4)
    (tmp_path / "facets.ngc").write_text(text_of(points))
    before = nl.read(tmp_path / "facets.ngc")
    after = nl.smooth(before, tolerance=0.01)
    assert len(before.moves) / len(after.moves) > 50
    assert [m.kind for m in after.moves[-2:]] == ["cut", "rapid"]
    assert after.moves[-2].curve.rational  # the arc
    assert {round(move.feed, 9) for move in after.curves and after.moves[:-3]} == {20.0}
    assert after.moves[-3].feed == 10.0
    lines = [move.line for move in after.moves]
    assert lines == sorted(lines)
    ends = [move.curve(move.curve.domain) for move in after.moves]
    assert max(np.linalg.norm(a[1] - b[0]) for a, b in itertools.pairwise(ends)) < 1e-9
    curves = [move.curve for move in after.moves[1:-3]]
    assert max(farthest(curves, points)) < 0.0102
    for dialect in ("fanuc", "siemens"):
        file = nl.export(tmp_path / "curves.ngc", after, dialect=dialect, units="mm", axes="XYZ")
        assert len(file.read_text().splitlines()) < 1600 / 8


def test_a_program_made_by_hand_is_smoothed_too():
    points = wave(200)
    moves = [Move("rapid", polyline(points[0] + (0, 0, 5), points[0]), 100.0)]
    moves += [Move("cut", polyline(a, b), 20.0) for a, b in itertools.pairwise(points)]
    smooth = nl.smooth(Program(tuple(moves)), tolerance=0.01)
    assert len(smooth.moves) == 2
    for name in ("kind", "curve", "feed", "line"):
        assert getattr(smooth.moves[0], name) == getattr(moves[0], name)
    same = nl.smooth(milling(), tolerance=0.01)
    assert [m.curve.degree for m in same.moves] == [m.curve.degree for m in milling().moves]


def test_blended_corners_keep_the_tolerance_and_the_tangent():
    points = wave(200)
    for tolerance in (1e-3, 1.0):
        curve = nl.interchange.blend(points, tolerance=tolerance)
        assert max(farthest([curve], points)) <= tolerance + 2e-4  # the comb of samples
        knots = np.unique(curve.knots)[1:-1]
        before, after = curve.tangent(knots - 1e-9), curve.tangent(knots)
        np.testing.assert_allclose(before, after, atol=1e-4)


def test_smooth_motion_is_shorter_than_blended_motion():
    """Under a limit of jerk it is shorter than blended motion without one, which no plan can undercut."""
    points = wave(800, step=0.03)
    limits = {"speed": 60.0, "acceleration": 1000.0, "axis_acceleration": 1000.0, "period_s": 1e-3}
    smooth = nl.plan_feed(nl.smooth(points, tolerance=0.01), jerk=5e4, **limits).duration
    blended = nl.plan_feed(nl.interchange.blend(points, tolerance=0.01), **limits).duration
    assert smooth < 0.85 * blended
