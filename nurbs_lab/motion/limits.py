"""The limits of a machine, and the speed that they allow for a tangent and a curvature."""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.checks import as_floats, as_positive
from nurbs_lab.motion import _kernels

#: The limits that say how fast the tool may pass a place of the path.
NAMES = "speed", "chord_error", "centripetal_acceleration", "axis_speed", "axis_acceleration"


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

    def speed_table(self, tangents, curvatures):
        """A row each: the largest speed by each of `NAMES`, infinite without a limit, and the curvature."""
        along = (self.speed, self.chord_error, self.centripetal_acceleration)
        axes = (self.axis_speed, self.axis_acceleration)
        table = np.empty((len(NAMES) + 1, len(curvatures)))
        _kernels.speed_limits(
            tangents, curvatures, tuple(np.inf if limit is None else limit for limit in along), self.period_s,
            *(np.empty(0) if limit is None else limit for limit in axes), table,
        )  # fmt: skip
        return table

    @property
    def of_the_curve(self):
        """Whether any limit depends on the shape of the curve."""
        limits = self.chord_error, self.centripetal_acceleration, self.axis_speed, self.axis_acceleration
        return any(limit is not None for limit in limits)

    def least_speed(self, curvature):
        """A speed that keeps every limit but ``axis_speed`` wherever the curvature is at most this."""
        across = np.column_stack([curvature, np.zeros(len(curvature))])
        bare = replace(self, axis_speed=None, axis_acceleration=None)
        least = bare.speed_table(across, across)[:-1].min(axis=0)
        if self.axis_acceleration is not None:
            with np.errstate(divide="ignore"):
                least = np.minimum(least, np.sqrt(self.axis_acceleration.min() / curvature))
        return least

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
