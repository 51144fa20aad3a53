"""Triangles and tables, read back by others or by hand."""

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.nurbs import cylinder
from nurbs_lab.tests.interchange.shapes import path


@pytest.mark.filterwarnings("ignore:.*states no unit")
@pytest.mark.parametrize("suffix", [".stl", ".obj"])
@pytest.mark.parametrize("size", [1e-12, 1.0, 1e12])
def test_triangles_follow_the_surface(tmp_path, suffix, size):
    mesh = nl.read(nl.export(tmp_path / f"tube{suffix}", cylinder(3 * size, 10 * size)))
    assert mesh.area == pytest.approx(2 * np.pi * 3 * 10 * size**2, rel=1e-3)
    vertices = np.asarray(mesh.vertices) / size
    np.testing.assert_allclose(np.linalg.norm(vertices[:, :2], axis=1), 3, atol=1e-6)
    rims = trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1)
    assert set(np.round(vertices[mesh.edges_sorted[rims]][..., 2].ravel(), 6)) == {0, 10}  # no seam


def test_an_stl_of_numbers_that_it_cannot_hold_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"items: an STL holds no 1e\+50 mm"):
        nl.export(tmp_path / "tube.stl", cylinder(1.0, 1e50))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".stl", ".obj"])
def test_triangles_of_a_reconstruction_are_closed(tmp_path, suffix):
    ball = trimesh.creation.icosphere(subdivisions=3, radius=10)
    built = nl.reconstruct(ball, tolerance=0.1)
    mesh = nl.read(nl.export(tmp_path / f"ball{suffix}", built))
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(ball.volume, rel=0.01)


@pytest.mark.parametrize(("tolerance", "away", "rounded"), [(1e-4, 0.0, False), (0.1, 5e6, True)])
def test_an_stl_that_cannot_keep_the_tolerance_is_warned_of(tmp_path, recwarn, tolerance, away, rounded):
    box = trimesh.creation.box((10, 10, 10)).apply_translation((away + 0.3, 0.1, 0))
    made = nl.reconstruct(box, tolerance=tolerance)
    nl.export(tmp_path / "part.obj", made)
    assert not recwarn
    nl.export(tmp_path / "part.stl", made)
    assert [("moves these points by up to 0.2 mm" in str(w.message)) for w in recwarn] == [True] * rounded


@pytest.mark.parametrize("dim", [2, 3])
def test_table_of_a_tool_path(tmp_path, dim):
    sent = path(dim)
    file = nl.export(tmp_path / "path.csv", sent)
    assert file.read_text().splitlines()[0] == ("t,u,x,y,v" if dim == 2 else "t,u,x,y,z,v")
    table = nl.read(file)
    for name in ("t", "u", "points"):
        np.testing.assert_array_equal(getattr(table, name), getattr(sent, name))
    assert table.v[0] == 0
    chords = np.linalg.norm(np.diff(sent.points, axis=0), axis=1)
    np.testing.assert_allclose(np.diff(sent.t) * table.v[1:], chords)


def test_a_table_whose_last_line_has_no_end_is_warned_of(tmp_path):
    (tmp_path / "cloud.csv").write_text("x,y,z\n1,2,3\n7,8,9\n4,5,6.7")
    with pytest.warns(UserWarning, match=r"cloud\.csv: its last line has no end; it may be cut off"):
        np.testing.assert_array_equal(nl.read(tmp_path / "cloud.csv"), [(1, 2, 3), (7, 8, 9), (4, 5, 6.7)])


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", "y,z,x\n2,3,1\n"),
        ("a.csv", '# of a probe\n"Z [m]",X (cm),y\n0.003,0.1,2\n'),
        ("a.txt", "# z x y\n3 1 2\n"),  # as NumPy writes it
        ("a.txt", "1, 2, 3\n"),
        ("a.csv", "1 2 3\n"),
        ("a.csv", "x;y;z\n1,0;2;3\n"),  # of Excel in Europe
        ("a.csv", "1,0;2,0;3,0\n"),
        ("a.csv", "1,2,3, ,\n"),  # of a sheet with empty columns
        ("a.csv", '"x","y","z"\n"1","2","3"\n'),
        ("a.csv", ",x_mm,y (\u00b5m),z [inches]\nP 1,1,2000,0.11811023622047244\n"),  # of pandas
        ("a.txt", "# x y z nx ny nz\n1 2 3 0 0 1\n"),
        ("a.csv", "i,z,y,x\n7,3,2,1\n"),
    ],
)
def test_a_table_of_points_with_a_header_that_names_its_columns_or_none(tmp_path, name, text):
    for coding in ("utf-8", "utf-16"):
        (tmp_path / name).write_text(text, encoding=coding)
        np.testing.assert_allclose(nl.read(tmp_path / name), [(1, 2, 3)])


def test_a_minus_of_a_typesetter_is_one_and_an_unknown_suffix_names_its_cure(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z\n\u22121,2,3\n", encoding="utf-8")
    np.testing.assert_array_equal(nl.read(tmp_path / "a.csv"), [(-1, 2, 3)])
    with pytest.raises(ValueError, match=r"unknown suffix '\.xyz'.* a table of points \.txt"):
        nl.read((tmp_path / "a.csv").rename(tmp_path / "a.xyz"))
