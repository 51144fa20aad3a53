"""Interpolation: it meets the points, equals SciPy's, has true seams, and converges at the right order."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import CubicHermiteSpline, make_interp_spline

import nurbs_lab as nl
from nurbs_lab import nurbs
from nurbs_lab.nurbs import circle
from nurbs_lab.nurbs.knots import universal_parameters
from nurbs_lab.tests.nurbs.samples import chord_parameters, torus, trefoil


@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(0, 60), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=50, deadline=None)
def test_open_curve_meets_points_and_scipy(seed, degree, more, scale):
    rng = np.random.default_rng(seed)
    count = degree + 1 + more
    points = trefoil((np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count, scale)
    curve = nl.interpolate_curve(points, degree)
    t = chord_parameters(points)
    assert_allclose(curve(t), points, atol=1e-12 * 3 * scale, rtol=0)
    if degree <= 5:
        reference = make_interp_spline(t, points, k=degree, t=curve.knots)
        u = np.linspace(0, 1, 101)
        size = np.abs(reference.c).max()
        assert_allclose(curve(u), reference(u), atol=1e-12 * size, rtol=0)


@given(st.integers(0, 2**32 - 1), st.integers(1, 9), st.integers(0, 60), st.sampled_from([1e-6, 1.0, 1e6]))
@settings(max_examples=50, deadline=None)
def test_closed_curve_has_a_true_seam(seed, degree, more, scale):
    rng = np.random.default_rng(seed)
    count = degree + 2 + more
    points = trefoil((np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count, scale)
    curve = nl.interpolate_curve(points, degree, closed=True)
    assert curve.closed
    t = chord_parameters(np.vstack([points, points[:1]]))[:-1]
    assert_allclose(curve(t), points, atol=1e-12 * 6 * scale, rtol=0)
    u = np.linspace(0, 1, 50)
    for order in range(degree):
        size = np.linalg.norm(curve.derivative(u, order), axis=1).max()
        jump = np.linalg.norm(curve.derivative(0.0, order) - curve.derivative(1.0, order))
        assert jump <= 1e-12 * size


def test_closed_curve_equals_scipys_periodic_one():
    points = trefoil(np.arange(40) / 40)
    ring = np.vstack([points, points[:1]])
    curve = nl.interpolate_curve(ring, closed=True)
    reference = make_interp_spline(chord_parameters(ring), ring, bc_type="periodic")
    u = np.linspace(0, 1, 301)
    assert_allclose(curve(u), reference(u), atol=1e-12, rtol=0)


@pytest.mark.parametrize("scale", [1e-3, 1.0])
def test_parametrizations_differ_and_follow_their_formulas(scale):
    points = np.array([[0, 0], [3, 0], [3, 4], [4, 4], [6, 5.0]])
    chords = np.array([3, 4, 1, np.hypot(2, 1)])
    turn = np.r_[0, np.pi / 2, np.pi / 2, np.arctan2(1, 2), 0]
    stretched = []
    for i, d in enumerate(chords):
        left = turn[i] * chords[i - 1] / (chords[i - 1] + d) if i > 0 else 0
        right = turn[i + 1] * chords[i + 1] / (chords[i + 1] + d) if i < 3 else 0
        stretched.append(d * (1 + 1.5 * left + 1.5 * right))
    expected = {
        "chord": chords,
        "centripetal": np.sqrt(chords),
        "uniform": np.ones(4),
        "foley": np.array(stretched),
    }
    for name, increments in expected.items():
        curve = nl.interpolate_curve(scale * points, 2, parametrization=name)
        t = np.r_[0, np.cumsum(increments) / increments.sum()]
        assert_allclose(curve(t), scale * points, atol=1e-12 * scale)


def test_universal_parameters_are_the_peaks_of_the_basis():
    points = trefoil(np.linspace(0, 0.8, 9))
    curve = nl.interpolate_curve(points, 3, parametrization="universal")
    u = np.linspace(0, 1, 20001)
    basis = nl.NurbsCurve(3, curve.knots, np.eye(9))(u)
    assert_allclose(curve(u[basis.argmax(axis=0)]), points, atol=2e-3)


def test_tangents_count_as_points():
    ends, slopes = [(0.0, 0.0), (10.0, 2.0)], [(0.0, 20.0), (5.0, -7.0)]
    curve = nl.interpolate_curve(ends, tangents=dict(enumerate(slopes)))
    u = np.linspace(0.0, 1.0, 9)
    assert_allclose(curve(u), CubicHermiteSpline([0.0, 1.0], ends, slopes)(u), atol=1e-13)


def test_given_parameters_and_tangents():
    t = np.array([-1.0, 0.2, 0.5, 1.7, 2.0, 3.0])
    points = trefoil(t / 7)
    curve = nl.interpolate_curve(
        points, 3, parameters=t, tangents={0: [1, 2, 3], -1: [-3, 2, 1], 3: [2, 0, 1]}
    )
    assert curve.domain == (-1.0, 3.0)
    assert_allclose(curve(t), points, atol=1e-12)
    assert_allclose(curve.derivative([-1.0, 1.7, 3.0]), [[1, 2, 3], [2, 0, 1], [-3, 2, 1]], atol=1e-11)
    closed = nl.interpolate_curve(points, 4, closed=True, parameters=[*t, 4.5])
    assert_allclose(closed(t), points, atol=1e-12)
    assert closed.domain == (-1.0, 4.5)


def slope(errors):
    return -np.polyfit(np.log2([2**i for i in range(len(errors))]), np.log2(errors), 1)[0]


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("degree", [1, 3, 5])
def test_order_of_accuracy_is_degree_plus_one(degree, closed):
    errors = []
    for count in (80, 160, 320):
        t = np.linspace(0, 1 if closed else 0.8, count + 1)
        curve = nl.interpolate_curve(trefoil(t), degree, closed=closed, parameters=t)
        u = np.linspace(*curve.domain, 2001)
        errors.append(np.abs(curve(u) - trefoil(u)).max())
    assert slope(errors) == pytest.approx(degree + 1, abs=0.35)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("closed", [(False, False), (True, False), (False, True), (True, True)])
def test_surface_meets_its_points(closed, scale):
    u, v = np.arange(17) / 17, np.arange(11) / 11
    net = torus(u, v, scale)
    surface = nl.interpolate_surface(net, (3, 4), closed=closed)
    assert surface.closed == closed
    t = [np.linspace(0, 1, len(x) + c)[: len(x)] for x, c in zip((u, v), closed, strict=True)]
    evenly = nl.interpolate_surface(net, (3, 4), closed=closed, parametrization="uniform")
    assert_allclose(evenly.grid(*t), net, atol=1e-12 * 6 * scale, rtol=0)
    w = np.linspace(0, 1, 13)
    for axis in np.flatnonzero(closed):
        for order in range(surface.degrees[axis]):
            orders = (order, 0) if axis == 0 else (0, order)
            ends = [surface.derivative(*((e, w) if axis == 0 else (w, e)), orders) for e in (0.0, 1.0)]
            assert np.abs(ends[0] - ends[1]).max() <= 1e-12 * np.abs(ends[0]).max()


@pytest.mark.parametrize("axis", [0, 1])
def test_surface_order_of_accuracy(axis):
    errors = []
    dense, few = np.linspace(0, 0.7, 1201), np.linspace(0, 0.7, 12)
    at = (dense, few) if axis == 0 else (few, dense)
    for count in (40, 80, 160):
        sizes = (count, 320) if axis == 0 else (320, count)
        t = [np.linspace(0, 0.7, n + 1) for n in sizes]
        surface = nl.interpolate_surface(torus(*t), (3, 3), parametrization="uniform")
        errors.append(np.abs(surface.grid(at[0] / 0.7, at[1] / 0.7) - torus(*at)).max())
    assert slope(errors) == pytest.approx(4, abs=0.35)


def test_collapsed_rows_make_poles():
    turn, height = 2 * np.pi * np.arange(24)[:, None] / 24, np.linspace(0, np.pi, 33)[None]
    net = np.stack(
        [np.sin(height) * np.cos(turn), np.sin(height) * np.sin(turn), np.cos(height) + 0 * turn], axis=-1
    )
    net[:, 0], net[:, -1] = (0, 0, 1), (0, 0, -1)
    ball = nl.interpolate_surface(net, closed=(True, False))
    t = np.linspace(0, 1, 41)
    assert_allclose(np.linalg.norm(ball.grid(t, t), axis=-1), 1, atol=2e-4)
    assert_allclose(ball(t, 0.0), np.tile([0, 0, 1.0], (41, 1)), atol=1e-13)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_skin_untwists_sections_of_unequal_counts(scale):
    rng = np.random.default_rng(7)
    sections = []
    for i, count in enumerate([30, 47, 38, 60, 33, 52]):
        turn = np.linspace(0, 2 * np.pi, count + 1) + rng.uniform(0, 6)
        turn = turn[::-1] if i % 2 else turn
        size = 2 + 0.1 * i
        ring = [size * np.cos(turn), 0.6 * size * np.sin(turn), np.full(count + 1, 0.5 * i)]
        sections.append(scale * np.stack(ring, axis=-1))
    tube = nl.skin(sections)
    assert tube.closed == (True, False)
    t = np.linspace(0, 1, 101)
    points = tube.grid(t, t) / scale
    assert_allclose(np.hypot(points[..., 0], points[..., 1] / 0.6), 2 + 0.2 * points[..., 2], atol=1e-3)
    assert np.abs(np.diff(points[..., 0], axis=1)).max() < 0.02  # no path round the tube: no twist
    curves = [nl.interpolate_curve(s, closed=True) for s in sections]
    assert_allclose(nl.skin(curves).grid(t, t), tube.grid(t, t), atol=1e-9 * scale)


@pytest.mark.parametrize(("count", "off"), [(31, 2.8e-3), (61, 4e-4)])
def test_skin_of_circles_and_sharp_aerofoils(count, off):
    """NACA profiles of 24 to 14 %, one of them reversed, behind two circles with seams of their own."""
    sections, x = [], (1 - np.cos(np.linspace(0, np.pi, count))) / 2
    for i in range(7):
        y = (1.2 - 0.1 * i) * (
            0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
        )
        plane = np.vstack([np.column_stack([x, y])[::-1], np.column_stack([x, -y])[1:]])
        turn = np.linspace(0, 2 * np.pi, 2 * count - 1) + i + 0.7
        if i < 2:
            plane = 0.25 * np.column_stack([2 + np.cos(turn), np.sin(turn)])
        sections.append(np.column_stack([plane, np.full(len(plane), 0.5 * i)])[:: 1 - 2 * (i == 4)])
    wing = nl.skin(sections)
    assert max(wing.closest_point(section)[1].max() for section in sections) < off  # of a chord


@pytest.mark.parametrize("elsewhere", [0.0, 0.9, 3.0])
def test_skin_keeps_a_corner_that_stays_and_none_that_jumps(elsewhere):
    """Unit circles with one tip, which lies elsewhere on the last three: a twisted tube has more area."""
    half, sections = np.arccos(0.8), []  # the tip is 1.25 away from the centre
    arc = np.exp(1j * np.linspace(half, 2 * np.pi - half, 100))
    side = np.linspace(1.25, arc[0], 9)[:-1]
    ring = np.concatenate([side, arc, side[:0:-1].conj()])
    for i in range(9):
        turned = np.roll(ring * np.exp(1j * elsewhere * (i > 5)), 17 * i)
        turned = np.append(turned, turned[0])
        sections.append(np.column_stack([turned.real, turned.imag, np.full(len(turned), 0.2 * i)]))
    tube = nl.skin(sections)
    assert abs(tube.area / (1.6 * (2 * np.pi - 2 * half + 1.5)) - 1) < 0.02
    if not elsewhere:  # one piece, which begins and ends at the tip
        assert_allclose(np.hypot(*tube(0.0, np.linspace(0, 1, 9))[:, :2].T), 1.25, atol=1e-9)


def test_skin_of_a_pyramid_keeps_the_edges_up_to_its_apex():
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)])
    rows = [np.column_stack([square * (4 - z) / 4, np.full(5, z)]) for z in range(4)]
    pyramid = nl.skin([*rows, [(0.0, 0.0, 4.0)]], samples=43)
    edges = np.concatenate(
        [row * (1, 1, 0) * (4 - z - 0.5) / (4 - z) + (0, 0, z + 0.5) for z, row in enumerate(rows)]
    )
    assert pyramid.closest_point(edges)[1].max() < 1e-9


@pytest.mark.parametrize("turn", [0.0, np.pi / 2, np.pi])
@pytest.mark.parametrize("top", [2.0, 0.5, 0.0])
def test_skin_of_circles_is_exact(turn, top):
    """Cylinders, frusta and cones, also of circles that begin and run in different ways."""
    circle, rows, t = nl.nurbs.circle(2.0), [], np.linspace(0, 1, 101)
    for i, radius in enumerate(np.linspace(2.0, top, 5)):
        (s, c), size = (np.sin(i * turn), np.cos(i * turn)), radius / 2
        matrix = [[size * c, -size * s, 0], [size * s, size * c, 0], [0, 0, 1]]
        ring = circle.transform(np.array(matrix), np.array([0, 0, i])) if radius else [(0.0, 0.0, i)]
        rows.append(ring.reverse() if i == 1 else ring)
    points = nl.skin(rows).grid(t, t)
    radius = 2.0 + (top - 2.0) * points[..., 2] / 4
    assert_allclose(np.hypot(points[..., 0], points[..., 1]), radius, atol=1e-14)


def test_skin_of_open_curves_is_the_ruled_surface_between_them():
    """Each keeps its direction: between two skew lines, one way or the other, lie two saddles."""
    knots, t = [0, 0, 0, 0, 1, 1, 1, 1], np.linspace(0.0, 1.0, 9)
    first = nl.NurbsCurve(3, knots, [(0, 0, 0), (1, 3, 0), (3, -2, 0), (4, 1, 0)])
    for last in (nl.NurbsCurve(3, knots, [(4, 1, 4), (3, 2, 4), (1, -3, 4), (0, 0, 4)]), first.reverse()):
        moved, v = last.translate((0, 0, 4)), t[:, None, None]
        ruled = (1 - v) * first(t) + v * moved(t)
        assert_allclose(nl.skin([first, moved]).grid(t, t).swapaxes(0, 1), ruled, atol=1e-14)


@pytest.mark.parametrize("closed", [True, False])
def test_skin_ends_in_poles(closed):
    turn = np.linspace(0, 2 * np.pi, 41)[: 41 if closed else 30]
    rings = [
        np.column_stack([np.sin(a) * np.cos(turn), np.sin(a) * np.sin(turn), np.cos(a) + 0 * turn])
        for a in np.linspace(0.2, np.pi - 0.2, 15)
    ]
    ball = nl.skin([[(0, 0, 1)], *rings, [(0, 0, -1)]])
    assert ball.closed == (closed, False)
    u = np.linspace(0, 1, 40)
    assert_allclose(ball(u, 0.0), np.tile([0, 0, 1.0], (40, 1)), atol=1e-14)
    assert_allclose(np.linalg.norm(ball.grid(u, u), axis=-1), 1, atol=1e-4)


@pytest.mark.parametrize("parametrization", ["chord", "universal"])
def test_a_surface_meets_its_points_at_the_mean_of_the_paths_own_parameters(parametrization):
    """Each path counts alike, however long it is (Eq. 7)."""
    rng = np.random.default_rng(4)
    grid = np.cumsum(rng.uniform(0.2, 1, (7, 6, 3)), axis=0) * np.geomspace(1, 30, 6)[:, None]
    grid[..., 1] += 40 * np.arange(6) ** 1.5
    surface = nl.interpolate_surface(grid, parametrization=parametrization)
    t = []
    for axis in (0, 1):
        along = np.cumsum(np.linalg.norm(np.diff(grid, axis=axis), axis=-1), axis=axis).swapaxes(0, axis)
        mean = np.append(0, (along / along[-1]).mean(axis=1))
        t.append(mean if parametrization == "chord" else universal_parameters(3, len(mean)))
    assert_allclose(surface.grid(*t), grid, atol=1e-9 * np.ptp(grid))


@pytest.mark.parametrize("degree", [2, 3])
def test_inner_knots_are_means_of_neighbouring_parameters(degree):
    """NURBS Book Eq. 9.8, for a curve and for both directions of a surface."""
    points = trefoil(np.linspace(0, 0.8, 9) ** 1.5)
    t = chord_parameters(points)
    inner = [t[j : j + degree].mean() for j in range(1, 9 - degree)]
    expected = [0.0] * (degree + 1) + inner + [1.0] * (degree + 1)
    assert_allclose(nl.interpolate_curve(points, degree).knots, expected, atol=1e-14)
    sheet = points[:, None] + points * [1, 1, -1]  # every row and every column is the same curve, moved
    for knots in nl.interpolate_surface(sheet, (degree, degree)).knots:
        assert_allclose(knots, expected, atol=1e-14)


def test_a_curve_that_misses_its_points_is_refused_and_the_cure_works():
    points = np.column_stack([10 ** np.linspace(-6, 2, 60), np.sin(np.linspace(0, 6, 60))])
    with pytest.raises(ValueError, match=r"swings up to .* and misses them by .*='centripetal'"):
        nl.interpolate_curve(points, 9)
    curve = nl.interpolate_curve(points, 9, parametrization="centripetal")
    assert curve.closest_point(points)[1].max() < 1e-11


def test_nothing_that_swings_past_what_it_was_made_for_is_returned():
    """Also where another coordinate is large, with tangents, in both passes of a surface, across sections."""
    x, y = 10 ** np.linspace(-6, 2, 60), np.sin(np.linspace(0, 6, 60))
    points = np.column_stack([x, y])
    rings = [circle(2.0 + b, (0.0, 0.0, a)) for a, b in points]
    squares = [np.array([(1, 1, a), (-1, 1, a), (-1, -1, a), (1, -1, a), (1, 1, a)]) for a in x]
    sheet = np.stack([*np.meshgrid(x, x, indexing="ij"), np.outer(y, y)], axis=-1)
    for make in (
        lambda: nl.interpolate_curve(np.add(points, (0.0, 1e9)), 9),
        lambda: nl.interpolate_curve(points, 9, tangents={0: (2.0, 1.0)}),
        lambda: nl.interpolate_surface(sheet, (9, 9)),
        lambda: nurbs.skin(rings, (2, 9)),
        lambda: nurbs.skin(squares, (1, 9)),
    ):
        with pytest.raises(ValueError, match=r"swings up to .* and misses them by .*; take a lower degree"):
            make()


def test_rounding_of_places_far_away_is_no_swing():
    points = 1e-3 * trefoil(np.linspace(0.0, 0.9, 24)) + 1e7
    curve = nl.interpolate_curve(points)
    assert_allclose(curve(chord_parameters(points)), points, rtol=2e-15)
