"""A closed mesh divided into four-sided patches: the layout of a reconstruction.

The mesh is coarsened to a few large triangles that know which part of the mesh they stand for, and pairs of
triangles are joined to quadrilaterals (Eck and Hoppe 1996). Edges of the mesh that are sharper than an angle
stay edges of the layout.
"""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.values import Value
from nurbs_lab.mesh.core import edges_and_ways, tails_and_heads
from nurbs_lab.mesh.solid import _kernels_layout, _kernels_ring, quads
from nurbs_lab.mesh.solid.faces import ALONG
from nurbs_lab.mesh.solid.features import Surfels


@dataclass(frozen=True, eq=False, repr=False)
class Layout(Value):
    """Quadrilaterals on a mesh.

    Attributes
    ----------
    fixed : (vertices,) array of bool
        Vertices that are corners of sharp curves.
    corners : (faces, 4) array
        Vertices of the layout, counter-clockwise from outside; corners 0 to 3 are at
        (0, 0), (1, 0), (1, 1) and (0, 1).
    edges : (faces, 4) array
        Edge of the layout on side k, from corner k to the next.
    forward : (faces, 4) array of bool
        Whether the edge runs along the side.
    sides : (edges, 2) array
        The two sides, ``4 face + side``, that meet in every edge; the first one runs forward.
    sharp : (edges,) array of bool
    curves : (edges, samples, 3) array
        Points of the sharp edges, evenly spaced along the mesh, in the direction of the edge; else zeros.
    """

    fixed: np.ndarray
    corners: np.ndarray
    edges: np.ndarray
    forward: np.ndarray
    sides: np.ndarray
    sharp: np.ndarray
    curves: np.ndarray


@dataclass(frozen=True, eq=False)
class Chart:
    """Where the faces of a layout lie on the mesh.

    Attributes
    ----------
    log : (n, 3) array
        How the mesh was coarsened, see `_kernels_feet.trace_back`.
    halves : (faces, 2) array
        The diagonal of the two coarse triangles that a face lies in, as half-edge of either. Their unit
        square has (0, 0) at the head of the first.
    squares : (faces, 4, 2) array
        Corners of the face in that unit square.
    """

    log: np.ndarray
    halves: np.ndarray
    squares: np.ndarray

    def places(self, cells):
        """Coarse triangles, and weights of their corners, of the nodes of even grids on all faces."""
        t = np.arange(cells + 1) / cells
        u, v = t[:, None, None], t[None, :, None]
        a, b, c, d = (self.squares[:, k][:, None, None] for k in range(4))
        u, v = np.moveaxis((a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + c * u) * v, -1, 0)
        upper = v > u
        half = np.where(upper, self.halves[:, 1, None, None], self.halves[:, 0, None, None])
        order = (half[..., None] + np.where(upper, 0, 1)[..., None] + np.arange(3)) % 3
        in_order = np.where(
            upper[..., None], np.stack([1 - v, u, v - u], -1), np.stack([1 - u, u - v, v], -1)
        )
        weights = np.empty_like(in_order)
        np.put_along_axis(weights, order, in_order, axis=-1)
        return half // 3, weights


def lay_out(mesh: Surfels, weight, most_cost, most_faces) -> tuple[Layout, Chart] | None:
    """Divide a mesh; ``most_cost`` is the largest quadric error of a collapse, a squared length.

    ``weight`` of the vertices multiplies the error. None where that takes more than ``most_faces`` pairs of
    coarse triangles: to join so many to faces can take a minute.
    """
    triangles, opposite, sharp = mesh.triangles.copy(), mesh.opposite.copy(), mesh.sharp.copy()
    alive, begin, out = np.ones(len(triangles), dtype=bool), np.arange(len(sharp)), np.empty_like(mesh.kinds)
    tails, heads = tails_and_heads(triangles)
    out[tails] = begin
    length = np.linalg.norm(mesh.vertices[heads] - mesh.vertices[tails], axis=1)
    coarse = _kernels_ring.Coarse(
        mesh.vertices, mesh.kinds, out, triangles, alive, opposite, sharp, begin, length
    )
    log = _kernels_layout.coarsen(coarse, weight, most_cost, mesh.least_chord)
    if alive.sum() > 2 * most_faces:
        return None
    triangle = np.cumsum(alive) - 1
    old = (3 * np.flatnonzero(alive)[:, None] + np.arange(3)).ravel()
    opposite = opposite[old]
    opposite = 3 * triangle[opposite // 3] + opposite % 3
    triangles, sharp, begin = triangles[alive], sharp[old], begin[old]
    curves = _curves(mesh, triangles, opposite, sharp, begin)
    number, count, parts = len(mesh.vertices), len(opposite), []
    middle = number + np.minimum(np.arange(count), opposite)  # of edges; then those of polygons
    for sides, parents, way in quads.divide(mesh, triangles, opposite, sharp):
        hubs = number + count + parents
        nodes = np.column_stack([triangles.ravel()[sides], middle[sides], hubs])
        parts.append(quads.pieces(nodes, sharp[sides], curves[sides], parents, way))
    corners, squares, parents, marks, paths = (np.concatenate(one) for one in zip(*parts, strict=True))
    fixed = np.concatenate([mesh.kinds == _kernels_ring.CORNER, np.zeros(2 * count, dtype=bool)])
    layout = _layout(fixed, corners, marks, paths)
    halves = np.column_stack([parents, opposite[parents]])
    return layout, Chart(log, 3 * np.flatnonzero(alive)[halves // 3] + halves % 3, squares)


def _curves(mesh, triangles, opposite, sharp, begin):
    """Points evenly spaced along the part of the mesh that every sharp half-edge stands for."""
    curves = np.zeros((len(sharp), ALONG, 3))
    tails, heads = tails_and_heads(mesh.triangles)
    halves = np.flatnonzero(mesh.sharp)
    sums = np.bincount(tails[halves], halves, len(mesh.vertices)).astype(int)  # of the two leaving a vertex
    first = np.flatnonzero(sharp & (np.arange(len(sharp)) < opposite))
    ends = tails_and_heads(triangles)[1][first]
    for h, half, end in zip(first.tolist(), begin[first].tolist(), ends.tolist(), strict=True):
        along = [tails[half], heads[half]]
        while along[-1] != end:
            half = sums[along[-1]] - mesh.opposite[half]
            along.append(heads[half])
        path = mesh.vertices[along]
        s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
        t = np.linspace(0.0, s[-1], curves.shape[1])
        curves[h] = np.column_stack([np.interp(t, s, x) for x in path.T])
    curves[opposite[first]] = curves[first, ::-1]
    return curves


def _layout(fixed, corners, sharp, curves):
    """Number the edges of quadrilaterals."""
    used, corners = np.unique(corners, return_inverse=True)
    fixed, corners = fixed[used], corners.reshape(-1, 4)
    edges, ways = edges_and_ways(corners, np.arange(corners.size))
    count, forward = int(edges.max()) + 1, ways > 0
    if len(edges) != 2 * count or np.bincount(edges[forward], minlength=count).max() != 1:
        raise ArithmeticError("the layout is not a closed surface")
    sides = np.empty((count, 2), dtype=np.int64)
    sides[edges[forward], 0] = np.flatnonzero(forward)
    sides[edges[~forward], 1] = np.flatnonzero(~forward)
    first = sides[:, 0]
    sharp, curves = sharp.ravel()[first], curves.reshape(len(edges), *curves.shape[2:])[first]
    return Layout(fixed, corners, edges.reshape(-1, 4), forward.reshape(-1, 4), sides, sharp, curves)
