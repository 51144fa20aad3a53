"""Twin of rtl/stepper.v: the whole run in integers. The arrangement does not matter: all give these bits."""

from dataclasses import dataclass, field
from itertools import islice
from math import frexp

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind, as_positive
from nurbs_lab.hardware.arithmetic import divide, round_shift, square_root
from nurbs_lab.hardware.cu import LoadedCurve, evaluate_cu
from nurbs_lab.hardware.feed import LoadedFeed

#: Numerators of Eqs. (17) and (20) over 24, the latest slope first.
ADAMS, RUNGE_KUTTA = (55, -59, 37, -9), (4, 8, 8, 4)
#: Steps by Runge-Kutta before Adams takes over.
STARTED = 4


class Fault(ArithmeticError):
    """A flag of the hardware, by its name."""


@dataclass(frozen=True)
class Program:
    """All that the hardware is loaded with for one run."""

    curve: LoadedCurve
    feed: LoadedFeed
    #: The first slope stands for |C'| at the start: ``first_chord / first_du``.
    first_du: int
    first_chord: int
    #: Largest step of an axis between two points.
    largest_step: int
    #: Lowest and highest coordinate of each axis.
    axis_limits: tuple

    format = property(lambda self: self.curve.format)
    dim = property(lambda self: self.curve.dim)
    point_fraction = property(lambda self: self.curve.point_fraction)

    def from_positions(self, positions) -> np.ndarray:
        """Parameters of the curve."""
        return self.curve.from_u(positions)

    def batches(self) -> list[list[tuple[int, int, int]]]:
        """What to put on the load bus for the only bank: ``(space, index, data)``."""
        first = [(5, 2, self.first_du), (5, 3, self.first_chord)]
        return [[*self.curve.writes(), *self.feed.writes(), *first, *limit_writes(self)]]


@dataclass(frozen=True)
class Run:
    """What a machine sent in integers, and its flags; where a flag stops a run, one more beat is void."""

    u: list = field(default_factory=list)
    points: list = field(default_factory=list)
    flags: tuple = ()
    #: Bits of the piece that come with each point, from the exact machine.
    outputs: list = field(default_factory=list)
    #: Of the simulated Verilog: cycle in which each point left, from the last write on; cycles of the run.
    clocks: list = field(default_factory=list)
    cycles: int = 0
    #: Of a watched run: (cycle, unit, row) for each cycle in which a unit works.
    work: list = field(default_factory=list)


#: Largest step of an axis if the caller gives none, as a multiple of what a period moves at the peak.
_STEP_MARGIN = 1.5


def loaded_limits(dim, moved, largest_step, axis_limits, point_fraction, format):
    """Largest step and axis limits in integers; ``moved`` is what a period moves at most, in mm."""
    unit = 2.0**point_fraction
    if largest_step is None:
        step = _STEP_MARGIN * moved * unit + 4
    else:
        step = as_positive("largest_step", largest_step) * unit
    limits = ((-format.largest - 1, format.largest),) * dim
    if axis_limits is not None:
        ends = as_floats("axis_limits", axis_limits, ("dim", "2"))
        if np.shape(ends) != (dim, 2) or np.any(ends[:, 0] > ends[:, 1]):
            raise ValueError(f"axis_limits must be a lowest, then a highest coordinate of {dim} axes")
        words = np.clip(ends * unit, -format.largest - 1, format.largest)
        limits = tuple((int(np.ceil(low)), int(np.floor(high))) for low, high in words)
    return int(np.clip(step, 1, 2 * format.largest + 1)), limits


def limit_writes(program):
    """The limits of a program on the load bus, as rtl/soft_limits.v takes them."""
    limits = [limit for axis in program.axis_limits for limit in axis]
    return [(5, 4, program.largest_step), *((5, 8 + i, limit) for i, limit in enumerate(limits))]


def check_limits(program, here, before):
    """Twin of ``limits``; ``before`` holds the point before, or nothing."""
    axes = range(len(here))
    far = any(abs(here[i] - point[i]) > program.largest_step for point in before for i in axes)
    beyond = any(not low <= here[i] <= high for i, (low, high) in enumerate(program.axis_limits))
    if far or beyond:
        raise Fault(*["too_far"] * far, *["beyond"] * beyond)


