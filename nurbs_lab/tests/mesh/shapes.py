"""Fine meshes of smooth shapes."""

import numpy as np
import trimesh


def lathe(radius, z, sections=360):
    """A closed surface of revolution about z."""
    return trimesh.creation.revolve(np.column_stack([radius, z]), sections=sections)


def ball(radius=10.0):
    """A sphere."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 241)
    return lathe(radius * np.cos(angle).clip(0.0), radius * np.sin(angle))


def ring():
    """A torus of radii 10 and 4."""
    return trimesh.creation.torus(10.0, 4.0, major_sections=360, minor_sections=180)


def pillar():
    """A cylinder of radius 5 and height 20, its wall in many rows."""
    z = np.linspace(0.0, 20.0, 81)
    return lathe(np.concatenate([[0.0], np.full(81, 5.0), [0.0]]), np.concatenate([[0.0], z, [20.0]]))


def vase():
    """Height 20, with a waist: its wall is smooth, and steep at every height."""
    z = np.linspace(0.0, 20.0, 121)
    radius = 10.0 + 3.0 * np.cos(np.pi * z / 10.0)
    return lathe(np.concatenate([[0.0], radius, [0.0]]), np.concatenate([[0.0], z, [20.0]]), 180)


def trousers():
    """Two legs that meet in one body: a thick upright letter U turned over, as a smooth solid."""
    import pyvista

    grid = pyvista.ImageData(dimensions=(61, 31, 61), spacing=(0.2, 0.2, 0.2), origin=(-6, -3, -6))
    x, y, z = grid.points.T
    legs = np.exp(-((x - 2.5) ** 2 + y**2)) + np.exp(-((x + 2.5) ** 2 + y**2))
    body = np.exp(-(x**2) / 16 - y**2 / 2)
    share = 1 / (1 + np.exp(-2 * z))
    field = (share * body + (1 - share) * legs) * np.where(np.abs(z) < 5, 1, 0) - 0.4
    surface = grid.contour([0.0], scalars=field).triangulate().smooth_taubin(n_iter=20, pass_band=0.05)
    mesh = trimesh.Trimesh(np.asarray(surface.points), surface.regular_faces, process=False)
    if mesh.volume < 0:
        mesh.invert()
    return mesh
