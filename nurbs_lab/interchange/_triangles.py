"""Triangles: OBJ and binary STL written for printers and viewers; all mesh files read, clouds too."""

import trimesh

from nurbs_lab.common.checks import extent
from nurbs_lab.interchange._export_items import in_space
from nurbs_lab.mesh.read import read_file

FINENESS = 1e-4  # of the diagonal of the control points: largest distance from the triangles to a surface


def write(path, parts):
    meshes = [*map(triangles, parts.surfaces), *(solid.to_mesh() for solid in parts.solids)]
    trimesh.util.concatenate(meshes).export(path)


def read(path, unit=None):
    try:
        points, triangles = read_file(path, unit)
    except ValueError as error:  # without the name of the file, which `read` gives
        raise ValueError(str(error.__cause__ or error)) from error
    return trimesh.Trimesh(points, triangles, process=False) if len(triangles) else points


def triangles(surface):
    """A triangle mesh of a surface; equal points (seams, poles) are merged, empty triangles removed."""
    points, faces = surface.tessellate(FINENESS * extent(surface.control_points))
    mesh = trimesh.Trimesh(in_space(points), faces, process=False)
    mesh.merge_vertices(digits_vertex=9)
    mesh.update_faces(mesh.nondegenerate_faces())
    return mesh
