"""A file that is read in blocks, here or by workers, gives what the same mesh in memory gives."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import trimesh

from nurbs_lab.mesh import mesh_graph, samples, slice_mesh
from nurbs_lab.mesh.slicing import stl_blocks as streaming
from nurbs_lab.mesh.slicing.contours import axis_frame
from nurbs_lab.tests.mesh.oracle import same_layers


@pytest.fixture(scope="module")
def organ(tmp_path_factory):
    path = tmp_path_factory.mktemp("stl") / "organ.stl"
    samples.frog_organ("spleen").export(path)
    return path


@pytest.fixture(scope="module")
def organs(tmp_path_factory):
    """64 organs side by side: several runs of blocks, and more triangles than are cut at once."""
    path = tmp_path_factory.mktemp("stl") / "organs.stl"
    organ = samples.frog_organ("spleen")
    steps = 1.1 * organ.extents * np.stack(np.mgrid[:4, :4, :4], axis=-1).reshape(-1, 3)
    trimesh.util.concatenate([organ.copy().apply_translation(step) for step in steps]).export(path)
    return path


@pytest.fixture(autouse=True)
def small_files_are_streamed(monkeypatch):
    monkeypatch.setattr(streaming, "STREAMED", 100)


@pytest.mark.parametrize(
    ("axis", "most_held", "threads"),
    [("z", 10**6, None), ("x", 40_000, 2), ((0.2, -0.4, 0.9), 40_000, None), ((0.2, -0.4, 0.9), 10**6, 2)],
)
def test_the_same_contours_as_in_memory(organs, monkeypatch, most_held, axis, threads):
    monkeypatch.setattr(streaming, "MOST_HELD", most_held)
    graph = mesh_graph(organs)
    places = graph.vertices @ axis_frame(axis)[2]
    heights = np.linspace(places.min(), places.max(), 150)[::-1]
    executor = threads and ThreadPoolExecutor(threads)
    layers = slice_mesh(organs, heights, axis, executor=executor)
    assert layers == slice_mesh(str(organs), heights, axis, executor=executor)
    in_memory = slice_mesh(graph, heights, axis)
    assert sum(len(layer.contours) for layer in layers) >= 1000
    assert same_layers(layers, in_memory)
    for one, other in zip(layers, in_memory, strict=True):
        for p, q in zip(one.contours, other.contours, strict=True):
            assert np.array_equal(p.triangles, q.triangles)


def test_an_open_mesh_streams_alike(tmp_path):
    path = tmp_path / "airplane.stl"
    samples.airplane().export(path)
    heights = np.linspace(-10, 270, 15)
    assert same_layers(slice_mesh(path, heights), slice_mesh(mesh_graph(path), heights))


def test_planes_beside_the_mesh_are_empty(organ):
    assert [layer.contours for layer in slice_mesh(organ, [-1e4, 1e4])] == [(), ()]


def test_what_is_no_binary_file_is_read_as_a_whole(tmp_path, organ):
    text = tmp_path / "text.stl"
    trimesh.creation.box().export(text, file_type="stl_ascii")
    assert [layer.area for layer in slice_mesh(text, [0.0])] == [1.0]
    (tmp_path / "short.stl").write_bytes(organ.read_bytes()[:-30])
    with pytest.raises(ValueError, match=r"mesh file '.*short.stl' cannot be read"):
        slice_mesh(tmp_path / "short.stl", [0.0])


@pytest.mark.parametrize("byte", [104, 96])  # height, x of the first corner
def test_numbers_that_are_not_finite_are_refused(tmp_path, organ, byte):
    broken = bytearray(organ.read_bytes())
    corners = trimesh.load_mesh(organ).triangles[0, :, 2]
    broken[byte : byte + 4] = np.float32(np.nan).tobytes()
    (tmp_path / "broken.stl").write_bytes(broken)
    with pytest.raises(ValueError, match="not finite"):
        slice_mesh(tmp_path / "broken.stl", [corners.mean()])
