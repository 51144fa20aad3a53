"""Every picture is drawn without a display, and pyplot has forgotten it afterwards."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
import trimesh

import nurbs_lab as nl


@pytest.fixture(autouse=True)
def nothing_left_open():
    plt.close("all")
    yield
    assert plt.get_fignums() == []


@pytest.fixture(scope="session")
def tetrahedron():
    """ABCD, its faces numbered as in the paper: 0 BCD below, 1 ABD, 2 ACD, 3 ABC in front."""
    corners = [(0, 0, 10), (-5, -4, 0), (6, -3, 0), (0, 6, 0)]
    faces = [(1, 3, 2), (1, 0, 3), (0, 2, 3), (0, 1, 2)]
    return nl.mesh.mesh_graph(trimesh.Trimesh(corners, faces, process=False))


@pytest.fixture(scope="session")
def pipe():
    """A closed mesh whose layers have an outline and a hole."""
    return trimesh.creation.annulus(r_min=4, r_max=10, height=6)


@pytest.fixture(scope="session")
def sheet():
    u, v = np.linspace(0, 2, 6), np.linspace(0, 1, 5)
    x, y = np.meshgrid(10 * u, 10 * v, indexing="ij")
    return nl.interpolate_surface(np.stack([x, y, 2 * np.sin(x / 3) * np.cos(y / 4)], axis=-1))


@pytest.fixture(scope="session")
def path():
    feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=0.01)
    return nl.trace(nl.paper.CURVE, feed, stepper="rk4", period_s=0.01)
