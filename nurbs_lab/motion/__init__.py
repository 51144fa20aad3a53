"""Feedrate v(t), steppers, tool paths and their error (paper 3.1).

Constants that steer plans, what half and twice their value change in the time of the motion (parts in a
million) and in that of planning, on the butterfly without jerk, with it, and on the paper's curve at 40 mm/s
and 0.1 ms (2026-11; 0 where the whole number of periods stays):

======================================  =======  ======================  ======================
constant (module)                       value    half                    twice
======================================  =======  ======================  ======================
SCAN_TOLERANCE (scan), of the speed     2e-4     0, 0, 0; 1.1 x          0, 0, +231; 1.0 to 1.1 x
TURN (scan), radians a cell             5e-3     -209, 0, -234; 1.7 x    +388, 0, +234; 0.6 x
WHOLE.margin (scurve), of a limit       1e-3     0, -231, 0; 1.0 x       0, 0, 0; 0.8-1.0 x
_SAMPLES (scurve), samples a cell       8        0, 0, 0; 1.0 x          0, 0, 0; 0.95 x
_MOST (scurve), cells                   20,000   0, +169, 0; 0.8 x       0, 0, 0; 1.0 x
WHOLE.per_period (scurve), cells        4        0, +169, 0; 0.6 to 1 x  0, 0, 0; 1.2 to 2.6 x
FALL (_scurve_problem), of the weight   0.2      0, 0, 0; 1.0 x          0, 0, 0; 1.0 x
_NEAR (_scurve_problem), of a weight    0.3      0, 0, 0; 1.1 x          0, 0, 0; 1.1 x
_TRUST (multistep), of a step           1e-4     see notebook 07, 5      largest error 2 x
======================================  =======  ======================  ======================

_MOST (scurve) adds 30 cells for each corner: each of 1,000 equal corners takes 2.7 % longer than each of 20,
with none 5.3 %, with 50 2.0 % and with 100 1.2 %; plans of 3,000 take 0.45, 1.6 and 2.8 times as long.
_GROWTH (scurve), of a cell, is 0.03: half of it takes 430 to 600 parts in a million off paths of 10 and 100
corners, in 1.05 to 1.4 times the time; twice adds 370 to 600, in 0.8 to 0.85 of the time.

Without TURN an arc of 1.5 radians has 11 samples, and its plan takes 2.4 % longer than the closed form; with
it 0.03 %.

Others, on the butterfly without jerk, a polyline of 59 corners with jerk, and 300 lines as a program:

======================================  =======  ======================  ======================
constant (module)                       value    half                    twice
======================================  =======  ======================  ======================
_BESIDE (scan), of a span               1e-2     0, +416, 0; 1.0-1.2 x   0, +139, 0; 1.0 x
_FIRST_CELLS (scan), of a span          8        0, 0, -437; 1.0-1.1 x   -97, -139, +437; 1.2 x
_SHORTEST_CELL (scurve)                 6e-5     0, +139, 0; 1.0 x       0, 0, 0; 1.0 x
_FIRST (program), periods               500      0, 0, +50,655; 1.1 x    0, 0, -1,310; 1.0 x
_PLACES (override), of a reversal       48       0, 0, 0; 0.95 x         0, 0, 0; 1.05 x
======================================  =======  ======================  ======================

At half and at twice of these none of 80 parts (60 random plans, 12 near-cusps, 8 polylines) lasts longer or
shorter, in 0.96 to 1.04 of the time of planning; another value does this:

======================================  =======  =============================================
constant (module)                       value    another value
======================================  =======  =============================================
JUMP (scan)                             1e-6     0: 3 are 4 to 19 % longer
_MOST_CELLS (scan), in all, a span      2e4, 2e3 none is refused at half
_NEGLIGIBLE (corners)                   1e-7     0: 8 are up to 19 % longer
_APART (corners), of the length         1e-10    1e-14: none
_SHORTEST (scurve), of the length       1e-9     1e-12, 1e-6: none
_SLOWINGS (_scurve_problem), doublings  40       5, 400: none
_ROUNDED (plan), of a speed             1e-7     1e-5: a chord error is exceeded by 6e-6
_ROUNDING (_verify), of the length      1e-13    0: a near-cusp of radius 6e-12 mm is refused
CUSP (prepared_curve), of mean C'       1e-9     1e-13: none
BESIDE_END (prepared_curve), of a span  1e-10    1e-13, 1e-7: none
======================================  =======  =============================================

_SHORT 5e-6 (multistep) has no effect at half and twice. Without _EXTRA 2 (corrected), 'chord-corrected' with
one trial errs by 3.6 in place of 2.5 parts in a million.
A program of 1,000 spans at 3 mm/s² takes 3 % longer with half of _WINDOW 16,000 and the same with twice; the
same with half of _KEPT 0.25 (1.1 x), 0.15 % less with twice (1.4 x); with equal pieces of 32, 64 or 128 spans
in place of _SPANS 16 and _DOUBLINGS 5 it takes 3 to 8 % longer. Six others last as long but for 0.03 %.
_NEAR 0.5 (multistep) has the same errors at half its value, and up to eight times as large ones at twice.
WINDOW (scurve) is (0.25, 5, 200, 3e-3, 4e-3), WHOLE (4, 40, 2000, 1e-4, 1e-3). With the last, the margin, at
1e-3 windows of waves are planned 2.2 times, at 2e-3 1.8 times, at 4e-3 once, lasting 1.4e-4 longer.
The hundredth of a step that `settle` adds to the last one: at half its value 3 of 360 paths that end at speed
take a period too many, at twice none.

_TOLERATED (plan), a factor in speed, is 1 + 1e-5: with 1 + 1e-7 windows take up to 5 % longer.

Of rounding are SHORTEST 1e-15 mm and AGREE 1e-6 (prepared_curve) and _EQUAL 1e-9 (override). Limits of work,
memory and size are _ROUNDS 16 (plan; the same at half and twice, with 4 a spline of sharp turns is refused),
_LONGER 6 (_relaxation), MOST_SAMPLES 5,000,000 (feed) and LARGEST 2 (override). STEPS 1000 (_scurve_problem)
changes nothing at half and twice; with 60 a spline at 10,000 mm/s with jerks of axes takes 1.5 % longer, and
at 1e9 mm/s 5 %.

_FINER 8 (certificate): the bound without jerk is 60 parts in a million low on 35 curves (the median), with
half of it 130, and with twice 26 in 1.9 times the time. Of the bound with jerk (_relaxation), _GAP 3e-4 is
lost; _FIRST 0.1 at half and twice changes it by 1e-4, at ten times one of four plans, and at a hundredth two,
are left without a bound; with FALL 0.05 instead of 0.2 it takes 1.5 to 1.9 times as long and differs by
6e-5; _NEAR is 0.1, since looser early stages left one of eight plans unbounded.

Definitions: the coefficients of formulas (BASHFORTH, MOULTON), how many points and slopes they take (_POINTS
5, _SLOPES 4), quadratures (_NODES, _WEIGHTS), where `_verify` looks in a cell (_INSIDE), the steppers
(STEPPERS, _STEPPERS, _ROWS), the kinds of them (TAYLOR, RUNGE_KUTTA, SLOPES, EXACT, MENDED, NEWER, PLUS,
MINUS), the names of limits (NAMES, VECTOR, BY_SPEED, _LOWERED, KEPT), of the arrays of a scan
(ROWS) and of files (_STORED).

Rules that were switched off in turn (2026-11), on 67 or 68 parts: random splines of degrees 1 to 5, kinks
from 1e-9 to 1 rad, rasters, a rounded rectangle, a smoothed part, programs, the paper's curve and the
butterfly. The first three rows and the last were measured on other parts.

================================================  ======================================================
without (module)                                  parts whose motion takes 0.2 % longer, or what else
================================================  ======================================================
samples beside jumps (scan)                       a corner costs 70 ms
nodes at jumps (scurve)                           one polyline takes 277 times as long
shortest cells, bends between nodes (scurve)      blended facets 18 % slower
samples where a corner's speed begins (corners)   9, by up to 21 %
jerk of axes at corners (corners)                 4 shorter, 3 of these beyond a limit
_NEGLIGIBLE corners left out (corners)            11, by up to 2.5 %
phases of jerk out of near rest (scurve)          1 refused
a slow speed in reach of a short path (scurve)    1 refused
the slow first motion (scurve)                    none; 1.9 times the time of planning
the straight first motion (scurve)                none; ends that move are refused (test_scurve)
the steep first motion (scurve)                   none; a zigzag takes 9 times the time of planning
jerks of axes in the first motion (scurve)        6 refused
half the jerk of axes beside corners (scurve)     8 shorter by up to 1 %, one 3 % beyond its limit
cells on the way to corners (scurve)              2, by 0.2 %
corners left out of the trapezoid (scurve)        1, by 0.2 %
room for turning in the first motion (scurve)     1, by 0.2 %; 0.83 of the time of planning
own speeds on both sides of a node (scurve)       none; programs exceed speeds of their own by 1.6 %
no margin at ends that move (scurve)              none; ends 1e-4 below the limit of a circle are refused
samples at minima of |C'| (scan)                  none; 1 of 40 slow near-cusps 13 % beyond its limit
samples at quarters of cells (scan)               none; 2 of 600 of degrees 2 to 15, by up to 6 % beyond
_SPANS and _DOUBLINGS, equal pieces (program)     1, by 8 %; the first motion takes 3.7 times as long to come
all samples near jumps between nodes (scurve)     windows of blended facets by 2.6 %, planned twice as long
_KEPT (program)                                   none; at 3 mm/s² programs take 4 times the time of planning
================================================  ======================================================
"""

from nurbs_lab.motion.certificate import Certificate
from nurbs_lab.motion.curves import BenchmarkCurve, benchmark_curves
from nurbs_lab.motion.feed import FeedProfile
from nurbs_lab.motion.leaderboard import Score, leaderboard
from nurbs_lab.motion.limits import Limits
from nurbs_lab.motion.override import apply_override
from nurbs_lab.motion.plan import plan_feed
from nurbs_lab.motion.program import plan_program, plan_windows
from nurbs_lab.motion.steppers.registry import (
    STEPPERS,
    Job,
    Option,
    Stepper,
    Steps,
    register,
    software_steppers,
    steps_of,
)
from nurbs_lab.motion.toolpath import ToolPath
from nurbs_lab.motion.trace import trace

__all__ = [
    "STEPPERS",
    "BenchmarkCurve",
    "Certificate",
    "FeedProfile",
    "Job",
    "Limits",
    "Option",
    "Score",
    "Stepper",
    "Steps",
    "ToolPath",
    "apply_override",
    "benchmark_curves",
    "leaderboard",
    "plan_feed",
    "plan_program",
    "plan_windows",
    "register",
    "software_steppers",
    "steps_of",
    "trace",
]
