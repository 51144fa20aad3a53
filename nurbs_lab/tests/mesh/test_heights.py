"""Where the planes go."""

import pytest
import trimesh

from nurbs_lab.mesh import uniform_heights


def test_uniform_heights_are_middles_of_equal_layers():
    box = trimesh.creation.box((1.0, 2.0, 4.0))
    assert uniform_heights(box, layers=4) == pytest.approx([-1.5, -0.5, 0.5, 1.5])
    assert uniform_heights(box, layer_height=1.9) == pytest.approx([-1.0, 1.0])
    assert uniform_heights(box, layers=1, axis="y") == pytest.approx([0.0])


def test_wrong_heights_are_named():
    with pytest.raises(TypeError, match="either layers"):
        uniform_heights(trimesh.creation.box())
    with pytest.raises(ValueError, match="layer_height is 1e-09: more than 100000 layers"):
        uniform_heights(trimesh.creation.box(), layer_height=1e-9)
