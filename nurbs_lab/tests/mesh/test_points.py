"""Meshes from point clouds, and the report on meshes."""

import contextlib
import re

import numpy as np
import pytest
import trimesh
from scipy.spatial import cKDTree

import nurbs_lab as nl
from nurbs_lab.mesh import check_mesh, mesh_from_points, samples, slice_mesh
from nurbs_lab.mesh.cloud.normals import _joined
from nurbs_lab.tests.mesh.shapes import figure, plate


def cloud(count=4000, radii=(2.0, 0.6)):
    """Even samples of a torus and their normals."""
    major, minor = radii
    i = np.arange(count) + 0.5
    angle, around = 2 * np.pi * i / count, 2 * np.pi * ((i * 0.6180339887498949) % 1.0)
    normals = np.column_stack(
        [np.cos(around) * np.cos(angle), np.cos(around) * np.sin(angle), np.sin(around)]
    )
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    return major * rim + minor * normals, normals


def distance_to_torus(points, radii=(2.0, 0.6)):
    return np.abs(np.hypot(np.hypot(*points[:, :2].T) - radii[0], points[:, 2]) - radii[1])


def pierced(mesh):
    """Number of edges that pass through a triangle without a common corner, of all pairs that are near."""
    corners, edges = mesh.vertices[mesh.faces], mesh.edges_unique
    centres, ends = corners.mean(axis=1), mesh.vertices[edges]
    reach = np.linalg.norm(corners - centres[:, None], axis=2).max() + mesh.edges_unique_length.max() / 2
    near = cKDTree(centres).query_ball_point(ends.mean(axis=1), reach)
    edge, face = np.repeat(np.arange(len(edges)), [len(some) for some in near]), np.concatenate(near)
    apart = (edges[edge][:, :, None] != mesh.faces[face][:, None]).all(axis=(1, 2))
    (a, b), corners = np.moveaxis(ends[edge[apart]], 1, 0), corners[face[apart]]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    above, below = (np.einsum("ij,ij->i", place - corners[:, 0], normal) for place in (a, b))
    crossing = above * below < 0.0
    share = np.where(crossing, above / np.where(crossing, above - below, 1.0), 0.0)
    at = a + share[:, None] * (b - a)
    for k in range(3):
        side = np.cross(corners[:, k] - corners[:, k - 1], at - corners[:, k - 1])
        crossing &= np.einsum("ij,ij->i", side, normal) > 0.0
    return np.count_nonzero(crossing)


def surface_samples(mesh, count, *, noise=0.0, outliers=0.0, seed=0):
    """Random points of a surface, with noise and outliers in parts of the size."""
    random = np.random.default_rng(seed)
    points = np.array(trimesh.sample.sample_surface(mesh, count, seed=seed)[0])
    points += random.normal(size=points.shape) * noise * np.ptp(points, axis=0).max()
    stray = int(outliers * count)
    points[:stray] = random.uniform(*mesh.bounds, (stray, 3))
    return points


def hollow_box():
    inner = trimesh.creation.box((30.0, 20.0, 12.0))
    inner.invert()
    return trimesh.util.concatenate([trimesh.creation.box((40.0, 30.0, 20.0)), inner])


SOLIDS = {
    "torus": lambda: trimesh.creation.torus(2.0, 0.6),
    "cube": lambda: trimesh.creation.box((60.0, 60.0, 60.0)),
    "hollow box": hollow_box,
    "plate of genus 4": plate,
    "figure": figure,
    "nut": samples.nut,
    "eye": lambda: samples.frog_organ("eye_white"),
    "spleen": lambda: samples.frog_organ("spleen"),
}


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize(("count", "noise", "outliers"), [(5000, 0.0, 0.0), (10_000, 0.002, 0.01)])
def test_random_samples_become_a_closed_mesh_of_the_same_volume_and_genus(name, count, noise, outliers):
    solid = SOLIDS[name]()
    solid = trimesh.Trimesh(solid.vertices, solid.faces)
    mesh = nl.mesh_from_points(surface_samples(solid, count, noise=noise, outliers=outliers))
    assert mesh.metadata["report"].watertight
    assert mesh.metadata["report"].outward
    assert mesh.volume == pytest.approx(solid.volume, rel=0.01)
    assert mesh.euler_number == solid.euler_number


def test_a_torus_from_its_points_is_where_the_torus_is():
    mesh = nl.mesh_from_points(cloud()[0])
    assert isinstance(mesh, trimesh.Trimesh)
    assert mesh.metadata["report"].sound
    assert distance_to_torus(mesh.vertices).max() < 0.004
    assert mesh.volume == pytest.approx(2 * np.pi**2 * 2.0 * 0.36, rel=0.002)


