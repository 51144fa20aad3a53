"""What cannot be written or read is refused in words; what was there stays."""

import sys

import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.tests.interchange.shapes import curve, path, surface

SUFFIXES = [".step", ".stp", ".iges", ".igs", ".json", ".obj", ".stl", ".ngc", ".csv"]


def test_a_folder_is_no_file(tmp_path):
    folder = tmp_path / "part.json"
    folder.mkdir()
    for call in (nl.read, lambda name: nl.export(name, curve())):
        with pytest.raises(IsADirectoryError, match=r"path: .*part\.json"):
            call(folder)
        with pytest.raises(TypeError, match=r"^path must be a file name.* got 3"):
            call(3)


OTHER_KINDS = "items must be NurbsCurve"
LOOP = []
LOOP.append([curve(), LOOP])


@pytest.mark.parametrize(
    ("name", "items", "kind", "said"),
    [
        *(("part.step", item, TypeError, OTHER_KINDS) for item in (None, 3, "curve", {"u": 1})),
        ("part.stl", trimesh.creation.box(), TypeError, "got Trimesh; a mesh writes itself by its export"),
        ("part.json", LOOP, ValueError, "a list holds itself"),
        *(("part.step", items, ValueError, "nothing to write") for items in ([], [[]])),
        *(
            (f"part{suffix}", path(), ValueError, r"file cannot hold .*; write it")
            for suffix in SUFFIXES[:-2]
        ),
        *((f"part{suffix}", surface(), ValueError, r"file cannot hold .*; wr") for suffix in SUFFIXES[-2:]),
        ("two.ngc", [path(), path()], ValueError, "file holds"),
        ("two.csv", [path(), path()], ValueError, "file holds"),
        ("mixed.json", [curve(), surface()], ValueError, "file holds"),
        *((name, curve(dim=4), ValueError, "2 or 3") for name in ("part.step", "part.igs")),
        *((name, curve(), ValueError, "unknown suffix.*" + SUFFIXES[-1]) for name in ("part.xyz", "part")),
        ("none/part.json", curve(), FileNotFoundError, "does not exist"),
    ],
)
def test_what_cannot_be_written_is_refused_and_leaves_no_file(tmp_path, name, items, kind, said):
    with pytest.raises(kind, match=said):
        nl.export(tmp_path / name, items)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".step", ".igs"])
def test_a_missing_extra_is_named_with_its_command(tmp_path, monkeypatch, suffix):
    for loaded in list(sys.modules):
        if loaded.split(".")[0] == "OCP":
            monkeypatch.setitem(sys.modules, loaded, None)
        elif loaded.startswith(("nurbs_lab.interchange._", "nurbs_lab.mesh.solid.opencascade")):
            monkeypatch.delitem(sys.modules, loaded)
    monkeypatch.setitem(sys.modules, "OCP", None)
    monkeypatch.delattr(nl.interchange, "_opencascade", raising=False)
    monkeypatch.delattr("nurbs_lab.mesh.solid.opencascade", raising=False)
    with pytest.raises(ImportError, match="pip install"):
        nl.export(tmp_path / f"part{suffix}", curve())
