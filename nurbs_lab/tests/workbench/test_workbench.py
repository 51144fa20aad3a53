"""A part, all the way: from its file to the exported path."""

import base64
import csv
import datetime
import io

import numpy as np
import pytest
import trimesh
from PIL import Image

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
    ("name", "text", "say"), [("part.doc", "", "ends in one of"), ("empty.json", "{}", "empty.json")]
)
def test_what_is_no_part_is_refused(tmp_path, name, text, say):
    (tmp_path / name).write_text(text)
    with pytest.raises(ValueError, match=say):
        read_part(tmp_path / name)


def shown(bench):
    """The pictures by caption."""
    pairs = (child.children for child in bench.gallery.children)
    return {caption.value[3:-4]: bytes(picture.value) for caption, picture in pairs}


def test_widgets_follow_the_hand(tmp_path):
    bench = Workbench("the paper's curve", tmp_path / "exports")
    first = shown(bench)
    assert set(first) == {"tool path", "feed", "feed fluctuation"}
    bench.stepper.value = "taylor1"
    then = shown(bench)
    assert then["tool path"].startswith(b"\x89PNG")
    assert then["feed fluctuation"] != first["feed fluctuation"]
    assert "taylor1" in bench.status.value
    bench.button.click()
    assert (tmp_path / "exports" / "path.ngc").is_file()


def test_stored_without_a_kernel_the_pictures_remain(tmp_path):
    bundle, metadata = Workbench("the paper's curve", tmp_path)._repr_mimebundle_()
    picture = Image.open(io.BytesIO(base64.b64decode(bundle["image/png"])))
    assert picture.width == 3 * 480
    assert "application/vnd.jupyter.widget-view+json" in bundle
    assert metadata["image/png"]["alt"] == "the paper's curve: tool path, feed, feed fluctuation"


def uploaded(name, content):
    """What the browser hands to an upload widget."""
    now = datetime.datetime.now(datetime.UTC)
    return ({"name": name, "content": content, "type": "", "size": len(content), "last_modified": now},)


def test_an_uploaded_file_is_worked_and_a_bad_one_is_refused_kindly(tmp_path):
    bench = Workbench("the paper's curve", tmp_path)
    bench.upload.value = uploaded("broken.json", b"{}")
    assert bench.status.value.startswith("<b>")
    bench.upload.value = uploaded("mine.csv", b"0,0\n10,5\n20,-5\n30,0\n")
    assert bench.part.curve.closest_point([(10.0, 5.0)])[1][0] < 1e-9
    bench.choice.value = "butterfly"
    assert bench.upload.value == ()
    assert bench.part.curve.length() > 300


def test_every_offered_part_exists():
    for make in PARTS.values():
        part = make()
        assert isinstance(part, (nl.NurbsCurve, trimesh.Trimesh))
