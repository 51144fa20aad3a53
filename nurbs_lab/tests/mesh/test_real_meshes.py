"""Ant, nut, airplane, the frog's liver and skeleton: contours and tubes against independent counts."""

import numpy as np
import pytest

from nurbs_lab.mesh import samples, slice_mesh
from nurbs_lab.tests.mesh.oracle import count_contours, inner_heights


@pytest.mark.parametrize("load", [samples.ant, samples.nut, samples.airplane])
def test_contours_of_small_meshes(load):
    mesh = load()
    for layer in slice_mesh(mesh, inner_heights(mesh, 60)):
        assert len(layer.contours) + layer.collapsed == count_contours(mesh, layer.height)
        assert layer.open_ends == 2 * sum(not c.closed for c in layer.contours)


@pytest.mark.parametrize(
    ("organ", "triangles"), [("eye_white", 8956), ("spleen", 5080), ("liver", None), ("skeleton", None)]
)
def test_contours_and_volumes_of_organs(organ, triangles):
    mesh = samples.frog_organ(organ)
    assert triangles in (None, len(mesh.faces))
    assert mesh.is_watertight
    layers = slice_mesh(mesh, inner_heights(mesh, 12))
    assert [len(x.contours) for x in layers] == [count_contours(mesh, x.height) for x in layers]
    assert all(c.closed for x in layers for c in x.contours)
    inside = sum(x.area for x in slice_mesh(mesh, inner_heights(mesh, 400))) * np.ptp(mesh.bounds[:, 2]) / 400
    assert inside == pytest.approx(mesh.volume, rel=0.002)
