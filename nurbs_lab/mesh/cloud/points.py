"""From a point cloud to a triangle mesh, and what a mesh lacks."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from nurbs_lab.common.checks import as_floats, counted, extent, shown_place
from nurbs_lab.common.progress import interruptible
from nurbs_lab.mesh.cloud.indicator import closed_surface, moved_to, uncrossed
from nurbs_lab.mesh.cloud.normals import NEIGHBOURHOODS, directions_of, outward
from nurbs_lab.mesh.core import (
    bodies_of,
    components,
    mesh_graph,
    opposite_of,
    tails_and_heads,
    unit,
    vertex_normals,
)  # fmt: skip
from nurbs_lab.mesh.repair import NO_VOLUME, around_of, parts_of

_LEAST_POINTS = 10
_CROWD = 8  # neighbours that tell how far a point is from the others
_FAR = 1.8  # times the neighbours' distance; farther is left out
_FLAT = 1e-3  # thickness of a cloud that is a plane or a line, as a fraction of its length
_NOISY = 0.12  # flatness beyond which noise hides the surface
_FEW, _MOST = 5_000, 200_000  # points that are never, and always, averaged
_HIGH = 0.7  # spacings above the planes of its neighbours; a higher point is left out
_SPECK = 0.01  # of the points; a smaller body is left out
_APART = 4.0  # spacings between points and surface; a place of it farther from all points closes a hole
_MOST_ALONE = 0.25  # of the surface may close holes
_AGAINST = 0.1  # of the surface may face against the points near it
_MISSED = 0.9  # spacings: most of the points must be nearer to the surface
_THIN = 0.05  # spread of neighbours across over along: points on curves have less
_ALONG = 1.5  # cells that points on curves are averaged in, in distances of neighbours
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
        Whether the normals point out: the enclosed volume is positive, and that of every closed body that
        is in no other.
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
    graph = mesh_graph(mesh)
    wrong = graph.boundary_edges, graph.non_manifold_edges, graph.against_winding_edges
    flaws = [len(edges) for edges in wrong]
    return MeshReport(
        not any(flaws),
        len(np.unique(bodies_of(graph.opposite)[1][~graph.junk])),
        _faces_outward(graph),
        *flaws,
        int(graph.junk.sum()),
    )


def _faces_outward(graph):
    """Whether the enclosed volume is positive, and that of every closed part which is inside no other."""
    kept = np.flatnonzero(~graph.junk)
    triangles, opposite = graph.triangles[kept], graph.opposite.reshape(-1, 3)[kept]
    label = np.unique(bodies_of(graph.opposite)[1][kept], return_inverse=True)[1]
    parts = parts_of(graph.vertices, triangles, label) if len(kept) else []
    torn = set(label[(opposite < 0).any(axis=1)].tolist())
    outermost = [k for k, some in enumerate(around_of(parts)) if not some and k not in torn]
    least = -NO_VOLUME * extent(graph.vertices) ** 3
    return sum(part[2] for part in parts) > 0.0 and all(parts[k][2] > least for k in outermost)


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
    Method: signs by all links of neighbours and the winding number, then the indicator function by Poisson's
    equation on a grid (`nurbs_lab.mesh.cloud.indicator`). The time is linear in the points, up to 200,000 of
    them. The mesh does not cut itself. Walls thinner than twice the distance of neighbouring points may be
    lost, edges are rounded by about that distance, and a gap in the cloud is closed.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> mesh = nl.mesh_from_points(trimesh.creation.icosphere(subdivisions=4).vertices)
    >>> mesh.is_watertight, round(float(mesh.volume), 2)  # of the ball: 4.19
    (True, 4.19)
    """
    repairs = []
    rows = _distinct(points, normals, repairs)
    middle, size = rows[:, :3].mean(axis=0), np.ptp(rows[:, :3], axis=0).max()
    rows[:, :3] = (rows[:, :3] - middle) / size
    rows = _cleared(rows, repairs)
    spread = np.linalg.svd(rows[:, :3] - rows[:, :3].mean(axis=0), compute_uv=False)
    if spread[2] < _FLAT * spread[0]:
        shape = "on a line" if spread[1] < _FLAT * spread[0] else "in one plane"
        raise ValueError(f"points lie {shape}; there is no solid around them")
    rows = _on_planes(_averaged(rows, repairs), repairs)
    points, (distances, near) = rows[:, :3], _nearest(rows)
    areas = _spacing(distances) ** 2
    given = normals is not None
    normals = unit(rows[:, 3:]) if given else outward(points, near, areas)
    if given and np.einsum("ij,ij->", points - points.mean(axis=0), normals) < 0.0:
        normals = -normals
        repairs.append("normals turned, which pointed inwards")
    vertices, triangles = _without_specks(*closed_surface(points, normals, areas), points, repairs)
    moved = moved_to(points, normals, vertices, triangles)
    spacing = np.sqrt(np.median(areas))
    holes, share, width, place = _holes_closed(moved, triangles, points, normals, spacing)
    if holes:
        repairs.append(
            f"{counted(holes, 'hole')} closed, the widest about {size * width:.3g} mm, at "
            f"{shown_place(middle + size * place)}; no points are near {100 * share:.2g} % of the surface"
        )
    mesh = trimesh.Trimesh(middle + size * uncrossed(moved, vertices, triangles), triangles, process=False)
    mesh.metadata["report"] = replace(check_mesh(mesh), repairs=tuple(repairs))
    return mesh


