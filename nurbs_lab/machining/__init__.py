"""Cutters, finishing and roughing programs, the virtual machine.

Constants that steer programs, and what half and twice their value change (2026-11) on a plate of 40 x 30 x
12 mm with pocket, holes and bosses: of finishing by a ball of 6 mm, scallop 0.05, and of roughing by a flat
cutter of 6 mm, step 2. The first number is the length outside rapid moves, the second the number of moves,
both in per cent; ramps are among them. Nothing was gouged, nor more left than the scallop, unless it is said.
Of a scan of 30 mm (the spleen, scallop 0.1, of which 1.13 are left) are the rows with one star, of a wavy
block of 20 mm (scallop 0.05) those with two, of a pocket of 10 x 12 mm (cutter 5 mm, 0.1 mm left) those with
three; a plus is the mean of 16 to 21 programs of 10 parts, five of them CAD; of verify there are ten.

=======================================  =======  =============  =============
constant (module)                        value    half           twice
=======================================  =======  =============  =============
CUSP (finish), of the scallop            0.65     +35, +39 *     at 0.95 -6, +3 *; 1.03 scallops are left
SAMPLES (finish), of the step-over       0.125    +1, +16 *      +2, +7 *; 1.38 scallops are left
FINEST_SAMPLES (finish), diameters       1/80     at 1/64 1.007 of 0.03 left; 1/128 1.6 x a flat's time
CLOSER (finish), of the tolerance        0.25     +1, -13        +3, +8; at 1 3.6 x the bad places of a liver
FIT (fit), of the tolerance              0.4      0, 0           at 0.48 +5, +8
SHORTEST (fit), tolerances               0.1      0, 0 +         0, 0 +; at 0 no end within minutes
LOSS (fit), of the tolerance             0.08     +1, -2 *       +35, +128 *
SPLIT (passes), degrees                  45       30: +1, +42    60: +11, -41
CLIFF (passes), degrees                  75       60: -6, +3     85: +14, -30
RISE (passes), tolerances                0.45     +1, -5 *       0, +1 *
GAP (passes), diameters                  1        -1, +8         +1, -7; also between lowest places of walls
WIDTH (passes), step-overs               0.5      -12, -40       +3, -38
JOIN (passes), step-overs                2        -2, -6         -3, -7; 0, -8 *; also of heights beside a way
SUBDIVISIONS (passes), of a way          8        0, 0           0, 0; at 2 0.5 % of a narrow gap is left
NEAR (passes), of the step-over          0.25     0, +11 *       0, -4 *; without it bites of 19 mm, not 9 *
LEVEL_STEP (passes), of the flat disc    1.2      +68, +57       +488, +474; of a block by a flat cutter
NEAR (link), diameters                   2        -2, +9 *       0, 0 *; also of the legs of ramps
UP (link), diameters                     0.1      0, +1 *        0, -1 *; the links up and down are longer
ASIDE (link), diameters                  0.6 to 2 +6, +38 *      +2, 0 *; without +52, +97 *
TURNS (link), directions                 12       +3, +2 **     0, 0 **; four of them +7, +57 of a slot
SAFE (link), diameters                   1        0, 0 **        0, 0; the rapid length -2, +4
PLUNGE (link), of the feed               1/3      0, 0 **        0, 0; the time +22, -11
DOWN (order)                             4        +5, +2         -1, +4; at 1 +12, +35
CLOSE (link), diameters                  0.005    0, 0           0.05 gouged by 0.03 mm
RAMP_SLOPE (link)                        tan 5°   0, 0 **        0, 0; legs of ramps are more, or fewer
MOST_LEGS (link), legs                   80       -5, -23        0, +2; half of it has steeper ramps
CLOSEST (waterlines), of a step          0.5      -1, -1         +2, +4
STUB (waterlines), of CLOSEST            0.1      0, 0           0, +1 *; at 0 0, -1 *
VALLEY (surface), steps of the grid      1        +11, +10 *     +5, +14 *
CELLS (stock), cells a diameter          24       0, +4 of rough 0, 0; of rough 1.6 x the time, at half 0.9 x
  of the grid of passes                           0, -39         0, 0
LEAF (box_tree), items                   4        of verify, the time is 0.98 x at 8, 0.94 x at 16 *
FLAT_STEP (rough), diameters             0.4      +83, +40       -29, -29; BALL_STEP, 0.25, is that of balls
TILT (rough), degrees                    1        0, 0           0, 0; at 5 for a ball 14 levels, not 11 **
GRID (rough), nodes a diameter           12       -5, -23        +1, +3
FINE (rough), tolerances a diameter      120      -8, -59 ***    0, 0 ***; RIM (stock), 2, the other way round
SKIN (rough), thicknesses of a skin      8        0, 0           a skin of 0.45 mm stays on a box, by 12 mm
FINEST (rough), diameters                0.125    0, 0           a skin of 1.7 mm stays on a box, by 100 mm
SLACK (rough), of the step down          0.05     -8, -6 *       +33, +6 ***; of the plate 0, 0
PUSHED (search), radii                   2e-5     0, -1 +        0, -1 +
RIM (link), diameters                    0.25     0, +2          -4, -11; at 0.05 1.3 x the time of a liver
RAISES (link), points of a link          289      0, 0 +; 0.9 x  0, 0 +; 1.05 x the time
SINGLE (part), sizes, normals, feeds     1e-6     0, 0 +         0, 0 +; at 0 +3, +15, and one is refused
TOGETHER_MM (program)                    1e-9     0, 0 +         0, 0 +; at 0 +1, +6
ROUNDING, _ROUNDS (contact)              1e-12,60 0, 0 +         0, 0 +
INSIDE (stock), cells                    0.01     0, 0           0, 0; at 0 8 of 10 stocks of 32 bits refused
TIP_SPACING (stock), cells               0.5      0, 0 +; 1.1 x  0, 0 +; 1.0 x the time
WARN_CELLS (simulate), a diameter        16       0, 0 +         0, 0 +
SPACING (verify), diameters              0.006    1.5 x time     gouges up to 5 % less deep; 0.85 x the time
TIMES (verify), a control point          10       the same       gouges up to 0.7 % deeper; 1.2 x the time
SAMPLES (verify), diameters              0.03     2.7 x time     26 % less to 1 % more left; 0.7 x the time
LEAST_SAMPLES (verify), of a part        2e4      0, 0           6 % more left on small parts; 1.1 x the time
MOST_SAMPLES (verify), of a part         2.5e6    0, 0           0, 0; met from 0.08 m² on with a ball of 6 mm
TESSELLATION (part), mm                  1e-3     5e5 triangles  1.3e5, not 5e5 of a torus of radii 2 and 1 mm
MOST_NODES, MOST_OF_TIPS (field)         5e7, 5e6 0, 0           0, 0; of 8 and 500 bytes, more are refused
MOST_SAMPLES (surface), MOST_LEVELS      1e7, 2e3 0, 0           0, 0; more are refused
MOST_CELLS (stock)                       4e6      0, 0           0, 0; cells of wide stocks are larger
=======================================  =======  =============  =============

Rules switched off one at a time (2026-11; 16 to 30 programs of 13 parts, judged by a field of heights,
distances and a clock that are no part of this package), and the time without them: walls left to the lowest
waterline 2.6 x, rings of a roughing that end beside walls 2.6 to 3.4 x, the raster of discs 1.7 x, ways in
from beside 1.5 x (roughing 2.4 x), sideways pushes 16 % more, waterlines along level faces 14 % of a plate
and two warnings, cliffs 13 %, links tangent to both passes 7 %, closed gaps 5 %, cuts that plunge into little
3 to 6 %, rapid moves below the safe height 2 % (roughing 6 %), slopes of low steps 1 %, but a cone is cut 15
µm too deep and a step of 0.4 mm takes 1,007 moves of a flat cutter, not 29, tips spared by waterlines 1 %, of
a pocket with fillets 11 %, and up to 30 % of the way of programs after others; processor time of owners of
edges 27 %, of trying the last triangle first 10 %. Without cuts in steps, one of 130 roughings bites 2.3
steps deep, not one.

Definitions: HALF (half the diagonal of a cell), NEEDLE (a cutter without width), ROBERTS (the sequence R2),
MACHINE (a small machine), _LINE, _LINK, _BASIS, _STRAIGHT (splines of links; without the straight
ones a scan takes 9 % longer, with them alone too), KINDS and CONTACTS (names).
"""

from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import drop_cutter
from nurbs_lab.machining.finish import finish
from nurbs_lab.machining.part import Part, prepare_part
from nurbs_lab.machining.program import MACHINE, Move, Program
from nurbs_lab.machining.rough import rough
from nurbs_lab.machining.simulate import Simulation, simulate
from nurbs_lab.machining.stock import stock_around
from nurbs_lab.machining.verify import Verification, verify

__all__ = [
    "MACHINE",
    "Cutter",
    "Move",
    "Part",
    "Program",
    "Simulation",
    "Verification",
    "drop_cutter",
    "finish",
    "prepare_part",
    "rough",
    "simulate",
    "stock_around",
    "verify",
]
