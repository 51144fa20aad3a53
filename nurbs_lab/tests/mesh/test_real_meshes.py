"""Ant, nut, airplane, the frog's liver and skeleton: contours and tubes against independent counts."""

import numpy as np
import pytest
import pyvista

from nurbs_lab.mesh import reconstruct, samples, slice_mesh
from nurbs_lab.tests.mesh.oracle import count_contours


def spread_heights(mesh, count):
    low, high = mesh.bounds[:, 2]
    return low + (high - low) * (np.arange(count) + 0.5) / count


def slab_components(mesh, low, high):
    """Connected parts of the mesh between two planes, cut out and counted by VTK."""
    slab = pyvista.wrap(mesh).clip("z", origin=(0, 0, low), invert=False).clip("z", origin=(0, 0, high))
    return len(np.unique(slab.connectivity()["RegionId"]))


@pytest.mark.parametrize(("load", "planes"), [(samples.ant, 60), (samples.nut, 60), (samples.airplane, 60)])
def test_contours_of_small_meshes(load, planes):
    mesh = load()
    layers = slice_mesh(mesh, spread_heights(mesh, planes))
    assert [len(x.contours) + x.collapsed for x in layers] == [count_contours(mesh, x.height) for x in layers]


@pytest.mark.parametrize(("organ", "planes"), [("skeleton", 12), ("liver", 12)])
def test_contours_of_large_organs(organ, planes):
    mesh = samples.frog_organ(organ)
    layers = slice_mesh(mesh, spread_heights(mesh, planes))
    assert [len(x.contours) for x in layers] == [count_contours(mesh, x.height) for x in layers]
    assert all(c.closed for x in layers for c in x.contours)
    inside = (
        sum(x.area for x in slice_mesh(mesh, spread_heights(mesh, 400))) * np.ptp(mesh.bounds[:, 2]) / 400
    )
    assert inside == pytest.approx(mesh.volume, rel=0.002)


@pytest.mark.parametrize("load", [samples.nut, samples.ant])
def test_every_body_becomes_one_closed_shell(load):
    mesh = load()
    result = reconstruct(mesh, tolerance=0.01 * np.linalg.norm(mesh.extents))
    assert result.within_tolerance
    assert all(shell.closed for shell in result.shells)
    assert len(result.bodies) == len(mesh.split(only_watertight=False))
    assert result.to_mesh().volume == pytest.approx(mesh.volume, rel=0.01)
