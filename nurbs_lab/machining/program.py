"""A milling program: its moves in order, each a curve of the cutter's tip."""

from dataclasses import dataclass

from nurbs_lab.common.checks import as_choice, as_kind, as_positive
from nurbs_lab.machining.cutter import Cutter
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
    feed : float
        Largest speed along the curve, in mm/s.
    """

    kind: str
    curve: NurbsCurve
    feed: float

    def __post_init__(self):
        as_choice("kind", self.kind, KINDS)
        as_kind("curve", self.curve, NurbsCurve)
        if self.curve.control_points.shape[1] != 3:
            raise ValueError(
                f"curve must have three coordinates, got {self.curve.control_points.shape[1]}; "
                "lift it into space by its transform"
            )
        object.__setattr__(self, "feed", as_positive("feed", self.feed))


@dataclass(frozen=True, eq=False)
class Program:
    """Moves of a cutter, in order.

    Attributes
    ----------
    moves : tuple of Move
    cutter : Cutter or None
        None where a program was read from a file that does not say.
    """

    moves: tuple[Move, ...]
    cutter: Cutter | None = None

    @property
    def curves(self) -> tuple[NurbsCurve, ...]:
        """The cutting moves."""
        return tuple(move.curve for move in self.moves if move.kind == "cut")
