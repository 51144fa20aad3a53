"""Triangles: OBJ and binary STL written for printers and viewers; all mesh files read, clouds too."""

import warnings

import numpy as np
import trimesh

from nurbs_lab.common.checks import extent
from nurbs_lab.mesh.read import read_file

FINENESS = 1e-4  # of the diagonal of the control points: largest distance from the triangles to a surface


def write(path, parts):
    made = [(triangles(surface), FINENESS * extent(surface.control_points)) for surface in parts.surfaces]
    made += [(solid.to_mesh(), solid.tolerance / 10) for solid in parts.solids]
    stl, largest = path.suffix.lower() == ".stl", max(np.abs(mesh.vertices).max() for mesh, _ in made)
    if stl and largest > np.finfo(np.float32).max:
        raise ValueError(f"items: an STL holds no {largest:.2g} mm; write an .obj")
    options = {} if stl else {"digits": max(8, *(_digits(mesh.vertices) for mesh, _ in made))}
    trimesh.util.concatenate([mesh for mesh, _ in made]).export(path, **options)
    for mesh, asked in made if stl else ():
        moved = np.abs(mesh.vertices - mesh.vertices.astype(np.float32)).max()
        if moved > asked:
            warnings.warn(
                f"items: an STL keeps 24 bits of a coordinate, which moves these points by up to {moved:.2g} "
                f"mm, and {asked:.2g} mm are asked; write an .obj, or move the part to the origin",
                stacklevel=5,
            )


def read(path, unit=None):
    try:
        points, triangles = read_file(path, unit)
    except ValueError as error:  # without the name of the file, which `read` gives
        raise ValueError(str(error.__cause__ or error)) from error
    return trimesh.Trimesh(points, triangles, process=False) if len(triangles) else points


def triangles(surface):
    """A triangle mesh of a surface; equal points (seams, poles) are merged, empty triangles removed."""
    points, faces = surface.tessellate(FINENESS * extent(surface.control_points))
    mesh = trimesh.Trimesh(np.pad(points, ((0, 0), (0, 3 - surface.dim))), faces, process=False)
    mesh.merge_vertices(digits_vertex=_digits(points))
    mesh.update_faces((mesh.faces != np.roll(mesh.faces, 1, axis=1)).all(axis=1))
    return mesh


def _digits(points):
    """Digits after the point that tell places apart by 1e-9 of their size."""
    return 9 - int(np.ceil(np.log10(max(extent(points), 1e-99))))
