"""The steppers 'rtl', the simulated Verilog, and 'board', that of rtl/boards over a serial line."""

import sys
from importlib import import_module
from itertools import chain
from types import ModuleType

import numpy as np

from nurbs_lab.common.checks import as_choice, as_flag, as_kind, as_positive
from nurbs_lab.hardware.arithmetic import SHIPPED, Format, checksum
from nurbs_lab.hardware.cu import load_curve
from nurbs_lab.hardware.exact import run_exact
from nurbs_lab.hardware.exact_program import ExactProgram, build_exact_program, check_chain
from nurbs_lab.hardware.feed import load_feed
from nurbs_lab.hardware.simulation import rtl_folder, simulate, split_words
from nurbs_lab.hardware.stepper import STARTED, Program, Run, first_slope, loaded_limits
from nurbs_lab.motion import Option, Stepper, Steps, register
from nurbs_lab.nurbs import NurbsCurve

#: Name -> parameter ARRANGEMENT of rtl/adams.v.
ARRANGEMENTS = {"serial": 0, "parallel": 1, "cached": 2}
#: Registers of rtl/nurbs_interpolator.v.
CONTROL, STATUS, LOAD_LOW, LOAD_HIGH, LOAD_AT, CYCLES, SHAPE, CYCLES_HIGH, OVERRIDE = range(0, 36, 4)
#: Orders to the register CONTROL.
GO, FORGET, ABORT = 1, 2, 4
#: Bit of STATUS -> what went wrong.
FAULTS = dict(enumerate(("overflow", "by_zero", "backward", "bad curve", "too_far", "beyond", "aborted"), 8))
#: Space of the load bus that closes a load.
CLOSE = 7


def build_program(
    curve, feed, period_s, periods, *, largest_step=None, axis_limits=None, format: Format = SHIPPED
) -> Program:
    """What to load for a curve and a feed.

    Parameters
    ----------
    curve : NurbsCurve
        See ``load_curve`` for what the hardware takes.
    feed : FeedProfile
        See ``load_feed`` for what the hardware takes.
    period_s : float
        Long enough that the tool moves by some last places of a coordinate in one: else the run ends with
        the flag ``by_zero``.
    periods : int
        Number of the step that has to end at the curve's end.
    largest_step : float, optional
        Largest move of an axis in a period, in mm; 1.5 times what a period moves at the feed's peak if
        left out. The hardware stops before a larger one.
    axis_limits : array_like, shape (dim, 2), optional
        Lowest and highest coordinate of each axis, in mm. The hardware stops before a point outside.
    format : Format, optional

    Raises
    ------
    ValueError
        If the curve or the feed breaks a limit of the hardware, or the feed is that of another length.
    """
    loaded = load_curve(curve, format)
    loaded_feed = load_feed(feed, period_s, periods, loaded.point_fraction, format)
    check_chain([curve], feed)
    du, chord = first_slope(curve, loaded)
    moved = feed.peak * as_positive("period_s", period_s)
    step, limits = loaded_limits(curve.dim, moved, largest_step, axis_limits, loaded.point_fraction, format)
    return Program(loaded, loaded_feed, du, chord, step, limits)


def close_load(writes, bank=0) -> tuple[int, int, int]:
    """The write that closes a load: number and checksum of the writes, as in rtl/load_guard.v."""
    words = (data ^ data >> 32 ^ (space << 10 | index) for space, index, data in writes)
    return CLOSE, bank, (len(writes) & 0xFFFF) << 32 | checksum(words)


def register_writes(program: Program | ExactProgram) -> list[tuple[int, int]]:
    """A program of one bank as writes ``(address, data)`` to the registers; the last one starts the run.

    Raises
    ------
    ValueError
        If the program has more banks: all but the first two are loaded while it runs.
    """
    first, *later = batch_writes(program)
    if later:
        raise ValueError(f"program has {len(later) + 1} banks: load them in turn, as batch_writes gives them")
    return [(CONTROL, FORGET), *first, (CONTROL, GO)]


def batch_writes(program) -> list[list[tuple[int, int]]]:
    """The writes ``(address, data)`` of each bank in its turn; a ``Program`` has one."""
    if not isinstance(program, ExactProgram):
        as_kind("program", program, Program)
    found = []
    for n, writes in enumerate(program.batches()):
        words = (*writes, close_load(writes, n & 1))
        found.append([])
        for space, index, data in words:
            low, high = data & 0xFFFFFFFF, data >> 32 & 0xFFFFFFFF
            found[-1] += [(LOAD_LOW, low), (LOAD_HIGH, high), (LOAD_AT, space << 10 | index)]
    return found


