"""Point cloud, triangles, ordered contours, reconstruction (paper 2.1, 2.3, Fig. 7).

Constants that steer repair and clouds, and what is wrong at half and at twice their value (2026-11). The
first three: of 70 meshes, most of them broken, how many give other triangles or reports without, at half, at
twice. The others on clouds of 4,000 to 12,000 points (torus, hollow box, plate of genus 4, figure, nut, eye;
half of them with noise of 0.2 % of the size and 1 % outliers; a ball without a cap of 25 degrees, a kidney's
contours 3 mm apart, tori with few points on one side or with a speck), a filled cube and an open sheet; of
`indicator` on four. Those of solids stand in `nurbs_lab.mesh.solid`.

==================  =====  ====================  =============================================
constant            value  unit                  wrong at half; at twice
==================  =====  ====================  =============================================
repair._NEAR        0.01   shortest edge beside  5, 0, 0
repair._TOUCHING    1e-6   size of the mesh      4, 1, 0
repair._PINHOLE     0.03   size of the mesh      1, 1, 0; holes of three or four edges are 22 more
points._CROWD       8      neighbours            nothing; contours
points._FAR         1.8    neighbours' distance  9 clouds; nothing
points._FLAT        1e-3   length of the cloud   nothing; without it flat clouds fail later
points._NOISY       0.12   flatness              nothing; without it 60,000 noisy points refused
points._FEW         5000   points                nothing; 0: the filled cube becomes a body
points._HIGH        0.7    spacings              nothing; the noisy hollow box
points._SPECK       0.01   of the points         the torus with a speck; nothing
points._APART       4      spacings              nothing; the sheet becomes a body
points._MOST_ALONE  0.25   of the surface        nothing; the sheet becomes a body
points._AGAINST     0.1    of the surface        nothing; without it a hollow box gets 28 handles
points._MISSED      0.9    spacings              all refused; the filled cube becomes a body
points._THIN        0.05   of the variance       nothing; 0: contours
points._ALONG       1.5    neighbours' distance  contours; nothing
normals._LINKS      10     neighbours            contours; nothing
normals._MOST_AREA  4      median area           nothing; without it 1 of 32 is refused
indicator._CELL     0.75   spacings              nothing; hollow box, cap and contours refused
indicator._NEAR     20     points                contradicting normals pass; 1.7 x time
==================  =====  ====================  =============================================

Steps of the repair, off, of these 70: welds 5, T-junctions 5, windings 3, stray sheets 2, holes filled 23,
the flattest way to fill them 8, parts without volume 2, surfaces that only touch 2.

Rules of clouds, one at a time, on 32 of them. Gone, as no result became wrong: cells that are half empty,
blurs by octaves of spacing, links that noise makes doubtful, a search over flips of patches. Stay, with the
clouds that change without them: levels (10, `indicator._LEVELLING`), means of triangles (9), planes of near
points (7), `normals.NEIGHBOURHOODS` of three sizes (4), small bodies (3), points on curves, voids (1 each,
of the one or two that have them), and points off their neighbours' planes (3 of 8 noisy hollow boxes).
`points._AGAINST` is at most 0.05 where no side is wrong.

Limits of work: `points._MOST`, `indicator._MOST_CELLS`, `contours._MANY`, `stl_blocks`
(`MOST_HELD`, `STREAMED`, `_BLOCK`), `packages._MOST_BYTES`,
`shape._MOST_CORNERS`, `_kernels_core.FEW`. Of rounding and of sense: `_kernels_distance.ROUNDING` (without it
a rotated bone has 30 to 46 faces, not 30), `points._LEAST_POINTS`, `_HELD`, `normals._PLACES`,
`indicator._REACH`, `repair.NO_VOLUME`, `shape._FOLDED`, `_NO_AREA`, `read._USUAL_SIZE`,
`_kernels_core.SAME_ANGLE`. Definitions: `_kernels_core.BOUNDARY`, `MANY` and `AGAINST`, `core._BY_WEIGHT`,
`repair._SPLITS` and `samples.FROG_ORGANS`; of files `read.UNITS`, `READERS`, `_PLY_TYPES`,
`_OTHER_WORDS`, `RECORD`, `HEADER_BYTES`, `_TRIPLE`, `_FACET`, `_SOLID`, `_END`, `_FLOAT`, `_TRIANGLES`,
`_STRIP`, `_WORDS`, `CROSSED`.
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