def _distinct(points, normals, repairs):
    """Different points ``(n, 3)``, or with their normals ``(n, 6)``, in an order of their own."""
    rows = points = as_floats("points", points, ("n", "3"))
    if points.shape[1] != 3:
        raise ValueError(f"points has shape {points.shape}; give (n, 3)")
    if normals is not None:
        normals = as_floats("normals", normals, ("n", "3"))
        if normals.shape != points.shape:
            raise ValueError(f"normals has shape {normals.shape}, points {points.shape}; give one for each")
        if not normals.any(axis=1).all():
            raise ValueError(f"normals[{np.argmin(normals.any(axis=1))}] is zero; give directions")
        rows = np.hstack([points, normals])
    rows = rows[np.unique(points, axis=0, return_index=True)[1]]
    if len(rows) < len(points):
        repairs.append(f"{counted(len(points) - len(rows), 'repeated point')} merged")
    if len(rows) < _LEAST_POINTS:
        raise ValueError(f"points holds {len(rows)} different ones; give at least {_LEAST_POINTS}")
    return rows


def _nearest(rows, count=NEIGHBOURHOODS[-1]):
    """Distances and numbers of the points nearest to each point, which is the first of them."""
    return cKDTree(rows[:, :3]).query(rows[:, :3], k=min(count + 1, len(rows)))


def _cleared(rows, repairs):
    """The points whose neighbours are about as far as the neighbours' own neighbours are."""
    distances, near = _nearest(rows, _CROWD)
    kept = distances[:, -1] <= _FAR * np.median(distances[near[:, 1:], -1], axis=1)
    if not kept.all():
        repairs.append(f"{counted(np.count_nonzero(~kept), 'point')} far from all others left out")
    return rows[kept]


def _averaged(rows, repairs):
    """Means of the points in the cells of a grid, while noise hides the surface or the points are many.

    So are points on curves, such as contours, until they are about as far from one another as the curves are.
    """
    while True:
        points, (distances, near) = rows[:, :3], _nearest(rows)
        many, few = len(rows) > _MOST, len(rows) <= _FEW
        on_curves = len(rows) > 4 * NEIGHBOURHOODS[-1] and _spread(points[near[:, : _CROWD + 1]]) < _THIN
        if on_curves:
            cell = _ALONG * np.median(distances[:, 1])
        elif many or (not few and np.median(directions_of(points, near)[1]) > _NOISY):
            cell = 2.0 * np.median(_spacing(distances))  # of about four points
        else:
            return rows
        places = np.floor((points - points.min(axis=0)) / cell)
        cells, sizes = np.unique(places, axis=0, return_inverse=True, return_counts=True)[1:]
        if len(sizes) == len(rows):
            return rows
        where = " on curves" if on_curves else ""
        repairs.append(f"{len(rows)} points{where} averaged in {len(sizes)} cells")
        rows = np.column_stack([np.bincount(cells.ravel(), column) for column in rows.T]) / sizes[:, None]


