"""What curves and surfaces share: control points with weights, changes of their knots, and affine maps."""

from dataclasses import replace

import numpy as np

from nurbs_lab.common import checks
from nurbs_lab.common.values import Value
from nurbs_lab.nurbs import refinement


class Spline(Value):
    """Base of curves and surfaces: ``control_points (..., dim)`` and ``weights (...)``."""

    def _store(self, points, weights, **fields):
        fields["control_points"], fields["weights"] = checks.freeze(points), checks.freeze(weights)
        fields["homogeneous"] = checks.freeze(refinement.lift(points, weights))
        for name, value in fields.items():
            object.__setattr__(self, name, value)

    @property
    def dim(self):
        """Number of coordinates of a point."""
        return self.control_points.shape[-1]

    @property
    def rational(self):
        """Whether the weights differ."""
        return bool(np.ptp(self.weights) > 0)

    @classmethod
    def _of(cls, degrees, knots, rows):
        return cls(degrees, knots, refinement.project(rows), rows[..., -1])

    def _along(self, direction, change, *arguments):
        """The result of a change of representation along one direction: a shape or a tuple of them."""
        every = self._directions
        axis = list(every).index(checks.as_choice("direction", direction, tuple(every)))
        net = np.ascontiguousarray(np.moveaxis(self.homogeneous, axis, 0))
        results = change(*every[direction], net.reshape(len(net), -1), *arguments)
        single, shapes = not isinstance(results[0], tuple), []
        for degree, knots, rows in [results] if single else results:
            changed = np.moveaxis(rows.reshape(-1, *net.shape[1:]), 0, axis)
            shapes.append(self._with(every | {direction: (degree, knots)}, changed))
        return shapes[0] if single else tuple(shapes)

    def insert_knot(self, u, times=1, *, direction="u"):
        """The same shape with the knot u inserted ``times`` times; only surfaces have a direction "v"."""
        most = max(degree for degree, _ in self._directions.values())
        new = [u] * checks.as_count("times", times, 1, most)
        return self._along(direction, refinement.insert, new, direction)

    def refine(self, parameters, *, direction="u"):
        """The same shape with all these parameters as further knots."""
        return self._along(direction, refinement.insert, parameters, "parameters")

    def remove_knot(self, u, tolerance, *, direction="u"):
        """The shape with one knot u removed; ValueError if a point could move by more than the tolerance."""
        return self._along(direction, refinement.remove, u, tolerance, self.dim + 1, direction)

    def elevate_degree(self, times=1, *, direction="u"):
        """The same shape with a degree that is higher by ``times``."""
        return self._along(direction, refinement.elevate, checks.as_count("times", times, 1, 20))

    def split(self, u, *, direction="u"):
        """The part before u and the part after it, which divide the domain."""
        return self._along(direction, refinement.split, u, direction)

    def reverse(self, *, direction="u"):
        """The same shape in the opposite direction, over the same domain."""
        return self._along(direction, refinement.reverse)

    def clamped(self):
        """The same shape with end knots of multiplicity degree + 1: its corners are control points."""
        shape = self
        for direction, (degree, knots) in self._directions.items():
            if refinement.domain(degree, knots) != (knots[0], knots[-1]):
                shape = shape._along(direction, refinement.clamped)
        return shape

    def transform(self, matrix, offset=None):
        """The image under x -> matrix x + offset.

        Parameters
        ----------
        matrix : array_like, shape (m, dim) or (dim + 1, dim + 1)
            The larger one acts on (x, 1), as in trimesh; its last row is 0, ..., 0, 1.
        offset : array_like, shape (m,), optional
            Only with a matrix of shape (m, dim).

        Examples
        --------
        >>> from nurbs_lab.nurbs import circle
        >>> circle(2.0, (0, 0)).transform([[0, -1], [1, 0]], (5, 0))(0.0).tolist()
        [5.0, 2.0]
        """
        dim = self.dim
        matrix = checks.as_floats("matrix", matrix, ("m", "dim"))
        if matrix.shape == (dim + 1, dim + 1) and offset is None:
            if matrix[-1].tolist() != [0.0] * dim + [1.0]:
                raise ValueError(f"matrix must end in the row 0, ..., 0, 1, got {matrix[-1]}")
            matrix, offset = matrix[:-1, :-1], matrix[:-1, -1]
        if matrix.shape[1] != dim or not len(matrix):
            raise ValueError(
                f"matrix must have shape (m, {dim}), or ({dim + 1}, {dim + 1}) without an offset, "
                f"got {matrix.shape}"
            )
        moved = self.control_points @ matrix.T
        if offset is not None:
            moved = moved + checks.as_vector("offset", offset, len(matrix))
        return replace(self, control_points=moved)

    def translate(self, offset):
        """The shape moved by an offset ``(dim,)``."""
        return self.transform(np.eye(self.dim), offset)

    def scale(self, factor, center=None):
        """The shape scaled about a center ``(dim,)``, the origin by default.

        ``factor`` is one number, or one for each coordinate; negative ones mirror, zero is refused.
        """
        factor = checks.as_floats("factor", factor)
        if factor.shape not in ((), (self.dim,)) or not factor.all():
            raise ValueError(f"factor must be one number or {self.dim}, none of them zero, got {factor}")
        return self._about(np.diag(np.broadcast_to(factor, self.dim)), center)

    def rotate(self, angle, axis=(0.0, 0.0, 1.0), center=None):
        """The shape turned by an angle in radians, counter-clockwise about an axis through a center.

        In the plane the axis is ignored. The center ``(dim,)`` is the origin by default.
        """
        dim, angle = self.dim, checks.as_number("angle", angle)
        if dim not in (2, 3):
            raise ValueError(f"only shapes in 2-D and 3-D are rotated, this one is in {dim}-D")
        axis = checks.as_direction("axis", axis)
        x, y, z = axis if dim == 3 else (0.0, 0.0, 1.0)
        across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])  # Rodrigues' formula
        turn = np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across
        return self._about(turn[:dim, :dim], center)

    def _about(self, matrix, center):
        if center is None:
            return self.transform(matrix)
        center = checks.as_vector("center", center, self.dim)
        return self.transform(matrix, center - matrix @ center)
