"""The NURBS curve."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from nurbs_lab.common import checks
from nurbs_lab.nurbs import _kernels, closest, measure, refinement
from nurbs_lab.nurbs.spans import find_breaks, span_table

CLOSED_WITHIN = 1e-9  # of the extent: ends nearer than this are one point

MANY = 24  # points per knot from which on the polynomials of the spans are worth their set-up
POLYNOMIAL_UP_TO = 5  # degree; Taylor coefficients lose a digit or two beyond
EVEN = 100  # largest ratio of weights: where w(u) falls by more, Taylor coefficients lose digits too


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

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> arc = nl.NurbsCurve(2, [0, 0, 0, 1, 1, 1], [(1, 0), (1, 1), (0, 1)], [1, 0.5**0.5, 1])
    >>> round(arc.length(), 9), round(float(arc.curvature(0.3)), 9)
    (1.570796327, 1.0)
    """

    degree: int
    knots: np.ndarray
    control_points: np.ndarray
    weights: np.ndarray | None = None

    def __post_init__(self):
        degree = checks.as_count("degree", self.degree)
        points = checks.as_points("control_points", self.control_points)
        if len(points) <= degree:
            raise ValueError(
                f"control_points: degree {degree} needs at least {degree + 1} of them, got {len(points)}"
            )
        knots = checks.as_knots("knots", self.knots, degree, len(points))
        weights = checks.as_weights("weights", self.weights, (len(points),))
        homogeneous = refinement.lift(points, weights)
        object.__setattr__(self, "degree", degree)
        object.__setattr__(self, "knots", checks.freeze(knots))
        object.__setattr__(self, "control_points", checks.freeze(points))
        object.__setattr__(self, "weights", checks.freeze(weights))
        object.__setattr__(self, "homogeneous", checks.freeze(homogeneous))

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
        return bool(np.linalg.norm(last - first) <= CLOSED_WITHIN * checks.extent(self.control_points))

    def __call__(self, u):
        """Points C(u): ``(..., dim)`` for u of shape ``(...)``."""
        u = checks.as_parameters("u", u, self.domain)
        out = np.empty((u.size, self.dim))
        even = self.degree <= POLYNOMIAL_UP_TO and self.weights.max() <= EVEN * self.weights.min()
        if even and u.size > MANY * len(self.knots):
            _kernels.piecewise_points(*self._rows, self.rational, span_table(*self._rows), u.ravel(), out)
        else:
            _kernels.curve_points(*self._rows, u.ravel(), out)
        return out.reshape(*u.shape, self.dim)

    def derivative(self, u, order=1):
        """The derivative of the given order, ``(..., dim)``; at a knot the right-hand one."""
        return self.derivatives(u, order)[..., -1, :]

    def derivatives(self, u, order):
        """C(u) and all derivatives up to ``order``: ``(..., order + 1, dim)``."""
        order = checks.as_count("order", order, 0, checks.HIGHEST_ORDER)
        u = checks.as_parameters("u", u, self.domain)
        out = _kernels.curve_derivatives(self.degree, self.knots, self.homogeneous, u.ravel(), order)
        return out.reshape(*u.shape, order + 1, self.dim)

    def curvature(self, u):
        """Curvature (unsigned, 1 / length) at u, shape of u."""
        values = self.derivatives(u, 2)
        unit = 2.0 ** np.frexp(np.ptp(self.domain))[1]  # of u, so that no square overflows
        return measure.curvature(unit * values[..., 1, :], unit * (unit * values[..., 2, :]), u)

    def length(self, u0=None, u1=None):
        """Arc length from u0 to u1 (the whole domain if left out), to near machine precision."""
        return measure.length(self, u0, u1)

    def parameter_at(self, length):
        """The parameter at an arc length from the start; any refinement."""
        return measure.parameter_at(self, length)

    def closest_point(self, points):
        """Nearest point of the curve to each point ``(..., dim)``: (u, distance), each of shape ``(...)``."""
        return closest.closest_on_curve(self, points)

    def bounding_box(self):
        """Smallest box around the curve: (lowest, highest) corner, each ``(dim,)``, to 1e-12 of its size."""
        return measure.curve_box(self)

    @classmethod
    def from_homogeneous(cls, degree, knots, rows):
        """The curve with homogeneous control points ``(n, dim + 1)``, rows (w x, ..., w)."""
        return cls(degree, knots, *refinement.points_and_weights("rows", rows, ("n", "dim + 1")))

    @property
    def _rows(self):
        return self.degree, self.knots, self.homogeneous

    def insert_knot(self, u, times=1):
        """The same curve with the knot u ``times`` more."""
        times = checks.as_count("times", times)
        return self.from_homogeneous(*refinement.insert(*self._rows, u, times))

    def refine(self, parameters):
        """The same curve with all these parameters as further knots."""
        return self.from_homogeneous(*refinement.insert_all(*self._rows, parameters))

    def remove_knot(self, u, tolerance):
        """One knot u less; ValueError if that could move a point by more than the tolerance."""
        return self.from_homogeneous(*refinement.remove(*self._rows, u, tolerance))

    def elevate_degree(self, times=1):
        """The same curve, ``times`` degrees higher."""
        rows = self._rows
        for _ in range(checks.as_count("times", times, 1, 20)):
            rows = refinement.elevate(*rows)
        return self.from_homogeneous(*rows)

    def split(self, u):
        """The part before u and the part after it, each with its share of the domain."""
        return tuple(self.from_homogeneous(*part) for part in refinement.split(*self._rows, u))

    def reverse(self):
        """The same curve, run through backwards over the same domain."""
        return self.from_homogeneous(*refinement.reverse(*self._rows))

    def clamped(self):
        """The same curve with end knots of multiplicity p + 1: it starts and ends at control points."""
        return self.from_homogeneous(*refinement.clamped(*self._rows))

    def beziers(self):
        """The Bezier pieces between neighbouring knots, as curves of one span each."""
        ends = find_breaks(self.knots, self.degree)
        pieces = refinement.bezier_rows(*self._rows, ends)
        return [
            self.from_homogeneous(self.degree, np.repeat(ends[i : i + 2], self.degree + 1), piece)
            for i, piece in enumerate(pieces)
        ]

    def transform(self, matrix, offset=None):
        """The image under x -> matrix x + offset; ``matrix (m, dim)``, ``offset (m,)``."""
        points = refinement.affine(self.control_points, matrix, offset)
        return NurbsCurve(self.degree, self.knots, points, self.weights)

    def to_scipy(self):
        """The same curve as a `scipy.interpolate.BSpline`, if it is not rational."""
        if self.rational:
            raise ValueError("weights differ, and a SciPy BSpline has none; see the array `homogeneous`")
        return BSpline(self.knots, self.control_points, self.degree, extrapolate=False)

    @classmethod
    def from_scipy(cls, spline):
        """The curve of a `scipy.interpolate.BSpline` with coefficients ``(n,)`` or ``(n, dim)``."""
        if not isinstance(spline, BSpline):
            raise TypeError(f"spline must be a scipy.interpolate.BSpline, got {type(spline).__name__}")
        points = spline.c[: len(spline.t) - spline.k - 1]
        return cls(spline.k, spline.t, points[:, None] if points.ndim == 1 else points)