def _on_planes(rows, repairs):
    """The points that are near the planes of at least a quarter of their neighbours."""
    points, (distances, near) = rows[:, :3], _nearest(rows)
    directions = directions_of(points, near)[0]
    heights = np.abs(np.einsum("nkd,nkd->nk", directions[near], points[:, None] - points[near]))
    kept = np.quantile(heights[:, 1:], 0.25, axis=1) < _HIGH * _spacing(distances)
    if kept.all() or np.count_nonzero(kept) < max(_LEAST_POINTS, 0.9 * len(rows)):
        return rows
    off = counted(np.count_nonzero(~kept), "point")
    repairs.append(f"{off} off the planes of their neighbours left out")
    return rows[kept]


def _spread(groups):
    """Second largest variance of groups of points ``(n, k, 3)`` over their largest, the median of all."""
    groups = groups - groups.mean(axis=1, keepdims=True)
    values = np.linalg.eigvalsh(np.einsum("nki,nkj->nij", groups, groups))
    return np.median(values[:, 1] / np.maximum(values[:, 2], np.finfo(float).tiny))


def _spacing(distances):
    """Side of the square that each point stands for, from the distance of a neighbour."""
    half = distances.shape[1] // 2
    return np.sqrt(np.pi / half) * distances[:, half]


def _without_specks(vertices, triangles, points, repairs):
    """The bodies that more than a few points lie at."""
    if not len(triangles):
        raise ValueError("points gave no surface at all; they may be too few or in no order of a surface")
    label = bodies_of(opposite_of(triangles))[1]
    at = label[cKDTree(vertices[triangles].mean(axis=1)).query(points)[1]]
    held = np.bincount(at, minlength=label.max() + 1)
    kept = held >= max(_LEAST_POINTS, _SPECK * len(points))
    kept[held.argmax()] = True
    if not kept.all():
        fewer = counted(np.count_nonzero(~kept), "smaller body", "smaller bodies")
        repairs.append(f"{fewer} removed, {held[~kept].sum()} points")
    used, corners = np.unique(triangles[kept[label]], return_inverse=True)
    return vertices[used], corners.reshape(-1, 3)


def _holes_closed(vertices, triangles, points, normals, spacing):
    """Number of holes in the cloud that the surface closes, their share of it, width and place of the widest.

    Raises ValueError if the surface is not where the points are.
    """
    missed = np.quantile(cKDTree(vertices).query(points)[0], _HELD) / spacing
    gaps, near = cKDTree(points).query(vertices)
    gaps, alone = gaps / spacing, np.mean(gaps > _APART * spacing)
    facing = np.einsum("ij,ij->i", vertex_normals(vertices, triangles)[0], normals[near])
    against = np.mean((facing < 0.0) & (gaps < _APART))
    reasons = (
        (missed > _MISSED, f"misses some of them by {missed:.1f} times their spacing"),
        (against > _AGAINST, f"faces the wrong way over {100 * against:.2g} % of its area"),
        (alone > _MOST_ALONE, f"is far from all of them over {100 * alone:.2g} % of its area"),
    )
    if said := " and ".join(text for true, text in reasons if true):
        raise ValueError(
            f"points show no closed surface: the best one {said}; give more points, or normals "
            "that point outward; for contours of a part, use nurbs_lab.skin"
        )
    tails, heads = tails_and_heads(triangles)
    far = (gaps[tails] > _APART) & (gaps[heads] > _APART)
    label = components(len(gaps), tails[far], heads[far])[1]
    holes = len(np.unique(label[gaps > _APART]))
    return holes, alone, 2.0 * gaps.max() * spacing, vertices[gaps.argmax()]
