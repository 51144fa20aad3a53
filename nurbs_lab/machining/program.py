"""A milling program: its moves in order, each a curve of the cutter's tip."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from nurbs_lab.common.checks import as_choice, as_count, as_kind, as_positive
from nurbs_lab.common.progress import bar
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.motion import FeedProfile, Limits, plan_program
from nurbs_lab.nurbs import NurbsCurve

TOGETHER_MM = 1e-9
#: A small milling machine; without a limit of jerk, planning is about five times faster.
MACHINE = Limits(speed=200.0, acceleration=2000.0, jerk=50_000.0, chord_error=1e-3)
KINDS = ("rapid", "plunge", "cut", "link")


@dataclass(frozen=True, eq=False)
class Move:
    """One move of a program.

    Attributes
    ----------
    kind : {"rapid", "plunge", "cut", "link"}
        Rapid traverse; down in material; cutting; up from a cut, or down to one where no material is.
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


@dataclass(frozen=True, eq=False)
class Program:
    """Moves of a cutter, in order.

    Attributes
    ----------
    moves : sequence of Move
        A tuple, or for a program read from a file a sequence that makes each move on demand.
    cutter : Cutter or None
        None for a program read from a file that does not name one.
    machine : Limits
        Of the motion, with which the time is computed; ``speed`` is that of rapid moves.
    tolerance : float
        Largest distance of the cutting moves from the exact path, in mm.
    stock : block (2, 3), Simulation, Part or None
        What it was planned to be cut from, if that is known.
    warnings : tuple of str
        What was found wrong when it was planned, such as contacts of the shank with the stock.
    after : Program or None
        Cut before this one, if it was planned with one.
    """

    moves: Sequence[Move]
    cutter: Cutter | None = None
    machine: Limits = MACHINE
    tolerance: float = 1e-3
    stock: object = None
    warnings: tuple[str, ...] = ()
    after: "Program | None" = None

    def __post_init__(self):
        if not isinstance(self.moves, Sequence) or isinstance(self.moves, (str, bytes)):
            raise TypeError(f"moves must be a sequence of Move, got {type(self.moves).__name__}")
        moves = self.moves
        if isinstance(moves, (tuple, list)):
            moves = tuple(as_kind("moves", move, Move) for move in moves)
        if self.cutter is not None:
            as_kind("cutter", self.cutter, Cutter)
        as_kind("machine", self.machine, Limits)
        object.__setattr__(self, "moves", moves)
        object.__setattr__(self, "tolerance", as_positive("tolerance", self.tolerance))

    def __repr__(self):
        kinds = ", ".join(f"{sum(move.kind == kind for move in self.moves)} {kind}" for kind in KINDS)
        return f"Program({len(self.moves)} moves: {kinds})"

    def require_cutter(self, name="program"):
        """Refuse a program that names no cutter."""
        if self.cutter is None:
            raise ValueError(f"{name} names no cutter; give it one: dataclasses.replace({name}, cutter=...)")

    @property
    def chain(self) -> list["Program"]:
        """The programs that were cut before this one, and this one at last."""
        return [*([] if self.after is None else self.after.chain), self]

    @property
    def curves(self) -> tuple[NurbsCurve, ...]:
        """The cutting moves."""
        return tuple(move.curve for move in self.moves if move.kind == "cut")

    @cached_property
    def feeds(self) -> tuple[FeedProfile, ...]:
        """The feed of every move, planned as one motion: corners are passed as fast as the machine allows."""
        machine = self.machine
        curves = bar([move.curve for move in self.moves], len(self.moves), "planning the feed", " moves")
        speeds = [move.feed or machine.speed for move in self.moves]
        return tuple(plan_program(curves, machine, speeds=speeds))

    @property
    def time_s(self) -> float:
        """Time of all moves, in s, without dwells and changes of the tool."""
        return sum(feed.duration for feed in self.feeds)
