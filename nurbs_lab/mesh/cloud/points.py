"""From a point cloud to a triangle mesh, and what a mesh lacks."""

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from nurbs_lab.common.checks import as_floats, lengths
from nurbs_lab.common.progress import interruptible
from nurbs_lab.mesh.cloud.indicator import closed_surface, moved_to
from nurbs_lab.mesh.cloud.normals import directions_of, outward
from nurbs_lab.mesh.core import bodies_of, components, enclosed_volume, mesh_graph

_LEAST_POINTS = 10
_CROWD = 8  # neighbours that tell how far a point is from the others
_FAR = 1.8  # times the neighbours' distance; farther is left out
_FLAT = 1e-3  # thickness of a cloud that is a plane or a line, as a fraction of its length
_NEIGHBOURS = 24
_NOISY = 0.12  # flatness beyond which noise hides the surface
_FEW, _MOST = 5_000, 200_000  # points that are never, and always, averaged
_MOST_AVERAGINGS = 8
_COARSER = 2.0  # cells that points are averaged in, in spacings
_HALF_EMPTY = 0.4  # of the mean number of points in a cell
_QUARTER = 0.25  # of its neighbours' planes have a point of the surface near them
_HIGH = 1.0  # spacings above them; a higher point is left out
_SPECK = 0.01  # of the points; a smaller body is left out
_APART = 4.0  # spacings between points and surface; a place of it farther from all points closes a hole
_MOST_ALONE = 0.25  # of the surface may close holes
_MISSED = 0.9  # spacings: most of the points must be nearer to the surface
_THIN = 0.05  # spread of neighbours across over along: points on curves have less
_ALONG = 1.5  # cells that points on curves are averaged in, in distances of neighbours
_BEYOND = 0.25  # of the size of the cloud, outside its box
_HELD = 0.95  # of the points are near the surface


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
    flaws = [
        len(edges) for edges in (graph.boundary_edges, graph.non_manifold_edges, graph.against_winding_edges)
    ]
    return MeshReport(
        not any(flaws),
        len(np.unique(bodies_of(graph.opposite)[1][~graph.junk])),
        bool(enclosed_volume(graph.vertices, graph.triangles[~graph.junk]) > 0.0),
        *flaws,
        int(graph.junk.sum()),
        tuple(repairs),
    )


@interruptible()
def mesh_from_points(points, normals=None) -> trimesh.Trimesh:
    """A closed triangle mesh around a point cloud (paper, Fig. 7, first step).

    Parameters
    ----------
    points : (n, 3) array
        Samples of the surface of one or several solids, in any order. Equal points are merged, points far
        from all others are left out, and a dense or noisy cloud is averaged in cells.
    normals : (n, 3) array, optional
        Outward normals of any length. Without them they are estimated: see `nurbs_lab.mesh.cloud.normals`.

    Returns
    -------
    trimesh.Trimesh
        Closed, normals outward, about five triangles for each point. ``metadata["report"]`` is a
        `MeshReport`, which says what was left out.

    Raises
    ------
    ValueError
        If the points are fewer than ten, not finite, in one plane or on one line, or if they show no closed
        surface.

    Notes
    -----
    Method: signs by a spanning tree and the winding number, then the indicator function by the Poisson
    equation on a grid (`nurbs_lab.mesh.cloud.indicator`). The time is linear in the points, up to 200,000 of
    them, and nothing is iterated until it converges. Walls thinner than twice the distance of neighbouring
    points may be lost, edges are rounded by about that distance, and a gap in the cloud is closed.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> mesh = nl.mesh_from_points(trimesh.creation.icosphere(subdivisions=4).vertices)
    >>> mesh.is_watertight, round(float(mesh.volume), 2)  # of the ball: 4.19
    (True, 4.19)
    """
    points = as_floats("points", points, ("n", "3"))
    if points.shape[1] != 3:
        raise ValueError(f"points has shape {points.shape}; give (n, 3)")
    if normals is not None:
        normals = as_floats("normals", normals, ("n", "3"))
        if normals.shape != points.shape:
            raise ValueError(f"normals has shape {normals.shape}, points {points.shape}; give one for each")
        if not normals.any(axis=1).all():
            raise ValueError(f"normals[{np.argmin(normals.any(axis=1))}] is zero; give directions")
    repairs = []
    distinct, first = np.unique(points, axis=0, return_index=True)
    if len(distinct) < len(points):
        repairs.append(f"{len(points) - len(distinct)} repeated points merged")
    points, normals = distinct, None if normals is None else normals[first]
    if len(points) < _LEAST_POINTS:
        raise ValueError(f"points holds {len(points)} different ones; give at least {_LEAST_POINTS}")
    middle, size = points.mean(axis=0), np.ptp(points, axis=0).max()
    points = (points - middle) / size
    points, normals = _cleared(points, normals, repairs)
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[2] < _FLAT * spread[0]:
        shape = "on a line" if spread[1] < _FLAT * spread[0] else "in one plane"
        raise ValueError(f"points lie {shape}; there is no solid around them")
    points, normals = _on_planes(*_averaged(points, normals, repairs), repairs)
    normals, areas = _oriented(points, normals)
    vertices, triangles = closed_surface(points, normals, areas)
    mesh = _without_specks(vertices, triangles, points, repairs)
    mesh.vertices = moved_to(points, normals, mesh.vertices.view(np.ndarray), mesh.faces.view(np.ndarray))
    _require_near(mesh, points, np.sqrt(np.median(areas)), lambda place: middle + size * place, repairs)
    mesh.vertices = middle + size * mesh.vertices
    mesh.metadata["report"] = _report(mesh, repairs)
    return mesh


