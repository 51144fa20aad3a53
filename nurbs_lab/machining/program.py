"""A milling program: its moves in order, each a curve of the cutter's tip."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np

from nurbs_lab.common.checks import as_choice, as_count, as_kind, as_positive
from nurbs_lab.common.progress import bar
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.motion import FeedProfile, ToolPath, plan_feed, trace
from nurbs_lab.nurbs import NurbsCurve
from nurbs_lab.nurbs.curve import trusted_curve

STRAIGHT = 1e-6  # radians: a corner that is none
TOGETHER_MM = 1e-9
KINDS = ("rapid", "plunge", "cut", "link")


@dataclass(frozen=True, eq=False)
class Move:
    """One move of a program.

    Attributes
    ----------
    kind : {"rapid", "plunge", "cut", "link"}
        Rapid traverse; down to the part; cutting; between two cuts at their feed.
    curve : NurbsCurve
        Path of the tip in space, in mm. It begins where the move before it ends.
    feed : float or None
        Largest speed along the curve, in mm/s; None for a rapid move at the machine's own speed.
    line : int or None
        Number of the line that the move was read from, counted from 1.
    """

    kind: str
    curve: NurbsCurve
    feed: float | None
    line: int | None = None

    def __post_init__(self):
        as_choice("kind", self.kind, KINDS)
        as_kind("curve", self.curve, NurbsCurve)
        if self.curve.control_points.shape[1] != 3:
            raise ValueError(
                f"curve must have three coordinates, got {self.curve.control_points.shape[1]}; "
                "lift it into space by its transform"
            )
        if self.feed is not None or self.kind != "rapid":
            object.__setattr__(self, "feed", as_positive("feed", self.feed))
        if self.line is not None:
            object.__setattr__(self, "line", as_count("line", self.line, 1))


@dataclass(frozen=True)
class Feeds:
    """Feeds by kind of move; `finish` and `rough` also take one number, that of cuts.

    Attributes
    ----------
    cut : float
        Of cuts, in mm/s.
    plunge : float, optional
        Of ramps into the material; a third of that of cuts by default.
    link : float, optional
        Of links in the air; that of cuts by default.
    ramp_angle : float
        Steepest angle of a ramp, in radians.
    """

    cut: float = 50.0
    plunge: float | None = None
    link: float | None = None
    ramp_angle: float = math.radians(5.0)

    def __post_init__(self):
        cut = as_positive("feed", self.cut)
        usual = {"cut": cut, "plunge": cut / 3.0, "link": cut, "ramp_angle": self.ramp_angle}
        for name, value in usual.items():
            given = getattr(self, name)
            object.__setattr__(self, name, value if given is None else as_positive(name, given))
        if not self.ramp_angle < math.pi / 2:
            raise ValueError(f"ramp_angle must be below a right angle, got {self.ramp_angle} radians")


def as_feeds(feed) -> Feeds:
    """Feeds from one number, that of cuts, or as they are."""
    return feed if isinstance(feed, Feeds) else Feeds(as_positive("feed", feed))


@dataclass(frozen=True)
class Machine:
    """Limits of a machine's motion.

    Attributes
    ----------
    rapid_speed : float
        Of rapid moves, in mm/s.
    acceleration : float
        Along the path and across it, in mm/s².
    jerk : float or None
        Along the path, in mm/s³; None for no limit, with which planning is about five times faster.
    chord_error : float
        In mm.
    period_s : float
        Of the interpolator, in s.
    """

    rapid_speed: float = 200.0
    acceleration: float = 2000.0
    jerk: float | None = 50_000.0
    chord_error: float = 1e-3
    period_s: float = 1e-3

    def __post_init__(self):
        for name in ("rapid_speed", "acceleration", "jerk", "chord_error", "period_s"):
            if name == "jerk" and self.jerk is None:
                continue
            object.__setattr__(self, name, as_positive(name, getattr(self, name)))


@dataclass(frozen=True, eq=False)
class Program:
    """Moves of a cutter, in order.

    Attributes
    ----------
    moves : sequence of Move
        A tuple, or for a program read from a file a sequence that makes each move on demand.
    cutter : Cutter or None
        None for a program read from a file that does not name one.
    machine : Machine
        Limits of the motion, with which the time is computed.
    tolerance : float
        Largest distance of the cutting moves from the exact path, in mm.
    stock : block (2, 3), Simulation, Part or None
        What it was planned to be cut from, if that is known.
    warnings : tuple of str
        What was found wrong when it was planned, such as contacts of the shank with the stock.
    """

    moves: Sequence[Move]
    cutter: Cutter | None = None
    machine: Machine = Machine()
    tolerance: float = 1e-3
    stock: object = None
    warnings: tuple[str, ...] = ()

    def __post_init__(self):
        if not isinstance(self.moves, Sequence) or isinstance(self.moves, (str, bytes)):
            raise TypeError(f"moves must be a sequence of Move, got {type(self.moves).__name__}")
        moves = self.moves
        if isinstance(moves, (tuple, list)):
            moves = tuple(as_kind("moves", move, Move) for move in moves)
        if self.cutter is not None:
            as_kind("cutter", self.cutter, Cutter)
        as_kind("machine", self.machine, Machine)
        object.__setattr__(self, "moves", moves)
        object.__setattr__(self, "tolerance", as_positive("tolerance", self.tolerance))

    def __repr__(self):
        kinds = ", ".join(f"{sum(move.kind == kind for move in self.moves)} {kind}" for kind in KINDS)
        return f"Program({len(self.moves)} moves: {kinds})"

    @property
    def curves(self) -> tuple[NurbsCurve, ...]:
        """The cutting moves."""
        return tuple(move.curve for move in self.moves if move.kind == "cut")

    @cached_property
    def chains(self) -> tuple[tuple[NurbsCurve, float], ...]:
        """Successive moves without a corner between them, joined to one curve, with its largest speed."""
        chains = []
        for move in self.moves:
            last = chains[-1][-1] if chains else move
            same = last is not move and last.feed == move.feed and "rapid" not in (last.kind, move.kind)
            if same and runs_on(last.curve, move.curve):
                chains[-1].append(move)
            else:
                chains.append([move])
        pace = self.machine.rapid_speed
        curves = (reduce(join_smoothly, [move.curve for move in chain]) for chain in chains)
        return tuple(zip(curves, [min(move.feed or pace for move in chain) for chain in chains], strict=True))

    @cached_property
    def feeds(self) -> tuple[FeedProfile, ...]:
        """The feed of every chain, from rest to rest."""
        machine = self.machine
        limits = {"jerk": machine.jerk, "chord_error": machine.chord_error, "period_s": machine.period_s}
        limits |= dict.fromkeys(("acceleration", "centripetal_acceleration"), machine.acceleration)
        chains = bar(self.chains, len(self.chains), "planning the feed", " chains")
        return tuple(plan_feed(curve, speed=speed, **limits) for curve, speed in chains)

    @property
    def time_s(self) -> float:
        """Time of all moves, in s."""
        return sum(feed.duration for feed in self.feeds)

    def trace(self, stepper="adams") -> tuple[ToolPath, ...]:
        """The tool path of every chain, by any stepper."""
        pairs = zip(self.chains, self.feeds, strict=True)
        return tuple(trace(curve, feed, stepper=stepper) for (curve, _), feed in pairs)


def runs_on(before, after) -> bool:
    """Whether a curve goes on in the direction in which the one before it ends."""
    first, then = before.control_points, after.control_points
    one, two = first[-1] - first[-2], then[1] - then[0]
    turn = np.linalg.norm(np.cross(one, two))
    straight = turn <= STRAIGHT * np.linalg.norm(one) * np.linalg.norm(two) and one @ two > 0.0
    return straight and np.linalg.norm(then[0] - first[-1]) < TOGETHER_MM


def join_smoothly(before, after) -> NurbsCurve:
    """One curve through both; its derivative is continuous where they meet, if `can_join_smoothly`.

    The parameter of the second is scaled such that their common control point lies between its neighbours as
    the knots ask for. So this point is not needed.
    """
    if not can_join_smoothly(before, after):
        return before.join(after)
    p, first, then = before.degree, before.control_points, after.control_points
    reach = (before.knots[-1] - before.knots[-p - 2]) * math.dist(then[0], then[1])
    scale = reach / math.dist(first[-1], first[-2]) / (after.knots[p + 1] - after.knots[0])
    knots = before.knots[-1] + scale * (after.knots[p + 1 :] - after.knots[0])
    return trusted_curve(p, np.concatenate([before.knots[:-2], knots]), np.vstack([first[:-1], then[1:]]))


def can_join_smoothly(before, after) -> bool:
    """Whether both are polynomial, clamped and of one degree above 1."""
    p = before.degree
    same = p == after.degree > 1 and not (before.rational or after.rational)
    return same and before.knots[-p - 1] == before.knots[-1] and after.knots[0] == after.knots[p]
