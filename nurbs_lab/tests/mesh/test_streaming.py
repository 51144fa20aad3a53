"""The streaming slicer gives what the slicer in memory gives."""

import numpy as np
import pytest
import trimesh

from nurbs_lab.mesh import samples, slice_mesh, slice_stl, streaming
from nurbs_lab.tests.mesh.oracle import same_layers


@pytest.fixture(scope="module")
def organ(tmp_path_factory):
    path = tmp_path_factory.mktemp("stl") / "organ.stl"
    samples.frog_organ("spleen").export(path)
    return path


@pytest.mark.parametrize("most_triangles", [2_000_000, 900])
@pytest.mark.parametrize("axis", ["z", "x", (0.2, -0.4, 0.9)])
def test_the_same_contours_as_in_memory(organ, monkeypatch, most_triangles, axis):
    monkeypatch.setattr(streaming, "_CHUNK", 700)
    monkeypatch.setattr(streaming, "_BAND", 500)
    low, high = np.sort(np.asarray(trimesh.load_mesh(organ).bounds) @ streaming.axis_frame(axis)[2])
    heights = np.linspace(low, high, 12)[::-1]
    layers = slice_stl(organ, heights, axis, most_triangles=most_triangles)
    in_memory = slice_mesh(organ, heights, axis)
    assert sum(len(layer.contours) for layer in layers) >= 8
    assert same_layers(layers, in_memory)
    for one, other in zip(layers, in_memory, strict=True):
        for p, q in zip(one.contours, other.contours, strict=True):
            assert np.array_equal(p.triangles, q.triangles)


def test_an_open_mesh_streams_alike(tmp_path):
    path = tmp_path / "airplane.stl"
    samples.airplane().export(path)
    heights = np.linspace(-10, 270, 15)
    assert same_layers(slice_stl(path, heights), slice_mesh(path, heights))


def test_planes_beside_the_mesh_are_empty(organ):
    assert [layer.contours for layer in slice_stl(organ, [-1e4, 1e4])] == [(), ()]


def test_what_cannot_be_streamed_is_named(tmp_path, organ):
    text = tmp_path / "text.stl"
    text.write_text("solid nothing\nendsolid nothing\n")
    with pytest.raises(ValueError, match="no binary STL"):
        slice_stl(text, [0.0])
    with pytest.raises(FileNotFoundError, match="nowhere"):
        slice_stl(tmp_path / "nowhere.stl", [0.0])
    with pytest.raises(ValueError, match="alone crosses more than 5 triangles"):
        slice_stl(organ, [80.0, 81.0], most_triangles=5)


@pytest.mark.parametrize("byte", [104, 96])  # height, x of the first corner
def test_numbers_that_are_not_finite_are_refused(tmp_path, organ, byte):
    broken = bytearray(organ.read_bytes())
    corners = trimesh.load_mesh(organ).triangles[0, :, 2]
    broken[byte : byte + 4] = np.float32(np.nan).tobytes()
    (tmp_path / "broken.stl").write_bytes(broken)
    with pytest.raises(ValueError, match="not finite"):
        slice_stl(tmp_path / "broken.stl", [corners.mean()])
