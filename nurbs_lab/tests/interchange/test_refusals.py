"""What cannot be written or read is refused in words; what was there stays."""

import sys

import pytest

import nurbs_lab as nl
from nurbs_lab.tests.interchange.shapes import curve, path, surface

SUFFIXES = [".step", ".stp", ".iges", ".igs", ".3dm", ".json", ".obj", ".stl", ".ngc", ".csv"]


@pytest.mark.parametrize("name", ["part.xyz", "part"])
def test_unknown_suffix_lists_the_known_ones(tmp_path, name):
    with pytest.raises(ValueError, match="unknown suffix") as error:
        nl.export(tmp_path / name, curve())
    assert all(suffix in str(error.value) for suffix in SUFFIXES)


WRONG_NAMES = [
    (b"part.json", TypeError, "b'part.json'"),
    (None, TypeError, "None"),
    (3, TypeError, "3"),
    (["part.json"], TypeError, r"\['part.json'\]"),
    ("", ValueError, "''"),
    ("part\0.json", ValueError, "NUL"),
    ("\ud800.json", ValueError, "character"),
    ("x" * 300 + ".json", ValueError, "305 bytes"),
]


@pytest.mark.parametrize(("name", "kind", "said"), WRONG_NAMES)
@pytest.mark.parametrize("call", [nl.read, lambda name: nl.export(name, curve()), nl.workbench.read_part])
def test_what_is_no_file_name_is_refused_by_name(call, name, kind, said):
    with pytest.raises(kind, match=rf"^path .*{said}"):
        call(name)


def test_a_folder_is_no_file(tmp_path):
    folder = tmp_path / "part.json"
    folder.mkdir()
    for call in (nl.read, lambda name: nl.export(name, curve())):
        with pytest.raises(IsADirectoryError, match=r"path: .*part\.json"):
            call(folder)


def test_suffixes_in_capitals(tmp_path):
    assert nl.read(nl.export(tmp_path / "PART.STEP", curve()))


@pytest.mark.parametrize("item", [None, 3, "curve", {"u": 1}])
def test_other_kinds_of_items(tmp_path, item):
    with pytest.raises(TypeError, match="items must be NurbsCurve"):
        nl.export(tmp_path / "part.step", item)


@pytest.mark.parametrize("suffix", [".step", ".iges"])
@pytest.mark.parametrize("item", [curve(), surface()])
def test_what_opencascade_takes_for_a_point_is_refused(tmp_path, item, suffix):
    tiny = item.scale(1e-10)
    file = tmp_path / f"part{suffix}"
    with pytest.raises(ValueError, match=r"items: .* at most 1e-07 mm"):
        nl.export(file, tiny)
    assert not file.exists()


@pytest.mark.parametrize("items", [(), ([],), ([[]],)])
def test_nothing_to_write(tmp_path, items):
    with pytest.raises(ValueError, match="nothing to write"):
        nl.export(tmp_path / "part.step", *items)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_a_format_cannot_hold(tmp_path, suffix):
    wrong = surface() if suffix in (".ngc", ".csv") else path()
    with pytest.raises(ValueError, match=rf"{suffix} file cannot hold .*; write it to \."):
        nl.export(tmp_path / f"part{suffix}", wrong)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "items"),
    [
        ("two.ngc", lambda: [path(), path()]),
        ("two.csv", lambda: [path(), path()]),
        ("mixed.json", lambda: [curve(), surface()]),
    ],
)
def test_too_much_for_one_file(tmp_path, name, items):
    with pytest.raises(ValueError, match="file holds"):
        nl.export(tmp_path / name, items())


@pytest.mark.parametrize("suffix", [".step", ".3dm"])
def test_four_dimensions_fit_nowhere(tmp_path, suffix):
    with pytest.raises(ValueError, match="2 or 3"):
        nl.export(tmp_path / f"part{suffix}", curve(dim=4))


def test_missing_folder(tmp_path):
    with pytest.raises(FileNotFoundError, match="does not exist"):
        nl.export(tmp_path / "none" / "part.json", curve())


@pytest.mark.parametrize("suffix", [".step", ".igs", ".3dm", ".json"])
def test_files_that_are_missing(tmp_path, suffix):
    with pytest.raises(FileNotFoundError, match="no file"):
        nl.read(tmp_path / f"part{suffix}")


@pytest.mark.parametrize(
    ("suffix", "package", "module"),
    [(".step", "OCP", "_opencascade"), (".igs", "OCP", "_opencascade"), (".3dm", "rhino3dm", "_rhino")],
)
def test_a_missing_extra_is_named_with_its_command(tmp_path, monkeypatch, suffix, package, module):
    for loaded in list(sys.modules):
        if loaded.split(".")[0] == package:
            monkeypatch.setitem(sys.modules, loaded, None)
        elif loaded.startswith("nurbs_lab.interchange._"):
            monkeypatch.delitem(sys.modules, loaded)
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delattr(nl.interchange, module, raising=False)
    with pytest.raises(ImportError, match="pip install"):
        nl.export(tmp_path / f"part{suffix}", curve())
