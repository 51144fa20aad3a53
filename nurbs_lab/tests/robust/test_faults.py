"""Damaged files, a full disk, an interrupt and two writers at once: one clear error, and no half file."""

import errno
import importlib
import tracemalloc
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.interchange import _json, _step
from nurbs_lab.interchange._export_items import Parts
from nurbs_lab.tests.interchange import shapes
from nurbs_lab.tests.robust import hostile

WRITERS = {
    ".step": ("_step", shapes.surface),
    ".igs": ("_iges", shapes.surface),
    ".json": ("_json", shapes.surface),
    ".obj": ("_triangles", nl.nurbs.cylinder),
    ".stl": ("_triangles", nl.nurbs.cylinder),
    ".ngc": ("_gcode", shapes.path),
    ".csv": ("_table", shapes.path),
}
MESHES = {
    ".stl": {},
    ".ply": {},
    ".obj": {},
    ".txt.stl": {"file_type": "stl_ascii"},
    ".txt.ply": {"encoding": "ascii"},
}


NONSENSE = (b"", b"\n", bytes(range(256)), b"solid", b"ply\n", b'{"shape": []}', b"[" * 100_000)


@pytest.mark.parametrize("suffix", [".json", *MESHES])  # those of CAD: interchange/test_whole_files
def test_damaged_files_are_refused_by_their_names(suffix, tmp_path):
    whole, file = tmp_path / f"whole{suffix}", tmp_path / f"bad{suffix}"
    if suffix in MESHES:
        trimesh.creation.icosphere(subdivisions=1).export(whole, **MESHES[suffix])
    else:
        nl.export(whole, shapes.surface())
    data, rng = whole.read_bytes(), np.random.default_rng(0)
    for content in (*NONSENSE, *(hostile.file(rng, data) for _ in range(20))):
        file.write_bytes(content)
        said = file.name
        try:
            nl.read(file)
        except ValueError as error:
            said = str(error)
        assert file.name in said
        assert file.read_bytes() == content


BALL = trimesh.creation.icosphere(subdivisions=1)
STL, PLY = BALL.export(file_type="stl"), BALL.export(file_type="ply")
#: File name -> content with a number that cannot be.
LIES = {
    "many.stl": STL[:80] + (2**32 - 1).to_bytes(4, "little") + STL[84:],
    "vertices.ply": PLY.replace(b"vertex 42", b"vertex 4000000000"),
    "faces.ply": PLY.replace(b"face 80", b"face 4000000000"),
}


@pytest.mark.parametrize("name", LIES)
def test_numbers_that_cannot_be_are_refused_and_take_no_memory(name, tmp_path):
    file = tmp_path / name
    file.write_bytes(LIES[name])
    tracemalloc.start()
    try:
        with pytest.raises(ValueError, match=name):
            nl.slice_mesh(file, 0.1)
        assert tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (b'"size_u": 7', b'"size_u": 10000000000'),
        (b'"degree_u": 3', b'"degree_u": ' + b"9" * 5000),
        (b'"points": [[', b'"points": [[NaN, 0, 0], ['),
        (b'"weights": [', b'"weights": [null, '),
    ],
)
def test_json_with_numbers_that_cannot_be_is_refused(before, after, tmp_path):
    file = nl.export(tmp_path / "part.json", shapes.surface())
    assert before in file.read_bytes()
    file.write_bytes(file.read_bytes().replace(before, after, 1))
    with pytest.raises(ValueError, match=r"part\.json"):
        nl.read(file)


@pytest.mark.parametrize("suffix", WRITERS)
@pytest.mark.parametrize("fault", [KeyboardInterrupt(), OSError(errno.ENOSPC, "No space left on device")])
def test_a_fault_half_way_leaves_what_was_there(suffix, fault, tmp_path, monkeypatch):
    module, shape = WRITERS[suffix]
    file = nl.export(tmp_path / f"part{suffix}", shape())
    before = file.read_bytes()
    module = importlib.import_module(f"nurbs_lab.interchange.{module}")
    write = module.write

    def half_way(path, parts):
        write(path, parts)
        with path.open("rb+") as half:
            half.truncate(len(before) // 2)
        raise fault

    monkeypatch.setattr(module, "write", half_way)
    with pytest.raises(type(fault)):
        nl.export(file, shape())
    with pytest.raises(type(fault)):
        nl.export(tmp_path / f"new{suffix}", shape())
    assert file.read_bytes() == before
    assert list(tmp_path.iterdir()) == [file]


def test_an_export_keeps_mode_and_link(tmp_path):
    file, link = tmp_path / "part.json", tmp_path / "link.json"
    nl.export(file, shapes.curve())
    file.chmod(0o600)
    link.symlink_to(file)
    nl.export(link, shapes.curve(), shapes.curve())
    assert link.is_symlink()
    assert file.stat().st_mode & 0o777 == 0o600
    assert len(nl.read(file)) == 2
    assert sorted(tmp_path.iterdir()) == [link, file]


@pytest.mark.parametrize("writer", [_json, _step])
def test_a_full_disk_is_named(writer, tmp_path):
    def on_full_disk(beside):
        beside.unlink()
        beside.symlink_to("/dev/full")
        writer.write(beside, Parts([shapes.curve()]))

    with pytest.raises(OSError, match="No space left on device"):
        nl.interchange._replace(tmp_path / "part", on_full_disk)


@pytest.mark.parametrize("suffix", [".json", ".step", ".stl"])
def test_many_writers_at_once_leave_one_whole_file(suffix, tmp_path):
    file = tmp_path / f"part{suffix}"
    kinds = [nl.nurbs.cylinder, lambda: nl.nurbs.cylinder(5.0)]
    whole = {nl.export(file, kind()).read_bytes() for kind in kinds}

    def write_and_look(i):
        nl.export(file, kinds[i % 2]())
        return file.read_bytes()

    with ThreadPoolExecutor(6) as pool:
        assert set(pool.map(write_and_look, range(24))) <= whole
    assert list(tmp_path.iterdir()) == [file]
