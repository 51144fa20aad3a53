"""Triangles: OBJ and binary STL written for printers and viewers; all mesh files read, clouds too."""

import warnings

import numpy as np
import trimesh

from nurbs_lab.common.checks import extent
from nurbs_lab.mesh.read import read_file
from nurbs_lab.nurbs.tessellation import grid_triangles, parameters_within

FINENESS = 1e-4  # of the diagonal of the control points: largest distance from the triangles to a surface


def write(path, parts):
    meshes = [*map(triangles, parts.surfaces), *(solid.to_mesh() for solid in parts.solids)]
    trimesh.util.concatenate(meshes).export(path)


def read(path, unit=None):
    points, triangles = read_file(path, unit)
    return trimesh.Trimesh(points, triangles, process=False) if len(triangles) else points


def triangles(surface):
    """A triangle mesh of a surface; equal points (seams, poles) are merged, empty triangles removed."""
    surface = surface if surface.dim == 3 else surface.transform(np.eye(3, surface.dim))
    tolerance = FINENESS * extent(surface.control_points)
    u, v, off = parameters_within(surface, tolerance)
    if off > tolerance:
        said = f"items: the triangles of a surface are up to {off:.2g} mm away from it; split the surface"
        warnings.warn(said, stacklevel=5)
    faces = grid_triangles(len(u), len(v))
    mesh = trimesh.Trimesh(surface.grid(u, v).reshape(-1, 3), faces, process=False)
    mesh.merge_vertices(digits_vertex=9)
    mesh.update_faces(mesh.nondegenerate_faces())
    return mesh
