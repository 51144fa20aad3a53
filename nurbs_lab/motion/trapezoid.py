"""Trapezoids: the fastest speeds with limited acceleration, from one pass backwards and one forwards."""

from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np

from nurbs_lab.motion._trapezoid_kernels import braking
from nurbs_lab.motion.feed import from_speeds, stretch

#: A motion with given end speeds lasts longer by slowing the rest of the way, by at most this factor.
_SLOWEST = 1e3


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
    def profile(self):
        """The feed profile."""
        return self._slower(0.0, 0.0)

    def lasting(self, duration):
        """The profile of a longer motion with the same speeds at both ends, where these leave a choice.

        At most 200 motions are planned to find its duration.
        """
        from scipy.optimize import brentq

        profile, most, slower = self.profile, np.log(_SLOWEST), cache(self._slower)

        def excess(log_factor, power):
            return slower(log_factor, power).duration / duration - (1.0 - 1e-12)

        for power in (2.0, 0.0) if self.ends.any() else ():
            if excess(0.0, power) < 0.0 < excess(most, power):
                profile = slower(brentq(excess, 0.0, most, (power,), xtol=1e-10), power)
                speeds = [profile.speed(0.0), profile.speed(profile.duration)]
                if np.allclose(speeds, self.ends, rtol=1e-9, atol=1e-9 * profile.peak):
                    break  # else the ends need all that the axes may accelerate
        return stretch(profile, duration / profile.duration)

    def _slower(self, log_factor, power):
        """Under a lower speed limit, but where braking with half of the acceleration needs more speed.

        The accelerations may be lower by the factor to the ``power``: with 2, all that is far from the ends
        is the same motion in slow motion.
        """
        caps, s, most = self.path.caps, self.path.lengths, self.limits.acceleration
        braked = np.maximum(self.ends[0] ** 2 - most * s, self.ends[1] ** 2 - most * (s[-1] - s))
        caps = np.minimum(caps, np.maximum(caps * np.exp(-2.0 * log_factor), braked))
        limits, factor = self.limits, np.exp(-power * log_factor)
        axes = None if limits.axis_acceleration is None else limits.axis_acceleration * factor
        limits = replace(limits, acceleration=limits.acceleration * factor, axis_acceleration=axes)
        lengths, squares = fastest(self.path, limits, self.ends, caps)
        nodes = np.searchsorted(s, lengths, side="right") - 1  # at each or before it
        held = squares >= caps[nodes] * (1.0 - 2e-9)
        causes = np.where(held[1:] & held[:-1], self.path.causes[nodes[:-1]], "acceleration")
        return from_speeds(lengths, np.sqrt(squares), self.limits, causes)
