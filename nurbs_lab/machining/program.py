"""A milling program: its moves in order, each a curve of the cutter's tip."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from nurbs_lab.common.checks import as_choice, as_count, as_kind, as_positive
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.motion import FeedProfile, plan_feed
from nurbs_lab.nurbs import NurbsCurve

KINDS = ("rapid", "plunge", "cut", "link")


@dataclass(frozen=True, eq=False)
class Move:
    """One move of a program.

    Attributes
    ----------
    kind : {"rapid", "plunge", "cut", "link"}
        Through the air at the machine's pace; down to the part; in the part; between two cuts at their feed.
    curve : NurbsCurve
        Way of the tip, three coordinates, in mm. It begins where the move before it ends.
    feed : float or None
        Largest speed along the curve, in mm/s; None for a rapid move at whatever pace the machine has.
    line : int or None
        Of the file that the move was read from, counted from 1.
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
            as_count("line", self.line, 1)


@dataclass(frozen=True)
class Machine:
    """Limits of a machine's motion.

    Attributes
    ----------
    rapid_speed : float
        In the air, in mm/s.
    acceleration : float
        Of every axis, in mm/s².
    jerk : float
        Along the path, in mm/s³.
    chord_error : float
        In mm.
    period_s : float
        Of the interpolator, in s.
    """

    rapid_speed: float = 200.0
    acceleration: float = 2000.0
    jerk: float = 50_000.0
    chord_error: float = 1e-3
    period_s: float = 1e-3

    def __post_init__(self):
        for name in ("rapid_speed", "acceleration", "jerk", "chord_error", "period_s"):
            object.__setattr__(self, name, as_positive(name, getattr(self, name)))


@dataclass(frozen=True, eq=False)
class Program:
    """Moves of a cutter, in order.

    Attributes
    ----------
    moves : sequence of Move
        A tuple; of a program read from a file, a sequence that makes each move when it is asked for.
    cutter : Cutter or None
        None where a program was read from a file that does not say.
    machine : Machine
        Limits of the motion that its time is reckoned with.
    tolerance : float
        Largest distance of the cutting moves from the exact path, in mm.
    """

    moves: Sequence[Move]
    cutter: Cutter | None = None
    machine: Machine = Machine()
    tolerance: float = 1e-3

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
    def feeds(self) -> tuple[FeedProfile, ...]:
        """The feed of every move, planned from rest to rest."""
        return tuple(self._planned(move) for move in self.moves)

    @property
    def time_s(self) -> float:
        """Time of all moves, in s."""
        return sum(feed.duration for feed in self.feeds)

    def _planned(self, move):
        machine = self.machine
        return plan_feed(
            move.curve,
            speed=move.feed or machine.rapid_speed,
            acceleration=machine.acceleration,
            jerk=machine.jerk,
            chord_error=machine.chord_error,
            axis_acceleration=machine.acceleration,
            period_s=machine.period_s,
        )
