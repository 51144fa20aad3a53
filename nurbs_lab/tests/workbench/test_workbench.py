"""A part, all the way: from its file to the exported path."""

import csv
import datetime
import io

import numpy as np
import pytest
import trimesh
from PIL import Image

import nurbs_lab as nl
from nurbs_lab import interchange, workbench
from nurbs_lab.common.checks import lengths
from nurbs_lab.workbench import Workbench, work


@pytest.fixture(scope="module")
def ball():
    return trimesh.creation.icosphere(subdivisions=3, radius=10.0)


def test_a_mesh_becomes_surfaces_and_a_path(ball, tmp_path):
    file = tmp_path / "ball.stl"
    ball.export(file)
    part = work(file, tolerance=0.4, speed=20)
    assert part.reconstruction.within_tolerance
    radius = np.linalg.norm(part.curve(np.linspace(*part.curve.domain, 50)), axis=1)
    assert np.all(np.abs(radius - 10.0) < 0.4)
    assert np.array_equal(part.path.points[-1], part.curve(part.curve.domain[1]))
    assert "kept" in part.summary()
    assert "below 1e-6 %" in part.summary()  # as in its picture, in which the last step does not count either
    pictures = part.pictures()
    assert list(pictures)[:3] == ["solid", "deviation", "tool path"]
    assert all(opened(picture).width > 300 for picture in pictures.values())


def test_a_damaged_part_is_followed_as_it_was_mended(ball):
    """One triangle is missing that the plane at half the height cuts."""
    part = ball.copy().apply_transform(trimesh.transformations.rotation_matrix(0.3, (1, 2, 0)))
    cut = np.flatnonzero(np.ptp(np.sign(part.triangles[..., 2]), axis=1) == 2)[0]
    torn = trimesh.Trimesh(part.vertices, np.delete(part.faces, cut, axis=0), process=False)
    followed = work(torn, tolerance=0.2).curve
    assert followed.closed
    assert followed.length() == pytest.approx(2 * np.pi * 10.0, rel=0.01)


def test_the_path_of_a_coarse_part_keeps_the_tolerance():
    x, y = np.abs(work(trimesh.creation.box((10, 20, 3)), tolerance=0.05).path.points[:, :2].T)
    assert np.abs(np.maximum(x - 5, y - 10)).max() < 0.05


def test_export_leaves_a_solid_a_table_and_a_program(tmp_path):
    part = work(nl.paper.CURVE, speed=4, acceleration=40)
    files = part.export(tmp_path / "out")
    assert [file.name for file in files] == ["part.step", "path.csv", "path.ngc"]
    (again,) = interchange.read(files[0])
    assert np.allclose(again(0.3), [*nl.paper.CURVE(0.3), 0.0][: again.dim], atol=1e-9)
    rows = list(csv.reader(line for line in files[1].open() if not line.startswith("#")))
    assert len(rows) - 1 == len(part.path)
    assert "G1" in files[2].read_text()


def cloud(count=600):
    """Points of a ball, in no order."""
    rng = np.random.default_rng(5)
    points = rng.normal(size=(count, 3))
    return 10 * points / np.linalg.norm(points, axis=1)[:, None]


def test_a_cloud_becomes_surfaces_and_a_path():
    part = work(cloud(), tolerance=1.0)
    radius = np.linalg.norm(part.curve(np.linspace(*part.curve.domain, 50)), axis=1)
    assert np.all(np.abs(radius - 10.0) < 1.0)


def test_a_program_of_facets_becomes_smooth(tmp_path):
    angle = np.linspace(0, 3, 500)
    blocks = "\n".join(f"X{30 * np.cos(a):.4f} Y{20 * np.sin(a):.4f}" for a in angle)
    (tmp_path / "mine.ngc").write_text(f"G21 G90\nG0 X30 Y0 Z5\nG1 Z0 F600\n{blocks}\nG0 Z5\nM2\n")
    part = work(tmp_path / "mine.ngc", tolerance=0.01)
    assert (part.blocks, len(part.program.moves)) == (501, 3)
    assert "program of 3 moves, for 501 in the file" in part.summary()
    assert lengths(np.diff(part.path.points, axis=0)).max() <= 0.01 * (1 + 1e-9)  # 600 mm/min for 1 ms
    (tmp_path / "rapid.ngc").write_text("G21 G90\nG0 X30 Y0 Z5\nG0 Z9\nM2\n")
    with pytest.raises(ValueError, match="no move that cuts"):
        work(tmp_path / "rapid.ngc")
    files = part.export(tmp_path / "out", dialect="fanuc", units="mm", axes="XYZ")
    assert files[-1].name == "program.ngc"
    assert len(files[-1].read_text().splitlines()) < 50


