"""Ant, nut, airplane, the frog's liver and skeleton: contours and tubes against independent counts."""

from collections import defaultdict
from itertools import pairwise

import numpy as np
import pytest
import pyvista
import trimesh

from nurbs_lab.mesh import mesh_graph, reconstruct, samples, slice_mesh
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


def test_the_ant_has_its_legs_and_feelers_as_tubes():
    """Its bodies told apart by trimesh: the six that stand on the ground, and the two that reach foremost."""
    mesh = samples.ant()
    result = reconstruct(mesh, layers=40, tolerance=5.0, axis="x", adaptive=False)
    label = trimesh.graph.connected_component_labels(mesh.face_adjacency, node_count=len(mesh.faces))
    bodies = [mesh.submesh([np.flatnonzero(label == i)], append=True) for i in range(label.max() + 1)]
    legs = [i for i, body in enumerate(bodies) if body.bounds[0, 1] < -9.0]
    feelers = [i for i, body in enumerate(bodies) if body.bounds[1, 2] > 12.0]
    assert (len(legs), len(feelers)) == (6, 2)
    tubes_of = defaultdict(list)
    for tube in result.tubes:
        tubes_of[label[tube.contours[0].triangles[0]]].append(tube)
    for i in legs + feelers:
        (tube,) = tubes_of[i]
        planes = range(tube.first_layer, tube.first_layer + len(tube.contours))
        crossings = [count_contours(bodies[i], layer.height, axis=0) for layer in result.layers]
        assert crossings == [int(k in planes) for k in range(40)]


@pytest.mark.parametrize("load", [samples.nut, lambda: samples.frog_organ("spleen")])
def test_tubes_follow_the_connected_parts_between_planes(load):
    mesh = load()
    result = reconstruct(mesh, layers=12, tolerance=5.0, adaptive=False)
    heights = [layer.height for layer in result.layers]
    for slab, (low, high) in enumerate(pairwise(heights), start=1):
        through = sum(t.first_layer < slab < t.first_layer + len(t.contours) for t in result.tubes)
        ends = sum(junction.slab == slab for junction in result.junctions)
        assert through + ends == slab_components(mesh, low, high)


def test_the_whole_liver_within_a_tolerance():
    graph = mesh_graph(samples.frog_organ("liver"))
    result = reconstruct(graph, layers=40, tolerance=2.0)
    deviation = result.deviation()
    assert deviation.max <= 2.0
    assert len(deviation.tubes) == len(result.tubes) > 10
    assert max(part.max() for part in deviation.tubes) == deviation.max
    kinds = {junction.kind for junction in result.junctions}
    assert {"branch", "cap"} <= kinds
