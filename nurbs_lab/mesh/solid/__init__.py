"""Closed meshes to solids of NURBS faces (paper, section 2.3, and beyond).

Constants of the fit and of its loop (2026-11). Figures are sums of faces over the thigh bone, a nut, an
annulus, a cylinder and the spleen at 0.5 % of the size and two hulls of 60 random points on an ellipsoid at
0.8 %: 313 with the values that stand, in 3.3 s; nothing folds in any of these runs. Less than 10 is noise.

- `refine.COST`, 0.03, as a length: quadric error of the first layout. Half: 469. Twice: 313 in 4.1 s.
- `refine.RAISE`, 1.5. 1: 319.
- `fit.ENERGY`, 1e-3 to 1e-5 in five rounds. Of an older loop, half and twice: 97 and 85 faces for 88 of three
  parts.
- `fit.ROUNDS`, 14. 10: two folds are left on a knob of 4,334 triangles at 0.5 %, none with 14.
- `fit.HOPELESS`, 2 tolerances. None: the same sum, but the mug takes 1.5 times the time.
- `fit.STIFFER`, 10, for a patch that folds. 1, 3, 10: 43, 16 and 7 folds in ten rounds on that knob.
- `fit.PENALTY`, 1e3, corrected 4 times: angles of seams of 1e-12 to 2e-6 degrees.
- `fit.GRID`, 7 cells. 4: 315. 10: 313. `grids.CELLS`, 4 cells where the fit begins. 3 and 6: 311.

The same of twelve parts (also a tube, ileum and eye_white smoothed, a drilled plate and a figure): 576 faces
with the values that stand, in 22 s; nothing folds, and all keep the tolerance, but for what is said.

- `refine._SLIVER`, 0.5 tolerances. 0.25: 590. None, or 1: the plate misses, with 99 folds.
- `refine._BESIDE`, 2 tolerances. 1: 688, and the ileum misses. 4: 619.
- `refine._COARSE`, 3.75 tolerances. 1.9: 588. 7.5: 576. All meshes rough: 541, but arcs round half a hole.
- `refine._LONGEST`, 0.05 of the size. 0.025: 599. 0.1: 568. None: 518, but two of twelve more parts miss. As
  the length below which sharp edges are noise, half or twice changes none.
- `refine._FEWEST`, 10,000 triangles. 5,000: 600. 20,000: 587.
- `refine._CLOSE`, 33 places. 11, evenly: faces are 4 to 41 % farther than said near corners (nut, a letter);
  17: up to 55 % (the letter); 65: one letter of three parts has 4 % more faces.
- `refine.SAFETY`, 0.98. 0.9: 638 in 61 s. `refine.RAISE`, 1.5. 1: 630 in 61 s. 3: 771 in 66 s, one fold.
- `refine.ATTEMPTS`, 12, and `refine.MOST_FACES`, 4000, bound the time: half or twice changes none.
- `features._COTANGENTS`, 0.02 to 3. 0.04 to 1.5: 613. Unbounded: 877.
- `features._MOST_VOLUME`, 1e-3, `_FLAT_EDGE`, 1e-12: none changes without them; they are for thin sheets and
  for polyhedra: without the second a cone of six sides has 33 faces, not 26.
- `features._PINNED`, 1e6. 1e4: 563.
- `fit.CORRECTIONS`, 4. 2: 588 in 35 s. 8: 579. `fit.HOPELESS`, 2. None: 580 in 36 s.
- `space._STRAIGHT`, 20 degrees. 10: 562. 40: 636. None: 639.
- `space._LEAST_ANGLE`, 20 degrees. 10: 563. 40: 576 in 30 s. None: 586 in 38 s.
- `_kernels_ring.SPREAD`, 5e-3 of the squared length. 2.5e-3: 561 in 27 s.
- `_kernels_ring.LEAST_COSINE`, 0.2. 0.1: 578. 0.4: 600 in 38 s.

These figures are from before the size was that of the rotated part as well: the length of a thin rod with as
large a radius of gyration. First layouts of 17 parts since then (also capsule, torus, ball, cone, five meshed
with OpenCASCADE): 733 faces as before, on average.

- `_kernels_ring.TRACE`, 1e-4 of a cost or a length, by which `untied` orders equal ones. Without it in the
  costs the first layouts of nine parts spread by up to 75 % in four rotations, with it by none. Irregular
  numbers are needed: with ties in the order of the mesh a capsule began with 466 faces in place of 22.

Not choices but limits of work and definitions: `_kernels_ring.MOST_NEIGHBOURS` and the kinds `FREE`,
`ON_CURVE`, `CORNER`; `_kernels_patches.ROUNDS`, `LONGEST` of Newton's; `net.DEGREE`, `grids._HALVES`; pieces
of polygons, `quads._PIECES` and `WAYS`; names and numbers of surfaces, `faces.KINDS` and `quadrics.ROUND`;
`opencascade_reader.WHOLE` and `reconstruction._INSIDE`, which are rounding. Places where an edge is measured:
`reconstruction._PLACES`, 65, and `opencascade._ALONG`, 17; `layout._SAMPLES`, 32, where it is sharp.

Constants of the layout (2026-11). Figures are faces of the first layout at 0.5 % of the size: thigh bone 30,
drilled plate 142, mug 157, spleen 66, eye_white 51, bracket 299, before edges were halved so; parts not named
do not change.

- `quads._LONE`, 4, cost of a lone triangle. 2, 4, 8, 12: 694, 679, 680 and 679 faces of fourteen parts.
- `quads._TREES`, 32, `_STRAIGHT`, 4 then 50, `_IDLE`, 60. Pieces of 14 first layouts, 973 by an integer
  program that took up to 58 s: 989 in 2.5 s. Of eight trees 996, of one 1,019. Of eight, `_STRAIGHT` 2 then
  50, and 50 alone: 1,002 and 1,020; `_IDLE` 20 and 200: 1,011 and 996. Shortest paths between lone triangles
  in place of turns: 1,099.
- `features._LEAST_CHORD`, 0.94 of the arc. 0.97: plate 365, mug 275,
  bracket 315. 0.88: mug 95, and 207 in the end where 0.94 has 201. None: edges run half round a hole.
  On rough meshes as well: 17 folds in the first fit of a knob for 43 and a wavy tube with plane ends 66 faces
  for 78, but a figure 115 for 93, a lens 30 for 27 and a rod 46 for 28.
- `features._JAGGED`, 4 reaches a corner. 0 and 2: spleen 155, eye_white 95 and 82. 8: no change.
- `features._MOVED`, 0.15 reaches. 0: bone 29, spleen 52, eye_white 57; raw eye_white 291 faces in the
  end for 163. 0.075: bone 18, spleen 53, eye_white 61. 0.3: bone 23, spleen 68, eye_white 61.
- `_kernels_layout.LEAST_SINE`, 0.1, and half of it in the end. Half: 413 faces in the end, for 376 of ten
  parts. None in the end: 408. The same to the end: 389, and a box of 14 faces; but 503 faces for 567 of the
  raw eye_white, mug and spleen.

Constants of exact faces (2026-11). Figures are parts whose faces come back, of 57 made with OpenCASCADE
(blocks, ribs, bosses, tees, pins, rings, cones; drilled, filleted, chamfered), each meshed coarsely and
finely: all 114 with the values that stand. Half and twice are for 38 coarse ones.

- `regions._ON` 1e-5, `_TURN` 40 degrees, `_FEWEST` 4 facets, `_IN_VAIN` 25, on 81 meshes, 23 of them of CAD
  parts that turn by 1 radian from facet to facet: half changes 2, 12, 13 and 9 of them, twice none, 3, 15 and
  5. All that change are so coarse, but for a rod with chamfers, which has 3 faces for 5 at twice `_TURN`, and
  a hull of 60 points, which is 32 at twice `_FEWEST`. Without the bound by chords in `on` 2 of 38 are lost.
- The second look of `exact_shell`, at a third of the sharp angle: without it a cylinder and a cone that meet
  at 14 degrees are 124 patches; at a half they are exact, too. It costs free forms 0.2 to 0.5 s.
- Without joining smaller regions (`_absorb`) 3 of 57 fine parts are lost; without the distance of centres,
  which tells a cone from a torus, 2 of 38.
- `quadrics.SAME`, 2e-6. As the distance of one plane, half or twice changes none. 1e-5 made two different
  radii equal.
- Limits of work or of sense: `quadrics._STEPS` 12, `_FAR` 1e-3,
  `_LARGEST` 20 sizes, `_ANGLES` 0.5 to 89.5 degrees; `exact._PLACES` 8 to 400 a curve, `_FINE` 1e-7 of the
  size; `trimmed._SIZE`, `_LEAST` and `exact._LEAST`, which OpenCASCADE's 1e-7 asks for;
  `trimmed._FINE` 0.05 of the tolerance, `_FINEST` 2e-6 of the root of the area, at which a sphere takes
  minutes, `_SHARP` 1 degree; `skinned._FINE` 0.002 of the size;
  `shell_triangles._MOST_TRIANGLES` and `_PLACES`.
"""