def test_a_mesh_is_finished_with_a_cutter(tmp_path):
    dome = trimesh.creation.box(extents=(6, 6, 3))
    part = work(dome, tolerance=0.5, cutter=nl.Cutter("ball", diameter=6.0), scallop=0.4)
    assert len(part.program.curves) > 2
    files = part.export(tmp_path, dialect="g1", tolerance=0.05, units="mm", axes="XYZ")
    assert nl.read(files[-1]).moves[0].kind == "rapid"


def test_of_straight_cuts_the_longest_is_followed(tmp_path):
    (tmp_path / "mine.ngc").write_text("G21 G90\nG0 X0 Y0 Z0\nG1 X5 F600\nG0 Y9\nG1 X40\nG0 Z5\nM2\n")
    assert work(tmp_path / "mine.ngc").curve.length() == pytest.approx(35.0)


def test_a_cutter_that_nothing_is_milled_with_is_named():
    with pytest.warns(UserWarning, match="only a mesh or a cloud of points is milled"):
        work(nl.paper.CURVE, speed=4, cutter=nl.Cutter("ball", diameter=2.0))


def shown(bench):
    """The pictures by caption."""
    pairs = (child.children for child in bench.gallery.children)
    return {caption.value[3:-4]: bytes(picture.value) for caption, picture in pairs}


def test_widgets_follow_the_hand(tmp_path):
    with pytest.raises(ValueError, match=r"part must be one of the paper's curve, .*got 'nope'"):
        Workbench("nope")
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


def test_an_interrupt_leaves_the_widgets_usable(tmp_path, monkeypatch):
    bench = Workbench("the paper's curve", tmp_path)

    def stopped(*args, **options):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(workbench, "trace", stopped)
        bench.speed.value = 30
        assert "stopped" in bench.status.value
        with pytest.raises(KeyboardInterrupt):  # a cell that is stopped says so itself
            Workbench("the paper's curve", tmp_path)
    bench.speed.value = 40
    assert bench.part.path.feed.peak > 30
    assert set(shown(bench)) == {"tool path", "feed", "feed fluctuation"}


def opened(file):
    return Image.open(io.BytesIO(file))


def uploaded(name, content):
    """What the browser hands to an upload widget."""
    now = datetime.datetime.now(datetime.UTC)
    return ({"name": name, "content": content, "type": "", "size": len(content), "last_modified": now},)


def test_an_uploaded_mesh_has_the_unit_that_is_chosen(tmp_path, ball):
    bench = Workbench("the paper's curve", tmp_path)
    bench.upload.value = uploaded("ball.stl", ball.export(file_type="stl"))
    before = bench.part.reconstruction.volume
    bench.unit.value = "inch"
    assert bench.part.reconstruction.volume == pytest.approx(before * 25.4**3, rel=0.01)
    bench.upload.value = uploaded("mine.csv", b"0,0\n10,5\n20,-5\n30,0\n")
    assert "no mesh file" in bench.status.value


def test_an_uploaded_file_is_worked_and_a_bad_one_is_refused_kindly(tmp_path):
    bench = Workbench("the paper's curve", tmp_path)
    bench.upload.value = uploaded("broken.json", b"{}")
    assert bench.status.value.startswith("<b>")
    bench.upload.value = uploaded("mine.csv", b"0,0\n10,5\n20,-5\n30,0\n")
    assert bench.part.curve.closest_point([(10.0, 5.0)])[1][0] < 1e-9
    bench.choice.value = "butterfly"
    assert bench.upload.value == ()
    assert bench.part.curve.length() > 300


def test_a_refused_or_doubtful_file_is_named_and_never_taken_for_another(tmp_path, ball):
    """The text tells of warnings, of what is shown still, and of what is exported; a part can be had back."""
    bench = Workbench("the paper's curve", tmp_path)
    bench.upload.value = uploaded("tiny.stl", ball.copy().apply_scale(0.05).export(file_type="stl"))
    assert bench.choice.value is None
    bench.upload.value = uploaded("small.stl", ball.copy().apply_scale(0.028).export(file_type="stl"))
    assert "states no unit" in bench.status.value
    bench.upload.value = uploaded("empty.stl", b"")
    assert bench.status.value.startswith("<b>path: &#x27;empty.stl&#x27; cannot be read")
    assert "what is shown is the last result" in bench.status.value
    bench.button.click()
    assert bench.status.value.startswith("small.stl is written: ")
    bench.choice.value = "the paper's curve"  # which it was before the files
    assert (bench.upload.value, bench.part.curve) == ((), nl.paper.CURVE)
