"""Fixed point, bit-exact twins of rtl/, simulation, timing (paper 3.2)."""

from nurbs_lab.hardware.cu import evaluate
from nurbs_lab.hardware.formats import Format
from nurbs_lab.hardware.loader import LoadedCurve, load
from nurbs_lab.hardware.simulation import CuRun, simulate_cu

__all__ = ["CuRun", "Format", "LoadedCurve", "evaluate", "load", "simulate_cu"]
