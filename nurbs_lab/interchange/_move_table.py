"""The moves of a long program as columns; a row becomes a `Move` when it is asked for."""

from collections.abc import Sequence

import numpy as np

from nurbs_lab.interchange._arcs import arc_curve
from nurbs_lab.machining.program import Move
from nurbs_lab.nurbs import NurbsCurve

RAPID, CUT = 0, 1
NO_FEED = 0.0


class MoveTable(Sequence):
    """Moves by column.

    Attributes
    ----------
    kinds, feeds, lines : ndarray, shape (n,)
        RAPID or CUT; mm/s, NO_FEED of rapid moves; lines of the file, counted from 1, 0 where there is none.
    starts, ends : ndarray, shape (n, 3)
        In mm.
    curves : mapping of int to callable or tuple
        What makes the curve of a move that is not straight, by the index of the move; or of an arc, what
        `arc_curve` needs beside its ends.
    """

    def __init__(self, kinds, starts, ends, feeds, lines, curves):
        self.kinds, self.starts, self.ends, self.feeds, self.lines = map(
            np.array, (kinds, starts, ends, feeds, lines)
        )
        self.curves = curves
        for column in (self.kinds, self.starts, self.ends, self.feeds, self.lines):
            column.setflags(write=False)

    def __len__(self):
        return len(self.kinds)

    def __getitem__(self, index):
        if isinstance(index, slice):
            return tuple(self[i] for i in range(*index.indices(len(self))))
        i = range(len(self))[index]
        made = self.curves.get(i, line)
        if isinstance(made, tuple):
            curve = arc_curve(self.starts[i], self.ends[i], *made)
        else:
            curve = line(self.starts[i], self.ends[i]) if made is line else made()
        kind = ("rapid", "cut")[self.kinds[i]]
        return Move(kind, curve, float(self.feeds[i]) or None, int(self.lines[i]) or None)


def line(*points):
    """The polyline through points as a curve of degree 1, its knots at the numbers of the points."""
    inner = np.arange(len(points), dtype=float)
    return NurbsCurve(1, np.r_[0.0, inner, inner[-1]], np.array(points))
