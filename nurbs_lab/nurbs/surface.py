"""The NURBS surface."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.nurbs import _checks, _kernels_surface
from nurbs_lab.nurbs.curve import CLOSED_WITHIN


@dataclass(frozen=True, eq=False, repr=False)
class NurbsSurface:
    """A non-uniform rational B-spline surface S(u, v) (paper Eq. 6).

    Parameters
    ----------
    degrees : (int, int)
        p along u and q along v, at least 1.
    knots : (array_like, array_like)
        U, shape (nu + p + 1,), and V, shape (nv + q + 1,).
    control_points : array_like, shape (nu, nv, dim)
    weights : array_like, shape (nu, nv), optional
        Positive; all one if left out.

    Raises
    ------
    TypeError, ValueError
        Naming the argument, the wrong value and the cure.

    Notes
    -----
    All arrays are read-only float64; ``homogeneous`` is ``(nu, nv, dim + 1)``. Closed directions of a
    fit have periodic, unclamped knots, see `NurbsCurve`.
    """

    degrees: tuple
    knots: tuple
    control_points: np.ndarray
    weights: np.ndarray | None = None

    def __post_init__(self):
        degrees = tuple(
            _checks.as_count(f"degrees[{i}]", d)
            for i, d in enumerate(_checks.as_pair("degrees", self.degrees))
        )
        points = _checks.as_floats("control_points", self.control_points, ("nu", "nv", "dim"))
        for axis, degree in enumerate(degrees):
            if points.shape[axis] <= degree:
                raise ValueError(
                    f"control_points: degree {degree} in direction {'uv'[axis]} needs at least {degree + 1} "
                    f"control points there, got {points.shape[axis]}"
                )
        if points.shape[2] < 1:
            raise ValueError(f"control_points must have one coordinate or more, got shape {points.shape}")
        knots = tuple(
            _checks.freeze(_checks.as_knots(f"knots[{i}]", k, degrees[i], points.shape[i]))
            for i, k in enumerate(_checks.as_pair("knots", self.knots))
        )
        weights = _checks.as_weights("weights", self.weights, points.shape[:2])
        homogeneous = np.concatenate([points * weights[..., None], weights[..., None]], axis=2)
        object.__setattr__(self, "degrees", degrees)
        object.__setattr__(self, "knots", knots)
        object.__setattr__(self, "control_points", _checks.freeze(points))
        object.__setattr__(self, "weights", _checks.freeze(weights))
        object.__setattr__(self, "homogeneous", _checks.freeze(homogeneous))

    def __repr__(self):
        nu, nv, dim = self.control_points.shape
        kind = "rational" if self.rational else "polynomial"
        return f"NurbsSurface(degrees {self.degrees}, {nu} x {nv} control points in {dim}-D, {kind})"

    @property
    def dim(self):
        """Number of coordinates of a point."""
        return self.control_points.shape[2]

    @property
    def domain(self):
        """((u first, u last), (v first, v last))."""
        return tuple((float(k[p]), float(k[-p - 1])) for k, p in zip(self.knots, self.degrees, strict=True))

    @property
    def rational(self):
        """Whether the weights differ."""
        return bool(np.ptp(self.weights) > 0)

    @property
    def closed(self):
        """(along u, along v): whether the opposite edges meet, measured within 1e-9 of the extent."""
        extent = np.linalg.norm(np.ptp(self.control_points.reshape(-1, self.dim), axis=0))
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

    def _pairs(self, u, v):
        """u and v checked, broadcast, flat, and the shape that they share."""
        u = _checks.as_parameters("u", u, self.domain[0])
        v = _checks.as_parameters("v", v, self.domain[1])
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
        u, v = (
            np.atleast_1d(_checks.as_parameters(name, x, span))
            for name, x, span in zip("uv", (u, v), self.domain, strict=True)
        )
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
        ku, kv = (
            _checks.as_count(f"order[{i}]", k, least=0) for i, k in enumerate(_checks.as_pair("order", order))
        )
        u, v, shape = self._pairs(u, v)
        out = _kernels_surface.surface_derivatives(*self._plain, u, v, ku, kv)
        return out.reshape(*shape, ku + 1, kv + 1, self.dim)
