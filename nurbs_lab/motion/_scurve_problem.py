"""Least time from one stop of a path to the next with limited jerk: the problem and its solution."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.motion import _scurve_kernels

#: The weight of the barrier is multiplied by this from one stage to the next.
_KEPT = 0.2
#: A stage before the last ends when a Newton step would gain less than this part of the weight a cell.
_NEAR = 0.3
#: In slowing down, how often the weight of the barrier is raised at most, and the factor each time.
_SLOWINGS, _SLOWING = 40, 2.0
#: Most rounds that seek a first motion: it moves away from the limits, which are then drawn in.
_ROUNDS = 20


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
        ``along * slope + across * v² < 1`` for every row keeps the limits of axes: four rows an axis, for the
        least and the largest tangent and curvature near the node, in both directions.
    acceleration, jerk : float
    speeds : tuple of float
        At both ends, where the acceleration is zero.
    ramp_times : tuple of float
        Durations of the phases of constant jerk out of rest, or nearly rest, and into it; 0 where none is.
    ramp_jerk : float
        Jerk of these phases.
    """

    nodes: np.ndarray
    ends: np.ndarray
    caps: np.ndarray
    causes: np.ndarray
    along: np.ndarray
    across: np.ndarray
    acceleration: float
    jerk: float
    speeds: tuple
    ramp_times: tuple
    ramp_jerk: float

    def relaxed(self, factor):
        """The same block with the limits of a motion ``factor`` times faster."""
        return replace(
            self,
            caps=self.caps * factor**2,
            along=self.along / factor**2,
            across=self.across / factor**2,
            acceleration=self.acceleration * factor**2,
            jerk=self.jerk * factor**3,
        )

    def squares(self, middle):
        """v² and its slope at the nodes."""
        squares, slopes = np.empty(len(self.nodes)), np.empty(len(self.nodes))
        _scurve_kernels.nodal(np.diff(self.nodes), middle, self.ends, squares, slopes)
        return squares, slopes

    def time(self, middle):
        """Duration between the first node and the last."""
        speeds = np.sqrt(self.squares(middle)[0])
        return float(np.sum(2.0 * np.diff(self.nodes) / (speeds[1:] + speeds[:-1])))

    def is_feasible(self, middle):
        """Whether every limit is kept with room to spare."""
        squares, slopes = np.empty(len(self.nodes)), np.empty(len(self.nodes))
        return np.isfinite(_scurve_kernels.potential(*self._given(middle), 0.0, squares, slopes))

    def _given(self, middle):
        machine = self.acceleration, self.jerk
        return np.diff(self.nodes), middle, self.ends, self.caps, (self.along, self.across), machine

    def _centre(self, middle, weight, tolerance=0.1, most=60):
        """Least time with a weight on the room to the limits, in place."""
        _scurve_kernels.centre(*self._given(middle), weight, tolerance, most)

    def _balanced_weight(self, middle):
        """A weight at which time and room count alike."""
        return self.time(middle) / (8.0 * len(middle))

    def infeasibility(self, middle):
        """The least power of 1.5 by which the limits must be relaxed; infinite above 1e9."""
        factor = 1.0
        while not self.relaxed(factor).is_feasible(middle):
            factor *= 1.5
            if factor > 1e9:
                return np.inf
        return factor

    def _is_too_fast_at_an_end(self):
        """Whether the greatest jerk in the first cell or in the last leaves the next one above its cap."""
        widths, caps, (start, slope, stop, other) = np.diff(self.nodes), self.caps, self.ends
        # The two cells at each end, and the cap between them; a motion of one cell has none.
        for square, rise, w, cap in (
            (start, slope, widths[:2], caps[1:-1][:1]),
            (stop, -other, widths[:-3:-1], caps[-2:0:-1][:1]),
        ):
            drop = self.jerk / np.sqrt(square) * w[0] * w.sum()
            if (square + rise * (w[0] + 0.5 * w[-1]) - drop > cap).any():
                return True
        return False

    def make_feasible(self, middle):
        """Change a motion, in place, until it keeps every limit; whether that was possible.

        The limits are relaxed to those of a motion some factor faster, and the factor is drawn towards one,
        with centering steps between: at most `_ROUNDS` times.
        """
        if self._is_too_fast_at_an_end():
            return False
        factor = self.infeasibility(middle)
        for _ in range(_ROUNDS if factor < np.inf else 0):
            if self.is_feasible(middle):
                return True
            self.relaxed(factor)._centre(middle, 10.0 * self._balanced_weight(middle))
            low, high = 0.0, 1.0  # part of the way from 1 to the factor
            for _ in range(30):
                part = 0.5 * (low + high)
                if self.relaxed(1.0 + part * (factor - 1.0)).is_feasible(middle):
                    high = part
                else:
                    low = part
            if high > 0.99:
                return False
            factor = 1.0 + min(high * 1.1, 0.5 * (1.0 + high)) * (factor - 1.0)
        return False

    def solve(self, middle, gap):
        """Least time from a motion that keeps the limits, in place; the weight on their room that remains.

        The weight falls by `_KEPT` from stage to stage, which makes log(1 / gap) / log(1 / _KEPT) stages and
        a few more, because the time falls too; each takes at most 60 Newton steps over all cells.

        The time is above the least one by less than the part ``gap`` of it; seen: a fiftieth of that.
        """
        weight = self._balanced_weight(middle)
        while weight * 8.0 * len(middle) > gap * self.time(middle):
            self._centre(middle, weight, _NEAR * len(middle))
            weight *= _KEPT
        self._centre(middle, weight, tolerance=1e-9)
        return weight

    def stretch_to(self, middle, weight, duration):
        """Slow a least-time motion down to a duration, in place: more weight on the room to the limits.

        The weight is doubled at most `_SLOWINGS` times.

        Between the last motion that is too fast and the first that is too slow, which are near each other,
        lies the one sought.
        """

        from scipy.optimize import brentq

        def lacking(motion):
            return duration - float(self.phases(motion)[0].sum())

        slow = middle.copy()
        for _ in range(_SLOWINGS):
            if lacking(slow) <= 0.0:
                break
            middle[:] = slow
            weight *= _SLOWING
            self._centre(slow, weight)
        if lacking(middle) > 0.0 >= lacking(slow):
            part = brentq(lambda part: lacking(middle + part * (slow - middle)), 0.0, 1.0, xtol=1e-14)
            middle += part * (slow - middle)

    def phases(self, middle):
        """Durations, jerks and names of the limits that bind, of phases of constant jerk."""
        count = len(middle)
        durations, jerks = np.empty(3 * count), np.empty(3 * count)
        _scurve_kernels.phases(np.diff(self.nodes), *self.squares(middle), durations, jerks)
        durations = np.concatenate([self.ramp_times[:1], durations, self.ramp_times[1:]])
        jerks = np.concatenate([[self.ramp_jerk], jerks, [self.ramp_jerk]])
        names = np.concatenate([["jerk"], np.repeat(self._binding(middle)[0], 3), ["jerk"]])
        there = durations != 0.0
        return durations[there], jerks[there], names[there]

    def hardest(self, middle):
        """Length at which a motion is farthest beyond a limit, and the name of that limit."""
        names, parts = self._binding(middle)
        cell = int(np.argmax(parts))
        return float(self.nodes[cell]), names[cell]

    def _binding(self, middle):
        """Name of the limit nearest to being met, cell by cell, and the part of it that is taken."""
        squares, slopes = self.squares(middle)
        by_axis = (self.along * slopes[:, None] + self.across * squares[:, None]).max(axis=1, initial=0.0)
        second_derivative = np.abs(np.diff(slopes)) / np.diff(self.nodes)
        parts = {
            "speed": middle / self.caps,
            "acceleration": np.maximum(*_sides(np.abs(slopes))) / (2.0 * self.acceleration),
            "axis_acceleration": np.maximum(*_sides(by_axis)),
            "jerk": second_derivative * np.sqrt(np.maximum(*_sides(squares))) / (2.0 * self.jerk),
        }
        table = np.array(list(parts.values()))
        names = np.array(list(parts), dtype=object)[table.argmax(axis=0)]
        return np.where(names == "speed", self.causes, names), table.max(axis=0)


def _sides(values):
    """Values at both ends of every cell."""
    return values[:-1], values[1:]
