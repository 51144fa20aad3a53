"""The stepper 'rtl': the whole path made by the simulated Verilog."""

from typing import NamedTuple

import numpy as np

from nurbs_lab.common.checks import as_choice, as_count, as_kind
from nurbs_lab.hardware.feed import load_feed
from nurbs_lab.hardware.formats import SHIPPED, Format
from nurbs_lab.hardware.loader import load_curve
from nurbs_lab.hardware.simulation import simulate, split_words
from nurbs_lab.hardware.stepper import Program, first_slope
from nurbs_lab.motion import Option, Stepper, Steps, register

#: Name -> parameter ARRANGEMENT of rtl/adams.v.
ARRANGEMENTS = {"serial": 0, "parallel": 1, "cached": 2}
#: Name -> parameter HISTORY of rtl/adams.v.
SLOPES = {"quotient": 0, "history": 1}
#: Registers of rtl/nurbs_interpolator.v.
CONTROL, STATUS, LOAD_LOW, LOAD_HIGH, LOAD_AT, CYCLES = range(0, 24, 4)
#: Bit of STATUS -> what went wrong.
FAULTS = {8: "overflow", 9: "by_zero", 10: "backward", 11: "bad curve"}


class PathRun(NamedTuple):
    """What the simulated module ``nurbs_interpolator`` sent, in integers."""

    u: list
    points: list
    #: Clock at which each point left, counted from the last write.
    clocks: list
    flags: tuple
    #: Clocks of the whole run, counted by the hardware.
    cycles: int


def build_program(curve, feed, period_s, periods, *, trials=0, format: Format = SHIPPED) -> Program:
    """What to load for a curve and a feed; see ``load_curve`` and ``load_feed`` for what is refused."""
    trials = as_count("trials", trials, 0, 7)
    loaded = load_curve(curve, format)
    du, chord = first_slope(curve, loaded)
    return Program(
        loaded, load_feed(feed, period_s, periods, loaded.point_fraction, format), du, chord, trials
    )


def register_writes(program: Program) -> list[tuple[int, int]]:
    """The program as writes ``(address, data)`` to the registers, the last of which starts the run."""
    found = []
    for space, index, data in program.writes():
        low, high = data & 0xFFFFFFFF, data >> 32 & 0xFFFFFFFF
        found += [(LOAD_LOW, low), (LOAD_HIGH, high), (LOAD_AT, space << 10 | index)]
    return [(CONTROL, 2), *found, (CONTROL, 1)]


def simulate_path(program: Program, *, arrangement="cached", slope="quotient") -> PathRun:
    """Run a program in the simulated ``nurbs_interpolator``.

    Parameters
    ----------
    program : Program
    arrangement : {'cached', 'parallel', 'serial'}
    slope : {'quotient', 'history'}
        'history' keeps points, so it exists only 'cached'.
    """
    as_kind("program", program, Program)
    as_choice("arrangement", arrangement, ARRANGEMENTS)
    as_choice("slope", slope, SLOPES)
    if slope == "history" and arrangement != "cached":
        raise ValueError(
            f"slope 'history' keeps points, so arrangement must be 'cached', got {arrangement!r}"
        )
    format, dim = program.curve.format, program.curve.dim
    lines = simulate(
        "path_run",
        {
            "WORD": format.word,
            "DIM": dim,
            "ARRANGEMENT": ARRANGEMENTS[arrangement],
            "HISTORY": SLOPES[slope],
        },
        writes=[f"{address:x} {data:x}" for address, data in register_writes(program)],
    )
    *beats, end = (line.split() for line in lines)
    rows = [split_words(int(data, 16), 40, dim + 1) for _, _, data in beats]
    status, cycles = (int(value, 16) for value in end)
    return PathRun(
        u=[row[0] for row in rows],
        points=[tuple(row[1:]) for row in rows],
        clocks=[int(clock) for clock, _, _ in beats],
        flags=tuple(name for bit, name in FAULTS.items() if status >> bit & 1),
        cycles=cycles,
    )


def _run(job, *, arrangement="cached", slope="quotient", trials=0, format: Format = SHIPPED):
    plan = build_program(job.curve, job.feed, job.period_s, job.last_step, trials=trials, format=format)
    run = simulate_path(plan, arrangement=arrangement, slope=slope)
    u = plan.curve.from_u(run.u)
    if run.flags or run.u[-1] != plan.curve.last_u:
        raise ValueError(
            f"the hardware stopped at u = {u[-1]:.9g} with {', '.join(run.flags) or 'no flag'}; "
            "a shorter period may pass there"
        )
    # The ends of the domain are exact; so are all points, which have fewer bits than a float.
    u[0], u[-1] = job.curve.domain
    details = {
        "arrangement": arrangement,
        "slope": slope,
        "cycles": np.diff(run.clocks, prepend=0)[:-1],
        "total_cycles": run.cycles,
        "points": plan.curve.from_points(run.points),
    }
    return Steps(u, (_evaluations(len(u) - 1, arrangement, trials), 0, 0, 0), details["points"], details)


def _evaluations(steps, arrangement, trials):
    """How often C is evaluated: in the first step once, in three more by Runge-Kutta, then by Adams."""
    cached = arrangement == "cached"
    started = min(steps, 4)
    runge_kutta = 1 + (started - 1) * (7 if cached else 8)
    return runge_kutta + (steps - started) * (1 if cached else 8) + steps * trials + 1


register(
    Stepper(
        "rtl",
        "the paper's scheme in the simulated Verilog",
        (1, 0, 0, 0),
        _run,
        options=(
            Option("arrangement", str, "cached", tuple(ARRANGEMENTS), "which modules there are"),
            Option("slope", str, "quotient", tuple(SLOPES), "Eq. (16), or differences of the stored points"),
            Option("trials", int, 0, (0, 7), "points tried by the corrector in a step"),
            Option("format", Format, Format(), (), "word lengths"),
        ),
    )
)
