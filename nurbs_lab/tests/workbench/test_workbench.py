"""A part, all the way: from its file to the exported path."""

import csv
import json

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab import interchange
from nurbs_lab.workbench import PARTS, Workbench, read_part, work


@pytest.fixture(scope="module")
def ball():
    return trimesh.creation.icosphere(subdivisions=3, radius=10.0)


def test_a_mesh_becomes_surfaces_and_a_path(ball, tmp_path):
    file = tmp_path / "ball.stl"
    ball.export(file)
    part = work(file, layers=12, tolerance=0.4, speed=20)
    assert part.reconstruction.within_tolerance
    radius = np.linalg.norm(part.curve(np.linspace(*part.curve.domain, 50)), axis=1)
    assert np.all(np.abs(radius - 10.0) < 0.4)
    assert np.array_equal(part.path.points[-1], part.curve(part.curve.domain[1]))
    assert "kept" in part.summary()


def test_export_leaves_a_solid_a_table_and_a_program(tmp_path):
    part = work(nl.paper.CURVE, speed=4, acceleration=40)
    files = part.export(tmp_path / "out")
    assert [file.name for file in files] == ["part.step", "path.csv", "path.ngc"]
    (again,) = interchange.read(files[0])
    assert np.allclose(again(0.3), [*nl.paper.CURVE(0.3), 0.0][: again.dim], atol=1e-9)
    rows = list(csv.reader(line for line in files[1].open() if not line.startswith("#")))
    assert len(rows) - 1 == len(part.path)
    assert "G1" in files[2].read_text()


def test_points_become_a_curve(tmp_path):
    points = np.array([(0, 0), (10, 5), (20, -5), (30, 0)], dtype=float)
    np.savetxt(tmp_path / "points.csv", points, delimiter=",")
    curve = read_part(tmp_path / "points.csv")
    assert np.allclose(curve.closest_point(points)[1], 0.0, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "text", "say"), [("part.doc", "", "ends in one of"), ("empty.json", "{}", "")]
)
def test_what_is_no_part_is_refused(tmp_path, name, text, say):
    (tmp_path / name).write_text(text)
    with pytest.raises(ValueError, match=say):
        read_part(tmp_path / name)


def test_widgets_follow_the_hand(tmp_path):
    bench = Workbench("the paper's curve", tmp_path / "exports")
    first = {child.children[0].value: child.children[1].value for child in bench.gallery.children}
    assert set(first) == {"<b>tool path</b>", "<b>feed</b>", "<b>feed fluctuation</b>"}
    bench.stepper.value = "taylor1"
    then = {child.children[0].value: child.children[1].value for child in bench.gallery.children}
    assert then["<b>tool path</b>"].startswith(b"\x89PNG")
    assert then["<b>feed fluctuation</b>"] != first["<b>feed fluctuation</b>"]
    assert "taylor1" in bench.status.value
    bench.button.click()
    assert (tmp_path / "exports" / "path.ngc").is_file()


def test_an_uploaded_file_is_worked_and_a_bad_one_is_refused_kindly(tmp_path):
    bench = Workbench("the paper's curve", tmp_path)
    curve = {"type": "curve", "shape": {}}
    bench.upload.value = (
        {"name": "broken.json", "content": json.dumps(curve).encode(), "type": "", "size": 1},
    )
    assert bench.status.value.startswith("<b>")
    points = b"0,0\n10,5\n20,-5\n30,0\n"
    bench.upload.value = ({"name": "mine.csv", "content": points, "type": "text/csv", "size": len(points)},)
    assert bench.part.curve.closest_point([(10.0, 5.0)])[1][0] < 1e-9
    bench.choice.value = "butterfly"
    assert bench.upload.value == ()
    assert bench.part.curve.length() > 300


def test_every_offered_part_exists():
    for make in PARTS.values():
        part = make()
        assert isinstance(part, (nl.NurbsCurve, trimesh.Trimesh))
