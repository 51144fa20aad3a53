"""Trapezoids: the fastest speeds with limited acceleration, from one pass backwards and one forwards."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nurbs_lab.motion._trapezoid_kernels import braking
from nurbs_lab.motion.feed import from_speeds, stretch


def fastest(path, limits, ends, caps):
    """Lengths, and the largest v² there with limited acceleration under the limits ``caps`` of v².

    The lengths are those of the path's samples and of places between them where braking or starting ends.
    """
    axis = np.empty(0) if limits.axis_acceleration is None else limits.axis_acceleration
    axes = np.outer(path.parts[:, 1], axis)
    kappas = np.zeros(len(axes)) if limits.tangential_only else np.linalg.norm(path.curvatures, axis=1)
    cones = np.column_stack([limits.acceleration * path.parts[:, 1], kappas])
    tangents, curvatures = path.tangents, path.curvatures
    if len(path.zones):
        t, n = path.shares(path.lengths, limits, tangents, curvatures)
        if not axis.size:
            tangents, curvatures = tangents[:, :0], curvatures[:, :0]
        tangents = np.column_stack([tangents, t, -t])
        curvatures = np.column_stack([curvatures, n, n])
        axes = np.column_stack([axes, np.ones((len(t), 2))])
    machine = tangents, curvatures, axes, cones
    lengths, squares, nodes = braking(path.lengths, caps, *machine, ends[1] ** 2)
    after = np.minimum(nodes + 1, len(caps) - 1)
    way = path.lengths[after] - path.lengths[nodes]
    part = ((lengths - path.lengths[nodes]) / np.where(way > 0.0, way, 1.0))[:, None]
    rows = [((1.0 - part) * row[nodes] + part * row[after])[::-1].copy() for row in machine]
    machine = -rows[0], *rows[1:]  # along the reversed path, starting is braking
    lengths, squares, _ = braking(-lengths[::-1], squares[::-1].copy(), *machine, ends[0] ** 2)
    lengths, squares = -lengths[::-1], squares[::-1]
    apart = np.append(True, np.diff(lengths) > 0.0)  # two samples at a knot have the curvatures of both sides
    return lengths[apart], squares[apart]


@dataclass(frozen=True, eq=False)
class Trapezoid:
    """The fastest motion along a scanned path with limited acceleration."""

    path: object
    limits: object
    ends: np.ndarray

    @cached_property
    def _fastest(self):
        return fastest(self.path, self.limits, self.ends, self.path.caps)

    @cached_property
    def profile(self):
        """The feed profile."""
        lengths, squares = self._fastest
        return self._profile(lengths, squares, squares)

    def lasting(self, duration):
        """The profile of a longer motion with the same speeds at both ends, where these leave a choice.

        All limits are convex in v² and its slope, so that every motion between two that keep them does.
        """
        from scipy.optimize import brentq

        profile = self.profile
        if self.ends.any():
            low = self._slow((0.1 * profile.length / duration) ** 2)
            nodes, at = self._fastest[0], low[0]
            beside = nodes[np.searchsorted(nodes, at).clip(1, len(nodes) - 1) - [[1], [0]]]
            apart = np.abs(beside - at).min(axis=0) > 0.01 * np.ptp(beside, axis=0)  # in others, rounding
            at = np.sort(np.append(nodes, at[apart]))
            fast, slow = (np.interp(at, *one) for one in (self._fastest, low))

            def excess(part):
                speeds = np.sqrt(fast + part * (slow - fast))
                return np.sum(2.0 * np.diff(at) / (speeds[1:] + speeds[:-1])) / duration - (1.0 - 1e-12)

            kept = np.allclose(fast[[0, -1]], slow[[0, -1]], rtol=1e-9, atol=1e-9 * fast.max())
            if kept and excess(0.0) < 0.0 < excess(1.0):  # else the ends need all that axes may accelerate
                part = brentq(excess, 0.0, 1.0, xtol=1e-14)
                profile = self._profile(at, fast + part * (slow - fast), fast)
        return stretch(profile, duration / profile.duration)

    def _slow(self, level):
        """A motion down to a level of v², but where braking with half of the acceleration needs more."""
        s, most = self.path.lengths, self.limits.acceleration
        if self.limits.axis_acceleration is not None:
            most = min(most, self.limits.axis_acceleration.min())
        braked = np.maximum(self.ends[0] ** 2 - most * s, self.ends[1] ** 2 - most * (s[-1] - s))
        caps = np.minimum(self.path.caps, np.maximum(level, braked))
        return fastest(self.path, self.limits, self.ends, caps)

    def _profile(self, lengths, squares, fast):
        nodes = np.searchsorted(self.path.lengths, lengths, side="right") - 1  # at each or before it
        held = fast >= self.path.caps[nodes] * (1.0 - 2e-9)
        causes = np.where(held[1:] & held[:-1], self.path.causes[nodes[:-1]], "acceleration")
        return from_speeds(lengths, np.sqrt(squares), self.limits, causes)
