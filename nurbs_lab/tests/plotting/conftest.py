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


@pytest.fixture(scope="session")
def board_rows():
    """Two steppers on two curves, one of them without any error."""
    return [
        {"curve": curve, "stepper": stepper, "chord_max": value, "chord_rms": value, "ns_per_step": 100.0}
        for curve in ("paper", "butterfly")
        for stepper, value in (("a", 1e-3), ("b", 0.0))
    ]


@pytest.fixture
def figures(path, tetrahedron, pipe, board_rows):
    """One picture of every kind in the plane."""
    plot, curve = nl.plotting, nl.paper.CURVE
    layer = nl.slice_mesh(pipe, [0.5])[0]
    return {
        "curve": plot.curve(curve, comb=True, points=curve([0.1, 0.5])),
        "basis": plot.basis(curve),
        "layer": plot.layer(layer),
        "order": plot.layer(layer, order=True),
        "path": plot.path(path),
        "u": plot.parameter(path),
        "step": plot.parameter_step(path),
        "8 to 10": plot.figures_8_to_10(path),
        "fluctuation": plot.fluctuation([path]),
        "orders": plot.orders([1e-3, 2e-3], {"one": [1, 2], "four": [1, 16]}),
        "feed": plot.feed(path.feed, limits={"speed": 4, "acceleration": 40}, curve=curve),
        "times": plot.times({"serial": {"paper": 1e-3, "counted": 2e-6}}, period_s=1e-3),
        "area": plot.area({"cells": {"cached": 10}}, limits={"cells": 100}),
        "wave": plot.waveform({"clk": [0, 1] * 4, "u": [None, 1, 1, 2] * 2}, clock_hz=50e6),
        "lines": plot.lines(
            [1, 2], {"a": [1, 2]}, x_label="x [mm]", y_label="y [mm]", log="xy", markers=True
        ),
        "leaderboard": plot.leaderboard(board_rows),
    }