def test_the_error_falls_with_the_square_of_the_distance_of_points():
    errors = [
        np.sqrt(np.mean(distance_to_torus(nl.mesh_from_points(cloud(n)[0]).vertices) ** 2))
        for n in (2000, 4000, 8000, 16_000)
    ]
    slope = np.polyfit(np.log([2000, 4000, 8000, 16_000]), np.log(errors), 1)[0]
    assert 2 * slope < -1.7


@pytest.mark.parametrize("factor", [3.0, -3.0])
def test_given_normals_decide_what_is_inside(factor):
    points, normals = cloud()
    mesh = mesh_from_points(points, factor * normals)
    assert mesh.metadata["report"].sound
    assert mesh.metadata["report"].repairs == ("normals turned, which pointed inwards",) * (factor < 0)
    assert distance_to_torus(mesh.vertices).max() < 0.004


def test_the_order_of_points_does_not_matter():
    points = cloud()[0]
    mesh, other = mesh_from_points(points), mesh_from_points(points[::-1])
    np.testing.assert_array_equal(mesh.vertices, other.vertices)
    np.testing.assert_array_equal(mesh.faces, other.faces)


@pytest.mark.parametrize("cap_deg", [10, 25, 60, 90])
def test_a_hole_as_wide_as_the_shape_allows_is_closed_and_named(cap_deg):
    points = trimesh.creation.icosphere(subdivisions=5, radius=10.0).vertices
    points = points[points[:, 2] < 10.0 * np.cos(np.radians(cap_deg))]
    height = 10.0 * (1.0 - np.cos(np.radians(cap_deg)))
    flat = np.pi * (4000.0 - height**2 * (30.0 - height)) / 3.0  # of the ball without its cap
    mesh = mesh_from_points(points)
    assert mesh.is_watertight
    assert 0.999 * flat < mesh.volume < min(1.08 * flat, 4000.0 / 3.0 * np.pi)
    named = re.search(r"holes? closed, the widest about (.*) mm, at", mesh.metadata["report"].repairs[-1])
    assert float(named[1]) == pytest.approx(20.0 * np.sin(np.radians(cap_deg)), rel=0.1)


