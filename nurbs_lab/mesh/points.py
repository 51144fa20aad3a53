"""From a point cloud to a triangle mesh, and what a mesh lacks."""

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from nurbs_lab.common.checks import as_choice, as_count, as_floats
from nurbs_lab.mesh.graph import mesh_graph

_LEAST_POINTS = 10
_FAR = 1024  # sizes of a cloud; only one that is farther from the origin is moved
_DEEPEST = 14  # octree of 2**14 cells a side; memory ends there


@dataclass(frozen=True)
class MeshReport:
    """What a mesh is, and what was done to it.

    Attributes
    ----------
    watertight : bool
        Every edge has exactly two triangles, wound alike.
    bodies : int
        Connected parts.
    outward : bool
        Whether the normals point out: the enclosed volume is positive.
    open_edges, non_manifold_edges, edges_against_winding, junk_triangles : int
        What is wrong: see `MeshGraph`.
    repairs : tuple of str
        What was repaired.
    """

    watertight: bool
    bodies: int
    outward: bool
    open_edges: int
    non_manifold_edges: int
    edges_against_winding: int
    junk_triangles: int
    repairs: tuple[str, ...] = ()

    @property
    def sound(self) -> bool:
        """One watertight body, normals outward."""
        return self.watertight and self.bodies == 1 and self.outward


def check_mesh(mesh) -> MeshReport:
    """Report what a mesh is, without changing it."""
    return _report(mesh, ())


def _report(mesh, repairs):
    graph = mesh_graph(mesh)
    corners = graph.vertices[graph.triangles[~graph.junk]]
    a, b, c = (corners - graph.vertices.mean(axis=0)).swapaxes(0, 1)
    flaws = [
        len(edges) for edges in (graph.boundary_edges, graph.non_manifold_edges, graph.against_winding_edges)
    ]
    return MeshReport(
        not any(flaws),
        len(np.unique(_bodies(graph)[~graph.junk])),
        bool(np.einsum("ij,ij->", a, np.cross(b, c)) > 0.0),
        *flaws,
        int(graph.junk.sum()),
        tuple(repairs),
    )


def mesh_from_points(points, normals=None, *, method="distance", neighbours=20, depth=8) -> trimesh.Trimesh:
    """A triangle mesh around a point cloud (paper, Fig. 7, first step).

    Parameters
    ----------
    points : (n, 3) array
        Samples of a surface; equal ones are merged.
    normals : (n, 3) array, optional
        Outward normals. Without them they are estimated.
    method : 'distance' or 'poisson'
        'distance' contours the signed distance of local planes (VTK; good for closed, evenly sampled shapes).
        'poisson' is screened Poisson (PyMeshLab, the extra ``poisson``), the better one for real scans.
    neighbours : int
        Points that make up a local plane.
    depth : int
        Of the octree of 'poisson'.

    Returns
    -------
    trimesh.Trimesh
        Its largest body, normals outward. ``metadata["report"]`` is a `MeshReport`: what was repaired, and
        what is still wrong.

    Raises
    ------
    ValueError
        If the points are too few, in a plane, or not finite.
    ImportError
        If 'poisson' is asked for and PyMeshLab is missing.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> mesh = nl.mesh_from_points(trimesh.creation.icosphere(subdivisions=4).vertices)
    >>> mesh.is_watertight, round(float(mesh.volume), 2)  # of the ball: 4.19
    (True, 4.14)
    """
    points = as_floats("points", points, ("n", "3"))
    if points.shape[1] != 3:
        raise ValueError(f"points has shape {points.shape}; give (n, 3)")
    neighbours, depth = as_count("neighbours", neighbours, 3), as_count("depth", depth, 1, _DEEPEST)
    if normals is not None:
        normals = as_floats("normals", normals)
        if normals.shape != points.shape:
            raise ValueError(f"normals has shape {normals.shape}, points {points.shape}; give one for each")
    as_choice("method", method, ("distance", "poisson"))
    repairs = []
    distinct, first = np.unique(points, axis=0, return_index=True)
    if len(distinct) < len(points):
        repairs.append(f"{len(points) - len(distinct)} repeated points merged")
        points, normals = distinct, None if normals is None else normals[first]
    if len(points) < _LEAST_POINTS:
        raise ValueError(f"points holds {len(points)} different ones; give at least {_LEAST_POINTS}")
    # The surface is made in single precision: the cloud is brought near to the origin, and to its own size.
    size = 2.0 ** np.frexp(np.ptp(points, axis=0).max())[1]
    middle = np.rint(points.mean(axis=0) / (_FAR * size)) * (_FAR * size)
    points = (points - middle) / size
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[2] < 1e-9 * spread[0]:
        raise ValueError("points lie in one plane; there is no solid around them")
    neighbours = min(neighbours, len(points) - 1)
    if method == "distance":
        vertices, triangles = _by_distance(points, neighbours)
    else:
        vertices, triangles = _by_poisson(points, normals, neighbours, depth)
    mesh = _cleaned(vertices, triangles, repairs)
    mesh.vertices = middle + size * mesh.vertices
    return mesh


def _by_distance(points, neighbours):
    import pyvista

    surface = pyvista.PolyData(points).reconstruct_surface(nbr_sz=neighbours).triangulate()
    return np.asarray(surface.points, dtype=np.float64), surface.regular_faces


def _by_poisson(points, normals, neighbours, depth):
    try:
        import pymeshlab
    except ImportError:
        raise ImportError(
            "method='poisson' needs PyMeshLab: pip install 'nurbs-lab[poisson]', or use method='distance'"
        ) from None
    work = pymeshlab.MeshSet()
    if normals is None:
        work.add_mesh(pymeshlab.Mesh(vertex_matrix=points))
        work.compute_normal_for_point_clouds(k=neighbours)
    else:
        work.add_mesh(pymeshlab.Mesh(vertex_matrix=points, v_normals_matrix=normals))
    work.generate_surface_reconstruction_screened_poisson(depth=depth, preclean=True)
    mesh = work.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix()


def _cleaned(vertices, triangles, repairs):
    """The largest body, turned outward."""
    graph = mesh_graph(trimesh.Trimesh(vertices, triangles, process=False)) if len(triangles) else None
    if graph is None or graph.junk.all():
        raise ValueError("points gave no surface at all; they may be too sparse for their neighbours")
    if graph.junk.any():
        repairs.append(f"{graph.junk.sum()} junk triangles removed")
    label = _bodies(graph)
    names, counts = np.unique(label[~graph.junk], return_counts=True)
    if len(names) > 1:
        repairs.append(f"{len(names) - 1} smaller bodies removed, {counts.sum() - counts.max()} triangles")
    keep = (label == names[counts.argmax()]) & ~graph.junk
    mesh = trimesh.Trimesh(graph.vertices, graph.triangles[keep], process=False)
    mesh.remove_unreferenced_vertices()
    if mesh.volume < 0.0:
        mesh.invert()
        repairs.append("normals turned outward")
    mesh.metadata["report"] = _report(mesh, repairs)
    return mesh


def _bodies(graph):
    """Number of the body of every triangle."""
    halves = np.flatnonzero(graph.twins >= 0)
    count = len(graph.triangles)
    links = coo_array(
        (np.ones(len(halves), bool), (halves // 3, graph.twins[halves] // 3)), shape=(count, count)
    )
    return connected_components(links, directed=False)[1]