def _nearest(points, count):
    """Distances and numbers of the ``count`` nearest points, each point itself included."""
    return cKDTree(points).query(points, k=min(count, len(points)))


def _cleared(points, normals, repairs):
    """The points whose neighbours are about as far as the neighbours' own neighbours are."""
    distances, near = _nearest(points, _CROWD + 1)
    reach = distances[:, -1]
    kept = reach <= _FAR * np.median(reach[near[:, 1:]], axis=1)
    if np.count_nonzero(kept) < max(_LEAST_POINTS, len(points) // 2):
        return points, normals
    if not kept.all():
        repairs.append(f"{np.count_nonzero(~kept)} points far from all others left out")
    return points[kept], None if normals is None else normals[kept]


def _averaged(points, normals, repairs):
    """Means of the points in the cells of a grid, while noise hides the surface or the points are many.

    So are points on curves, such as contours, until they are about as far from one another as the curves are.
    """
    for _ in range(_MOST_AVERAGINGS):
        distances, near = _nearest(points, _NEIGHBOURS + 1)
        on_curves = len(points) > 4 * _NEIGHBOURS and _spreads(points[near[:, : _CROWD + 1]]) < _THIN
        if on_curves:
            cell = _ALONG * np.median(distances[:, 1])
        elif len(points) > _MOST or (
            len(points) > _FEW and np.median(directions_of(points, near)[1]) > _NOISY
        ):
            cell = _COARSER * np.median(_spacing(distances))
        else:
            break
        places = np.floor((points - points.min(axis=0)) / cell)
        cells, sizes = np.unique(places, axis=0, return_inverse=True, return_counts=True)[1:]
        full = sizes > _HALF_EMPTY * len(points) / len(sizes)  # noise alone fills the others
        where = " on curves" if on_curves else ""
        repairs.append(f"{len(points)} points{where} averaged in {np.count_nonzero(full)} cells")
        points, normals = (
            None if rows is None else _means(rows, cells.ravel(), sizes)[full] for rows in (points, normals)
        )
    return points, normals


def _spreads(groups):
    """Second largest variance of groups of points ``(n, k, 3)`` over their largest, the median of all."""
    groups = groups - groups.mean(axis=1, keepdims=True)
    values = np.linalg.eigvalsh(np.einsum("nki,nkj->nij", groups, groups))
    return np.median(values[:, 1] / np.maximum(values[:, 2], np.finfo(float).tiny))


def _means(rows, cells, sizes):
    return np.column_stack([np.bincount(cells, column) for column in rows.T]) / sizes[:, None]


def _spacing(distances):
    """Side of the square that each point stands for, from the distance of a neighbour."""
    half = distances.shape[1] // 2
    return np.sqrt(np.pi / half) * distances[:, half]


def _on_planes(points, normals, repairs):
    """The points that are near the planes of at least some neighbours."""
    distances, near = _nearest(points, _NEIGHBOURS + 1)
    directions = directions_of(points, near)[0]
    heights = np.abs(np.einsum("nkd,nkd->nk", directions[near], points[:, None] - points[near]))
    kept = np.quantile(heights[:, 1:], _QUARTER, axis=1) < _HIGH * _spacing(distances)
    if kept.all() or np.count_nonzero(kept) < max(_LEAST_POINTS, 0.9 * len(points)):
        return points, normals
    repairs.append(f"{np.count_nonzero(~kept)} points off the planes of their neighbours left out")
    return points[kept], None if normals is None else normals[kept]


def _oriented(points, normals):
    """Unit outward normals and areas."""
    distances, near = _nearest(points, _NEIGHBOURS + 1)
    areas = _spacing(distances) ** 2
    if normals is None:
        return outward(points, near, areas), areas
    return normals / np.maximum(lengths(normals), np.finfo(float).tiny)[:, None], areas


def _without_specks(vertices, triangles, points, repairs):
    """The bodies that more than a few points lie at."""
    if not len(triangles):
        raise ValueError("points gave no surface at all; they may be too few or in no order of a surface")
    mesh = trimesh.Trimesh(vertices, triangles, process=False)
    label = bodies_of(mesh_graph(mesh).opposite)[1]
    at = label[cKDTree(vertices[triangles].mean(axis=1)).query(points)[1]]
    held = np.bincount(at, minlength=label.max() + 1)
    kept = held >= max(_LEAST_POINTS, _SPECK * len(points))
    kept[held.argmax()] = True
    if not kept.all():
        repairs.append(f"{np.count_nonzero(~kept)} smaller bodies removed, {held[~kept].sum()} points")
    mesh = trimesh.Trimesh(vertices, triangles[kept[label]], process=False)
    mesh.remove_unreferenced_vertices()
    return mesh


def _require_near(mesh, points, spacing, place_of, repairs):
    """Refuse a surface that is not where the points are; name the holes that it closes."""
    beyond = max((points.min(axis=0) - mesh.bounds[0]).max(), (mesh.bounds[1] - points.max(axis=0)).max())
    missed = np.quantile(cKDTree(mesh.vertices).query(points)[0], _HELD) / spacing
    gaps = cKDTree(points).query(mesh.vertices)[0] / spacing
    alone = np.mean(gaps > _APART)
    curves = any("on curves" in repair for repair in repairs)
    noisy = not curves and any(
        "averaged" in repair for repair in repairs
    )  # which makes one of two near walls
    if beyond > _BEYOND or missed > _MISSED or alone > _MOST_ALONE * (not noisy):
        cure = "more of its sections, or these to nurbs_lab.skin" if curves else "more points, or normals"
        reasons = (
            (beyond > _BEYOND, f"reaches {100 * beyond:.0f} % of their size beyond them"),
            (missed > _MISSED, f"leaves some of them {missed:.1f} distances of neighbours aside"),
            (alone > 0.0, f"is far from all of them over {max(100 * alone, 0.1):.2g} % of its area"),
        )
        said = " and ".join(text for true, text in reasons if true)
        raise ValueError(
            f"points, with normals if given, show no closed surface: the one found {said}; give {cure}"
        )
    if gaps.max() > _APART:
        far = (gaps > _APART)[mesh.edges_unique].all(axis=1)
        label = components(len(gaps), *mesh.edges_unique[far].T)[1]
        holes = len(np.unique(label[gaps > _APART]))
        place = ", ".join(f"{x:.4g}" for x in place_of(mesh.vertices[gaps.argmax()]))
        width = 2.0 * gaps.max() * spacing * (place_of(np.ones(3)) - place_of(np.zeros(3)))[0]
        repairs.append(f"{holes} holes closed, the widest about {width:.3g} mm, at ({place}) mm")
