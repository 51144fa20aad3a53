"""Point cloud, triangles, ordered contours, reconstruction (paper 2.1, 2.3, Fig. 7)."""

from nurbs_lab.mesh.graph import MeshGraph, mesh_graph
from nurbs_lab.mesh.slicing import Contour, Layer, slice_mesh

__all__ = ["Contour", "Layer", "MeshGraph", "mesh_graph", "slice_mesh"]
