"""A triangle mesh as plain arrays: the weighted graph (paper, Eq. 1, Figs. 1 and 2) and its measures.

Face f points to its neighbour g with a weight that says *which edge of g* the two share: the sum of the
numbers of its two corners, so 1 for corners 0 and 1, 2 for 2 and 0, 3 for 1 and 2. It is stored as a table of
opposite half-edges, in the one numbering that all rooms use: half-edge ``3 f + e`` runs from corner e of
triangle f to its next corner. So e = 0, 1, 2 are the edges of weight 1, 3, 2.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from nurbs_lab.common.progress import interruptible
from nurbs_lab.common.values import Value
from nurbs_lab.mesh import _kernels_core
from nurbs_lab.mesh.read import arrays_of

_BY_WEIGHT = np.array([0, 2, 1])  # the edges of weight 1, 2, 3; also the weight less one of each edge


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
        The half-edge on the other side of each half-edge, -1 where there is none. Half-edge ``3 f + e`` runs
        from corner e of triangle f to its next corner.
    kinds : (3 m,) array
        0 regular, 1 boundary, 2 non-manifold (shared by three or more), 3 against the winding of its
        neighbour.
    junk : (m,) array of bool
        Triangles left out: a corner repeated, a copy of an earlier triangle, or the back of one in a mesh of
        which every triangle has one.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    opposite: np.ndarray
    kinds: np.ndarray
    junk: np.ndarray

    @property
    def neighbours(self) -> np.ndarray:
        """Face across each edge, ``(m, 3)``; -1 where there is none. Column w - 1 is the edge of weight w."""
        return np.where(self.opposite < 0, -1, self.opposite // 3).reshape(-1, 3)[:, _BY_WEIGHT]

    @property
    def weights(self) -> np.ndarray:
        """Weight of Eq. (1) towards each neighbour, ``(m, 3)``: 1, 2 or 3, and 0 where there is none."""
        weights = np.where(self.opposite < 0, 0, 1 + _BY_WEIGHT[self.opposite % 3])
        return weights.reshape(-1, 3)[:, _BY_WEIGHT]

    @property
    def closed(self) -> bool:
        """Whether every edge has two sides, so that every contour of every plane is closed."""
        return bool(np.count_nonzero(self.opposite < 0) == 3 * np.count_nonzero(self.junk))

    @property
    def boundary_edges(self) -> np.ndarray:
        """Vertex pairs of the edges that only one triangle has, ``(b, 2)``."""
        return self._edges(_kernels_core.BOUNDARY)

    @property
    def non_manifold_edges(self) -> np.ndarray:
        """Vertex pairs of the edges that three or more triangles share, ``(b, 2)``, each once."""
        return self._edges(_kernels_core.MANY)

    @property
    def against_winding_edges(self) -> np.ndarray:
        """Vertex pairs of the edges whose two triangles are wound against each other, ``(b, 2)``."""
        return self._edges(_kernels_core.AGAINST)

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
        halves = np.flatnonzero(self.kinds == kind)
        ends = [side[halves] for side in tails_and_heads(self.triangles)]
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
    junk = np.empty(len(triangles), bool)
    vertices = vertices[: _kernels_core.weld(vertices, triangles, junk)]
    return linked(vertices, triangles, junk)


def linked(vertices, triangles, junk=None) -> MeshGraph:
    """The graph of triangles whose vertices are distinct; ``junk`` are left out, and copies of others."""
    opposite, kinds = np.empty(triangles.size, np.int32), np.empty(triangles.size, np.uint8)
    junk = np.zeros(len(triangles), bool) if junk is None else junk
    body = np.zeros(len(triangles), np.int32)
    vertices.setflags(write=False)  # as those of a graph, so that the kernel is compiled once
    if _kernels_core.link(triangles, vertices, body, junk, opposite, kinds):
        copies = _backs(triangles, junk)
        copies = copies if copies.size else _copies(triangles, kinds)
        if copies.size:
            junk[copies] = True
            _kernels_core.link(triangles, vertices, body, junk, opposite, kinds)
        body = bodies_of(np.where(kinds == _kernels_core.MANY, -1, opposite))[1]
        _kernels_core.link(triangles, vertices, body, junk, opposite, kinds)
    return MeshGraph(vertices, triangles, opposite, kinds, junk)


def _backs(triangles, junk):
    """The second of every two triangles that are one, wound either way, if all are so: they enclose nothing.

    Some may be so: bodies that share a wall have its triangles twice, and so has one in the void of another.
    """
    used = np.flatnonzero(~junk)
    corners = triangles[used]
    around = corners[np.flatnonzero(corners == corners[0, 0]) // 3]
    if np.isin(around, corners[0]).all(axis=1).sum() != 2:  # most others, at once
        return used[:0]
    rising = (np.roll(corners, -1, axis=1) > corners).sum(axis=1)  # two one way, one the other
    ends = np.sort(corners, axis=1)
    order = np.lexsort(ends.T)  # equal ones as they stand
    first, second = order[:-1:2], order[1::2]
    paired = len(used) % 2 == 0 and (rising[first] + rising[second] == 3).all()
    return used[second] if paired and (ends[first] == ends[second]).all() else used[:0]


def _copies(triangles, kinds):
    """Triangles that repeat an earlier one, winding included; a copy shows by its irregular edges.

    Where bodies share a wall, its triangles stand twice and belong to both. So those that hang together stay
    if an edge of as many half-edges each way would not be one without them.
    """
    suspects = np.flatnonzero((kinds.reshape(-1, 3) > 1).all(axis=1))
    corners = triangles[suspects]
    turn = (corners.argmin(axis=1)[:, None] + np.arange(3)) % 3
    _, first = np.unique(np.take_along_axis(corners, turn, axis=1), axis=0, return_index=True)
    copies, halves = np.delete(suspects, first), np.flatnonzero(kinds > 1)
    edge, way = edges_and_ways(triangles, halves)
    away = np.isin(halves // 3, copies)
    row, mine = np.searchsorted(copies, halves[away] // 3), edge[away]
    balance, lost = np.bincount(edge, way), np.bincount(mine, way[away], edge.max() + 1)
    group = components(len(copies) + len(balance), row, len(copies) + mine)[1][: len(copies)]
    needed = np.bincount(group[row], ((balance == 0) & (lost != 0))[mine])
    return copies[needed[group] == 0]


def opposite_of(triangles) -> np.ndarray:
    """The half-edge across every edge of plain triangles, ``(3 m,)``; -1 where there is none, or several."""
    triangles = np.ascontiguousarray(triangles, dtype=np.int32)
    places = np.zeros((int(triangles.max()) + 1, 3))  # only edges with several triangles ask where they are
    places.setflags(write=False)
    opposite, kinds = np.empty(triangles.size, np.int32), np.empty(triangles.size, np.uint8)
    junk = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    _kernels_core.link(triangles, places, np.zeros(len(triangles), np.int32), junk, opposite, kinds)
    return np.where(kinds == 0, opposite, -1).astype(np.int64)


def tails_and_heads(faces):
    """The vertices where every half-edge of faces of any number of corners starts and ends."""
    return faces.ravel(), np.roll(faces, -1, axis=1).ravel()


def edges_and_ways(faces, halves):
    """Numbers of the edges of half-edges, and 1 for each that runs to the higher vertex, else -1."""
    tails, heads = (ends[halves] for ends in tails_and_heads(faces))
    ends = np.sort(np.column_stack([tails, heads]), axis=1)
    return np.unique(ends, axis=0, return_inverse=True)[1], np.where(tails < heads, 1, -1)


def components(count, first, second):
    """Number of connected parts of a graph with links between ``count`` nodes; the part of every node."""
    links = coo_array((np.ones(len(first), bool), (first, second)), shape=(count, count))
    return connected_components(links, directed=False)


def bodies_of(opposite):
    """Number of parts of a mesh that hang together across edges; the part of every triangle."""
    halves = np.flatnonzero(opposite >= 0)
    return components(len(opposite) // 3, halves // 3, opposite[halves] // 3)


def fans(opposite, joined, corners=3):
    """Number of fans of faces around vertices; the fan of every corner, across the half-edges ``joined``."""
    halves = np.flatnonzero(joined)
    across = opposite[halves]
    return components(len(opposite), halves, across - across % corners + (across + 1) % corners)


def face_normals(vertices, triangles) -> np.ndarray:
    """Twice the area of each triangle along its normal, ``(m, 3)``."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def vertex_normals(vertices, triangles):
    """Unit normals of the vertices, each triangle weighted by its area, and a third of these areas."""
    vectors = face_normals(vertices, triangles)
    columns = *vectors.T, np.linalg.norm(vectors, axis=1)
    sums = [sum(np.bincount(triangles[:, k], column, len(vertices)) for k in range(3)) for column in columns]
    return unit(np.column_stack(sums[:3])), sums[3] / 6


def enclosed_volume(vertices, triangles) -> float:
    """Volume inside a closed mesh, or minus that if its triangles are wound inwards."""
    middle = vertices.mean(axis=0)  # about which rounding is least
    return np.einsum("ij,ij->", vertices[triangles[:, 0]] - middle, face_normals(vertices, triangles)) / 6


def unit(vectors) -> np.ndarray:
    """Vectors of length one; zero stays zero."""
    sizes = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(sizes > 0.0, sizes, 1.0)
