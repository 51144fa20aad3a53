"""Point cloud, triangles, ordered contours, reconstruction (paper 2.1, 2.3, Fig. 7)."""

from nurbs_lab.mesh.cloud.points import MeshReport, check_mesh, mesh_from_points
from nurbs_lab.mesh.core import MeshGraph, mesh_graph
from nurbs_lab.mesh.distance import Deviation
from nurbs_lab.mesh.slicing.contours import Contour, Layer
from nurbs_lab.mesh.slicing.planes import slice_mesh, uniform_heights
from nurbs_lab.mesh.solid.faces import Face
from nurbs_lab.mesh.solid.reconstruction import Reconstruction, Shell, reconstruct
from nurbs_lab.mesh.solid.skinned import skin
from nurbs_lab.mesh.solid.trimmed import TrimmedShell

__all__ = [
    "Contour",
    "Deviation",
    "Face",
    "Layer",
    "MeshGraph",
    "MeshReport",
    "Reconstruction",
    "Shell",
    "TrimmedShell",
    "check_mesh",
    "mesh_from_points",
    "mesh_graph",
    "reconstruct",
    "skin",
    "slice_mesh",
    "uniform_heights",
]
