"""The NURBS curve."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.nurbs import _checks, _kernels, shape

CLOSED_WITHIN = 1e-9  # of the extent: ends nearer than this are one point


@dataclass(frozen=True, eq=False, repr=False)
class NurbsCurve:
    """A non-uniform rational B-spline curve C(u) (paper Eq. 4 and 5).

    Parameters
    ----------
    degree : int
        p, at least 1.
    knots : array_like, shape (n + p + 1,)
        Non-decreasing; clamped or not. The domain is [knots[p], knots[n]].
    control_points : array_like, shape (n, dim)
    weights : array_like, shape (n,), optional
        Positive; all one if left out.

    Raises
    ------
    TypeError, ValueError
        Naming the argument, the wrong value and the cure.

    Notes
    -----
    All arrays are read-only float64. Besides the arguments there is ``homogeneous``, ``(n, dim + 1)``
    rows (w x, ..., w), which the kernels take. A closed fit is kept with a periodic, unclamped knot
    vector, so that its seam is as smooth as every other knot; ``clamped()`` gives the same shape with
    end knots of multiplicity p + 1, as exchange formats want it.
    """

    degree: int
    knots: np.ndarray
    control_points: np.ndarray
    weights: np.ndarray | None = None

    def __post_init__(self):
        degree = _checks.as_count("degree", self.degree)
        points = _checks.as_points("control_points", self.control_points)
        if len(points) <= degree:
            raise ValueError(
                f"control_points: degree {degree} needs at least {degree + 1} of them, got {len(points)}"
            )
        knots = _checks.as_knots("knots", self.knots, degree, len(points))
        weights = _checks.as_weights("weights", self.weights, (len(points),))
        homogeneous = np.column_stack([points * weights[:, None], weights])
        object.__setattr__(self, "degree", degree)
        object.__setattr__(self, "knots", _checks.freeze(knots))
        object.__setattr__(self, "control_points", _checks.freeze(points))
        object.__setattr__(self, "weights", _checks.freeze(weights))
        object.__setattr__(self, "homogeneous", _checks.freeze(homogeneous))

    def __repr__(self):
        kind = "rational" if self.rational else "polynomial"
        low, high = self.domain
        return (
            f"NurbsCurve(degree {self.degree}, {len(self.control_points)} control points in {self.dim}-D, "
            f"{kind}, u in [{low:g}, {high:g}])"
        )

    @property
    def dim(self):
        """Number of coordinates of a point."""
        return self.control_points.shape[1]

    @property
    def domain(self):
        """First and last parameter, (float, float)."""
        return float(self.knots[self.degree]), float(self.knots[-self.degree - 1])

    @property
    def rational(self):
        """Whether the weights differ."""
        return bool(np.ptp(self.weights) > 0)

    @property
    def closed(self):
        """Whether the ends meet, measured: within 1e-9 of the extent of the control points."""
        first, last = self(self.domain)
        extent = np.linalg.norm(np.ptp(self.control_points, axis=0))
        return bool(np.linalg.norm(last - first) <= CLOSED_WITHIN * extent)

    def __call__(self, u):
        """Points C(u): ``(..., dim)`` for u of shape ``(...)``."""
        u = _checks.as_parameters("u", u, self.domain)
        out = np.empty((u.size, self.dim))
        _kernels.curve_points(self.degree, self.knots, self.homogeneous, u.ravel(), out)
        return out.reshape(*u.shape, self.dim)

    def derivative(self, u, order=1):
        """The derivative of the given order, ``(..., dim)``; at a knot the right-hand one."""
        return self.derivatives(u, order)[..., -1, :]

    def derivatives(self, u, order):
        """C(u) and all derivatives up to ``order``: ``(..., order + 1, dim)``."""
        order = _checks.as_count("order", order, least=0)
        u = _checks.as_parameters("u", u, self.domain)
        out = _kernels.curve_derivatives(self.degree, self.knots, self.homogeneous, u.ravel(), order)
        return out.reshape(*u.shape, order + 1, self.dim)

    def clamped(self):
        """The same curve with end knots of multiplicity p + 1: it starts and ends at control points."""
        return self.from_homogeneous(self.degree, *shape.clamped(self.degree, self.knots, self.homogeneous))

    @classmethod
    def from_homogeneous(cls, degree, knots, rows):
        """The curve with these homogeneous control points ``(n, dim + 1)``, rows (w x, ..., w)."""
        return cls(degree, knots, rows[:, :-1] / rows[:, -1:], rows[:, -1])
