"""Where the planes go."""

import numpy as np
import pytest
import trimesh

from nurbs_lab.mesh import adaptive_heights, uniform_heights
from nurbs_lab.tests.mesh import shapes


def test_uniform_heights_are_middles_of_equal_layers():
    box = trimesh.creation.box((1.0, 2.0, 4.0))
    assert uniform_heights(box, layers=4) == pytest.approx([-1.5, -0.5, 0.5, 1.5])
    assert uniform_heights(box, layer_height=1.9) == pytest.approx([-1.0, 1.0])
    assert uniform_heights(box, layers=1, axis="y") == pytest.approx([0.0])


def test_adaptive_layers_of_a_ball_follow_the_cusp():
    radius, cusp = 10.0, 0.1
    heights = adaptive_heights(shapes.ball(radius), cusp=cusp, thinnest=0.05, thickest=2.0)
    edges = [-radius]
    for height in heights:
        edges.append(2 * height - edges[-1])
    assert edges[-1] == pytest.approx(radius, abs=1e-6)
    thickness = np.diff(edges)
    assert np.all(thickness[:-1] <= 2.0 + 1e-9)
    tilt = np.maximum(np.abs(edges[:-1]), np.abs(edges[1:])) / radius  # the most tilted wall in each layer
    tilt = np.maximum(tilt - np.pi / 480, 0.0)  # of facets, which is half a facet less
    assert np.all((thickness * tilt <= 1.001 * cusp) | (thickness <= 0.0501))
    usable = np.minimum(cusp / np.maximum(tilt, cusp / 2.0), 2.0)
    assert np.mean(thickness[:-1] / usable[:-1]) > 0.8  # the last layer is what is left


def test_adaptive_layers_of_a_box_are_as_thick_as_allowed_between_its_faces():
    box = trimesh.creation.box((1.0, 1.0, 10.0))
    heights = adaptive_heights(box, cusp=0.05, thinnest=0.1, thickest=2.0)
    steps = np.diff(heights)
    assert steps.max() == pytest.approx(2.0, abs=0.05)
    assert len(heights) < 10


def test_adaptive_layers_of_a_pyramid_are_as_its_slope_allows():
    """The flat base allows 0.105, the walls 0.105 √5 = 0.2348; both in steps of a quarter of the thinnest."""
    pyramid = trimesh.convex.convex_hull([(-1, -1, 3), (1, -1, 3), (1, 1, 3), (-1, 1, 3), (0, 0, 5.0)])
    edges = 3.0 + np.array([0, *(0.1 + 0.23 * np.arange(9)), 2])
    heights = adaptive_heights(pyramid, cusp=0.105, thinnest=0.04, thickest=1.0)
    assert heights == pytest.approx(0.5 * (edges[:-1] + edges[1:]))


@pytest.mark.parametrize(
    ("heights", "options", "kind", "said"),
    [
        (uniform_heights, {}, TypeError, "either layers"),
        (
            uniform_heights,
            {"layer_height": 1e-9},
            ValueError,
            "layer_height is 1e-09: more than 100000 layers",
        ),
        (adaptive_heights, {"cusp": 0, "thinnest": 0.1, "thickest": 1}, ValueError, "cusp must be positive"),
        (adaptive_heights, {"cusp": 0.1, "thinnest": 2, "thickest": 1}, ValueError, "thinnest is 2"),
    ],
)
def test_wrong_heights_are_named(heights, options, kind, said):
    with pytest.raises(kind, match=said):
        heights(trimesh.creation.box(), **options)
