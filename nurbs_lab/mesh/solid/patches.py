"""Bicubic B-spline patches on a layout: neighbours have the same control points along their common edge."""

from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.interpolate import BSpline
from scipy.sparse import csr_matrix

from nurbs_lab.common.threads import equal_slices, over_blocks, over_slices
from nurbs_lab.common.values import Value
from nurbs_lab.mesh.solid import _kernels_patches as kernels
from nurbs_lab.mesh.solid.layout import Layout
from nurbs_lab.mesh.solid.surfels import unit
from nurbs_lab.nurbs import NurbsSurface
from nurbs_lab.nurbs.knots import uniform_knots

DEGREE = 3
BESIDE_TIP = 0.25  # of an edge that ends in a sharp point, where its angles do not count
_MANY = 20_000  # rows of a matrix that a second thread helps to multiply


@dataclass(frozen=True, eq=False, repr=False)
class Patches(Value):
    """Fitted patches.

    Attributes
    ----------
    layout : Layout
    spans : int
        Of every patch along each side.
    net : (faces, spans + 3, spans + 3) array
        Number of every control point; equal numbers are one point.
    control : (n, 3) array
    degree : int
        3; 1 if all patches are bilinear, which needs only their corners.
    """

    layout: Layout
    spans: int
    net: np.ndarray
    control: np.ndarray
    degree: int = DEGREE

    @cached_property
    def surfaces(self) -> tuple[NurbsSurface, ...]:
        """One untrimmed surface a face."""
        p = self.degree
        net = self.net if p == DEGREE else self.net[:, ::DEGREE, ::DEGREE]
        knots = uniform_knots(p, net.shape[1])
        return tuple(NurbsSurface((p, p), (knots, knots), rows) for rows in self.control[net])

    def grid(self, cells):
        """Points of every face on an even grid, ``(faces, cells + 1, cells + 1, 3)``."""
        out = np.empty((len(self.net), cells + 1, cells + 1, 3))
        t = np.arange(cells + 1) / cells
        over_slices(
            lambda part: kernels.grids(self.control, self.net[part], self.spans, t, out[part]),
            equal_slices(len(out), 1),
            "grids",
        )
        return out

    @cached_property
    def opposite(self) -> np.ndarray:
        """The side across every side."""
        edges = self.layout.edges.ravel()
        return self.layout.sides[edges].sum(axis=1) - np.arange(len(edges))

    def nearest(self, points, face, uv):
        """Distances of points; their places ``face`` and ``uv`` are moved downhill to the nearest ones."""
        sharp, gaps = self.layout.sharp[self.layout.edges].ravel(), np.empty(len(points))

        def move(part):
            gaps[part] = kernels.nearest_places(
                self.control, self.net, self.spans, self.opposite, sharp, points[part], face[part], uv[part]
            )

        over_blocks(move, len(points), "distances to patches")
        return gaps

    @property
    def points(self) -> int:
        """Number of control points of all faces, common ones counted for each."""
        return self.net.size if self.degree == DEGREE else 4 * len(self.net)

    def _area_vectors(self):
        """Area vectors of pieces of all faces, points of the pieces, and the basis along a side there.

        Five Gauss points a span make volumes exact to rounding. The mean of the control points is the origin.
        """
        t, w = gauss_points(self.spans, 5)
        value, first = basis_at(self.spans, t, 1)
        net = (self.control - self.control.mean(axis=0))[self.net]
        points, du, dv = (
            np.einsum("ai,bj,fijx->fabx", u, v, net, optimize=True)
            for u, v in ((value, value), (first, value), (value, first))
        )
        return np.cross(du, dv) * np.outer(w, w)[..., None], points, value

    def volume_and_area(self):
        """What the patches enclose, by the divergence theorem, and their area."""
        vectors, points, _ = self._area_vectors()
        return _volume(points, vectors), float(np.linalg.norm(vectors, axis=-1).sum())

    def enclosing(self, volume):
        """Patches moved by about one length along their normals, so that they enclose a volume.

        Flat faces stay. The length is one Newton step, which leaves an error of second order.
        """
        vectors, points, value = self._area_vectors()
        sizes = np.linalg.norm(vectors, axis=-1, keepdims=True)
        parts = np.einsum(
            "fabx,ai,bj->fijx", np.concatenate([vectors, sizes], -1), value, value, optimize=True
        )
        sums = np.zeros((len(self.control), 4))
        np.add.at(sums, self.net, parts)
        slopes, moves = sums[:, :3], sums[:, :3] / np.maximum(sums[:, 3:], 1e-300)
        moves[self.net[self.layout.flat]] = 0.0
        length = (volume - _volume(points, vectors)) / (slopes * moves).sum()
        return replace(self, control=self.control + length * moves)

    def seam_angles(self, samples):
        """Angle in degrees between the two faces at even places along every edge, ``(edges, samples)``.

        It is 0 on the last quarter of an edge that ends in a sharp point, such as the tip of a cone.
        """
        t = (np.arange(samples) + 0.5) / samples
        normals = []
        for which, along in ((0, t), (1, t[::-1])):
            side = self.layout.sides[:, which]
            uv = side_places(side % 4, along)
            _, du, dv = rows_at(self.net, len(self.control), self.spans, np.repeat(side // 4, samples), uv)
            normals.append(np.cross(du @ self.control, dv @ self.control))
        sine = np.linalg.norm(np.cross(*normals), axis=1)
        angles = np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", *normals))).reshape(-1, samples)
        tips = self.layout.tips
        angles[(tips[:, :1] & (t < BESIDE_TIP)) | (tips[:, 1:] & (1.0 - t < BESIDE_TIP))] = 0.0
        return angles


def _volume(points, vectors):
    """The volume inside a closed surface, of points on its pieces and the area vectors of these."""
    return float(np.einsum("fabx,fabx->", points, vectors)) / 3.0


def number_control_points(layout: Layout, spans):
    """Numbers of the control points of all patches: those of vertices, of edges, of the inside of faces."""
    vertices, edges, faces = int(layout.corners.max()) + 1, len(layout.sides), len(layout.corners)
    n = spans + DEGREE
    inner = n - 2
    net = np.empty((faces, n, n), dtype=np.int64)
    on_edge = vertices + inner * layout.edges[:, :, None] + np.arange(inner)
    on_edge = np.where(layout.forward[:, :, None], on_edge, on_edge[:, :, ::-1])
    for k, side in enumerate(sides_of(net)):
        side[:, 0], side[:, 1:-1] = layout.corners[:, k], on_edge[:, k]
    first = vertices + inner * edges
    net[:, 1:-1, 1:-1] = first + np.arange(faces * inner**2).reshape(faces, inner, inner)
    return net, first + faces * inner**2


def sides_of(grids):
    """Views of the four sides of grids ``(faces, n, n, ...)``, each counter-clockwise from its corner."""
    return grids[:, :, 0], grids[:, -1], grids[:, ::-1, -1], grids[:, 0, ::-1]


def cells_of(grids):
    """Views of the four corners of the cells of grids ``(faces, n, n, ...)``, counter-clockwise."""
    return grids[:, :-1, :-1], grids[:, 1:, :-1], grids[:, 1:, 1:], grids[:, :-1, 1:]


def cell_normals(grids):
    """Unit normals of the cells of grids of points."""
    a, b, c, d = cells_of(grids)
    return unit(np.cross(c - a, d - b))


def equations_at(net, spans, face, uv):
    """Numbers of the 16 control points at places, and their weights in the point and in both derivatives."""
    shape = (len(face), 16)
    columns = np.empty(shape, dtype=np.int64)
    weights = [np.empty(shape) for _ in range(3)]
    kernels.equations(net, spans, face, uv, columns, *weights)
    return columns, weights


def rows_of(columns, weights, count):
    """Equations with 16 control points each as a sparse matrix."""
    ends = np.arange(0, 16 * len(columns) + 1, 16)
    return csr_matrix((weights.ravel(), columns.ravel(), ends), shape=(len(columns), count))


def product(rows, x):
    """A sparse matrix, row by row, times three columns; on all cores if it is large."""
    return in_parts(
        partial(kernels.product, rows.indptr, rows.indices, rows.data, x), np.empty((rows.shape[0], 3))
    )


def in_parts(kernel, out):
    """Let ``kernel(start, stop, out)`` fill the rows of an array, on all cores if they are many."""
    parts = equal_slices(len(out), _MANY)
    over_slices(lambda part: kernel(part.start, part.stop, out), parts, "products")
    return out


def rows_at(net, count, spans, face, uv):
    """Sparse matrices from control points to points and their derivatives along u and v."""
    columns, weights = equations_at(net, spans, face, uv)
    return [rows_of(columns, w, count) for w in weights]


def side_places(side, t):
    """(u, v) at parameters t along sides, ``(len(side) len(t), 2)``."""
    zero, one = np.zeros_like(t), np.ones_like(t)
    table = np.stack([np.column_stack(p) for p in ((t, zero), (one, t), (1 - t, one), (zero, 1 - t))])
    return table[side].reshape(-1, 2)


def between_corners(layout: Layout, faces, t):
    """Points at parameters t along u and v between the corners of faces, ``(faces, len(t), len(t), 3)``."""
    a, b, c, d = (layout.points[layout.corners[faces, k]][:, None, None] for k in range(4))
    u, v = t[:, None, None], t[None, :, None]
    return (a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + c * u) * v


def basis_at(spans, t, order):
    """Matrices from the control points along a side to values and derivatives up to ``order`` at t."""
    splines = BSpline(uniform_knots(DEGREE, spans + DEGREE), np.eye(spans + DEGREE), DEGREE)
    return [splines(t, nu=k) for k in range(order + 1)]


def gauss_points(spans, count):
    """Parameters and weights of a Gauss formula with ``count`` points in every span."""
    nodes, weights = leggauss(count)
    t = ((np.arange(spans)[:, None] + (nodes + 1) / 2) / spans).ravel()
    return t, np.tile(weights, spans) / (2 * spans)


def middle_places(spans):
    """Parameters of the control points: the means of their knots (Greville)."""
    knots = uniform_knots(DEGREE, spans + DEGREE)
    return np.convolve(knots[1:-1], np.ones(DEGREE) / DEGREE, "valid")


def linear(layout: Layout) -> Patches:
    """Patches that are bilinear between the corners of the layout."""
    net, count = number_control_points(layout, 1)
    control = np.empty((count, 3))
    control[net] = between_corners(layout, slice(None), np.arange(DEGREE + 1) / DEGREE)
    return Patches(layout, 1, net, control, 1)
