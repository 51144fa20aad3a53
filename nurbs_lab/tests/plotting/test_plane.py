"""Plane pictures show the numbers they were given, with names and units on their axes."""

import io
import re

import numpy as np
import trimesh
from PIL import Image

import nurbs_lab as nl
from nurbs_lab.motion.leaderboard import Score
from nurbs_lab.plotting import style
from nurbs_lab.plotting.picture import HEAD, opened, png_of, sheet, words

plot = nl.plotting
CURVE = nl.paper.CURVE


def line(figure, label=None, axes=0):
    """x and y of the line of that name, or of the last one."""
    lines = [one for one in figure.axes[axes].lines if label in (None, one.get_label())]
    return np.array(lines[-1].get_data(), dtype=float)


def texts(ax):
    return [text.get_text() for text in ax.texts]


def test_all_are_light_labelled_and_told_in_words(path, pipe):
    score = Score("adams", "line", chord_max=1e-4, chord_rms=1e-5, evaluations_per_step=2.0, ns_per_step=90.0)
    (layer,) = nl.slice_mesh(pipe, [0.5])
    figures = {
        "area": plot.area({"cells": {"serial": 50}}, limits={"cells": 100}),
        "basis": plot.basis(CURVE),
        "binding": plot.binding(path),
        "chord_error": plot.chord_error(),
        "curve": plot.curve(CURVE, points=CURVE.control_points, label="line"),
        "feed": plot.feed(path.feed, limits={"speed": 4.0}, curve=CURVE),
        "figures_8_to_10": plot.figures_8_to_10(path),
        "fluctuation": plot.fluctuation(path),
        "layer": plot.layer(layer, order=True),
        "leaderboard": plot.leaderboard([score]),
        "lines": plot.lines(
            [1.0, 2.0], [1, 1], x_label="tolerance [mm]", y_label="y [mm]", log="x", markers=True
        ),
        "orders": plot.orders([1e-3, 2e-3], {"adams": [1.0, 16.0]}, y_label="error [mm]"),
        "waveform": plot.waveform({"clk": [0, 1, 0]}, clock_hz=50e6),
        "weighted_graph": plot.weighted_graph(nl.mesh.mesh_graph(trimesh.creation.box())),
    }
    for name, figure in figures.items():
        assert len(png_of(figure)) < 150_000, name
        assert len(words(figure)) > 20, name
        labels = [figure.get_supxlabel(), *(ax.get_xlabel() for ax in figure.axes)]
        assert any(labels) or name in ("area", "weighted_graph"), name
        for label in [*labels, *(ax.get_ylabel() for ax in figure.axes)]:
            assert not re.match(r"(x|y|z|time|speed|acceleration|jerk|curvature)$", label), (name, label)


def test_a_picture_can_be_drawn_into_given_axes(path):
    figure, axes = plot.subplots(1, 2)
    assert plot.path(path, ax=axes[0]) is figure
    assert plot.curve(CURVE, ax=axes[1]) is figure
    assert all(ax.lines for ax in axes)


def test_the_style_does_not_leak():
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    plot.curve(CURVE)
    assert dict(mpl.rcParams) == before


def test_curve_and_its_parts():
    figure = plot.curve(CURVE)
    np.testing.assert_array_equal(line(figure, "control polygon").T, CURVE.control_points)
    np.testing.assert_allclose(line(figure, "knots").T, CURVE(np.linspace(0, 1, 6)))
    x, y = line(figure, "curve, degree 2")
    np.testing.assert_allclose(np.column_stack([x, y])[[0, -1]], [(1, 2), (7, 2)])


def test_comb_is_as_long_as_the_curvature():
    figure = plot.curve(CURVE, comb=True)
    tips = line(figure, "curvature comb").T
    u = np.linspace(0, 1, len(tips))
    reach = np.linalg.norm(tips - CURVE(u), axis=1)
    np.testing.assert_allclose(reach / reach.max(), CURVE.curvature(u) / CURVE.curvature(u).max(), atol=1e-12)


def test_basis_functions_sum_to_one():
    total = sum(one.get_ydata() for one in plot.basis(CURVE).axes[0].lines)
    np.testing.assert_allclose(total, 1, atol=1e-14)


def test_weighted_graph_of_the_tetrahedron(tetrahedron):
    net, arrows = plot.weighted_graph(tetrahedron).axes
    assert sorted(texts(arrows)) == sorted(["", *"0123", *map(str, tetrahedron.weights.ravel())] + [""] * 11)
    assert sorted(t for t in texts(net) if t.isalpha()) == sorted("ABCDDD")
    assert [t for t in texts(net) if "v_" in t] == [f"$v_{i}$" for _ in range(4) for i in range(3)]
    for patch in net.patches:  # unfolding keeps every length
        corners = patch.get_xy()[:3]
        sides = sorted(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1))
        solid = [tetrahedron.vertices[t] for t in tetrahedron.triangles]
        true = [sorted(np.linalg.norm(c - np.roll(c, 1, axis=0), axis=1)) for c in solid]
        assert min(np.abs(np.subtract(sides, t)).max() for t in true) < 1e-9


