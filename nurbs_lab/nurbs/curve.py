"""The NURBS curve."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.nurbs import _kernels, closest, differential, measure, refinement, span_kernels
from nurbs_lab.nurbs.refinement import CLOSED_WITHIN
from nurbs_lab.nurbs.spans import find_breaks, span_parameters, span_table
from nurbs_lab.nurbs.spline import Spline

CELLS = 16  # of a picture, along each span
MANY = 24  # points per knot from which on the polynomials of the spans are worth their set-up
POLYNOMIAL_UP_TO = 5  # degree; at higher ones, powers lose one or two digits
EVEN = 100  # ratio of weights; where they differ more, powers lose digits too


@dataclass(frozen=True, eq=False, repr=False)
class NurbsCurve(Spline):
    """A non-uniform rational B-spline curve C(u) (paper Eq. 4 and 5).

    Parameters
    ----------
    degree : int
        p, at least 1.
    knots : array_like, shape (n + p + 1,)
        Non-decreasing; clamped or not. The domain is [knots[p], knots[n]].
    control_points : array_like, shape (n, dim)
    weights : array_like, shape (n,), optional
        Positive; all one by default.

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
        self._store(points, weights, degree=degree, knots=checks.freeze(knots))

    def __repr__(self):
        kind = "rational" if self.rational else "polynomial"
        low, high = self.domain
        return (
            f"NurbsCurve(degree {self.degree}, {len(self.control_points)} control points in {self.dim}-D, "
            f"{kind}, u in [{low:g}, {high:g}])"
        )

    @property
    def domain(self):
        """First and last parameter, (float, float)."""
        return refinement.domain(self.degree, self.knots)

    @property
    def closed(self):
        """Whether the ends meet, measured: within 1e-9 of the extent of the control points."""
        first, last = self(self.domain)
        return bool(np.linalg.norm(last - first) <= CLOSED_WITHIN * checks.extent(self.control_points))

    def __call__(self, u):
        """Points C(u): ``(..., dim)`` for u of shape ``(...)``."""
        u = checks.wrapped("u", u, self.domain, lambda: self.closed)
        out = np.empty((u.size, self.dim))
        many = u.size > MANY * len(self.knots) and self.degree <= POLYNOMIAL_UP_TO and self.dim <= 3
        if many and self.weights.max() <= EVEN * self.weights.min():
            span_kernels.points(span_table(*self._rows), self(np.array(self.domain)), u.ravel(), out)
        else:
            _kernels.curve_points(*self._rows, u.ravel(), out)
        return out.reshape(*u.shape, self.dim)

    def derivative(self, u, order=1):
        """The derivative of the given order, ``(..., dim)``; at a knot the right-hand one."""
        return self.derivatives(u, order)[..., -1, :]

    def derivatives(self, u, order):
        """C(u) and all derivatives up to ``order``: ``(..., order + 1, dim)``."""
        order = checks.as_count("order", order, 0, checks.HIGHEST_ORDER)
        u = checks.wrapped("u", u, self.domain, lambda: self.closed)
        out = _kernels.curve_derivatives(self.degree, self.knots, self.homogeneous, u.ravel(), order)
        checks.require_representable("order", order, out)
        return out.reshape(*u.shape, order + 1, self.dim)

    # Methods that are written in modules of their own.
    tangent, normal, binormal = differential.tangent, differential.normal, differential.binormal
    curvature, torsion = differential.curvature, differential.torsion
    length, parameter_at = measure.length, measure.parameter_at
    closest_point = closest.closest_on_curve

    @property
    def _rows(self):
        return self.degree, self.knots, self.homogeneous

    @property
    def _directions(self):
        return {"u": (self.degree, self.knots)}

    def _with(self, directions, net):
        return self._of(*directions["u"], net)

    def beziers(self):
        """The Bezier pieces between neighbouring knots, as curves of one span each."""
        ends = find_breaks(self.knots, self.degree)
        pieces = refinement.bezier_rows(*self._rows, ends)
        return [
            self._of(self.degree, np.repeat(ends[i : i + 2], self.degree + 1), piece)
            for i, piece in enumerate(pieces)
        ]

    def join(self, *others):
        """One curve that runs through this one and then through the others.

        Each must start where the one before ends, within 1e-9 of the extent. Lower degrees are elevated;
        all curves keep their shapes and the widths of their domains.

        Examples
        --------
        >>> from nurbs_lab.nurbs import arc
        >>> start, end = arc(1.0, 0.0, 2.0).split(0.25)
        >>> round(start.join(end).length(), 12)
        2.0
        """
        return refinement.joined([self, *(checks.as_kind("other", other, NurbsCurve) for other in others)])

    def to_scipy(self):
        """The same curve as a `scipy.interpolate.BSpline`, periodic if closed; ValueError if rational."""
        from scipy.interpolate import BSpline

        if self.rational:
            raise ValueError("weights differ, and a SciPy BSpline has none; see the array `homogeneous`")
        beyond = "periodic" if self.closed else False
        return BSpline(self.knots, self.control_points, self.degree, extrapolate=beyond)

    @classmethod
    def from_scipy(cls, spline):
        """The curve of a `scipy.interpolate.BSpline` with coefficients ``(n,)`` or ``(n, dim)``."""
        from scipy.interpolate import BSpline

        if not isinstance(spline, BSpline):
            raise TypeError(f"spline must be a scipy.interpolate.BSpline, got {type(spline).__name__}")
        points = spline.c[: len(spline.t) - spline.k - 1]
        return cls(spline.k, spline.t, points[:, None] if points.ndim == 1 else points)

    def to_pyvista(self):
        """Points along the curve as a polyline, a `pyvista.PolyData`, 16 cells a span.

        Curves in the plane lie at z = 0.
        """
        import pyvista

        if self.dim > 3:
            raise ValueError(f"only curves in up to 3-D can be drawn, this one is in {self.dim}-D")
        u = span_parameters(self.knots, self.degree, CELLS)
        points = np.zeros((len(u), 3))
        points[:, : self.dim] = self(u)
        return pyvista.PolyData(points, lines=[len(u), *range(len(u))])


def trusted_curve(degree, knots, control_points) -> NurbsCurve:
    """A polynomial curve of float64 arrays that are valid by construction; they are not checked.

    This takes a quarter of the time of `NurbsCurve`, which matters where curves are made by the thousand.
    """
    curve = object.__new__(NurbsCurve)
    curve._store(control_points, np.ones(len(control_points)), degree=degree, knots=checks.freeze(knots))
    return curve
