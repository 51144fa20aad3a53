"""Point cloud, triangles, ordered contours, reconstruction (paper 2.1, 2.3, Fig. 7).

Constants that steer repair and clouds, and what changed at half and at twice their value, November 2026: on
the defects of ``tests/mesh/test_repair.py``, and on clouds of a mug, a bone, an ileum (6,000 to 12,000
points, noise 0.2 % of the size, 1 % outliers), a torus, a ball without a cap of 40 degrees, a kidney's
contours 3 mm apart, a filled cube and an open sheet.

==================  =====  ====================  ==============================================
constant            value  unit                  at half; at twice
==================  =====  ====================  ==============================================
repair._NEAR        0.01   shortest edge beside  nothing; nothing
repair._TOUCHING    1e-6   size of the mesh      nothing; nothing
repair._PINHOLE     0.03   size of the mesh      nothing; nothing: all holes had three edges
points._FAR         1.8    neighbours' distance  nothing; nothing
points._NOISY       0.12   flatness              nothing; nothing
points._MISSED      0.9    neighbours' distance  all clouds refused; a filled cube is a body
points._MOST_ALONE  0.25   of the surface        a hemisphere refused; an open sheet is a body
normals._MOST_AREA  4      median area           without it 5 of 56 clouds are inside out
==================  =====  ====================  ==============================================

Ablation, one rule at a time, on 32 clouds (eight shapes in 5,000 and 10,000 points, the latter with noise and
outliers, contours, a cap, 5 % outliers, and thirty times more points on one side). Gone, since at most one
cloud became worse without them: points off their neighbours' planes, cells that are half empty, blurs by
octaves of spacing, a search over flips of patches. Stay, with the clouds that are wrong without them: levels
(10), means of triangles (9), planes of near points (7), neighbourhoods of three sizes (4), small bodies (3),
points on curves, voids (1 each, of the one or two that have them).
"""

from nurbs_lab.mesh.cloud.points import MeshReport, check_mesh, mesh_from_points
from nurbs_lab.mesh.core import MeshGraph, mesh_graph
from nurbs_lab.mesh.distance import Deviation
from nurbs_lab.mesh.slicing.contours import Contour, Layer
from nurbs_lab.mesh.slicing.planes import slice_mesh
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
]
