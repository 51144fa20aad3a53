"""The limits of a machine, and the speed that they allow for a tangent and a curvature."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.checks import as_floats, as_positive


@dataclass(frozen=True)
class Limits:
    """Limits of the motion, None where there is none; units mm and s."""

    speed: float
    acceleration: float
    period_s: float
    jerk: float | None = None
    chord_error: float | None = None
    centripetal_acceleration: float | None = None
    axis_speed: np.ndarray | None = None
    axis_acceleration: np.ndarray | None = None

    @classmethod
    def checked(cls, dim, **given):
        """Checked limits of a motion in ``dim`` dimensions."""
        for name, value in given.items():
            if value is None and name not in ("speed", "acceleration", "period_s"):
                continue
            given[name] = (
                _per_axis(name, value, dim) if name.startswith("axis_") else as_positive(name, value)
            )
        return cls(**given)

    def speeds(self, tangents, curvatures):
        """Largest speed by each limit, as {name: array}.

        The chord error eps allows ``2/T sqrt(2 rho eps - eps**2)``, and 2 rho / T where it exceeds the
        radius of curvature rho.
        """
        curvature = np.linalg.norm(curvatures, axis=1)
        found = {"speed": np.full(len(curvature), self.speed)}
        with np.errstate(divide="ignore"):
            if self.chord_error is not None:
                radius = 1.0 / curvature
                depth = np.minimum(self.chord_error, radius)
                found["chord_error"] = 2.0 / self.period_s * np.sqrt(depth * (2.0 * radius - depth))
            if self.centripetal_acceleration is not None:
                found["centripetal_acceleration"] = np.sqrt(self.centripetal_acceleration / curvature)
            if self.axis_speed is not None:
                found["axis_speed"] = (self.axis_speed / np.abs(tangents)).min(axis=1)
            if self.axis_acceleration is not None:
                found["axis_acceleration"] = np.sqrt(self._largest_square(tangents, curvatures))
        return found

    @property
    def of_the_curve(self):
        """Whether any limit depends on the shape of the curve."""
        limits = self.chord_error, self.centripetal_acceleration, self.axis_speed, self.axis_acceleration
        return any(limit is not None for limit in limits)

    def least_speed(self, curvature):
        """A speed that keeps every limit but ``axis_speed`` wherever the curvature is at most this."""
        across = np.column_stack([curvature, np.zeros((len(curvature), 1))])
        bare = replace(self, axis_speed=None, axis_acceleration=None)
        least = np.min(list(bare.speeds(None, across).values()), axis=0)
        if self.axis_acceleration is not None:
            with np.errstate(divide="ignore"):
                least = np.minimum(least, np.sqrt(self.axis_acceleration.min() / curvature))
        return least

    def _largest_square(self, tangents, curvatures):
        """Largest v² for which some acceleration keeps every axis: |t_i a + n_i v²| <= A_i for all i.

        Axis i alone allows ``n_i v² <= A_i``-like strips in the (a, v²) plane; two of them cross where
        eliminating a leaves ``|n_i t_k - n_k t_i| v² <= A_i |t_k| + A_k |t_i|``.
        """
        limit, dim = self.axis_acceleration, tangents.shape[1]
        best = np.full(len(tangents), np.inf)
        for i in range(dim):
            for k in range(i):
                cross = np.abs(curvatures[:, i] * tangents[:, k] - curvatures[:, k] * tangents[:, i])
                room = limit[i] * np.abs(tangents[:, k]) + limit[k] * np.abs(tangents[:, i])
                free = np.full_like(room, np.inf)
                best = np.minimum(best, np.divide(room, cross, out=free, where=cross > 0.0))
        return best

    def corner_speed(self, turn):
        """Largest speed through a corner that turns by ``turn`` radians, and the limit that says so."""
        if self.centripetal_acceleration is not None:
            return 0.0, "centripetal_acceleration"
        if self.axis_acceleration is not None:
            return 0.0, "axis_acceleration"
        if self.chord_error is not None:
            return 2.0 * self.chord_error / (self.period_s * np.sin(0.5 * turn)), "chord_error"
        return np.inf, "speed"


def _per_axis(name, value, dim):
    values = as_floats(name, value)
    if values.shape not in ((), (dim,)):
        raise ValueError(f"{name} must be one number or {dim}, one for each axis; got shape {values.shape}")
    return np.array([as_positive(name, one) for one in np.broadcast_to(values, (dim,))])
