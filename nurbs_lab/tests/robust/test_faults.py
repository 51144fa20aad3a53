"""Damaged files, a full disk, an interrupt and two writers at once: one clear error, and no half file."""

import errno
import importlib
import random
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.interchange import _rhino
from nurbs_lab.tests.interchange import shapes

WRITERS = {
    ".step": ("_step", shapes.surface),
    ".igs": ("_iges", shapes.surface),
    ".3dm": ("_rhino", shapes.surface),
    ".json": ("_json", shapes.surface),
    ".obj": ("_triangles", shapes.cylinder),
    ".stl": ("_triangles", shapes.cylinder),
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


def damaged(whole):
    """The file cut short, with bytes changed, with a piece missing, doubled; and no such file at all."""
    rng = random.Random(len(whole))
    for _ in range(4):
        a, b = sorted(rng.randrange(len(whole)) for _ in range(2))
        yield whole[:a]
        yield whole[:a] + whole[b:]
        yield whole[:b] + whole[a:]
        yield whole[:a] + bytes(rng.randrange(256) for _ in range(20)) + whole[a + 20 :]
    yield from (b"", b"\n", bytes(range(256)), b"solid", b"ply\n", b'{"shape": []}', b"[" * 100_000)


def assert_read_or_refused(read, file):
    before, said = file.read_bytes(), file.name
    try:
        read(file)
    except ValueError as error:
        said = str(error)
    assert file.name in said
    assert file.read_bytes() == before


@pytest.mark.parametrize("suffix", [".step", ".igs", ".3dm", ".json"])
def test_damaged_shapes_are_refused_by_file_name(suffix, tmp_path, monkeypatch):
    monkeypatch.setattr(_rhino, "PATIENCE_S", 5)  # it does hang, now and then
    whole = nl.export(tmp_path / f"whole{suffix}", shapes.surface()).read_bytes()
    file = tmp_path / f"bad{suffix}"
    for content in damaged(whole):
        file.write_bytes(content)
        assert_read_or_refused(nl.interchange.read, file)


@pytest.mark.parametrize(
    ("reader", "patience", "said"),
    [("while True: pass", 0.5, "found no end"), ("import os; os.abort()", 60, "crashed")],
)
def test_a_reader_that_hangs_or_crashes_is_reported(reader, patience, said, tmp_path, monkeypatch):
    file = nl.export(tmp_path / "part.3dm", shapes.surface())
    monkeypatch.setattr(_rhino, "READER", tmp_path / "reader.py")
    monkeypatch.setattr(_rhino, "PATIENCE_S", patience)
    _rhino.READER.write_text(reader)
    with pytest.raises(ValueError, match=rf"part\.3dm.* cannot be read: rhino3dm {said}"):
        nl.interchange.read(file)


@pytest.mark.parametrize("suffix", MESHES)
def test_damaged_meshes_are_refused_by_file_name(suffix, tmp_path):
    whole = tmp_path / f"whole{suffix}"
    trimesh.creation.icosphere(subdivisions=1).export(whole, **MESHES[suffix])
    file = tmp_path / f"bad{suffix}"
    for content in damaged(whole.read_bytes()):
        file.write_bytes(content)
        assert_read_or_refused(lambda file: nl.slice_mesh(file, 0.1), file)
        assert_read_or_refused(lambda file: nl.mesh.slice_stl(file, 0.1), file)


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


FULL_DISK = """
import pathlib, resource, signal, sys
import nurbs_lab as nl
from nurbs_lab.tests.robust.test_faults import WRITERS
folder = pathlib.Path(sys.argv[1])
old = {s: nl.export(folder / f"part{s}", shape()).read_bytes() for s, (_, shape) in WRITERS.items()}
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))
for suffix, (_, shape) in WRITERS.items():
    file = folder / f"part{suffix}"
    try:
        nl.export(file, shape())
        print(suffix, "said nothing")
    except OSError:
        pass
    if file.read_bytes() != old[suffix]:
        print(suffix, "was overwritten")
print("left over:", *(file.name for file in folder.iterdir() if file.stem != "part"))
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
"""


def test_a_full_disk_is_reported_and_leaves_what_was_there(tmp_path):
    ran = subprocess.run([sys.executable, "-c", FULL_DISK, tmp_path], capture_output=True, text=True)
    assert ran.stdout == "left over:\n", ran.stdout + ran.stderr


@pytest.mark.parametrize("suffix", [".json", ".step", ".stl"])
def test_many_writers_at_once_leave_one_whole_file(suffix, tmp_path):
    file = tmp_path / f"part{suffix}"
    kinds = [shapes.surface, shapes.cylinder]
    whole = {nl.export(file, kind()).read_bytes() for kind in kinds}

    def write_and_look(i):
        nl.export(file, kinds[i % 2]())
        return file.read_bytes()

    with ThreadPoolExecutor(6) as pool:
        assert set(pool.map(write_and_look, range(24))) <= whole
    assert list(tmp_path.iterdir()) == [file]


NOTEBOOK = """
import sys
import nurbs_lab as nl
from nurbs_lab.tests.interchange import shapes
shape = getattr(shapes, sys.argv[2])()
for _ in range(40):
    nl.export(sys.argv[1], shape)
"""


def test_two_notebooks_that_write_the_same_file_leave_it_whole(tmp_path):
    file = tmp_path / "part.json"
    kinds = ["surface", "cylinder"]
    whole = {nl.export(file, getattr(shapes, kind)()).read_bytes() for kind in kinds}
    both = [subprocess.Popen([sys.executable, "-c", NOTEBOOK, file, kind]) for kind in kinds]
    seen = set()
    while any(process.poll() is None for process in both):
        seen.add(file.read_bytes())
        time.sleep(1e-3)
    assert [process.returncode for process in both] == [0, 0]
    assert seen <= whole
    assert list(tmp_path.iterdir()) == [file]
