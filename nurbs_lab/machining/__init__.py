"""Cutters, finishing and roughing programs, the virtual machine.

Constants that steer programs, and what half and twice their value change (2026-11) on a plate of 40 x 30 x
12 mm with pockets, hole and bosses: of finishing by a ball of 6 mm, scallop 0.05 (rows other than WIDTH with
WIDTH 0.25), and of roughing by a flat cutter of 6 mm, step 2. The first number is the length outside rapid
moves, the second the number of moves, both in per cent.

=======================================  ======  =============  =============
constant (module)                        value   half           twice
=======================================  ======  =============  =============
CUSP (finish), of the scallop            0.65    +32, +24       at 0.95 -9, -19
GOOD (finish), of the scallop            0.97    +8, +55        at 1.15 0, 0
SAMPLES (finish), of the step-over       0.25    0, -6          -4, -7
FIT (fit), of the tolerance              0.45    -2, -2         +4, +92
WIDE, LONG (fit), of the tolerance       0.3, 3  0, 0           0, 0
NARROW (passes), diameters               0.1     -4, -5         +33, -9
GAP (passes), diameters                  1       +2, +1         +1, -1
SPARSE, OVERLAP (passes)                 3, 15   0, 0           0, 0
WIDTH (passes), step-overs               0.5     -13, +69       -1, -10
NEAR, BESIDE, LOW (link), diameters      6       0, +2          0, -2
UP (link), diameters                     0.2     -2, 0          +4, 0
CELLS, LOSS (stock)                      24      0, 0           0, 0
CLOSEST (waterlines), of a step          0.25    0, 0           -5, -6
FLAT_STEP (rough), diameters             0.4     +82, +39       -28, -27
GRID (rough), nodes a diameter           12      -6, -23        +1, +5
CELLS (rough), cells a diameter          48      0, 0; 0.65 x   0, 0; 3 x the time
TOLERANCE, SLACK (rough), RIM (stock)    0.1     0, +1          0, -1
DROP, RAMP (link), diameters             0.1, 3  0, +2          +2, +3
=======================================  ======  =============  =============
"""

from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.drop import drop_cutter
from nurbs_lab.machining.finish import finish
from nurbs_lab.machining.part import Part, prepare_part
from nurbs_lab.machining.program import MACHINE, Feeds, Move, Program
from nurbs_lab.machining.rough import rough
from nurbs_lab.machining.simulate import Simulation, simulate
from nurbs_lab.machining.stock import stock_around
from nurbs_lab.machining.verify import Verification, verify

__all__ = [
    "MACHINE",
    "Cutter",
    "Feeds",
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
