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
Without TURN an arc of 1.5 radians has 11 samples, and its plan takes 2.4 % longer than the closed form; with
it 0.03 %.

Others: three numbers are of the butterfly without jerk, a polyline of 59 corners with jerk, and 300 lines as
a program; of WHOLE the mean of 80 plans, of WINDOW the extremes of eight programs, the rest as shown:

======================================  =======  ======================  ======================
constant (module)                       value    half                    twice
======================================  =======  ======================  ======================
_BESIDE (scan), of a span               1e-2     0, +416, 0; 1.0-1.2 x   0, +139, 0; 1.0 x
_FIRST_CELLS (scan), of a span          8        0, 0, -437; 1.0-1.1 x   -97, -139, +437; 1.2 x
_SHORTEST_CELL (scurve)                 6e-5     0, +139, 0; 1.0 x       0, 0, 0; 1.0 x
_FIRST (program), periods               500      0, 0, +50,655; 1.1 x    0, 0, -1,310; 1.0 x
_GROWTH (scurve), 10 to 100 corners     0.03     -600 to -430; 1.2 x     +370 to +600; 0.8 x
_STOP (corners), 24 with jerks of axes  0.05     -2,740 to +710; 1.1 x -1,040 to +10,900; 0.8 x
_WORTH (corners), of 60 polylines       0.02     -540; 1.0 x             +1,870; 1.0 x
WHOLE.per_ramp (scurve), cells          40       -57; 0.9 x              +21; 1.1 x
WHOLE.fewest (scurve), cells            2000     +47; 1.0 x              +39; 1.0 x
WHOLE.gap (scurve), of the time         1e-4     0; 1.0 x                0; 1.0 x
WINDOW.per_period (scurve), cells       0.25     0                       -2,626 to +35
WINDOW.per_ramp (scurve), cells         5        0                       -2,626 to +35
WINDOW.fewest (scurve), cells           200      0                       0
WINDOW.gap (scurve), of the time        3e-3     -272 to 0               0 to +345
WINDOW.margin (scurve), of a limit      4e-3     -424 to 0; 1.8 plans    0 to +849; 0.7 x
_WINDOW (program), 1,000 spans          16,000   +30,000                 0
_KEPT (program), 1,000 spans            0.25     0; 1.1 x                -1,500; 1.4 x
_FAR (corrected), of a step             0.5      err as much (0.01)      9 of 76 leap by 2 to 99
_SHORT (multistep), of coordinates      5e-7     holds err 3 x           slow sharp turns err 18 x
_NEAR (multistep), of a step            0.5      errors 1 x              errors 8 x
_ROOM (multistep), of a limit           2.5e-4   1.1 x evaluations       chord errors 1.003
_FINER (certificate), the bound         8        -58 (median of 60)      +29; 1.8 x
_GAP (certificate), the bound           3e-4     +93 (median of 30)      0
_NEAR (certificate), the bound          0.1      0                       0
_LONGER (_relaxation), the bound        2        0; 1.05 x               0; 1.1 x
_FIRST (certificate), the bound         0.1      100                     100; of 1, 1 of 4 has none
======================================  =======  ======================  ======================

The four of the bound at the values of plans leave one of 16 plans, of teeth with jerk of axes, without one.
_SHORT at 5e-6 takes 3.4 times the acceleration on slow sharp turns, and at 0 holds err by 5e-7 of a step.
The hundredth of a step that `settle` adds to the last one: at half its value 3 of 360 paths that end at speed
take a period too many, at twice none.

At half and at twice of these none of 80 parts (60 random plans, 12 near-cusps, 8 polylines) lasts longer or
shorter, in 0.96 to 1.04 of the time of planning; another value does this:

