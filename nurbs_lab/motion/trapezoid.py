"""Trapezoids: the fastest speeds with limited acceleration, from a backward and a forward pass."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from nurbs_lab.motion._trapezoid_kernels import braking
from nurbs_lab.motion.feed import from_speeds, stretch

#: A motion with given end speeds lasts longer by slowing the rest of the way, by at most this factor.
_SLOWEST = 1e3


def fastest(path, limits, ends, caps=None):
    """Largest v² along the path with limited acceleration: lengths, the path's and some between, and v²."""
    caps = path.speeds**2 if caps is None else caps
    axis = np.empty(0) if limits.axis_acceleration is None else limits.axis_acceleration
    axes, most = np.outer(path.axis_parts, axis), limits.acceleration
    machine = path.tangents, path.curvatures, axes
    lengths, squares, nodes = braking(path.lengths, caps, *machine, most, ends[1] ** 2)
    back = nodes[::-1]  # along the reversed path starting is braking
    machine = -path.tangents[back], path.curvatures[back], axes[back]
    lengths, squares, _ = braking(-lengths[::-1], squares[::-1].copy(), *machine, most, ends[0] ** 2)
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
        return self._under(self.path.speeds**2)

    def lasting(self, duration):
        """The profile of a longer motion with the same speeds at both ends, where these leave a choice.

        At most 200 motions are planned to find its duration.
        """
        profile = self.profile
        if self.ends.any():
            squares, s, acceleration = self.path.speeds**2, self.path.lengths, self.limits.acceleration
            braked = np.maximum(
                self.ends[0] ** 2 - acceleration * s, self.ends[1] ** 2 - acceleration * (s[-1] - s)
            )  # from the ends with half of the acceleration

            def slowed(log_factor, power):
                low = squares * np.exp(-2.0 * log_factor)
                part = np.exp(-power * log_factor)
                return self._under(np.minimum(squares, np.maximum(low, braked)), part)

            def excess(log_factor, power):
                return slowed(log_factor, power).duration / duration - (1.0 - 1e-12)

            for power in (2.0, 0.0):  # axes accelerate less too, unless the ends need all of that
                if excess(0.0, power) < 0.0 < excess(np.log(_SLOWEST), power):
                    root = brentq(excess, 0.0, np.log(_SLOWEST), (power,), xtol=1e-10)
                    profile = slowed(root, power)
                    if self._keeps_ends(profile):
                        break
        return stretch(profile, duration / profile.duration)

    def _keeps_ends(self, profile):
        speeds = [profile.speed(0.0), profile.speed(profile.duration)]
        return np.allclose(speeds, self.ends, rtol=1e-9, atol=1e-9 * profile.peak)

    def _under(self, caps, part=1.0):
        """Under a limit of v² and a part of the accelerations of axes."""
        axes = self.limits.axis_acceleration
        gentle = self.limits if axes is None else replace(self.limits, axis_acceleration=part * axes)
        lengths, squares = fastest(self.path, gentle, self.ends, caps)
        nodes = np.searchsorted(self.path.lengths, lengths, side="right") - 1  # at each or before it
        speeds = np.sqrt(squares)
        held = squares >= caps[nodes] * (1.0 - 2e-9)
        causes = np.where(held[1:] & held[:-1], self.path.causes[nodes[:-1]], "acceleration")
        return from_speeds(lengths, speeds, self.limits, causes)
