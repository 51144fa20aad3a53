"""A lower bound of the time with limited jerk: the least time of a convex problem with more freedom.

An acceleration changes by no more than its jerk times the time. Here the time of each cell is an unknown of
its own: not less than ``2 h / (v + v')`` with the speeds at its ends, which is a convex function of v² and
v'², but it may be more. The limits of jerk, of the path and of each axis, are then linear, and so the least
time of this problem is what no motion can beat. A barrier method finds it: where time minus weight times the
logarithms of all M rooms is least, the time exceeds the least one by at most weight times M.
"""

import numpy as np

from nurbs_lab.motion._bands import factor_bands, solve_bands
from nurbs_lab.motion._scurve_problem import FALL, STEPS

#: The bound may be lower than the least time by this part.
_GAP = 3e-4
#: The barrier's first weight, as a part of that at which time and all rooms count alike.
_FIRST = 0.1
#: A stage ends when one more Newton step would gain less than this part of its weight.
_NEAR = 0.1
#: Steps to the time of a cell that is best for it.
_LONGER = 2


class Relaxation:
    """The relaxed problem of a `Block`; unknown are an ordinate of v² and a time for each cell."""

    def __init__(self, block):
        self.block, self.widths = block, np.diff(block.nodes)
        h, n = self.widths, len(self.widths)
        own = np.stack([[h[1:], h[:-1]], np.broadcast_to([[-2.0], [2.0]], (2, n - 1))]) / (h[1:] + h[:-1])
        self.nodal = np.moveaxis(own, 2, 0)  # v² and its slope at inner nodes, by the ordinates beside them
        self.ends = np.zeros((n, 4, 3))  # v² at both ends of a cell, and its slopes, by three ordinates
        self.ends[1:, ::2, :2] = self.ends[:-1, 1::2, 1:] = self.nodal
        first, last = block.turns[:, ::2], block.turns[:, 1::2]
        mean, half = 0.5 * (first + last)[..., 0], 0.5 * h[:, None]
        turns = (
            half * first[..., 2],
            half * last[..., 2],
            half * first[..., 1] - mean,
            half * last[..., 1] + mean,
        )
        along = np.array([0.0, 0.0, -0.5, 0.5]) / block.jerk[:, None, None]
        self.changes = np.concatenate([along, np.stack(turns, axis=2)], axis=1)
        self.rows = self.changes @ self.ends

    def least_time(self, middle):
        """The bound, from ordinates that keep the limits."""
        middle = middle.copy()
        count = sum(room.size for room in self._rooms(middle, 1.0)[2:5])
        weight = _FIRST * self.block.time(middle) / count
        self.block.centre(middle, weight)  # away from all limits Newton's method gets under way sooner
        while True:
            decrement = self._centre(middle, weight)
            if not decrement <= _NEAR * weight:
                return 0.0  # nothing is known
            if weight * count <= _GAP * self.block.time(middle):
                break
            weight *= FALL
        time = self._rooms(middle, weight)[5].sum() + sum(self.block.ramp_times)
        return time - weight * (count + np.sqrt(count * decrement / weight))

    def _rooms(self, middle, weight):
        """v² and its slope at nodes, the rooms of ordinates, nodes and cells, and the times of the cells."""
        block, (b, d) = self.block, self.block.squares(middle)
        v = np.sqrt(b)
        ends = np.stack([b[:-1], b[1:], d[:-1], d[1:]], axis=1)[:, :, None]
        changes = (self.changes @ ends)[:, :, 0]
        least = np.column_stack([2.0 * self.widths / (v[1:] + v[:-1]), changes, -changes])
        times = least.max(axis=1)
        cells = times[:, None] - least
        longer = np.full(len(cells), weight)
        for _ in range(_LONGER):  # least in time and barrier
            steep = weight / (cells + longer[:, None])
            slope, curvature = steep.sum(axis=1), (steep**2).sum(axis=1)
            longer += weight * (slope * slope - slope) / curvature
        cone = 1.0 - (0.5 * d / block.steepest) ** 2 - (block.kappas * b) ** 2
        nodes = np.column_stack([cone, 1.0 - block.along * d[:, None] - block.across * b[:, None]])[1:-1]
        own = np.stack([middle, block.caps - middle])[:, 1:-1]
        return b, d, own, nodes, cells + longer[:, None], times + longer

    def _potential(self, middle, weight):
        if not middle.min() > 0.0:
            return np.inf
        *rooms, times = self._rooms(middle, weight)[2:]
        if not min(room.min() for room in rooms) > 0.0:
            return np.inf
        return times.sum() - weight * sum(np.log(room).sum() for room in rooms)

    def _centre(self, middle, weight):
        """Newton steps in place; twice what the next one would gain."""
        value = self._potential(middle, weight)
        for _ in range(STEPS):
            step, decrement = self._step(middle, weight)
            if decrement <= _NEAR * weight:
                break
            fraction, found = 2.0, np.inf
            while fraction > 1e-9 and not found <= value - 0.1 * fraction * decrement + 1e-14 * abs(value):
                fraction *= 0.5
                found = self._potential(middle + fraction * step, weight)
            if not found < np.inf:
                break
            middle += fraction * step
            value = found
        return decrement

    def _step(self, middle, weight):
        """Newton's step of the ordinates, and its decrement."""
        b, d, own, nodes, cells, _ = self._rooms(middle, weight)
        n, block = len(middle), self.block
        (p, q), squares = 1.0 / np.sqrt([b[:-1], b[1:]]), self.ends[:, :2]
        mean = p * q / (p + q)
        first, second = self.widths * mean**2, self.widths * mean**3
        needed = -(first * p)[:, None] * squares[:, 0] - (first * q)[:, None] * squares[:, 1]
        ways = np.concatenate([needed[:, None], self.rows, -self.rows], axis=1)
        steep = 1.0 / cells[:, :, None]
        centre = (steep**2 * ways).sum(axis=1) / (steep**2).sum(axis=1)
        spread = steep * (ways - centre[:, None])  # the times follow: each is the best for its cell
        pp, pq, qq = p * p * (second + 0.5 * first * p), p * q * second, q * q * (second + 0.5 * first * q)
        bent = np.moveaxis(np.array([[pp, pq], [pq, qq]]) * steep[:, 0, 0], 2, 0)
        inner = np.swapaxes(spread, 1, 2) @ spread + np.swapaxes(squares, 1, 2) @ bent @ squares
        gradient, bands = np.zeros(n + 2), np.zeros((n + 2, 3))
        _add(gradient, bands, (steep * ways).sum(axis=1), inner, 0)
        curved = np.column_stack([2.0 * block.kappas**2, 0.5 / block.steepest**2])[1:-1]
        lines = np.stack([block.across, block.along], axis=2)[1:-1]
        ways = np.concatenate([(curved * np.column_stack([b, d])[1:-1])[:, None], lines], axis=1)
        spread = ways / nodes[:, :, None]
        inner = np.swapaxes(spread, 1, 2) @ spread
        inner[:, [0, 1], [0, 1]] += curved / nodes[:, :1]
        inner = np.swapaxes(self.nodal, 1, 2) @ inner @ self.nodal
        _add(gradient, bands, (spread.sum(axis=1)[:, None] @ self.nodal)[:, 0], inner, 1)
        gradient[2:-2] += 1.0 / own[1] - 1.0 / own[0]
        bands[2:-2, 0] += (1.0 / own**2).sum(axis=0)
        step = np.zeros(n + 2)  # the ordinates of the end cells are given
        step[2:-2] = -gradient[2:-2]
        factor_bands(bands[2:-2])
        solve_bands(bands[2:-2], step[2:-2])
        return step[1:-1], -weight * (gradient * step).sum()


def _add(gradient, bands, slopes, hessians, at):
    """Add those by a few ordinates each to those by all, padded by one at both ends."""
    count, size = slopes.shape
    for i in range(size):
        rows = slice(at + i, at + i + count)
        gradient[rows] += slopes[:, i]
        bands[rows, : size - i] += hessians[:, i, i:]