======================================  =======  =============================================
constant (module)                       value    another value
======================================  =======  =============================================
_MOST_CELLS (scan), in all, a span      2e4, 2e3 none is refused at half
_NEGLIGIBLE (corners)                   1e-7     0: 8 are up to 19 % longer
_APART (corners), of the length         1e-10    0: 3 of 16 polylines 0.5 to 2 % beyond a limit
_SHORTEST (scurve), of the length       1e-9     0: 4 of 24 with jerks of 1e6 to 1e18 refused
_ROUNDED (plan), of a speed             1e-7     1e-5: a chord error is exceeded by 6e-6
_TOLERATED (plan), of a speed           1e-5     1e-7: windows take up to 5 % longer
_ROUNDS (plan), motions                 16       4: a spline of sharp turns is refused
STEPS (_scurve_problem)                 1000     60: a spline at 1e4 mm/s takes 1.5 % longer
_PART (scurve), of accelerations        0.5      0.25: 1.2 x the Newton steps on polylines
_PULLS (_scurve_problem), of a cell     1 to 1e4 up to 1e2: ends are refused from 0.997 of it on, not 0.9997
_STAGES (_scurve_problem), weights      3        1: a sine of 300 facets is refused; 0: a circle of 4,000 too
SHARPEST (scan), of the length          1e-12    0: 12 of 24 near-cusps below 1e-12 mm are refused, not 5
_LEAP (trace), of a step                10       4: 'adams' is refused at spans 3.6, not 8.5 times as short
_NEARER (_verify), rounds               4        1: 3 of 10 splines 5e-5 to 5e-4 beyond a jerk of axes
CUSP (prepared_curve), of mean C'       1e-10    0: 4 of 30 near-cusps are planned, not followed
EQUAL_WITHIN (prepared_curve)           1e-6     0: 6 of 60 are not of their curve, 3 4 to 19 % longer
EQUAL (override), of a speed            1e-9     1e-6: speeds of overrides jump by as much
_HALVINGS (override)                    40       20: commands are met late, in more than 5 x the time
_TRIALS (override), halvings            4        16: 2 to 3 x the time, no limit is used more or less
_FINER (override), steps a period       4        1, 2, 8: up to 1.16, 1.015, 1.013 of a jerk of axes
_EXTRA (corrected), trials              2        0: first steps err by 3e-4 for 1e-7
LARGEST (override), MOST_SAMPLES (feed) 2, 5e6   what commands and paths may ask for
======================================  =======  =============================================

Definitions: _NODES, _WEIGHTS (quadrature), BASHFORTH, MOULTON, _POINTS, _SLOPES (formulas), _INSIDE (places
in a cell), STEPPERS, _STEPPERS, _ROWS, TAYLOR, RUNGE_KUTTA, SLOPES, EXACT, MENDED, NEWER, PLUS, MINUS
(steppers), NAMES, OF_AXES, BY_SPEED, _LOWERED, KEPT, LIMITS (names), ROWS (of arrays), _NONE,
_BEYOND (of landings), _STORED (of files), _CORRECTED (a summary).

Rules that were switched off in turn (2026-11), on 67 or 68 parts: random splines of degrees 1 to 5, kinks
from 1e-9 to 1 rad, rasters, a rounded rectangle, a smoothed part, programs, the paper's curve and the
butterfly. The first three rows and the last were measured on other parts, those of cells and trapezoid on 94.

================================================  ======================================================
without (module)                                  parts whose motion takes 0.2 % longer, or what else
================================================  ======================================================
samples beside jumps (scan)                       a corner costs 70 ms
nodes at jumps (scurve)                           one polyline takes 277 times as long
shortest cells, turns between nodes (scurve)      blended facets 18 % slower
samples where a corner's speed begins (corners)   9, by up to 21 %
jerk of axes at corners (corners)                 4 shorter, 3 of these beyond a limit
stops at corners (corners)                        22 of 24 with jerks of axes, by 0.02 to 23 %; 2 of fine
                                                  facets 0.2 and 0.3 % shorter; 0.6 of the time of planning;
                                                  without jerk 38 of 60 polylines by up to 5.6 %, 1 shorter
_NEGLIGIBLE corners left out (corners)            11, by up to 2.5 %
phases of jerk out of near rest (scurve)          1 refused
a slow speed in reach of a short path (scurve)    1 refused
limits for phases beside those for ends (problem)  none; 400 corners with jerks of axes 1.9 times the time
stretches of the first motion in place (scurve)   none; ends that move 1.7 times the time of planning
windows that begin or end at corners (corners)    none; 1 of 40 rows of tiny steps 7 % beyond its limit
corners seen as curvatures (scan.turned)          none; facets up to 22 % beyond their jerk of axes
room for speeding up in outer cells (scurve)      none; 3 of 1,115 up to 3.2e-4 beyond an axis's acceleration
speed peaks within cells (problem)                none, with it 2e-4; 3,000 corners are planned twice
half the jerk of axes beside corners (scurve)     8 shorter by up to 1 %, one 3 % beyond its limit
cells on the way to corners (scurve)              1, by a period; one 2.9 % beyond its jerk of axes
corners left out of the trapezoid (scurve)        8 with jerks of axes, by up to 12 %
growth of cells from rest and corners (scurve)    23, by up to 23 %
own speeds on both sides of a node (scurve)       none; programs exceed speeds of their own by 1.6 %
no margin at ends that move (scurve)              none; ends 1e-4 below the limit of a circle are refused
sixth points (multistep)                          none; 'history-arc' takes up to 1.57 of a jerk
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
