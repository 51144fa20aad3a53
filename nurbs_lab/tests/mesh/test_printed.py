"""The printed form of the values that calls return is one short line."""

import pytest

import nurbs_lab as nl
from nurbs_lab.mesh import samples


@pytest.fixture(scope="module")
def results():
    nut = samples.nut()
    layer = nl.slice_mesh(nut, [float(nut.centroid[2])])[0]
    rebuilt = nl.reconstruct(nut, tolerance=5.0)
    return [layer, *layer.contours, rebuilt, *rebuilt.shells, rebuilt.graph, rebuilt.deviation()]


def test_printed_values_are_one_short_line(results):
    for value in results:
        text = repr(value)
        assert text.startswith(type(value).__name__ + "(")
        assert len(text.splitlines()) == 1, text
        assert len(text) < 300, text


def test_a_reconstruction_prints_its_faces_and_deviation(results):
    rebuilt = next(value for value in results if isinstance(value, nl.mesh.Reconstruction))
    text = repr(rebuilt)
    assert f"{len(rebuilt.surfaces)} faces" in text
    assert f"{rebuilt.deviation().max:.4g} of 5 mm" in text
