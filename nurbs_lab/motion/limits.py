"""The limits of a machine, and the speed that they allow for a tangent, a curvature and a corner."""

from dataclasses import dataclass, fields, replace

import numpy as np

from nurbs_lab.common.checks import as_flag, as_floats, as_positive
from nurbs_lab.common.values import Value
from nurbs_lab.motion import _kernels

#: The limits that say how fast the tool may pass a place of the path.
NAMES = "speed", "chord_error", "centripetal_acceleration", "axis_speed", "axis_acceleration"
#: Those of axes: of their speed, acceleration and jerk.
OF_AXES = "axis_speed", "axis_acceleration", "axis_jerk"


@dataclass(frozen=True, eq=False, repr=False)
class Limits(Value):
    """Limits of a motion, the same in planner, program and machine; None where there is none.

    Attributes
    ----------
    speed : float
        Along the path, in mm/s.
    acceleration : float
        Of the acceleration vector, in mm/s²; along the path only if ``tangential_only``.
    jerk : float, optional
        Along the path, in mm/s³. Without it the acceleration may step, unless ``axis_jerk`` is given.
    chord_error : float, optional
        Largest distance between the chord of a period and its arc, in mm.
    centripetal_acceleration : float, optional
        Across the path, v² times curvature, in mm/s².
    axis_speed, axis_acceleration, axis_jerk : float or array_like, optional
        Of each machine axis, in mm/s, mm/s² and mm/s³.
    period_s : float
        Interpolation period, in s.
    tangential_only : bool
        Whether ``acceleration`` leaves the acceleration across the path free.

    Notes
    -----
    A corner is passed at the speed at which the velocity changes within a period by no more than the
    accelerations allow: v <= a T / (2 sin(turn / 2)) for the vector, and for each axis likewise. Changes at
    corners less than a period apart are added as vectors, and the curvature beside them shares the period.
    The speed is held for two periods. With ``axis_jerk`` the corner takes half of it, and holds its speed for
    four. Where a stop takes less time, without any limit of jerk 2 % less, the motion nearly stops.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> limits = nl.Limits(speed=20.0, acceleration=500.0, period_s=1e-3)
    >>> round(nl.plan_feed(nl.paper.CURVE, limits).duration, 9)
    0.461
    """

    speed: float
    acceleration: float
    jerk: float | None = None
    chord_error: float | None = None
    centripetal_acceleration: float | None = None
    axis_speed: np.ndarray | None = None
    axis_acceleration: np.ndarray | None = None
    axis_jerk: np.ndarray | None = None
    period_s: float = 1e-3
    tangential_only: bool = False

    def __post_init__(self):
        as_flag("tangential_only", self.tangential_only)
        for field in fields(self)[:-1]:
            value = getattr(self, field.name)
            if value is None and field.default is None:
                continue
            if field.name.startswith("axis_") and np.ndim(value):
                value = as_floats(field.name, value, ("axes",))
                value = np.array([as_positive(field.name, one) for one in value])
                value.setflags(write=False)
            else:
                value = as_positive(field.name, value)
            object.__setattr__(self, field.name, value)

    def in_dimensions(self, dim):
        """The same limits with one number for each of ``dim`` axes."""
        rows = {}
        for name in OF_AXES:
            value = getattr(self, name)
            if value is not None:
                if np.shape(value) not in ((), (dim,)):
                    raise ValueError(
                        f"{name} must be one number or {dim}, one for each axis; got shape {np.shape(value)}"
                    )
                rows[name] = np.broadcast_to(value, (dim,)).copy()
        return replace(self, **rows)

    @property
    def soft(self):
        """Whether the acceleration may not step."""
        return self.jerk is not None or self.axis_jerk is not None

    @property
    def across(self):
        """Largest acceleration across the path, and the name of the limit that says so."""
        own = np.inf if self.centripetal_acceleration is None else self.centripetal_acceleration
        if self.tangential_only or own <= self.acceleration:
            return own, "centripetal_acceleration"
        return self.acceleration, "acceleration"

    @property
    def names(self):
        """Names of the limits of the rows of `speed_table`."""
        return tuple(self.across[1] if name == "centripetal_acceleration" else name for name in NAMES)

    def speed_table(self, tangents, curvatures):
        """A row each: the largest speed by each of `names`, infinite without a limit, and the curvature."""
        chord_error = np.inf if self.chord_error is None else self.chord_error
        table, along = np.empty((len(NAMES) + 1, len(curvatures))), (self.speed, chord_error, self.across[0])
        axes = self.axis_speed, self.axis_acceleration
        axes = [np.empty(0) if axis is None else axis.copy() for axis in axes]
        _kernels.speed_limits(tangents, curvatures, along, self.period_s, *axes, table)
        return table

    @property
    def of_axes(self):
        """Whether any limit is one of axes."""
        return any(getattr(self, name) is not None for name in OF_AXES)

    @property
    def of_the_curve(self):
        """Whether any limit depends on the shape of the curve."""
        return self.across[0] < np.inf or self.chord_error is not None or self.of_axes

    def corner_speeds(self, lengths, steps, fastest):
        """Largest speeds in windows that begin at corners, lie around them and end there, and what says so.

        ``steps (n, dim)`` are the unit tangents behind the corners, at increasing lengths, minus those before
        them, and ``fastest`` the speeds that other limits allow there.
        """
        period, free, (across, name) = self.period_s, np.full(steps.shape[1], np.inf), self.across
        rows = {name: (2, (0, 1, 2), period, np.append(across * period, free))}
        if self.axis_acceleration is not None:
            budgets = np.append(np.inf, self.axis_acceleration * period)
            rows["axis_acceleration"] = 2, (0, 1, 2), period, budgets
        if self.axis_jerk is not None:  # half of it, which is room for all phases of the periods
            rows["axis_jerk"] = 3, (1, 2), period, np.append(np.inf, 0.5 * self.axis_jerk * period**2)
        if self.chord_error is not None:
            rows["chord_error"] = 2, (1,), 0.5 * period, np.append(4.0 * self.chord_error / period, free)
        table = np.full((len(rows), 3, len(lengths)), np.inf)
        corners = lengths, np.ascontiguousarray(steps), fastest
        for row, (order, places, between, budgets) in zip(table, rows.values(), strict=True):
            for k in places:
                out = row[k if len(places) == 3 else 1]  # those of one or two places count as around
                _kernels.pass_speeds(corners, (order, k), between, budgets, self.speed, out)
        return table.min(axis=0), np.array(list(rows), dtype=object)[table.argmin(axis=0)]
