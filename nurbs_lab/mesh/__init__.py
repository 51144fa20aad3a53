"""Point cloud, triangles, ordered contours, reconstruction (paper 2.1, 2.3, Fig. 7).

Constants that steer repair and clouds, and what changed at half and at twice their value, November 2026: the
first three on the defects of ``tests/mesh/test_repair.py``, on balls whose triangles are loose or that lack
some, and on boxes with a divided edge; the others on clouds of 4,000 to 12,000 points (torus, hollow box,
plate of genus 4, figure, nut, eye; half of them with noise of 0.2 % of the size and 1 % outliers; a ball
without a cap of 25 degrees, a kidney's contours 3 mm apart, a torus with an eighth of the points on one side,
one with a speck beside it), a filled cube and an open sheet; of `indicator` on four.

==================  =====  ====================  =============================================
constant            value  unit                  wrong at half; at twice
==================  =====  ====================  =============================================
repair._NEAR        0.01   shortest edge beside  loose corners 0.5 % of an edge apart; nothing
repair._TOUCHING    1e-6   size of the mesh      four vertices 0.7e-6 beside an edge; nothing
repair._PINHOLE     0.03   size of the mesh      a ball without a vertex, hole 0.02; nothing
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

`points._AGAINST` is 0.2 to 0.3 where sides are wrong, and at most 0.05 elsewhere. Limits, not ablated: of
work `points._MOST`, `indicator._MOST_CELLS`, `_CELLS_A_POINT`, `contours._MANY`,
`stl_blocks` (`MOST_HELD`, `STREAMED`, `_BLOCK`, `_BLOCKS_TOGETHER`), `packages._MOST_TRIANGLES`,
`_MOST_BYTES`, `_DEEPEST`, `shape._MOST_CORNERS`, `_kernels_core.FEW`, `_kernels_distance.LEAF`; of rounding
`_kernels_distance.EQUAL` and `SAME_PLACE` (twice or half changes none of six rotated bones: 30 faces; without
them 30 to 46); of sense
`points._LEAST_POINTS`, `_HELD`, `repair.NO_VOLUME`, `shape._FOLDED`, `_NO_AREA`, `read._USUAL_SIZE`,
`_kernels_core.SAME_ANGLE`. See the ablation for `normals.NEIGHBOURHOODS`, `normals._PLACES`,
`indicator._LEVELLING` and `_REACH`. Definitions, not choices: `_kernels_core.FULL_TURN`, `core._BY_WEIGHT`,
`contours._AXES`, kinds of edges `repair._BOUNDARY`, `_MANY`, `_AGAINST`, and ways to fill holes `_SPLITS`; of
files `read.UNITS`, `formats.READERS`, `ply._PLY_TYPES`, `stl.RECORD`, `HEADER_BYTES`, `_TRIPLE`, `_FACET`,
`_SOLID`, `_END`, `obj._OTHER_WORDS`, `packages._FLOAT`, `_FAN`, `_WORDS`, `stl_blocks.CROSSED`; labels
`samples.FROG_ORGANS`.

Ablation, one rule at a time, on 32 such clouds. Gone, as no result became wrong: cells that are half empty,
blurs by octaves of spacing, links that noise makes doubtful, a search over flips of patches. Stay, with the
clouds that change without them: levels (10), means of triangles (9), planes of near points (7), surroundings
of three sizes (4), small bodies (3), points on curves, voids (1 each, of the one or two that have them), and
points off their neighbours' planes (3 of 8 noisy hollow boxes).
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
