"""The NURBS surface."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.nurbs import _kernels_surface, closest, differential, measure, refinement, tessellation
from nurbs_lab.nurbs.curve import CLOSED_WITHIN, NurbsCurve
from nurbs_lab.nurbs.spans import span_parameters
from nurbs_lab.nurbs.spline import Spline

CELLS = 6  # of a picture, along each span


@dataclass(frozen=True, eq=False, repr=False)
class NurbsSurface(Spline):
    """A non-uniform rational B-spline surface S(u, v) (paper Eq. 6).

    Parameters
    ----------
    degrees : (int, int)
        p along u and q along v, at least 1.
    knots : (array_like, array_like)
        U, shape (nu + p + 1,), and V, shape (nv + q + 1,).
    control_points : array_like, shape (nu, nv, dim)
    weights : array_like, shape (nu, nv), optional
        Positive; all one by default.

    Raises
    ------
    TypeError, ValueError
        Naming the argument, the wrong value and the cure.

    Notes
    -----
    All arrays are read-only float64; ``homogeneous`` is ``(nu, nv, dim + 1)``. Closed directions of a
    fit have periodic, unclamped knots, see `NurbsCurve`.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> corners = [[(0, 0, 0), (0, 2, 0)], [(2, 0, 0), (2, 2, 4)]]
    >>> saddle = nl.NurbsSurface((1, 1), ([0, 0, 1, 1], [0, 0, 1, 1]), corners)
    >>> saddle(0.5, 0.5).tolist(), saddle.derivative(0.5, 0.5, order=(1, 1)).tolist()
    ([1.0, 1.0, 1.0], [0.0, 0.0, 4.0])
    """

    degrees: tuple
    knots: tuple
    control_points: np.ndarray
    weights: np.ndarray | None = None

    def __post_init__(self):
        degrees = checks.as_pair("degrees", self.degrees, checks.as_count)
        points = checks.as_floats("control_points", self.control_points, ("nu", "nv", "dim"))
        for axis, degree in enumerate(degrees):
            if points.shape[axis] <= degree:
                raise ValueError(
                    f"control_points: degree {degree} in direction {'uv'[axis]} needs at least {degree + 1} "
                    f"control points there, got {points.shape[axis]}"
                )
        if points.shape[2] < 1:
            raise ValueError(f"control_points must have one coordinate or more, got shape {points.shape}")
        knots = tuple(
            checks.freeze(checks.as_knots(f"knots[{i}]", k, degrees[i], points.shape[i]))
            for i, k in enumerate(checks.as_pair("knots", self.knots))
        )
        weights = checks.as_weights("weights", self.weights, points.shape[:2])
        self._store(points, weights, degrees=degrees, knots=knots)

    def __repr__(self):
        nu, nv, dim = self.control_points.shape
        kind = "rational" if self.rational else "polynomial"
        return f"NurbsSurface(degrees {self.degrees}, {nu} x {nv} control points in {dim}-D, {kind})"

    @property
    def domain(self):
        """((u first, u last), (v first, v last))."""
        return tuple(map(refinement.domain, self.degrees, self.knots))

    @property
    def closed(self):
        """(along u, along v): whether the opposite edges meet, measured within 1e-9 of the extent."""
        extent = checks.extent(self.control_points)
        (u0, u1), (v0, v1) = self.domain
        u, v = (
            np.linspace(*span, 4 * n) for span, n in zip(self.domain, self.control_points.shape, strict=False)
        )
        gap_u = self.grid([u0], v) - self.grid([u1], v)
        gap_v = self.grid(u, [v0]) - self.grid(u, [v1])
        return tuple(
            bool(np.linalg.norm(gap, axis=-1).max() <= CLOSED_WITHIN * extent) for gap in (gap_u, gap_v)
        )

    @property
    def _plain(self):
        return (*self.degrees, *self.knots, self.homogeneous)

    def _wrapped(self, axis, value):
        return checks.wrapped("uv"[axis], value, self.domain[axis], lambda: self.closed[axis])

    def _pairs(self, u, v):
        """u and v, checked, broadcast and flattened, and their common shape."""
        u, v = (self._wrapped(axis, x) for axis, x in enumerate((u, v)))
        try:
            shape = np.broadcast_shapes(u.shape, v.shape)
        except ValueError:
            raise ValueError(
                f"u and v must broadcast, got shapes {u.shape} and {v.shape}; see grid()"
            ) from None
        return *(np.array(np.broadcast_to(x, shape)).ravel() for x in (u, v)), shape

    def __call__(self, u, v):
        """Points S(u, v): ``(..., dim)`` for u and v that broadcast to shape ``(...)``."""
        u, v, shape = self._pairs(u, v)
        out = np.empty((u.size, self.dim))
        _kernels_surface.surface_points(*self._plain, u, v, out)
        return out.reshape(*shape, self.dim)

    def grid(self, u, v):
        """Points on the whole grid of two parameter lists: ``(len(u), len(v), dim)``."""
        u, v = (np.atleast_1d(self._wrapped(axis, x)) for axis, x in enumerate((u, v)))
        if u.ndim > 1 or v.ndim > 1:
            raise ValueError(f"u and v must be one-dimensional, got shapes {u.shape} and {v.shape}")
        out = np.empty((u.size, v.size, self.dim))
        _kernels_surface.surface_grid(*self._plain, u, v, out)
        return out

    def derivative(self, u, v, order=(1, 0)):
        """The mixed derivative of ``order`` (along u, along v): ``(..., dim)``."""
        return self.derivatives(u, v, order)[..., -1, -1, :]

    def derivatives(self, u, v, order):
        """All mixed derivatives up to ``order``: ``(..., order_u + 1, order_v + 1, dim)``."""
        ku, kv = checks.as_pair("order", order, checks.as_count, 0, checks.HIGHEST_ORDER)
        u, v, shape = self._pairs(u, v)
        out = _kernels_surface.surface_derivatives(*self._plain, u, v, (ku, kv))
        checks.require_representable("order", max(ku, kv), out)
        return out.reshape(*shape, ku + 1, kv + 1, self.dim)

    # Methods that are written in modules of their own.
    normal, curvature = differential.surface_normal, differential.surface_curvature
    area, closest_point = property(measure.area), closest.closest_on_surface
    tessellate = tessellation.triangles

    @property
    def _directions(self):
        return dict(zip("uv", zip(self.degrees, self.knots, strict=True), strict=True))

    def _with(self, directions, net):
        return self._of(*zip(*directions.values(), strict=True), net)

    def iso_curve(self, *, u=None, v=None):
        """The curve of constant u, or of constant v, lying in the surface."""
        if (u is None) == (v is None):
            raise ValueError(f"give either u or v, got u = {checks.shown(u)} and v = {checks.shown(v)}")
        axis, name, value = (0, "u", u) if v is None else (1, "v", v)
        value = checks.as_parameters(name, checks.as_number(name, value), self.domain[axis])
        net = np.ascontiguousarray(np.moveaxis(self.homogeneous, axis, 0))
        row = refinement.value(self.degrees[axis], self.knots[axis], net.reshape(len(net), -1), float(value))
        other = 1 - axis
        return NurbsCurve._of(self.degrees[other], self.knots[other], row.reshape(-1, self.dim + 1))

    def to_scipy(self):
        """The same surface as a `scipy.interpolate.NdBSpline`, if it is not rational."""
        from scipy.interpolate import NdBSpline

        if self.rational:
            raise ValueError("weights differ, and a SciPy NdBSpline has none; see the array `homogeneous`")
        return NdBSpline(self.knots, self.control_points, self.degrees, extrapolate=False)

    @classmethod
    def from_scipy(cls, spline):
        """The surface of a `scipy.interpolate.NdBSpline` with coefficients ``(nu, nv, dim)``."""
        from scipy.interpolate import NdBSpline

        if not isinstance(spline, NdBSpline):
            raise TypeError(f"spline must be a scipy.interpolate.NdBSpline, got {type(spline).__name__}")
        return cls(spline.k, spline.t, spline.c)

    def to_pyvista(self):
        """A `pyvista.StructuredGrid` of points, six cells a span."""
        import pyvista

        if self.dim != 3:
            raise ValueError(f"only surfaces in 3-D can be drawn, this one is in {self.dim}-D")
        u, v = (span_parameters(k, p, CELLS) for k, p in zip(self.knots, self.degrees, strict=True))
        points = self.grid(u, v)
        return pyvista.StructuredGrid(*(points[..., d : d + 1] for d in range(3)))
