"""Contact of a cutter with a part: resting heights, collisions, gouge depths, sideways motion."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind
from nurbs_lab.common.threads import over_blocks
from nurbs_lab.machining import _kernels_search as kernels
from nurbs_lab.machining.cutter import Cutter
from nurbs_lab.machining.part import Part, prepare_part


def drop_cutter(part, cutter, xy):
    """Height of the tip of a cutter that is lowered onto a part.

    Parameters
    ----------
    part : trimesh.Trimesh, pyvista.PolyData, file name, Reconstruction, NurbsSurface or Part
        NURBS are tessellated within 1 µm; `machining.prepare_part` takes another tolerance, and its result
        can be used many times.
    cutter : Cutter
        Its length and shank are ignored here; `finish` refuses a cutter that is too short.
    xy : array_like, shape (..., 2)
        Positions of the axis, in mm.

    Returns
    -------
    ndarray, shape (...,)
        Height of the tip in mm, -inf where the cutter touches nothing.

    Notes
    -----
    Exact for facets, edges and vertices, to rounding. The tree of boxes is searched on all cores.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> box = trimesh.creation.box(extents=(20, 20, 10))
    >>> nl.drop_cutter(box, nl.Cutter("ball", diameter=6.0), [(0, 0), (11, 0), (14, 0)]).round(3)
    array([5.   , 4.828,  -inf])
    """
    part, cutter = prepare_part(part), as_kind("cutter", cutter, Cutter)
    xy = as_floats("xy", xy)
    if xy.ndim < 1 or xy.shape[-1] != 2:
        raise ValueError(f"xy must have shape (..., 2), got {xy.shape}")
    return contact(part, cutter).heights(xy.reshape(-1, 2)).reshape(xy.shape[:-1])


NEEDLE = (0.0, 0.0, np.inf, 0.0)  # the shape of a cutter without width


@dataclass(frozen=True, eq=False)
class Contact:
    """A part and a cutter enlarged all round by an allowance; made by `contact`.

    All positions are of the tip of the cutter itself. A path within the allowance of one along which the
    enlarged cutter does not gouge is free of gouges for the cutter itself.
    """

    part: Part
    shape: tuple[float, float, float, float]
    allowance: float

    def heights(self, xy, least=-np.inf) -> np.ndarray:
        """Height of the resting tip at ``xy (n, 2)``; ``least``, of all or of each, where that is higher."""
        start = np.full(len(xy), least - self.allowance)
        out = self._over_blocks(kernels.drop, "dropping the cutter", xy, start)
        return np.where(out > start, out + self.allowance, least)

    def collides(self, tips) -> np.ndarray:
        """Whether the cutter cuts into the part with its tip at each of ``tips (n, 3)``."""
        return self.strays(tips, np.arange(len(tips) + 1))

    def strays(self, tips, starts, farther=None) -> np.ndarray:
        """Of rows of tips, whether this cutter cuts into the part, or the one ``farther`` off does not.

        Row i is ``tips[starts[i] : starts[i + 1]]``, of tips ``(n, 3)``.
        """
        other = None if farther is None else (farther.shape, farther.allowance)
        out, tips = np.empty(len(starts) - 1, bool), np.ascontiguousarray(tips)

        def block(some):
            rows = starts[some.start : some.stop + 1]
            kernels.collides(tips, rows, self._body, (self.shape, self.allowance), other, out[some])

        over_blocks(block, len(out), "checking")
        return out

    def depths(self, tips) -> np.ndarray:
        """How much smaller all round the cutter must be not to cut into the part at ``tips (n, 3)``."""
        return self._over_blocks(kernels.depths, "measuring gouges", tips - (0.0, 0.0, self.allowance))

    def push(self, free, stuck, level) -> np.ndarray:
        """Fraction of the distance from ``free (n, 2)`` to ``stuck`` that the tip moves at ``level (n,)``.

        It is found to 2e-5 of the radius on the free side; NaN if the tip cannot start or nothing stops it.
        """
        return self._over_blocks(kernels.push, "pushing", free, stuck, level - self.allowance)

    def _over_blocks(self, kernel, what, *arrays):
        out = np.empty(len(arrays[0]))

        def block(some):
            kernel(*(array[some] for array in arrays), self._body, self.shape, out[some])

        over_blocks(block, len(out), what)
        return out

    @property
    def _body(self):
        part, tree = self.part, self.part.tree
        return tree.corners, part.normals, part.edges, tree.boxes


def body_contacts(part, cutter, tips):
    """Of shank and holder, if they touch the part: name, the tips there, how far above the tip is enough."""
    for name, radius, height in cutter.bodies:
        touch = contact(part, Cutter("flat", diameter=2.0 * radius, length=height))
        hit = tips[touch.collides(tips + np.array([0.0, 0.0, height]))]
        if len(hit):
            yield name, hit, float((touch.heights(hit[:, :2]) - hit[:, 2]).max())


def contact(part, cutter, allowance=0.0, wider=0.0) -> Contact:
    """The contact of a part with a cutter enlarged by ``allowance`` all round, or reduced if it is negative.

    The offset of a cutter by ``allowance`` is a cutter with a larger corner radius. One that is ``wider`` all
    round has a larger disc, and holds the cutter as it is moved as far at its level.
    """
    flat, corner, slope, radius = cutter.shape
    flat, corner = flat + wider + min(corner + allowance, 0.0), max(corner + allowance, 0.0)
    return Contact(part, (flat, corner, slope, radius + allowance + wider), allowance)
