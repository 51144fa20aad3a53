"""The NURBS curve."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.nurbs import _kernels


@dataclass(frozen=True, eq=False)
class NurbsCurve:
    """A non-uniform rational B-spline curve C(u).

    First light only: evaluation. (The nurbs room replaces this file.)
    """

    degree: int
    knots: np.ndarray
    control_points: np.ndarray
    weights: np.ndarray | None = None

    def __post_init__(self):
        points = np.array(self.control_points, dtype=np.float64)
        weights = np.ones(len(points)) if self.weights is None else np.array(self.weights, dtype=np.float64)
        homogeneous = np.column_stack([points * weights[:, None], weights])
        values = {
            "knots": np.array(self.knots, dtype=np.float64),
            "control_points": points,
            "weights": weights,
            "_homogeneous": np.ascontiguousarray(homogeneous),
        }
        for name, value in values.items():
            value.setflags(write=False)
            object.__setattr__(self, name, value)

    def __call__(self, u):
        """Points C(u): ``(..., dim)`` for u of shape ``(...)``."""
        u = np.asarray(u, dtype=np.float64)
        out = np.empty((u.size, self.control_points.shape[1]))
        _kernels.curve_points(self.degree, self.knots, self._homogeneous, u.ravel(), out)
        return out.reshape(*u.shape, -1)
