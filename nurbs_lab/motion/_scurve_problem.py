"""Least time from one stop of a path to the next with limited jerk: the problem and its solution."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.checks import largest
from nurbs_lab.motion import _scurve_kernels

#: The weight of the barrier is multiplied by this from one stage to the next.
FALL = 0.2
#: A stage before the last ends when a Newton step would gain less than this part of the weight a cell.
_NEAR = 0.3
#: From rest to the speeds of the ends: what growing by a part counts beside the room of a cell.
_PULLS = 10.0 ** np.arange(5)
#: Stages at most in which a slowed motion becomes fast, before its ends do.
_STAGES = 3
#: Fields of a `Block` that hold what the limits allow.
LIMITS = "caps", "causes", "along", "across", "steepest", "kappas", "turns", "jerk"
#: Newton steps of a stage at most: one that is cut short leaves the next ones no way to the least time.
STEPS = 1000


@dataclass(frozen=True, eq=False)
class Block:
    """The limits on a grid of lengths; a motion is an array with one ordinate a cell, see `_scurve_kernels`.

    Attributes
    ----------
    nodes : ndarray, shape (n + 1,)
        Lengths, short of a slow end by the phase of constant jerk out of it or into it.
    ends : ndarray, shape (4,)
        v² and its slope at the first node and at the last.
    caps, causes : ndarray, shape (n,)
        Largest v² in every cell, and the name of the limit that says so.
    along, across : ndarray, shape (n + 1, rows)
        ``along * slope + across * v² < 1`` for every row keeps the limits of axes, from both sides of a node.
    steepest, kappas : ndarray, shape (n + 1,)
        ``(slope / 2 / steepest)² + (kappas * v²)² < 1`` keeps the acceleration.
    turns : ndarray, shape (n, rows, 3)
        ``|turns @ (second derivative of v², slope, v²)| v < 1`` keeps the jerks of axes; even rows hold
        at the start of the cell, odd ones at its end.
    jerk : ndarray, shape (n,)
        Largest jerk along the path in every cell.
    speeds : tuple of float
        At both ends, where the acceleration is zero.
    ramp_times : tuple of float
        Durations of the phases of constant jerk out of rest, or nearly rest, and into it; 0 where none is.
    ramp_jerks : tuple of float
        Jerks of these phases.
    parts : ndarray, shape (n,)
        What part of the jerk at its ends a cell takes at most, seen from the limits.
    """

    nodes: np.ndarray
    ends: np.ndarray
    caps: np.ndarray
    causes: np.ndarray
    along: np.ndarray
    across: np.ndarray
    steepest: np.ndarray
    kappas: np.ndarray
    turns: np.ndarray
    jerk: np.ndarray
    speeds: tuple
    ramp_times: tuple
    ramp_jerks: tuple
    parts: np.ndarray

    def squares(self, middle):
        """v² and its slope at the nodes."""
        found = np.empty((2, len(self.nodes)))
        _scurve_kernels.nodal(np.diff(self.nodes), middle, self.ends, *found)
        return found

    def time(self, middle):
        """Duration between the first node and the last."""
        speeds = np.sqrt(self.squares(middle)[0])
        return float(np.sum(2.0 * np.diff(self.nodes) / (speeds[1:] + speeds[:-1])))

    def is_feasible(self, middle):
        """Whether every limit is kept with room to spare."""
        squares = np.empty((2, len(self.nodes)))
        return np.isfinite(_scurve_kernels.potential(self.problem, middle, 0.0, *squares)[0])

    @property
    def problem(self):
        """What the kernels take."""
        nodes = self.along, self.across, self.steepest, self.kappas
        along = np.zeros((len(self.jerk), 2, 3))  # the jerk along the path, at both ends of a cell
        along[:, :, 0] = 0.5 / self.jerk[:, None]
        turns = np.concatenate([along, self.turns], axis=1) * self.parts[:, None, None]
        return np.diff(self.nodes), self.ends, self.caps, nodes, turns, np.empty((len(turns), 0, 4))

    def centre(self, middle, weight, tolerance=0.1, most=60):
        """Least time with a weight on the room to the limits, in place, by ``most`` Newton steps at most."""
        _scurve_kernels.centre(self.problem, middle, weight, tolerance, most, (1.0, 0.0))

    def _balanced_weight(self, middle):
        """A weight at which time and room count alike."""
        return self.time(middle) / (8.0 * len(middle))

    def _slower(self, factor):
        """The same block for motions slower by a factor."""
        return replace(self, ends=self.ends / factor**2)

    def make_feasible(self, middle):
        """Change a motion, in place, until it keeps every limit; the first weight of its solution, or 0.

        Slowed by some factor it does. It is then made faster in stages, as no way on leads from a motion that
        nearly rests in between, and none from one very near its limits. From the fastest that allows it the
        speeds of the ends grow, and the whole motion with them, by a barrier method on the logarithm of the
        part of v² that is reached. 0 means that no motion was found.
        """
        factor, near = 1.0, _NEAR * len(middle)
        while factor < 1e9 and not self._slower(factor).is_feasible(middle / factor**2):
            factor *= 1.2
        if not 1.0 < factor < 1e9:
            return self._balanced_weight(middle) if factor == 1.0 else 0.0
        block, slowed, motions = self._slower(factor), middle / factor**2, []
        for stage in range(_STAGES):
            weight = FALL**stage * block._balanced_weight(slowed)
            block.centre(slowed, weight, near, STEPS)
            motions.append((stage, weight, slowed.copy()))
        for stage, weight, grown in reversed(motions):
            problem, part = self._slower(factor).problem, factor**-2.0
            for pull in len(middle) * _PULLS:
                if part < 1.0:
                    task = problem, grown, FALL * weight, near, STEPS, (part, pull)
                    part, _ = _scurve_kernels.centre(*task)
            middle[1:-1] = grown[1:-1]
            if part == 1.0 and self.is_feasible(middle):
                return FALL**stage * self._balanced_weight(middle)
        return 0.0

    def solve(self, middle, weight, gap):
        """Least time from a motion that keeps the limits, in place; the weight on their room that remains.

        The weight falls by `FALL` from stage to stage, which makes log(1 / gap) / log(1 / FALL) stages and
        a few more, because the time falls too; each takes some ten Newton steps over all cells. The last
        one takes at most 60.

        The time is above the least one by less than the part ``gap`` of it; seen: a fiftieth of that.
        """
        block = self
        while weight * 8.0 * len(middle) > gap * self.time(middle):
            block.centre(middle, weight, _NEAR * len(middle), STEPS)
            block, weight = block._for_phases(middle), weight * FALL
        block.centre(middle, weight)
        return block, weight

    def _for_phases(self, middle):
        """The block that bounds the jerks of the phases of each cell by way of those at its ends."""
        used, along = self._used(middle), largest(self.turns[:, :, 0])
        (squares, slopes), ends = self.squares(middle), used["jerk"] * self.jerk
        bent, both = slopes[:-1] - slopes[1:], np.abs(slopes[1:] + slopes[:-1])
        top = bent * np.diff(self.nodes) / (12.0 * np.minimum(*_sides(squares)))
        more = largest(self._phases(middle)[1].reshape(-1, 3)) - ends
        more = np.maximum(more, np.where(both < 3.0 * bent, ends * top, 0.0))
        more *= np.maximum(1.0 / self.jerk, 2.0 * along)
        parts = 1.0 / (1.0 - np.clip(more, 0.0, 0.5))
        with np.errstate(divide="ignore"):
            most = 1.0 / np.maximum(used["jerk"], used.get("axis_jerk", 0.0))
        return replace(self, parts=np.minimum(parts, 0.5 * (self.parts + most)))

    def stretch_to(self, middle, weight, duration):
        """Slow a least-time motion down to a duration, in place: more weight on the room to the limits.

        The weight is doubled as long as that slows the motion. Between the last one that is too fast and the
        first that is too slow, which are near each other, lies the one sought.
        """
        from scipy.optimize import brentq

        def lacking(motion):
            return duration - float(self.phases(motion)[0].sum())

        slow, before = middle.copy(), None
        while lacking(slow) > 0.0 and not np.array_equal(slow, before):
            middle[:] = before = slow.copy()
            weight *= 2.0
            self.centre(slow, weight)
        if lacking(middle) > 0.0 >= lacking(slow):
            part = brentq(lambda part: lacking(middle + part * (slow - middle)), 0.0, 1.0, xtol=1e-14)
            middle += part * (slow - middle)

    def phases(self, middle):
        """Durations, jerks and names of the limits that bind, of phases of constant jerk."""
        durations, jerks = self._phases(middle)
        durations = np.concatenate([self.ramp_times[:1], durations, self.ramp_times[1:]])
        jerks = np.concatenate([self.ramp_jerks[:1], jerks, self.ramp_jerks[1:]])
        names = np.concatenate([["jerk"], np.repeat(self.binding(middle)[0], 3), ["jerk"]])
        there = durations != 0.0
        return durations[there], jerks[there], names[there]

    def _phases(self, middle):
        """Durations and jerks of three phases for each cell."""
        found = np.empty((2, 3 * len(middle)))
        _scurve_kernels.phases(np.diff(self.nodes), *self.squares(middle), *found)
        return found

    def binding(self, middle):
        """Name of the limit nearest to being met, cell by cell, and the part of it that is taken."""
        used = self._used(middle)
        table = np.array(list(used.values()))
        names = np.array(list(used), dtype=object)[table.argmax(axis=0)]
        return np.where(names == "speed", self.causes, names), table.max(axis=0)

    def _used(self, middle):
        """The part of every limit that is taken, cell by cell."""
        squares, slopes = self.squares(middle)
        by_axis = (self.along * slopes[:, None] + self.across * squares[:, None]).max(axis=1, initial=0.0)
        vector = np.hypot(0.5 * slopes / self.steepest, self.kappas * squares)
        second = np.diff(slopes) / np.diff(self.nodes)
        parts = {
            "speed": middle / self.caps,
            "acceleration": np.maximum(*_sides(vector)),
            "axis_acceleration": np.maximum(*_sides(by_axis)),
            "jerk": np.abs(second) * np.sqrt(np.maximum(*_sides(squares))) / (2.0 * self.jerk),
        }
        if self.turns.shape[1]:
            used = []
            for side, (d, b) in enumerate(zip(_sides(slopes), _sides(squares), strict=True)):
                jerks = np.einsum("nkc,cn->nk", self.turns[:, side::2], np.array([second, d, b]))
                used.append(largest(jerks) * np.sqrt(b))
            parts["axis_jerk"] = np.maximum(*used)
        return parts


def _sides(values):
    """Values at both ends of every cell."""
    return values[:-1], values[1:]