def test_the_arrow_of_a_contour_of_many_short_segments_shows_its_direction():
    """Matplotlib turns the head of an arrow that is shorter than a point any way."""
    (layer,) = nl.slice_mesh(trimesh.creation.icosphere(subdivisions=7), [0.3])
    ax = nl.plotting.layer(layer).axes[0]
    (arrow,) = ax.texts
    (x, y), (dx, dy) = arrow.xyann, np.subtract(arrow.xy, arrow.xyann)
    assert x * dy - y * dx > 0.9 * np.hypot(x, y) * np.hypot(dx, dy)  # counter-clockwise around the middle
    assert np.hypot(dx, dy) > 0.01 * layer.contours[0].length


def test_layer_closes_its_loops(pipe):
    (layer,) = nl.slice_mesh(pipe, [0.5])
    drawn = [one for one in plot.layer(layer).axes[0].lines if len(one.get_xdata()) > 1]
    for contour, one in zip(layer.contours, drawn, strict=True):
        np.testing.assert_array_equal(np.column_stack(one.get_data())[:-1], contour.points)
        assert one.get_color() == (style.RED if contour.is_hole else style.BLUE)


def test_fluctuation_is_in_percent(path):
    (ax,) = plot.fluctuation(path).axes
    expected = 100 * np.abs(path.chord_fluctuation)[:-1]
    assert len(expected) < 300  # so every step has a piece of its own
    drawn = ax.patches[-1].get_data()
    np.testing.assert_array_equal(drawn.edges[:-1], path.u[1:-1])
    np.testing.assert_allclose(drawn.values, np.maximum(expected, 1e-9))
    assert texts(ax)[0].startswith(f"{path.stepper}\nlargest {expected.max():.2g}"[:18])


def test_fluctuation_shows_the_worst_of_many_steps():
    path = nl.trace(CURVE, 4.0, stepper="paper", period_s=1e-3)
    (ax,) = plot.fluctuation(path).axes
    drawn = ax.patches[-1].get_data().values
    assert len(drawn) == 300
    assert drawn.max() == 100 * np.abs(path.chord_fluctuation[:-1]).max()


def test_feed_shows_profile_limits_and_reasons(path):
    figure = plot.feed(path.feed, limits={"speed": 4.0, "acceleration": 40.0})
    speed, acceleration = figure.axes
    t, v = speed.lines[0].get_data()
    np.testing.assert_array_equal(v, path.feed.speed(t))
    assert speed.lines[1].get_ydata()[0] == 4.0
    assert [one.get_ydata()[0] for one in acceleration.lines[1:]] == [40.0, -40.0]
    named = {t.get_text() for t in speed.get_legend().texts}
    assert named == {name.replace("_", " ") for name in path.feed.limited_by}


def test_the_map_of_what_is_left_begins_at_zero_unless_the_part_is_gouged():
    stock = np.array([(-5, -5, 0), (5, 5, 10.0)])
    cut = nl.machining.Move("cut", nl.interpolate_curve([(-4, 0, 8), (4, 0, 8)], degree=1), 10.0)
    milled = nl.simulate(nl.machining.Program([cut], nl.Cutter("flat", 4.0)), stock, 0.5)
    for top, lowest in ((7.5, 0.0), (9.0, -2e3)):
        part = trimesh.creation.box(bounds=[(-5, -5, 0), (5, 5, top)])
        colours = plot.remaining(milled, part, limit=2.0).axes[0].collections[0]
        assert colours.get_clim() == (lowest, 2e3)


def plain(colour, height):
    """A PNG file of one colour, 200 pixels wide."""
    data = io.BytesIO()
    Image.new("RGB", (200, height), colour).save(data, "png")
    return data.getvalue()


def test_pictures_share_the_columns_of_a_sheet():
    heights = {"#ff0000": 100, "#00ff00": 300, "#0000ff": 100, "#ffff00": 80}
    whole = opened(sheet({name: plain(name, high) for name, high in heights.items()}, width=200, columns=2))
    assert whole.size == (400, 3 * HEAD + 100 + 100 + 80)  # the second stands beside the three others
    counts = {"#{:02x}{:02x}{:02x}".format(*colour): count for count, colour in whole.getcolors()}
    for name, high in heights.items():
        assert counts[name] == 200 * high, "one picture covers another"
