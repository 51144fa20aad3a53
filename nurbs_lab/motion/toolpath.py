"""The sampled tool path and its error figures."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from nurbs_lab.common.checks import as_choice, as_flag
from nurbs_lab.common.values import Value
from nurbs_lab.motion.feed import FeedProfile
from nurbs_lab.nurbs import NurbsCurve


@dataclass(frozen=True, eq=False)
class ToolPath(Value):
    """Where the tool is at the end of every period, and how well that follows the command.

    Step j leads from sample j to sample j + 1; n steps, n + 1 samples. The last sample is exactly the end
    of the curve. The last step of a plan that ends at rest is commanded what the plan says, whatever is left
    to go; under a feed that ends moving it is commanded what was left. Fluctuations are relative
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
        Largest distance between the chord and its arc, in mm, found to 1e-4 of itself; up to 2 % too small,
        never too large, where the curve turns sharply within a step.
    lag : ndarray, shape (n,)
        Commanded minus true travelled length before each step, in mm: the error that piles up.
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
    evaluations_by_order: np.ndarray
    details: Mapping = field(default_factory=dict)

    def __len__(self):
        return len(self.u)

    def __repr__(self):
        return (
            f"ToolPath({self.stepper}, {len(self.moved)} steps of {self.period_s:g} s, "
            f"largest fluctuation {np.abs(self.arc_fluctuation).max():.2e} by arc, "
            f"{np.abs(self.chord_fluctuation).max():.2e} by chord)"
        )

    @cached_property
    def arc_fluctuation(self):
        """Relative error of the arc length of each step, shape (n,); 0 during a hold."""
        return self._relative(self.moved)

    @cached_property
    def chord_fluctuation(self):
        """Relative error of the chord of each step, shape (n,). Even a perfect arc shows -(κ v T)²/24."""
        fluctuation = self._relative(self.chord)
        if not self.feed.rests:
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
    def final_lag(self):
        """Length by which the tool was late (or, negative, early) when the last step began, in mm."""
        return float(self.lag[-1])

    @cached_property
    def knot_steps(self):
        """Whether a knot lies inside each step, shape (n,)."""
        knots = np.unique(self.curve.knots)
        return np.searchsorted(knots, self.u[:-1], side="right") < np.searchsorted(knots, self.u[1:])

    @cached_property
    def corner_steps(self):
        """Whether the commanded acceleration jumps inside each step, shape (n,)."""
        times, terms = self.feed.times, self.feed.terms
        lasts = np.diff(times)[:-1]
        before = 2.0 * terms[:-1, 2] + 6.0 * terms[:-1, 3] * lasts
        jumps = np.abs(2.0 * terms[1:, 2] - before) > 1e-6 * np.abs(2.0 * terms[:, 2]).max(initial=0.0)
        corners = times[1:-1][jumps]
        return np.searchsorted(corners, self.t[:-1]) < np.searchsorted(corners, self.t[1:])

    @cached_property
    def undisturbed(self):
        """Whether neither a step nor the eight before it meet a knot or a corner of v(t), shape (n,).

        Four slopes, each from five points, look back over eight periods; no stepper looks back further.
        """
        met = (self.knot_steps | self.corner_steps).astype(int)
        return np.convolve(met, np.ones(9, dtype=int))[: len(met)] == 0

    def statistics(self, metric="arc", *, undisturbed=False):
        """Largest, root-mean-square and 99th percentile of the fluctuation.

        Parameters
        ----------
        metric : {'arc', 'chord'}
        undisturbed : bool
            Only of the steps that are ``undisturbed``, or of all.

        Returns
        -------
        dict
            'max', 'rms' and 'p99' of all steps but the last, NaN of none, and 'last' of that, all relative.
        """
        as_choice("metric", metric, ("arc", "chord"))
        values = np.abs(getattr(self, f"{metric}_fluctuation"))
        last, values = float(values[-1]), values[:-1]  # a feed that ends moving uses a part of the last step
        if as_flag("undisturbed", undisturbed):
            values = values[self.undisturbed[:-1]]
        if not values.size:
            return {"max": np.nan, "rms": np.nan, "p99": np.nan, "last": last}
        rms = float(np.sqrt(np.mean(values**2)))
        return {"max": float(values.max()), "rms": rms, "p99": float(np.percentile(values, 99)), "last": last}
