"""Fixed point, bit-exact twins of rtl/, simulation, timing (paper 3.2)."""

from nurbs_lab.hardware.board import load_host  # and registers the stepper 'board'
from nurbs_lab.hardware.bounds import cu_error_bound
from nurbs_lab.hardware.cu import evaluate_cu
from nurbs_lab.hardware.exact import run_exact
from nurbs_lab.hardware.exact_program import ExactProgram, build_exact_program
from nurbs_lab.hardware.feed import LoadedFeed, load_feed
from nurbs_lab.hardware.formats import Format
from nurbs_lab.hardware.interpolator import build_program, simulate_path
from nurbs_lab.hardware.loader import LoadedCurve, load_curve
from nurbs_lab.hardware.processors import (
    CORTEX_M7,
    Processor,
    estimate_s,
    measure_s,
    paper_times_s,
    serial_parameters,
)
from nurbs_lab.hardware.simulation import CuRun, simulate_cu, watch_cu
from nurbs_lab.hardware.stepper import Program, Run, run_twin
from nurbs_lab.hardware.study import Accuracy, word_length_study
from nurbs_lab.hardware.timing import Timing, count_cycles

__all__ = [
    "CORTEX_M7",
    "Accuracy",
    "CuRun",
    "ExactProgram",
    "Format",
    "LoadedCurve",
    "LoadedFeed",
    "Processor",
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
    "paper_times_s",
    "run_exact",
    "run_twin",
    "serial_parameters",
    "simulate_cu",
    "simulate_path",
    "watch_cu",
    "word_length_study",
]
