"""Fixed point, bit-exact twins of rtl/, simulation, timing (paper 3.2).

What steers it, 2026-11, at half and twice (of `_RATIO` its excess over 1), on the paper's curve, six random
curves of degree 2 and 3, and a circle: 79 pieces, 258 records, steps right to 4e-7 of the largest.

| number | unit | half | twice |
| --- | --- | --- | --- |
| `_RATIO` | 1.9 | 105 pieces | 68 pieces; beyond it the words of 1 / |C'| do not reach |
| `_NEAR` | 8e-7 of the size | 87 pieces | 75 pieces |
| `_AGREE` (exact), first | 1e-8 of a period's distance | 395 records | 235 records |
| its last, of 12 short periods | 1e-5 | accelerations off by 1.5 % (2.6 %) | 3.9 %; a tenth: 5 refused |
| `_AGREE` (paper) | parts of the peak, tried in turn | | more than 1e-4 is refused |
| `_STEP_MARGIN` | 1.5 of a period's distance | 7 of 8 runs stop | a jump of 3 steps passes |
| `_STEP_ERROR` | 1e-3 of a step | 2.5 times the worst measured | a step 0.2 % above the plan is refused |
| `_HALVINGS` | 12 | 2 of 8 wild curves are refused | the same pieces |

The others are definitions. Of the Verilog: its limits (`MOST_DEGREE`, `MOST_POINTS`, `MOST_WEIGHT`,
`MOST_EXPONENT`), bits (`SHIPPED`, `T_GUARD`, `S_GUARD`), banks (`BANK`, `RECORDS`), load spaces (`KNOTS` to
`SHAPE`, `CLOSE`), registers and orders (`CONTROL` to `OVERRIDE`, `GO`, `FORGET`, `ABORT`) and names
(`ARRANGEMENTS`, `FAULTS`, `_STATES`). Of the formulas: `ADAMS`, `RUNGE_KUTTA`, `STARTED`. Of a stop, as its
test has it: `LONGEST`, `ON_THE_WAY`. Of times: the paper's (`_PAPER`, `_UNITS_S`), counted operations
(`_POINT`, `_SLOPE`, `_FORMULA`) and cycles of a processor (`_M7_HZ`, `_M7_CYCLES`).
"""

from nurbs_lab.hardware.arithmetic import Format
from nurbs_lab.hardware.cu import LoadedCurve, cu_error_bound, evaluate_cu, load_curve
from nurbs_lab.hardware.exact import run_exact
from nurbs_lab.hardware.exact_program import ExactProgram, build_exact_program
from nurbs_lab.hardware.feed import load_feed
from nurbs_lab.hardware.interpolator import build_program, load_host, simulate_path
from nurbs_lab.hardware.simulation import simulate_cu, watch_cu
from nurbs_lab.hardware.stepper import Program, Run, run_twin
from nurbs_lab.hardware.timing import (
    Timing,
    count_cycles,
    estimate_s,
    measure_s,
    serial_parameters,
    word_length_study,
)

__all__ = [
    "ExactProgram",
    "Format",
    "LoadedCurve",
    "Program",
    "Run",
    "Timing",
    "build_exact_program",
    "build_program",
    "count_cycles",
    "cu_error_bound",
    "estimate_s",
    "evaluate_cu",
    "load_curve",
    "load_feed",
    "load_host",
    "measure_s",
    "run_exact",
    "run_twin",
    "serial_parameters",
    "simulate_cu",
    "simulate_path",
    "watch_cu",
    "word_length_study",
]
