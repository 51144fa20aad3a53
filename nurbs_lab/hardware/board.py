"""The stepper 'board': a path run by the Verilog of rtl/boards/colorlight_i5.v, over a serial line."""

import sys
from importlib import import_module
from types import ModuleType

import numpy as np

from nurbs_lab.hardware.exact import run_exact
from nurbs_lab.hardware.exact_program import build_exact_program
from nurbs_lab.hardware.interpolator import steps_of
from nurbs_lab.hardware.simulation import rtl_folder
from nurbs_lab.motion import Option, Stepper, register
from nurbs_lab.nurbs import NurbsCurve

_PACKAGE = "nurbs_lab_board"


def load_host():
    """The module rtl/boards/host.py: `Machine`, `Simulation`, and what the board speaks."""
    sys.modules.setdefault(_PACKAGE, ModuleType(_PACKAGE)).__path__ = [str(rtl_folder() / "boards")]
    return import_module(f"{_PACKAGE}.host")


def _run(job, *, port="", steps_per_mm=400.0):
    curve = job.curve
    points = np.zeros((len(curve.control_points), 3))
    points[:, : curve.dim] = curve.control_points
    space = NurbsCurve(curve.degree, curve.knots, points, curve.weights)
    program = build_exact_program(space, job.feed, job.period_s)
    with load_host().Machine(port, steps_per_mm=steps_per_mm) as machine:
        *_, status = machine.run(program, job.period_s)
    run = run_exact(program)
    return steps_of(program, curve, run, (len(run.u), len(run.u) - 1), {"steps": status.steps})


register(
    Stepper(
        "board",
        "exact slopes on a Colorlight i5, behind a serial port",
        (1, 1, 0, 0),
        _run,
        options=(
            Option("port", str, "", (), "serial port of the board, such as '/dev/ttyACM0'"),
            Option("steps_per_mm", float, 400.0, (1e-6, 1e9), "steps of each axis per mm"),
        ),
    )
)
