"""The part to be milled, as triangles in a tree of bounding boxes."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

from nurbs_lab.common.checks import as_positive, lengths
from nurbs_lab.common.values import Value
from nurbs_lab.machining._kernels_contact import ROUNDING
from nurbs_lab.mesh.core import MeshGraph, mesh_graph
from nurbs_lab.mesh.distance import TriangleTree, triangle_tree
from nurbs_lab.nurbs import NurbsSurface

SINGLE = 1e-6  # relative: what coordinates in single precision do not tell apart
TESSELLATION = 1e-3  # mm: how far the triangles of a NURBS part may lie from its surfaces


@dataclass(frozen=True, eq=False, repr=False)
class Part(Value):
    """Triangles ready for contact; made once by `prepare_part` and used many times.

    Attributes
    ----------
    graph : MeshGraph
    tree : TriangleTree
        Of the triangles with three different corners.
    normals : (m, 3) array
        Unit normals in the order of the tree; zero for a triangle without area.
    edges : (m,) array of uint8
        Bit k says that contact with the edge after corner k is computed with this triangle. An edge belongs
        to one of its two triangles. A concave edge belongs to none, because every cutter touches its sides
        first.
    """

    graph: MeshGraph
    tree: TriangleTree
    normals: np.ndarray
    edges: np.ndarray

    @property
    def bounds(self) -> np.ndarray:
        """Least and largest x, y, z, ``(2, 3)``."""
        return self.tree.boxes[0].reshape(2, 3)

    @property
    def volume(self) -> float:
        """In mm³, negative if the triangles are inside out."""
        return float(np.einsum("ij,ij->", self.tree.corners[:, :3], self.tree.normals) / 6.0)

    def require_closed(self, name="part"):
        """Refuse an open mesh, which does not say on which side its material is."""
        if not self.graph.closed:
            count = len(self.graph.boundary_edges)
            raise ValueError(
                f"{name} is open: {count} edges have one triangle only; close its holes (see mesh.check_mesh)"
            )


def prepare_part(part, *, tessellation=None) -> Part:
    """Sort a part into a tree of boxes.

    Parameters
    ----------
    part : trimesh.Trimesh, pyvista.PolyData, file name, MeshGraph, Reconstruction, NurbsSurface or Part
        A `Part` is returned as it is.
    tessellation : float, optional
        Largest distance between a NURBS part and the triangles that replace it, in mm; 1e-3 by default, or
        the finest possible of a reconstruction where that is larger.

    Raises
    ------
    TypeError, ValueError
        If it is no part, or has no triangle with three different corners.

    Examples
    --------
    >>> import trimesh
    >>> from nurbs_lab import machining
    >>> part = machining.prepare_part(trimesh.creation.box())
    >>> len(part.normals), part.graph.closed
    (12, True)
    """
    return part_named("part", part, tessellation)


def part_named(name, part, tessellation=None) -> Part:
    """`prepare_part` for an argument of another name."""
    if isinstance(part, Part):
        return part
    if tessellation is None:
        tessellation = max([TESSELLATION, *(shell.finest for shell in getattr(part, "shells", ()))])
    tessellation = as_positive("tessellation", tessellation)
    if isinstance(part, NurbsSurface) and part.dim != 3:
        raise ValueError(f"{name}: a surface needs three coordinates, not {part.dim}")
    try:
        if isinstance(part, NurbsSurface):
            vertices, faces = part.tessellate(tessellation)
            part = SimpleNamespace(vertices=vertices, faces=faces)
        elif hasattr(part, "to_mesh"):
            part = part.to_mesh(tessellation)
        graph = mesh_graph(part)
    except (TypeError, ValueError, OSError) as error:
        said = str(error).removeprefix("mesh: ").replace("tolerance", "tessellation")
        raise type(error)(f"{name}: {said}") from None
    if graph.junk.all():
        raise ValueError(f"{name} has no triangle with three different corners")
    kept = np.flatnonzero(~graph.junk)
    tree = triangle_tree(graph.vertices[graph.triangles[kept]])
    size = lengths(tree.normals)[:, None]
    normals = np.divide(tree.normals, size, out=np.zeros_like(tree.normals), where=size > 0.0)
    return Part(graph, tree, normals, _contact_edges(graph, kept[tree.order], tree.corners, normals))


def _contact_edges(graph, order, corners, normals):
    """`Part.edges`, where row i of ``corners`` and ``normals`` is that of triangle ``order[i]``."""
    place = np.full(len(graph.triangles), -1)
    place[order] = np.arange(len(order))
    half = 3 * order[:, None] + np.arange(3)
    other = graph.opposite[half]
    beside, apex = place[other // 3], corners.reshape(-1, 3, 3)[place[other // 3], (other + 2) % 3]
    above = np.einsum("id,ikd->ik", normals, apex - corners[:, None, :3]) * np.sign(normals[:, 2:])
    valley = (normals[:, 2:] * normals[beside, 2] > 0.0) & (above > ROUNDING * np.abs(corners).max())
    alone = (other < 0) | (graph.kinds[half] != 0)
    return ((alone | ((other > half) & ~valley)) << np.arange(3)).sum(axis=1).astype(np.uint8)
