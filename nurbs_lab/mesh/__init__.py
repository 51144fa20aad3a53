"""Point cloud, triangles, ordered contours, reconstruction (paper 2.1, 2.3, Fig. 7).

Constants that steer, and what is wrong at half and at twice their value (2026-11). Numbers of `repair` are
meshes, of 70, most of them broken, which give other triangles or reports without, at half, at twice; of 119
for `NO_VOLUME` and `_kernels_core`. The others on clouds of 400 to 12,000 points (torus, hollow box, plate of
genus 4, figure, nut, eye; half of them with noise of 0.2 % of the size and 1 % outliers; a ball without a cap
of 25 degrees, a kidney's contours 3 mm apart, tori with few points on one side or with a speck), a filled
cube and an open sheet; of `indicator` on four or 28, limits on a nut of 190,000; polygons are 60 a kind.
Those of solids stand in `nurbs_lab.mesh.solid`.

=======================  ============  ====================  ==============================================
constant                 value         unit                  wrong at half; at twice
=======================  ============  ====================  ==============================================
SAME_ANGLE (core)        1e-9          radians               0, 0; at 1e-15 common walls of bodies part
FEW (core)               32            half-edges            0.9 x, 0.9 x; off: a fan of 40,000 180 x
repair._NEAR             0.01          shortest edge beside  5, 0, 0
repair._TOUCHING         1e-6          size of the mesh      4, 1, 0
repair._PINHOLE          0.03          size of the mesh      1, 1, 0; holes of 3 or 4 edges are 22 more
repair.NO_VOLUME         1e-12         size cubed            4, 1, 0; a box of 1 by 1e-6 by 1e-6
ROUNDING (distance)      1e-11         coordinates           0, 0 of 6; off: a turned bone 36 to 44 faces
points._LEAST_POINTS     10            points                nothing; clouds of 10 to 19 are refused
points._CROWD            8             neighbours            nothing; contours
points._FAR              1.8           neighbours' distance  9 clouds; nothing
points._FLAT             1e-3          length of the cloud   nothing; off: flat clouds fail later
points._NOISY            0.12          flatness              nothing; off: 60,000 noisy points refused
points._FEW              5000          points                nothing; 0: the filled cube becomes a body
points._MOST             200,000       points                0.4 x time and triangles; nothing
points._HIGH             0.7           spacings              nothing; the noisy hollow box
points._SPECK            0.01          of the points         the torus with a speck; nothing
points._APART            4             spacings              nothing; the sheet becomes a body
points._MOST_ALONE       0.25          of the surface        nothing; the sheet becomes a body
points._AGAINST          0.1           of the surface        nothing; off: a hollow box gets 28 handles
points._MISSED           0.9           spacings              all refused; the filled cube becomes a body
points._HELD             0.95          of the points         nothing; 1: five of eleven noisy ones refused
points._THIN             0.05          of the variance       nothing; 0: contours
points._ALONG            1.5           neighbours' distance  contours; nothing
normals.NEIGHBOURHOODS   9, 16, 24     points                box of 400: 1 % of volume; 1.2 x. One: 4 wrong
normals._LINKS           10            neighbours            contours; nothing
normals._MOST_AREA       4             median area           nothing; off: 1 of 32 is refused
indicator._CELL          0.75          spacings              nothing; hollow box, cap and contours refused
indicator._LEVELLING     2             spacings              nothing; nothing. Without levels 10 are wrong
indicator._NEAR          20            points                contradicting normals pass; 1.7 x time
indicator._REACH         0.475         of the farthest       1 %, 2 % farther off
indicator._MOST_CELLS    8e6                                 0.6 x triangles; 1.6 x, 1.2 x time
shape._FOLDED            1.5           area of the polygon   all cross; pentagrams do not
shape._NO_AREA           1e-12         largest triangle      39, 22 of 60 lines far off cross, not 32
shape._MOST_CORNERS      30,000        corners               0.3 s for a face, not 2; 7 s
packages._MOST_BYTES     4 GB                                nothing; nothing; bounds damaged files
read._USUAL_SIZE         1 to 1e4 mm                         nothing; nothing, of 14 parts
LINES (slicing)          8                                   107, 47 of 2,009 crossing pairs nested, not 64
contours._MANY           20,000        triangles             nothing; nothing. 0: small meshes 1.9 x
stl_blocks.STREAMED      300 MB                              0: as fast, but no warning of units
stl_blocks._BLOCK        40,000        triangles             nothing; nothing, of 1.3 million triangles
stl_blocks.MOST_HELD     8e6           triangles             1 / 20: as fast, 0.9 x memory
=======================  ============  ====================  ==============================================

Steps of the repair, off, of these 70: welds 5, T-junctions 5, windings 3, stray sheets 2, holes filled 23,
the flattest way to fill them 8, parts without volume 2, surfaces that only touch 2.

Rules of clouds without a constant, off, of 32: means of triangles 9, planes of near points 7, small bodies 3,
points on curves and voids 1 each of the one or two that have them, points off their neighbours' planes 3 of 8
noisy hollow boxes. One place instead of nine for a winding number, of 16 nested clouds: 0.

Definitions: `_kernels_core.BOUNDARY`, `MANY`, `AGAINST`, `core._BY_WEIGHT`, `repair._SPLITS`,
`samples.FROG_ORGANS`; of files `read.UNITS`, `_SPELT`, `READERS`, `_PLY_TYPES`, `_OTHER_WORDS`, `RECORD`,
`HEADER_BYTES`, `_TRIPLE`, `_FACET`, `_SOLID`, `_END`, `_FLOAT`, `_TRIANGLES`, `_STRIP`, `_WORDS`, `CROSSED`.
"""

from nurbs_lab.mesh.cloud.points import MeshReport, check_mesh, mesh_from_points
from nurbs_lab.mesh.core import MeshGraph, mesh_graph
from nurbs_lab.mesh.distance import Deviation
from nurbs_lab.mesh.repair import repair_mesh
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
    "repair_mesh",
    "skin",
    "slice_mesh",
]