def first_slope(curve, loaded: LoadedCurve) -> tuple[int, int]:
    """``du, chord`` in integers whose quotient is |C'| at the start, as large as they fit."""
    fraction = loaded.format.fraction
    speed = float(np.linalg.norm(curve.derivative(curve.domain[0]))) * loaded.knot_scale
    words = speed * 2.0 ** (loaded.point_fraction - fraction)
    shift = max(frexp(words)[1], 0)
    return 1 << (fraction - shift), round(words * 2.0 ** (fraction - shift))


def run_twin(program: Program) -> Run:
    """Run the twin to its last point, or to the first flag."""
    return Twin(as_kind("program", program, Program)).run()


class Twin:
    """The units of the stepper, as methods on integers."""

    def __init__(self, program):
        self.program, self.curve = program, program.curve
        self.format = program.curve.format
        self.axes = range(program.curve.dim)

    def run(self):
        curve, program = self.curve, self.program
        speeds = program.feed.samples()
        s = list(islice(speeds, 3))
        past_u, past_points, past_k = [], [], []
        done, ahead, step = Run(), curve.first_u, 0
        while True:
            last = step and (ahead >= curve.last_u or step == program.feed.periods)
            u = curve.last_u if last else ahead
            try:
                here = self.point(u)
                if not last and step < STARTED:
                    k, ahead = self.runge_kutta(u, here, past_u, past_points, s)
                elif not last:
                    k, ahead = self.adams(u, here, past_u, past_points, past_k, s[0])
                if ahead < u and not last:
                    raise Fault("backward")
                check_limits(program, here, past_points[:1])
            except Fault as fault:
                return Run(done.u, done.points, fault.args)
            done.u.append(u)
            done.points.append(here)
            if last:
                return done
            past_u = [u, *past_u[:3]]
            past_points = [here, *past_points[:3]]
            past_k = [k, *past_k[:2]]
            s = [s[2], *islice(speeds, 2)]
            step += 1

    def runge_kutta(self, u, here, past_u, past_points, s):
        """Fig. 5: the slope at u, and the next u."""
        if not past_u:
            chord = (self.program.first_chord, *[0] * (self.curve.dim - 1))
            slopes = [self.kout(s[i], self.program.first_du, chord) for i in (0, 1, 1, 2)]
        else:
            du = u - past_u[0]
            slopes = [self.kout(s[0], du, self.chord(here, past_points[0]))]
            for factor, distance in ((12, s[1]), (12, s[1]), (24, s[2])):
                a, b = (self.point(self.shifted(end, factor * slopes[-1])) for end in (u, past_u[0]))
                slopes.append(self.kout(distance, du, self.chord(a, b)))
        return slopes[0], self.ui_out(u, RUNGE_KUTTA, slopes)

    def adams(self, u, here, past_u, past_points, past_k, s):
        """Fig. 6: the slope at u, and the next u."""
        k = self.kout(s, u - past_u[0], self.chord(here, past_points[0]))
        return k, self.ui_out(u, ADAMS, (k, *past_k))

    def point(self, u):
        answer = evaluate_cu(self.curve, u)
        if answer.overflow or answer.by_zero:
            raise Fault("overflow" if answer.overflow else "by_zero")
        return answer.point

    def chord(self, a, b):
        found = [a[i] - b[i] for i in self.axes]
        if any(not -self.format.largest - 1 <= x <= self.format.largest for x in found):
            raise Fault("overflow")
        return found

    def kout(self, s, du, chord):
        """Twin of ``kout``."""
        k, overflow, by_zero = divide(s * du, square_root(sum(x * x for x in chord)), self.format.word)
        if overflow or by_zero:
            raise Fault("overflow" if overflow else "by_zero")
        return k

    def shifted(self, u, distance):
        """The adder of ``cuk``."""
        return min(max(u + round_shift(distance, self.format.guard), 0), self.format.largest)

    def ui_out(self, u, factors, slopes):
        """Twin of ``ui_out``."""
        return self.shifted(u, sum(f * k for f, k in zip(factors, slopes, strict=True)))
