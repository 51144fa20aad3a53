"""Moves of curves and surfaces: affine maps of their control points, which map the whole shape."""

import numpy as np

from nurbs_lab.common import checks


class Movable:
    """Base of curves and surfaces: affine maps of ``control_points (..., dim)``."""

    __slots__ = ()

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
        points = self.control_points
        dim = points.shape[-1]
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
        moved = points @ matrix.T
        if offset is not None:
            offset = checks.as_floats("offset", offset, ("m",))
            if offset.shape != (len(matrix),):
                raise ValueError(
                    f"offset must have {len(matrix)} entries, one for each row of matrix, got {offset.size}"
                )
            moved = moved + offset
        return self._with_points(moved)

    def translate(self, offset):
        """The shape moved by an offset ``(dim,)``."""
        return self.transform(np.eye(self.control_points.shape[-1]), offset)

    def scale(self, factor, center=None):
        """The shape scaled about a center ``(dim,)``, the origin if left out.

        ``factor`` is one number, or one for each coordinate; negative ones mirror, zero is refused.
        """
        dim = self.control_points.shape[-1]
        factor = checks.as_floats("factor", factor)
        if factor.shape not in ((), (dim,)) or not factor.all():
            raise ValueError(f"factor must be one number or {dim}, none of them zero, got {factor}")
        return self._about(np.diag(np.broadcast_to(factor, dim)), center)

    def rotate(self, angle, axis=(0.0, 0.0, 1.0), center=None):
        """The shape turned by an angle in radians, counter-clockwise about an axis through a center.

        In the plane the axis is ignored. The center ``(dim,)`` is the origin if left out.
        """
        dim, angle = self.control_points.shape[-1], checks.as_number("angle", angle)
        if dim not in (2, 3):
            raise ValueError(f"only shapes in 2-D and 3-D are rotated, this one is in {dim}-D")
        axis = checks.as_floats("axis", axis, ("3",))
        size = np.linalg.norm(axis)
        if axis.size != 3 or not size > 0:
            raise ValueError(f"axis must be a vector of 3 coordinates that is not zero, got {axis}")
        x, y, z = axis / size if dim == 3 else (0.0, 0.0, 1.0)
        across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])  # Rodrigues' formula
        turn = np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across
        return self._about(turn[:dim, :dim], center)

    def _about(self, matrix, center):
        if center is None:
            return self.transform(matrix)
        center = checks.as_floats("center", center, ("dim",))
        if center.size != len(matrix):
            raise ValueError(f"center must have {len(matrix)} coordinates, got {center.size}")
        return self.transform(matrix, center - matrix @ center)
