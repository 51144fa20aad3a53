"""The directed weighted graph of triangles (paper, Eq. 1, Figs. 1 and 2).

Face f points to its neighbour g with a weight that says *which edge of g* the two share: 1 for corners 0 and
1, 2 for corners 0 and 2, 3 for corners 1 and 2. It is stored as a table of opposite half-edges.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nurbs_lab.common.progress import interruptible
from nurbs_lab.common.threads import equal_slices, even_slices, over_slices
from nurbs_lab.common.values import Value
from nurbs_lab.mesh import _kernels_core
from nurbs_lab.mesh.read import arrays_of

_MANY = 20_000  # vertices; fewer are not worth a second thread


@dataclass(frozen=True, eq=False, repr=False)
class MeshGraph(Value):
    """Triangles that know their neighbours; build it once with `mesh_graph`, slice it many times.

    Attributes
    ----------
    vertices : (n, 3) array
        Distinct vertices: equal coordinates were welded.
    triangles : (m, 3) array
        Corners of every triangle of the mesh, in its order and winding.
    opposite : (3 m,) array
        The half-edge ``3 * triangle + weight - 1`` on the other side of each half-edge, -1 where there is
        none.
    kinds : (3 m,) array
        0 regular, 1 boundary, 2 non-manifold (shared by three or more), 3 against the winding of its
        neighbour.
    junk : (m,) array of bool
        Triangles left out: a corner repeated, or a copy of an earlier triangle.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    opposite: np.ndarray
    kinds: np.ndarray
    junk: np.ndarray

    def __post_init__(self):
        for array in (self.vertices, self.triangles, self.opposite, self.kinds, self.junk):
            array.setflags(write=False)

    @property
    def neighbours(self) -> np.ndarray:
        """Face across each edge, ``(m, 3)``; -1 where there is none. Column e is the edge of weight e + 1."""
        return np.where(self.opposite < 0, -1, self.opposite // 3).reshape(-1, 3)

    @property
    def weights(self) -> np.ndarray:
        """Weight of Eq. (1) towards each neighbour, ``(m, 3)``: 1, 2 or 3, and 0 where there is none."""
        return np.where(self.opposite < 0, 0, self.opposite % 3 + 1).reshape(-1, 3)

    @cached_property
    def closed(self) -> bool:
        """Whether every edge has two sides, so that every contour of every plane is closed."""
        parts = equal_slices(len(self.opposite), _MANY)
        alone = over_slices(lambda part: np.count_nonzero(self.opposite[part] < 0), parts, "counting")
        return bool(sum(alone) == 3 * np.count_nonzero(self.junk))  # which have no opposite ones

    @property
    def boundary_edges(self) -> np.ndarray:
        """Vertex pairs of the edges that only one triangle has, ``(b, 2)``."""
        return self._edges(1)

    @property
    def non_manifold_edges(self) -> np.ndarray:
        """Vertex pairs of the edges that three or more triangles share, ``(b, 2)``, each once."""
        return self._edges(2)

    @property
    def against_winding_edges(self) -> np.ndarray:
        """Vertex pairs of the edges whose two triangles are wound against each other, ``(b, 2)``."""
        return self._edges(3)

    def division_mark(self, layer) -> np.ndarray:
        """The paper's mark: True for every triangle that the contours of ``layer`` pass through, ``(m,)``."""
        contours = getattr(layer, "contours", None)
        if not isinstance(contours, tuple):
            raise TypeError(f"layer must be a Layer, got {type(layer).__name__}")
        mark = np.zeros(len(self.triangles), dtype=bool)
        for contour in contours:
            if contour.triangles.max() >= len(mark):
                raise ValueError(f"layer passes through triangle {contour.triangles.max()} of another mesh")
            mark[contour.triangles] = True
        return mark

    def _edges(self, kind):
        triangle, edge = np.divmod(np.flatnonzero(self.kinds == kind), 3)
        ends = [self.triangles[triangle, side[edge]] for side in (_kernels_core.TAIL, _kernels_core.HEAD)]
        return np.unique(np.sort(np.column_stack(ends), axis=1), axis=0)


@interruptible()
def mesh_graph(mesh) -> MeshGraph:
    """Build the weighted graph of a mesh in linear time (paper, Eq. 1).

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph
        Vertices with equal coordinates are welded, so a soup of triangles will do. A graph is returned as it
        is.

    Raises
    ------
    TypeError, ValueError
        If there is no mesh in it: see `nurbs_lab.mesh.read.arrays_of`.
    """
    if isinstance(mesh, MeshGraph):
        return mesh
    vertices, triangles = arrays_of(mesh)
    return graph_of(vertices, triangles)


def graph_of(vertices, triangles) -> MeshGraph:
    """The graph of plain arrays: vertices ``(n, 3)`` float64, triangles ``(m, 3)`` int32.

    The vertices are welded, and the triangles renumbered, in their own arrays.
    """
    index, hashes = np.empty(len(vertices), np.int32), np.empty(len(vertices), np.uint64)
    parts = equal_slices(len(vertices), _MANY)
    over_slices(
        lambda part: _kernels_core.hash_points(vertices[part], hashes[part]), parts, "hashing vertices"
    )
    over_slices(
        lambda i: _kernels_core.match_points(vertices, hashes, i, len(parts), index),
        range(len(parts)),
        "welding vertices",
    )
    vertices, index = _kernels_core.number_points(vertices, index)
    junk = np.empty(len(triangles), bool)
    over_slices(
        lambda part: _kernels_core.weld(triangles[part], index, junk[part]),
        equal_slices(len(triangles), _MANY),
        "numbering corners",
    )
    opposite, kinds, irregular = _link(vertices, triangles, junk)
    copies = _copies(triangles, kinds) if irregular else np.empty(0, int)
    if copies.size:
        junk[copies] = True
        opposite, kinds, _ = _link(vertices, triangles, junk)
    return MeshGraph(vertices, triangles, opposite, kinds, junk)


def _link(vertices, triangles, junk):
    """Opposite half-edge and kind of every half-edge, and how many are irregular."""
    opposite, kinds = np.empty(triangles.shape, np.int32), np.empty(triangles.shape, np.uint8)
    parts = equal_slices(len(triangles), _MANY)
    table = np.empty((len(parts), len(vertices) + 1), np.int32)
    table[-1, 0] = 0
    places = table[:, 1:]
    over_slices(
        lambda i: _kernels_core.count_edges(
            triangles[parts[i]], junk[parts[i]], places[i], opposite[parts[i]], kinds[parts[i]]
        ),
        range(len(parts)),
        "counting",
    )
    edges = np.empty((_kernels_core.places_from_counts(places), 2), np.int32)
    over_slices(
        lambda i: _kernels_core.place_edges(
            triangles[parts[i]], junk[parts[i]], parts[i].start, places[i], edges
        ),
        range(len(parts)),
        "sorting edges",
    )
    opposite, kinds = opposite.ravel(), kinds.ravel()
    offsets = table[-1]  # the places of the last part have come to the end of each vertex
    ranges = even_slices(offsets) if len(vertices) > _MANY else [slice(0, len(vertices))]
    irregular = over_slices(
        lambda part: _kernels_core.link_edges(
            triangles, vertices, offsets, edges, part.start, part.stop, opposite, kinds
        ),
        ranges,
        "linking edges",
    )
    return opposite, kinds, sum(irregular)


def _copies(triangles, kinds):
    """Triangles that repeat an earlier one, winding included; a copy shows by its irregular edges."""
    suspects = np.flatnonzero((kinds.reshape(-1, 3) > 1).all(axis=1))
    corners = triangles[suspects]
    turn = (corners.argmin(axis=1)[:, None] + np.arange(3)) % 3
    _, first = np.unique(np.take_along_axis(corners, turn, axis=1), axis=0, return_index=True)
    return np.delete(suspects, first)
