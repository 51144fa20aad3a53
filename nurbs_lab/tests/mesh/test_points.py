"""Meshes from point clouds, and the report on meshes."""

import importlib.util

import numpy as np
import pytest
import trimesh

import nurbs_lab as nl
from nurbs_lab.mesh import check_mesh, mesh_from_points


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


def test_a_torus_from_its_points():
    mesh = nl.mesh_from_points(cloud()[0])
    report = mesh.metadata["report"]
    assert isinstance(mesh, trimesh.Trimesh)
    assert report.sound
    assert (report.watertight, report.bodies, report.outward) == (True, 1, True)
    assert mesh.euler_number == 0
    assert distance_to_torus(mesh.vertices).max() < 0.08
    assert mesh.volume == pytest.approx(2 * np.pi**2 * 2.0 * 0.36, rel=0.05)


def test_screened_poisson_or_the_command_that_installs_it():
    points, normals = cloud()
    if importlib.util.find_spec("pymeshlab") is None:
        with pytest.raises(ImportError, match=r"pip install 'nurbs-lab\[poisson\]'"):
            mesh_from_points(points, normals, method="poisson")
    else:
        mesh = mesh_from_points(points, normals, method="poisson")
        assert mesh.metadata["report"].sound
        assert distance_to_torus(mesh.vertices).max() < 0.03


def test_repairs_are_reported():
    points = cloud()[0]
    blob = np.random.default_rng(1).normal(size=(200, 3))
    blob = blob / np.linalg.norm(blob, axis=1)[:, None] * 0.4 + [6.0, 0.0, 0.0]
    mesh = mesh_from_points(np.vstack([points, blob, points[:7]]))
    report = mesh.metadata["report"]
    assert report.bodies == 1
    assert report.repairs[0] == "7 repeated points merged"
    assert any("smaller bodies removed" in text for text in report.repairs)
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
    assert check_mesh(trimesh.util.concatenate([ball, other])).bodies == 2


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((20, 3)), "1 different"),
        (np.zeros((20, 2)), "shape"),
        (np.full((20, 3), np.nan), r"points\[0, 0\] is nan"),
        (np.column_stack([np.random.default_rng(0).random((20, 2)), np.zeros(20)]), "one plane"),
    ],
)
def test_wrong_clouds_are_named(points, message):
    with pytest.raises(ValueError, match=message):
        mesh_from_points(points)


def test_wrong_options_are_named():
    points, normals = cloud(100)
    with pytest.raises(ValueError, match=r"method must be one of .* got 'magic'"):
        mesh_from_points(points, method="magic")
    with pytest.raises(ValueError, match="normals has shape"):
        mesh_from_points(points, normals[:5])
