"""Pictures in space: without a display, not empty, light enough to be stored."""

import base64
import io
import os
import subprocess
import sys
import zlib

import numpy as np
import pytest
import trimesh
from matplotlib import colormaps
from PIL import Image

import nurbs_lab as nl
from nurbs_lab.interchange._moves import polyline
from nurbs_lab.machining.program import Move
from nurbs_lab.mesh.distance import Deviation
from nurbs_lab.plotting.orbit import LEVELS, packed
from nurbs_lab.plotting.stage import png

LIMIT = 150_000


def pixels(stage):
    data = png(stage)
    assert len(data) < LIMIT
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), dtype=int)


def ink(picture):
    """Share of the picture that is not white."""
    return (picture.min(axis=2) < 250).mean()


def draw(name, pipe, sheet):
    layers, plot = nl.slice_mesh(pipe, np.linspace(-2.5, 2.5, 6)), nl.plotting
    moves = [
        Move("rapid", polyline((0, 0, 20), (0, 0, 9)), None),
        Move("cut", polyline((0, 0, 9), (9, 0, 9)), 5.0),
    ]
    program = nl.machining.Program(tuple(moves), nl.Cutter("ball", diameter=4.0))
    return {
        "cloud": lambda: plot.cloud(pipe.sample(3000, seed=0), title="points"),
        "mesh": lambda: plot.mesh(pipe),
        "layers": lambda: plot.layers(layers, mesh=pipe),
        "surface": lambda: plot.surface(sheet),
        "deviation": lambda: plot.deviation(pipe, np.abs(pipe.vertices[:, 0]) / 100),
        "figure 7": lambda: plot.figure_7(pipe.sample(2000, seed=0), pipe, layers, [sheet]),
        "program": lambda: plot.program(program, part=pipe),
        "milled": lambda: plot.milled(nl.simulate(program, np.array([(-5, -5, 0), (15, 5, 10.0)]), 0.5)),
    }[name]()


@pytest.mark.parametrize(
    "name",
    ["cloud", "mesh", "layers", "surface", "deviation", "figure 7", "program", "milled"],
)
def test_the_picture_is_filled(name, pipe, sheet):
    picture = pixels(draw(name, pipe, sheet))
    assert 0.01 < ink(picture) < 0.8
    columns = np.flatnonzero((picture.min(axis=2) < 250).any(axis=0))
    assert columns[0] > 0  # nothing is cut at the sides
    assert columns[-1] < picture.shape[1] - 1
    if name == "figure 7":
        assert all(ink(panel) > 0.01 for panel in np.split(picture, 4, axis=1))


def test_the_worst_place_is_marked_where_a_tolerance_is_missed(pipe):
    far = np.array([[0.0, 0.0, 1.0]])
    values = np.full(len(pipe.vertices), 0.5)
    missed = Deviation(np.array([2.0]), values, far)
    marked, plain = (pixels(nl.plotting.deviation(pipe, missed, tolerance=most)) for most in (1.0, 3.0))
    dark = [(picture[:, :600].max(axis=2) < 60).sum() for picture in (marked, plain)]  # without the bar
    assert dark[0] > dark[1] + 50


@pytest.mark.parametrize(("lowest", "swatch"), [(0.0, 0), (-1.0, 0), (-2.0, 1)])
def test_a_deviation_has_exactly_the_colour_of_its_number_in_the_bar(lowest, swatch):
    ball = trimesh.creation.icosphere(subdivisions=3)
    heights = np.where(ball.vertices[:, 2] > 0, 0.75, lowest)
    picture = pixels(nl.plotting.deviation(ball, heights, tolerance=1.0))
    first, last = (0.0, 1.0) if lowest == 0 else (-1.0, 1.0)
    colours = colormaps["YlGnBu" if lowest == 0 else "RdBu_r"]
    expected = 255 * np.array(colours((0.75 - first) / (last - first))[:3])
    half = picture[100:250, 200:450].reshape(-1, 3)  # of the ball, the upper one
    assert (np.abs(half - expected).max(axis=1) <= 4).mean() > 0.9
    green = (np.abs(picture - (0, 158, 115)).max(axis=2) <= 4)[:, 600:]  # beside the ball
    assert (green.sum() > 50) == swatch


def test_reached_places_are_blue_and_those_below_grey():
    block = trimesh.creation.box(extents=(10, 10, 4))
    moves = (Move("cut", polyline((-5, 0, 2), (5, 0, 2)), 5.0),)
    program = nl.machining.Program(moves, nl.Cutter("ball", diameter=4.0, length=20.0))
    picture = pixels(nl.plotting.reached(nl.verify(program, block), block))
    blue = picture[..., 2] - picture[..., 0] > 40
    shown = picture.min(axis=2) < 250
    half = picture.shape[1] // 2
    assert blue[:, :half].sum() > 0.3 * shown[:, :half].sum()  # from above
    assert blue[:, half:].sum() < 0.6 * blue[:, :half].sum()  # from below only the sides


def unpacked(part, name, kind):
    """Rows of three numbers of a stored scene, as the book's viewer reads them."""
    steps = np.frombuffer(zlib.decompress(base64.b64decode(part["arrays"][name])), kind).reshape(3, -1)
    return np.cumsum(steps, axis=1, dtype=kind).T