def resampled(points, step):
    """Points at equal distances along a closed polyline."""
    ring = np.vstack([points, points[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    places = np.arange(0.0, along[-1], step)
    return np.column_stack([np.interp(places, along, column) for column in ring.T])


def test_contours_of_an_organ_three_millimetres_apart_become_the_organ():
    organ = samples.frog_organ("kidney", blur_mm=2.0)
    layers = slice_mesh(organ, np.arange(organ.bounds[0, 2] + 1.5, organ.bounds[1, 2], 3.0))
    points = np.vstack([resampled(contour.points_3d, 0.5) for x in layers for contour in x.contours])
    mesh = mesh_from_points(points)
    assert mesh.volume == pytest.approx(organ.volume, rel=0.01)
    assert any("points on curves averaged" in repair for repair in mesh.metadata["report"].repairs)


def test_points_that_fill_a_volume_or_an_open_sheet_are_refused():
    rng = np.random.default_rng(0)
    u, v = 10.0 * rng.random((2, 4000))
    for points in (rng.random((4000, 3)), rng.normal(size=(3000, 3)), np.column_stack([u, v, np.sin(u)])):
        with pytest.raises(ValueError, match=r"show no closed surface: .* give more points"):
            mesh_from_points(points)


@pytest.mark.parametrize("count", [10, 50, 300])
@pytest.mark.parametrize("thickness", [0.0, 1e-6, 1e-2, 0.1])
@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_points_without_a_surface_are_refused_or_get_a_closed_mesh_near_them(count, thickness, dimension):
    random = np.random.default_rng(count)
    points = random.random((count, 3)) * (np.arange(3) < dimension)
    points += thickness * random.normal(size=(count, 3))
    if thickness < 1e-3 and dimension < 3:
        with pytest.raises(ValueError, match=r"points lie (on a line|in one plane)"):
            mesh_from_points(points)
        return
    with contextlib.suppress(ValueError):
        mesh = mesh_from_points(points)
        assert mesh.metadata["report"].watertight
        size = np.ptp(points, axis=0).max()
        assert np.abs(mesh.bounds - [points.min(axis=0), points.max(axis=0)]).max() < 0.3 * size


def test_false_links_as_sure_as_the_best_turn_no_side():
    """Four links of a hundred are false, as through stray points; one in a tree of links would turn many."""
    random = np.random.default_rng(3)
    places, signs = random.random((3000, 2)), random.choice([-1.0, 1.0], 3000)
    heads = cKDTree(places).query(places, 9)[1][:, 1:].ravel()
    tails = np.repeat(np.arange(3000), 8)
    truth = random.uniform(0.5, 1.0, len(heads)) * np.where(random.random(len(heads)) < 0.04, -1.0, 1.0)
    found, part = _joined(tails, heads, truth * signs[tails] * signs[heads])
    assert not part.any()
    assert abs(np.mean(found * signs)) > 0.99


@pytest.mark.parametrize("share", [0.1, 0.3])
def test_normals_that_contradict_one_another_are_refused_and_not_made_a_surface_with_handles(share):
    points, normals = cloud()
    normals = normals * np.where(np.random.default_rng(1).random(len(points)) < share, -1.0, 1.0)[:, None]
    right = np.arctan2(points[:, 1], points[:, 0]) > np.pi * (1.0 - 2.0 * share)
    with pytest.raises(ValueError, match="show no closed surface"):
        mesh_from_points(points, cloud()[1] * np.where(right, -1.0, 1.0)[:, None])
    with contextlib.suppress(ValueError):  # where single normals are wrong, many more are right
        mesh = mesh_from_points(points, normals)
        assert mesh.euler_number == 0


def test_repairs_are_reported():
    points = cloud()[0]
    blob = np.random.default_rng(1).normal(size=(30, 3))
    blob = blob / np.linalg.norm(blob, axis=1)[:, None] * 0.1 + [6.0, 0.0, 0.0]
    mesh = mesh_from_points(np.vstack([points, blob, points[:7], [[9.0, 9.0, 9.0]]]))
    report = mesh.metadata["report"]
    assert report.bodies == 1
    assert report.repairs[0] == "7 repeated points merged"
    assert report.repairs[1] == "1 point far from all others left out"
    assert any("1 smaller body removed" in text for text in report.repairs)
    assert mesh.bounds[1, 0] < 3.0


def test_flaws_are_reported():
    ball = trimesh.creation.icosphere()
    assert check_mesh(ball).sound
    inside_out = ball.copy()
    inside_out.invert()
    assert (check_mesh(inside_out).watertight, check_mesh(inside_out).outward) == (True, False)
    holed = trimesh.Trimesh(ball.vertices, ball.faces[1:], process=False)
    assert (check_mesh(holed).watertight, check_mesh(holed).open_edges) == (False, 3)
    other = ball.copy()
    other.apply_translation([3.0, 0.0, 0.0])
    both = check_mesh(trimesh.util.concatenate([ball, other]))
    assert (both.bodies, both.outward) == (2, True)


@pytest.mark.parametrize(("size", "step", "outward"), [(0.5, 3, False), (0.5, 0, True), (2, 0, False)])
def test_a_body_inside_out_beside_another_is_told_from_a_void(size, step, outward):
    ball = trimesh.creation.icosphere()
    inverted = ball.copy().apply_scale(size).apply_translation([step, 0.0, 0.0])
    inverted.invert()
    assert check_mesh(trimesh.util.concatenate([ball, inverted])).outward is outward


TORUS, NORMALS = cloud(100)


@pytest.mark.parametrize(
    ("points", "normals", "message"),
    [
        (np.zeros((20, 3)), None, "1 different"),
        (trimesh.PointCloud(TORUS), None, "must hold real numbers, got <trimesh.PointCloud"),
        (np.full((20, 3), np.nan), None, r"points\[0, 0\] is nan"),
        (TORUS, NORMALS[:5], "normals has shape"),
        (TORUS, NORMALS * (np.arange(100) != 7)[:, None], r"normals\[7\] is zero"),
    ],
)
def test_wrong_clouds_are_named(points, normals, message):
    with pytest.raises((ValueError, TypeError), match=message):
        mesh_from_points(points, normals)


@pytest.mark.parametrize("count", [180, 400])
def test_a_mesh_of_few_points_does_not_cut_itself(count):
    assert pierced(mesh_from_points(cloud(count)[0])) == 0


def test_a_mesh_of_a_thin_wall_does_not_cut_itself():
    outer = trimesh.creation.icosphere(subdivisions=4)
    inner = outer.copy().apply_scale(0.9)
    inner.invert()
    wall = trimesh.util.concatenate([outer, inner])
    assert pierced(mesh_from_points(surface_samples(wall, 3500))) == 0
