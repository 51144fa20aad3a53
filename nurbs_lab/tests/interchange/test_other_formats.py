"""Triangles, G-code and tables, read back by others or by hand."""

import re

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.interchange._gcode import chords
from nurbs_lab.tests.interchange.shapes import curve, cylinder, path, surface


@pytest.mark.parametrize("suffix", [".stl", ".obj"])
def test_triangles_follow_the_surface(tmp_path, suffix):
    mesh = trimesh.load_mesh(nl.export(tmp_path / f"tube{suffix}", cylinder(3, 10)))
    assert mesh.area == pytest.approx(2 * np.pi * 3 * 10, rel=1e-3)
    radius = np.linalg.norm(mesh.vertices[:, :2], axis=1)
    np.testing.assert_allclose(radius, 3, atol=1e-6)
    rims = trimesh.grouping.group_rows(mesh.edges_sorted, require_count=1)
    assert set(np.round(mesh.vertices[mesh.edges_sorted[rims]][..., 2].ravel(), 6)) == {0, 10}  # no seam


def test_triangles_of_several_surfaces(tmp_path):
    sheets = [surface(), cylinder()]
    one, two = (trimesh.load_mesh(nl.export(tmp_path / f"{i}.stl", s)) for i, s in enumerate(sheets))
    both = trimesh.load_mesh(nl.export(tmp_path / "both.stl", sheets))
    assert both.area == pytest.approx(one.area + two.area, rel=1e-6)


def moves(file):
    """(G word, point, feed) of every move of a G-code file; the feed stays until it changes."""
    found, feed = [], None
    for line in file.read_text().splitlines():
        if match := re.match(r"G([01])((?: [XYZ]-?[\d.]+)+)(?: F([\d.]+))?$", line):
            feed = float(match[3]) if match[3] else feed
            found.append((int(match[1]), [float(w[1:]) for w in match[2].split()], feed))
    return found


@pytest.mark.parametrize("dim", [2, 3])
def test_gcode_of_a_tool_path(tmp_path, dim):
    sent = path(dim)
    lines = nl.export(tmp_path / "path.ngc", sent).read_text().splitlines()
    assert {"G21", "G90", "G94"} <= set(lines[1].split())  # mm, absolute, feed a minute
    assert lines[-1] == "M2"
    words, points, feeds = zip(*moves(tmp_path / "path.ngc"), strict=True)
    assert words == (0, 1, 1, 1, 1, 1)
    np.testing.assert_allclose(points, sent.points, atol=1e-6)
    steps = np.linalg.norm(np.diff(sent.points, axis=0), axis=1)
    np.testing.assert_allclose(steps / np.array(feeds[1:]) * 60, np.diff(sent.t), rtol=1e-6)


def test_a_period_at_rest_makes_no_move(tmp_path):
    sent = path()
    sent.points[1] = sent.points[0]
    assert len(moves(nl.export(tmp_path / "path.ngc", sent))) == 5


def test_gcode_of_a_curve_stays_within_the_bow_height(tmp_path):
    one = nl.paper.CURVE
    found = moves(nl.export(tmp_path / "curve.ngc", one))
    points = np.array([p for _, p, _ in found])
    assert {f for _, _, f in found[1:]} == {60 * nl.paper.SPEED}
    dense = one(np.linspace(0, 1, 20001))
    assert distance_to_polyline(dense, points).max() <= nl.paper.CHORD_ERROR
    assert len(points) < 400


@pytest.mark.parametrize("bow", [1.0, 1e-2])
def test_chords_keep_any_bow_height(bow):
    for one in (curve(2, 8, 2, seed=3), curve(3, 9, 3, seed=4), curve(5, 12, 2, seed=5)):
        dense = one(np.linspace(0, 1, 5001))
        assert distance_to_polyline(dense, chords(one, bow)).max() <= bow


def distance_to_polyline(points, corners):
    start, step = corners[:-1], np.diff(corners, axis=0)
    length2 = np.maximum((step**2).sum(1), 1e-300)
    best = np.full(len(points), np.inf)
    for a, d, l2 in zip(start, step, length2, strict=True):
        t = np.clip((points - a) @ d / l2, 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - t[:, None] * d, axis=1))
    return best


@pytest.mark.parametrize("dim", [2, 3])
def test_table_of_a_tool_path(tmp_path, dim):
    sent = path(dim)
    file = nl.export(tmp_path / "path.csv", sent)
    assert file.read_text().splitlines()[0] == ("t,u,x,y,v" if dim == 2 else "t,u,x,y,z,v")
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    np.testing.assert_array_equal(table[:, 0], sent.t)
    np.testing.assert_array_equal(table[:, 1], sent.u)
    np.testing.assert_array_equal(table[:, 2:-1], sent.points)
    assert table[0, -1] == 0
    np.testing.assert_allclose(
        np.diff(sent.t) * table[1:, -1], np.linalg.norm(np.diff(sent.points, axis=0), axis=1)
    )
