"""Parts with a known shape, and a cutter of every kind."""

import numpy as np
import trimesh

import nurbs_lab as nl

WIDE = 3.6  # mm: half the width of a slot
DOME = trimesh.creation.icosphere(subdivisions=5, radius=8.0)
CUTTERS = {
    "ball": nl.Cutter("ball", diameter=6.0),
    "flat": nl.Cutter("flat", diameter=6.0),
    "bull": nl.Cutter("bull", diameter=6.0, corner_radius=1.0),
    "cone": nl.Cutter("cone", diameter=6.0, angle=90.0),
}


def hills(count=24):
    """A closed block with an uneven upper side."""
    return block(lambda x, y: 2.0 * np.sin(0.5 * x) * np.cos(0.4 * y) + 0.02 * x * y, 20.0, count, 0.0)


def lying_cylinder():
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, (0.3, 1.0, 0.0))
    return trimesh.creation.cylinder(radius=7.0, height=24.0, sections=256, transform=turn)


def block(height, size, count=60, corner=None):
    """A closed block from z = -5 mm up, with the upper side ``height(x, y)``."""
    line = np.linspace(0.0, size, count + 1) + (-size / 2 if corner is None else corner)
    x, y = np.meshgrid(line, line, indexing="ij")
    z = height(x, y)
    index = np.arange(x.size).reshape(x.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    upper = np.concatenate([np.dstack([a, b, c]).reshape(-1, 3), np.dstack([a, c, d]).reshape(-1, 3)])
    rim = np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    floor = points * (1, 1, 0) - (0, 0, 5.0)
    after = np.roll(rim, -1)
    walls = np.concatenate(
        [np.column_stack([rim, rim + x.size, after]), np.column_stack([after, rim + x.size, after + x.size])]
    )
    faces = np.concatenate([upper, walls, upper[:, ::-1] + x.size])
    return trimesh.Trimesh(np.concatenate([points, floor]), faces, process=False)


def shallow_slot():
    """A slot from -WIDE to WIDE along x, 1 mm deep, less than the ball's radius."""
    boxes = [((-20, -9, 0), (20, 9, 8)), *(((-20, y, 8), (20, y + 3, 9)) for y in (-3 - WIDE, WIDE))]
    return trimesh.util.concatenate([trimesh.creation.box(bounds=box) for box in boxes])
