"""The sampled tool path and its error figures."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from nurbs_lab.common.checks import as_floats
from nurbs_lab.common.values import Value
from nurbs_lab.motion.feed import FeedProfile
from nurbs_lab.nurbs import NurbsCurve


@dataclass(frozen=True, eq=False)
class ToolPath(Value):
    """Where the tool is at the end of every period, and how well that follows the command.

    Step j leads from sample j to sample j + 1; n steps, n + 1 samples. The last sample is exactly the end
    of the curve, and the last step is commanded what was left to go. Fluctuations are relative
    (0.01 = 1 %), signed, and compare with the *displacement* commanded for the period, s(t_{j+1}) - s(t_j).

    Attributes
    ----------
    curve : NurbsCurve
    feed : FeedProfile
    stepper : str
    period_s : float
    t : ndarray, shape (n + 1,)
        Ends of the periods, in s.
    u : ndarray, shape (n + 1,)
    points : ndarray, shape (n + 1, dim)
        In mm.
    commanded : ndarray, shape (n,)
        Length commanded for each step, in mm.
    moved : ndarray, shape (n,)
        True arc length of each step, in mm.
    chord : ndarray, shape (n,)
        Straight distance of each step, in mm.
    chord_error : ndarray, shape (n,)
        Bow height: largest distance between the chord and its arc, in mm (to about 1e-4 of itself).
    lag : ndarray, shape (n,)
        Commanded minus true travelled length before each step, in mm: the error that piles up.
    arrival_time : float
        When the tool reaches the end, in s; inside the last period.
    evaluations_by_order : ndarray, shape (4,)
        How often C, C', C'' and C''' were evaluated in the whole run.
    details : mapping
        What else the stepper measured, such as clock cycles.
    """

    curve: NurbsCurve
    feed: FeedProfile
    stepper: str
    period_s: float
    t: np.ndarray
    u: np.ndarray
    points: np.ndarray
    commanded: np.ndarray
    moved: np.ndarray
    chord: np.ndarray
    chord_error: np.ndarray
    lag: np.ndarray
    arrival_time: float
    evaluations_by_order: np.ndarray
    details: Mapping = field(default_factory=dict)

    def __post_init__(self):
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def __len__(self):
        return len(self.u)

    def __repr__(self):
        return (
            f"ToolPath({self.stepper}, {len(self.moved)} steps of {self.period_s:g} s, "
            f"largest fluctuation {np.abs(self.arc_fluctuation).max():.2e} by arc, "
            f"{np.abs(self.chord_fluctuation).max():.2e} by chord)"
        )

    @property
    def length(self):
        """Length of the curve, in mm."""
        return float(self.moved.sum())

    @cached_property
    def arc_fluctuation(self):
        """Relative error of the arc length of each step, shape (n,); 0 during a hold."""
        return self._relative(self.moved)

    @cached_property
    def chord_fluctuation(self):
        """Relative error of the chord of each step, shape (n,). Even a perfect arc shows -(κ v T)²/24."""
        fluctuation = self._relative(self.chord)
        fluctuation[-1] = 0.0
        return fluctuation

    def _relative(self, made):
        moving = self.commanded > 0.0
        return np.divide(made, self.commanded, out=np.ones_like(made), where=moving) - 1.0

    @property
    def evaluations(self):
        """Evaluations of C and of its derivatives together, in the whole run."""
        return int(self.evaluations_by_order.sum())

    @property
    def evaluations_with_output(self):
        """The same, with C for the points that move the tool charged where the rule does not evaluate it."""
        points, *derivatives = self.evaluations_by_order
        return int(max(points, len(self.moved)) + sum(derivatives))

    @property
    def final_lag(self):
        """Length by which the tool was late (or, negative, early) when the last step began, in mm."""
        return float(self.lag[-1])

    @cached_property
    def knot_steps(self):
        """Whether a knot lies inside each step, shape (n,)."""
        knots = np.unique(self.curve.knots)
        return np.searchsorted(knots, self.u[:-1], side="right") < np.searchsorted(knots, self.u[1:])

    def by_span(self, fluctuation=None):
        """Figures of each span: an array with fields ``start``, ``stop``, ``steps``, ``largest``, ``rms``.

        Steps that cross a knot belong to the span in which they begin.

        Parameters
        ----------
        fluctuation : ndarray, shape (n,), optional
            ``arc_fluctuation`` if left out.
        """
        values = (
            self.arc_fluctuation if fluctuation is None else as_floats("fluctuation", fluctuation, ("n",))
        )
        if len(values) != len(self.moved):
            raise ValueError(f"fluctuation must have one entry a step, {len(self.moved)}, got {len(values)}")
        values = np.abs(values)
        low, high = self.u[0], self.u[-1]
        knots = np.unique(np.clip(self.curve.knots, low, high))
        span = np.searchsorted(knots, self.u[:-1], side="right") - 1
        rows = []
        for i in range(len(knots) - 1):
            mine = values[span == i]
            figures = (mine.max(), np.sqrt(np.mean(mine**2))) if mine.size else (0.0, 0.0)
            rows.append((knots[i], knots[i + 1], mine.size, *figures))
        kinds = [("start", float), ("stop", float), ("steps", int), ("largest", float), ("rms", float)]
        return np.array(rows, dtype=kinds)