def simulate_path(program: Program | ExactProgram, *, arrangement="cached", watch=False) -> Run:
    """Run a program in the simulated ``nurbs_interpolator``.

    Parameters
    ----------
    program : Program or ExactProgram
        Of ``build_program`` or ``build_exact_program``; the latter has no arrangement.
    arrangement : {'cached', 'parallel', 'serial'}
    watch : bool
        Record which unit works in which cycle: ``Run.work``.
    """
    as_choice("arrangement", arrangement, ARRANGEMENTS)
    first, *later = batch_writes(program)
    shape = {"WORD": program.format.word, "DIM": program.dim, "SLOPE": int(isinstance(program, ExactProgram))}
    lines = simulate(
        "path_watch" if as_flag("watch", watch) else "path_run",
        shape | {"ARRANGEMENT": ARRANGEMENTS[arrangement]},
        writes=[f"{at:x} {data:x}" for at, data in [(CONTROL, FORGET), *first, (CONTROL, GO)]],
        later=[f"{at:x} {data:x}" for at, data in chain.from_iterable(later)],
    )
    busy = [line.split()[1:] for line in lines if line.startswith("busy")]
    *beats, end = (line.split() for line in lines if not line.startswith("busy"))
    beats = [beat for beat in beats if beat[2] == "0"]  # a void beat is no point
    rows = [split_words(int(beat[3], 16), 40, program.dim + 1) for beat in beats]
    status, cycles = (int(value, 16) for value in end)
    return Run(
        u=[row[0] & (1 << 40) - 1 for row in rows],  # never negative
        points=[tuple(row[1:]) for row in rows],
        clocks=[int(clock) for clock, *_ in beats],
        flags=tuple(name for bit, name in FAULTS.items() if status >> bit & 1),
        cycles=cycles,
        outputs=[int(beat[4]) for beat in beats],
        work=[(int(cycle), unit, int(row)) for cycle, unit, row in busy],
    )


def _run(job, *, slope="quotient", format: Format = SHIPPED):
    if slope == "exact":
        program = build_exact_program(job.curve, job.feed, job.period_s, format=format)
    else:
        program = build_program(job.curve, job.feed, job.period_s, job.last_step, format=format)
    run = simulate_path(program)
    if run.flags:
        period = "longer" if "by_zero" in run.flags else "shorter"
        cure = f"a {period} period" + (" or slope='exact'" if slope == "quotient" else "") + " may pass it"
        raise ValueError(f"the hardware stopped after {len(run.u)} points: {', '.join(run.flags)}; {cure}")
    details = {"cycles": np.diff(run.clocks, prepend=0)[:-1], "total_cycles": run.cycles}
    steps = len(run.u) - 1  # the first three after the start take six more points, by Runge-Kutta
    evaluations = (steps + 1, steps) if slope == "exact" else (steps + 6 * min(steps, STARTED) - 5, 0)
    return steps_of_run(program, job.curve, run, evaluations, details)


def steps_of_run(program, curve, run, evaluations, details):
    """What a run of a program did along its curve."""
    u = program.from_positions(run.u)
    points = np.ldexp(np.array(run.points, float), -program.point_fraction)[:, : curve.dim]
    if isinstance(program, ExactProgram) and (curve.rational or curve.degree > 3):
        for _ in range(20):  # the pieces only lie near the curve; beside weights of 1/1000 it takes 11
            slopes = curve.derivative(u)
            u += np.sum((points - curve(u)) * slopes, axis=1) / np.sum(slopes**2, axis=1)
            u = np.clip(u, *curve.domain)
    u[0], u[-1] = curve.domain  # which are exact
    return Steps(u, (*evaluations, 0, 0), points, details)


register(
    Stepper(
        "rtl",
        "the paper's scheme in the simulated Verilog",
        (1, 0, 0, 0),
        _run,
        options=(
            Option("slope", str, "quotient", ("quotient", "exact"), "Eq. (16), or the exact machine"),
            Option("format", Format, SHIPPED, (), "word lengths"),
        ),
    )
)


def load_host():
    """The module rtl/boards/host.py: `Machine`, `Simulation`, and what the board speaks."""
    package = "nurbs_lab_board"
    sys.modules.setdefault(package, ModuleType(package)).__path__ = [str(rtl_folder() / "boards")]
    return import_module(f"{package}.host")


def _run_board(job, *, port="", steps_per_mm=400.0):
    curve = job.curve
    points = np.pad(curve.control_points, ((0, 0), (0, 3 - curve.dim)))
    space = NurbsCurve(curve.degree, curve.knots, points, curve.weights)
    program = build_exact_program(space, job.feed, job.period_s)
    with load_host().Machine(port, steps_per_mm=steps_per_mm) as machine:
        *_, status = machine.run(program, job.period_s)
    run = run_exact(program)
    return steps_of_run(program, curve, run, (len(run.u), len(run.u) - 1), {"steps": status.steps})


register(
    Stepper(
        "board",
        "exact slopes on a Colorlight i5, behind a serial port",
        (1, 1, 0, 0),
        _run_board,
        options=(
            Option("port", str, "", (), "serial port of the board, such as '/dev/ttyACM0'"),
            Option("steps_per_mm", float, 400.0, (1e-6, 1e9), "steps of each axis per mm"),
        ),
    )
)