def test_a_stored_scene_keeps_places_and_colours(pipe):
    heights = pipe.vertices[:, 2] - pipe.bounds[0, 2]
    ((part,),) = (view["parts"] for view in packed(nl.plotting.deviation(pipe, heights))["views"])
    points = unpacked(part, "points", "<i2") * np.ptp(pipe.bounds, axis=0).max() / LEVELS
    colours = unpacked(part, "colours", "u1")
    top = points[:, 2] > 0
    np.testing.assert_allclose(np.ptp(points, axis=0), np.ptp(pipe.bounds, axis=0), rtol=1e-3)
    assert (colours[top] == colours[top][0]).all()
    assert (colours[~top] == colours[~top][0]).all()
    assert (colours[top][0] != colours[~top][0]).any()


def test_a_cut_triangle_turns_with_its_names(tetrahedron):
    (contour,) = nl.slice_mesh(tetrahedron, [4.0])[0].contours
    for at in range(len(contour.triangles)):
        (view,) = packed(nl.plotting.plane_and_triangle(tetrahedron, contour, at=at))["views"]
        place = {name["text"].strip().split(",")[0]: np.array(name["at"]) for name in view["names"]}
        assert set(place) == {"Q₁", "Q₂", "Q₃", "Qₖ", "Qₖ₊₁", "x", "y", "z"}
        edges = {
            "Q₁": place["Q₂"] - place["Q₁"],
            "Q₂": place["Q₃"] - place["Q₂"],
            "Q₃": place["Q₁"] - place["Q₃"],
        }
        off = {name: np.cross(edge, place["Qₖ"] - place[name]) for name, edge in edges.items()}
        off = {name: np.linalg.norm(area) / np.linalg.norm(edges[name]) for name, area in off.items()}
        assert min(off, key=off.get) == "Q₁"  # the name of Qk is nearest to the edge Q1 Q2
        assert place["Qₖ"][2] == pytest.approx(place["Qₖ₊₁"][2], abs=1e-5)
        assert all(part["arrays"] for part in view["parts"])


def test_a_repeating_node_is_drawn_once(tetrahedron):
    (contour,) = nl.slice_mesh(tetrahedron, [4.0])[0].contours
    stage = nl.plotting.repeating_node(tetrahedron, contour)
    (view,) = packed(stage)["views"]
    assert {"first", "second", "  repeating node"} <= {name["text"] for name in view["names"]}
    assert 0.01 < ink(pixels(stage)) < 0.8


def test_patches_that_are_thinned_stay_one_body():
    ball = trimesh.creation.icosphere(subdivisions=5)
    flat = np.repeat(ball.triangles[:1, :1], 3, axis=1)  # a triangle that is a point
    patches = trimesh.Trimesh(**trimesh.triangles.to_kwargs([*ball.triangles, *flat]), process=False)
    ((part,),) = (view["parts"] for view in packed(nl.plotting.mesh(patches, edges=False))["views"])
    points = unpacked(part, "points", "<i2") * 2.0 / LEVELS
    kept = trimesh.Trimesh(points, unpacked(part, "cells", "<i4"), process=False)
    assert len(kept.faces) < 10_000
    assert kept.is_watertight
    assert kept.area == pytest.approx(ball.area, rel=0.01)


def test_no_display_is_needed():
    code = "import nurbs_lab as nl, trimesh; nl.plotting.show(nl.plotting.mesh(trimesh.creation.box()))"
    env = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    run = subprocess.run([sys.executable, "-c", code], env=env, timeout=600, capture_output=True, text=True)
    assert (run.returncode, run.stdout, run.stderr) == (0, "", "")


def test_a_slider_draws_anew_and_the_stored_form_is_a_picture(pipe):
    layers = nl.slice_mesh(pipe, [-1.0, 0.5, 2.0])
    browser = nl.plotting.explore(lambda number: nl.plotting.layer(layers[number]), number=(0, 2))
    slider, before = browser.controls["number"], browser.picture.value
    assert slider.continuous_update
    assert (slider.min, slider.value, slider.max) == (0, 1, 2)
    slider.value = 2
    assert browser.picture.value != before
    bundle, metadata = browser._repr_mimebundle_()
    assert bundle["text/plain"] == "Explorer: number from 0 to 2"
    assert metadata["image/png"]["alt"].startswith("number from 0 to 2: z = 2 mm, 2 contours: y [mm] over")
    assert {"image/png", "application/vnd.jupyter.widget-view+json"} <= set(bundle)
    stored = Image.open(io.BytesIO(base64.b64decode(bundle["image/png"])))
    assert stored.n_frames == 1 + 3  # the picture of viewers that play none, and one of each position


def test_exact_faces_are_drawn_as_they_are_trimmed_in_the_colours_of_their_kinds():
    made = nl.reconstruct(trimesh.creation.cylinder(5.0, 20.0, sections=48), tolerance=0.2)
    picture = nl.plotting.faces(made)
    assert len(picture.renderer.actors) >= 4  # planes, the cylinder, their rims, the legend
    bounds = np.array(nl.plotting.surface(made).bounds).reshape(3, 2)
    assert np.allclose(bounds, [[-5, 5], [-5, 5], [-10, 10]], atol=0.05)


def test_sharp_edges_are_not_shaded_round():
    box, ball = trimesh.creation.box(), trimesh.creation.icosphere()
    pictures = (
        [nl.plotting.mesh(body, edges=False) for body in (box, ball)],
        [nl.plotting.layers([], mesh=body) for body in (box, ball)],
    )
    for drawn in pictures:
        drawn = [stage.mesh.point_data["Normals"] for stage in drawn]
        assert np.abs(drawn[0]).max(axis=1) == pytest.approx(1.0, abs=1e-6)  # those of the six faces
        np.testing.assert_allclose((drawn[1] * ball.vertices).sum(axis=1), 1.0, atol=0.01)  # of the ball
