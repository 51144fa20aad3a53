"""Sections skinned and capped are closed solids."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

import nurbs_lab as nl
from nurbs_lab.tests.mesh.cad import stored, volume


def test_capped_sections_are_a_closed_solid(tmp_path):
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    rings = [np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + 3 * r]) for r in (2.0, 4.0)]
    solid = nl.skin(rings, capped=True)
    assert [face.kind for face in solid.faces] == ["patch", "plane", "plane"]
    assert solid.volume == pytest.approx(np.pi * 6 / 3 * (4 + 8 + 16), rel=1e-5)
    assert "2 exact, 1 smooth" in solid.report()
    assert "mesh" not in solid.report()
    assert volume(stored(tmp_path, solid)) == pytest.approx(solid.volume, rel=1e-6)
    eight, up = np.column_stack([np.sin(angle), np.sin(2 * angle), 0 * angle]), np.array([0, 0, 1])
    for wrong, said in (
        ([ring[:30] for ring in rings], "closed"),
        ([ring * (1, 1, 0) for ring in rings], "encloses no volume"),
        ([eight, eight + up], "passes through itself|no volume"),  # OpenCASCADE's volume of it never ended
        ([rings[0], rings[0] + 3 * up, rings[0] + up], "passes through itself"),
        ([rings[0], eight + 20 * up], "crosses itself"),  # a cap that OpenCASCADE fails to make
    ):
        with pytest.raises(ValueError, match=said):
            nl.skin(wrong, capped=True)


@pytest.mark.parametrize("radii", [(2, 0), (0, 1, 2)])
@pytest.mark.parametrize("tolerance", [0.02, 0.005])
def test_capped_sections_that_end_in_a_point_are_watertight(radii, tolerance):
    angle = np.linspace(0.0, 2.0 * np.pi, 65)
    rings = [
        np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + z]) for z, r in enumerate(radii)
    ]
    mesh = nl.skin([ring if np.ptp(ring[:, 0]) else ring[:1] for ring in rings], capped=True).to_mesh(
        tolerance
    )
    assert mesh.is_watertight


def test_layers_of_a_box_keep_its_corners():
    layers = nl.slice_mesh(trimesh.creation.box((4, 6, 10)).subdivide(), np.linspace(-4.5, 4.5, 7))
    solid = nl.skin(layers, capped=True)
    assert solid.volume == pytest.approx(4 * 6 * 9, rel=1e-12)
    assert [face.kind for face in solid.faces] == ["patch"] * 4 + ["plane"] * 2
    rough = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid.shells[0].shape(), rough)  # its Gauss points see no crease in a face
    assert rough.Mass() == pytest.approx(4 * 6 * 9, rel=1e-9)
    layers[3] = replace(layers[3], contours=layers[3].contours * 2)
    with pytest.raises(ValueError, match="has 2 contours"):
        nl.skin(layers)


def test_sections_in_a_ring_meet_smoothly():
    angle = np.linspace(0.0, 2.0 * np.pi, 33)
    x, z = 10 + 3 * np.cos(angle), 3 * np.sin(angle)
    turns = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    ring = nl.skin([np.column_stack([x * np.cos(t), x * np.sin(t), z]) for t in turns], closed=True)
    assert ring.closed == (True, True)
    first, last = (ring.derivative(0.3, v, (0, 1)) for v in ring.domain[1])
    assert np.allclose(first, last, atol=1e-9)
