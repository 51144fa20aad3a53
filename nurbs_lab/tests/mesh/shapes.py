"""Fine meshes of smooth shapes."""

import numpy as np
import trimesh


def lathe(radius, z, sections=360):
    """A closed surface of revolution about z."""
    return trimesh.creation.revolve(np.column_stack([radius, z]), sections=sections)


def pillar():
    """A cylinder of radius 5 and height 20, its wall in many rows."""
    z = np.linspace(0.0, 20.0, 81)
    return lathe(np.concatenate([[0.0], np.full(81, 5.0), [0.0]]), np.concatenate([[0.0], z, [20.0]]))


def contour(field, low, high, count):
    """The closed surface where a function of points is zero, negative inside; ``count`` cells long."""
    import pyvista

    cell = np.max(np.subtract(high, low)) / count
    shape = np.ceil(np.subtract(high, low) / cell).astype(int) + 1
    grid = pyvista.ImageData(dimensions=shape, spacing=[cell] * 3, origin=low)
    values = field(np.asarray(grid.points))
    values[np.abs(values) < 1e-3 * cell] = 1e-3 * cell  # no two corners of a triangle in one node
    surface = grid.contour([0.0], scalars=values, method="flying_edges")
    mesh = trimesh.Trimesh(np.asarray(surface.points), surface.regular_faces)
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh


def plate():
    """A plate of 100 x 60 x 4 with four holes."""

    def field(points):
        box = np.abs(points - [50.0, 30.0, 2.0]) - [50.0, 30.0, 2.0]
        holes = [
            8.0 - np.hypot(points[:, 0] - x, points[:, 1] - y) for x in (25.0, 75.0) for y in (18.0, 42.0)
        ]
        return np.max([*box.T, *holes], axis=0)

    return contour(field, (-1.0, -1.0, -1.0), (101.0, 61.0, 5.0), 200)


def figure():
    """A body with a head, two legs and two thin arms, 100 high."""
    limbs = [((0, 0, 45), (0, 0, 75), 9.0), ((0, 0, 90), (0, 0, 92), 7.0)]
    for side in (-1.0, 1.0):
        limbs += [((4 * side, 0, 42), (9 * side, 2, 4), 4.0), ((7 * side, 0, 76), (35 * side, 8, 60), 2.2)]

    def field(points):
        distances = []
        for tail, head, radius in limbs:
            along = np.subtract(head, tail)
            part = np.clip((points - tail) @ along / (along @ along), 0.0, 1.0)
            distances.append(np.linalg.norm(points - tail - part[:, None] * along, axis=1) - radius)
        return np.min(distances, axis=0)

    return contour(field, (-40.0, -12.0, -2.0), (40.0, 14.0, 102.0), 150)


def trousers():
    """Two legs that meet in one body: a thick upright letter U turned over, as a smooth solid."""
    import pyvista

    grid = pyvista.ImageData(dimensions=(61, 31, 61), spacing=(0.2, 0.2, 0.2), origin=(-6, -3, -6))
    x, y, z = grid.points.T
    legs = np.exp(-((x - 2.5) ** 2 + y**2)) + np.exp(-((x + 2.5) ** 2 + y**2))
    body = np.exp(-(x**2) / 16 - y**2 / 2)
    blend = 1 / (1 + np.exp(-2 * z))
    field = (blend * body + (1 - blend) * legs) * np.where(np.abs(z) < 5, 1, 0) - 0.4
    surface = grid.contour([0.0], scalars=field).triangulate().smooth_taubin(n_iter=20, pass_band=0.05)
    mesh = trimesh.Trimesh(np.asarray(surface.points), surface.regular_faces, process=False)
    if mesh.volume < 0:
        mesh.invert()
    return mesh
