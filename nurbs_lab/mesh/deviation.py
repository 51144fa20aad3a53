"""How far a reconstruction and its mesh lie apart, measured both ways."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from nurbs_lab.common.checks import as_number
from nurbs_lab.mesh import _kernels
from nurbs_lab.mesh.closest import triangle_tree
from nurbs_lab.mesh.slicing import in_frame

_SPACING = 0.01  # of the diagonal: triangles larger than that are sampled inside, too
_PER_SPAN = 2
_PER_SLAB = 4
_NEWTON_STEPS = 8
_WORTH_A_STEP = 1e-3  # relative gain below which the search for the nearest place ends


@dataclass(frozen=True, eq=False)
class Spread:
    """Distances of many samples, in mm."""

    values: np.ndarray

    @property
    def count(self) -> int:
        """Number of samples."""
        return len(self.values)

    @property
    def max(self) -> float:
        """Largest distance; 0 if there is no sample."""
        return float(self.values.max(initial=0.0))

    @property
    def mean(self) -> float:
        """Mean distance; 0 if there is no sample."""
        return float(self.values.mean()) if self.count else 0.0

    @property
    def rms(self) -> float:
        """Root of the mean square; 0 if there is no sample."""
        return float(np.sqrt(np.mean(self.values**2))) if self.count else 0.0

    def percentile(self, share) -> float:
        """Distance that ``share`` per cent of the samples do not exceed."""
        share = as_number("share", share)
        if not 0.0 <= share <= 100.0:
            raise ValueError(f"share is {share}; give a number of per cent from 0 to 100")
        return float(np.percentile(self.values, share)) if self.count else 0.0


@dataclass(frozen=True, eq=False)
class Deviation:
    """Two-sided deviation; `max`, `rms`, `mean`, `percentile` cover both directions, away from junctions.

    Attributes
    ----------
    mesh_to_surface, surface_to_mesh : Spread
        From points of the mesh to the nearest surface, and from points of the surfaces to the mesh.
    junctions : Spread
        From points of the mesh in caps and branch regions to the nearest surface or flat cap.
    vertices : (n,) array
        Distance of every vertex of the mesh (of ``Reconstruction.mesh``), for a picture.
    vertex_at_junction : (n,) array of bool
        Whether the vertex lies in a cap or branch region.
    surface_points : (k, 3) array
        Where ``surface_to_mesh`` was measured.
    tubes : tuple of arrays
        For every tube the largest distance, in either direction, between its neighbouring sections.
    slabs : (layers + 1,) array
        For every slab between neighbouring planes the largest distance in its junctions.
    diagonal : float
        Of the bounding box of the mesh.
    """

    mesh_to_surface: Spread
    surface_to_mesh: Spread
    junctions: Spread
    vertices: np.ndarray
    vertex_at_junction: np.ndarray
    surface_points: np.ndarray
    tubes: tuple[np.ndarray, ...]
    slabs: np.ndarray
    diagonal: float

    @property
    def both(self) -> Spread:
        """Both directions together, away from junctions."""
        return Spread(np.concatenate([self.mesh_to_surface.values, self.surface_to_mesh.values]))

    @property
    def max(self) -> float:
        """Largest distance in either direction."""
        return max(self.mesh_to_surface.max, self.surface_to_mesh.max)

    @property
    def rms(self) -> float:
        """Root mean square over both directions."""
        return self.both.rms

    @property
    def mean(self) -> float:
        """Mean over both directions."""
        return self.both.mean

    @property
    def samples(self) -> int:
        """Number of samples in both directions."""
        return self.mesh_to_surface.count + self.surface_to_mesh.count

    @property
    def relative(self) -> float:
        """The largest distance as a share of the diagonal."""
        return self.max / self.diagonal

    def percentile(self, share) -> float:
        """Distance that ``share`` per cent of the samples do not exceed."""
        return self.both.percentile(share)


def measure(graph, frame, heights, pieces, tubes) -> Deviation:
    """Measure tubes, one for every chain of ``pieces`` longer than one, against the mesh they were made from.

    The mesh is sampled at its vertices, and inside triangles larger than a hundredth of the diagonal; a
    point's nearest place on the surfaces is sought from the nearest sample by Gauss-Newton steps, so a
    distance is never reported too small. The surfaces are sampled between all knots and layers; their
    distance to the triangles is exact.
    """
    diagonal = float(np.linalg.norm(np.ptp(graph.vertices, axis=0)))
    triangles, points = _mesh_samples(graph, _SPACING * diagonal)
    planar = in_frame(points, frame)
    slabs = np.searchsorted(heights, planar[:, 2], side="right")
    owner = pieces.owner_at(triangles, slabs)

    grids = [_grid(tube) for tube in tubes]
    surface_points = np.concatenate([grid[2] for grid in grids])
    surface_slabs = np.concatenate([grid[3] for grid in grids])
    surface_owner = np.repeat(np.arange(len(tubes)), [len(grid[2]) for grid in grids])
    near = cKDTree(surface_points).query(points)[1]
    u = np.concatenate([grid[0] for grid in grids])[near]
    v = np.concatenate([grid[1] for grid in grids])[near]
    to_surface = np.empty(len(points))
    for tube, mine in zip(tubes, _groups(surface_owner[near], len(tubes)), strict=True):
        to_surface[mine] = _distance_to(tube.surface, points[mine], u[mine], v[mine], tube.closed)
    count = len(pieces.junctions)
    for junction, mine in zip(pieces.junctions, _groups(-1 - owner, count), strict=True):
        gap = _distance_to_cap(junction, planar[mine])
        to_surface[mine] = np.minimum(to_surface[mine], gap)

    to_mesh = triangle_tree(graph.vertices[graph.triangles[~graph.junk]]).distances(surface_points)
    away = owner >= 0
    at_junctions = np.zeros(len(heights) + 1)
    np.maximum.at(at_junctions, slabs[~away], to_surface[~away])
    per_tube = []
    of_mesh, of_surface = (_groups(labels, len(tubes)) for labels in (owner, surface_owner))
    for i, tube in enumerate(tubes):
        between = np.zeros(len(tube.contours) - 1)
        for values, where, mine in ((to_surface, slabs, of_mesh[i]), (to_mesh, surface_slabs, of_surface[i])):
            np.maximum.at(between, where[mine] - tube.first_layer - 1, values[mine])
        per_tube.append(between)
    n = len(graph.vertices)
    return Deviation(
        Spread(to_surface[away]),
        Spread(to_mesh),
        Spread(to_surface[~away]),
        to_surface[:n],
        ~away[:n],
        surface_points,
        tuple(per_tube),
        at_junctions,
        diagonal,
    )


def _groups(labels, count):
    """Indices of the rows with label 0, 1, ... count - 1; other labels are left out."""
    order = np.argsort(labels, kind="stable")
    return np.split(order, np.searchsorted(labels[order], np.arange(count + 1)))[1:-1]


def _mesh_samples(graph, spacing):
    """A triangle and a point for every vertex, then for a lattice inside every large triangle."""
    use = np.flatnonzero(~graph.junk)
    corner_of = np.zeros(len(graph.vertices), dtype=np.int64)
    corner_of[graph.triangles[use].ravel()] = np.repeat(use, 3)
    triangles, points = [corner_of], [graph.vertices]
    corners = graph.vertices[graph.triangles[use]]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.ceil(longest / spacing).astype(int)
    for n in np.unique(parts[parts > 1]):
        large = np.flatnonzero(parts == n)
        i, j = (axis.ravel() for axis in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
        i, j = i[i + j < n] + 1 / 3, j[i + j < n] + 1 / 3
        share = np.column_stack([n - i - j, i, j]) / n
        points.append((share @ corners[large]).reshape(-1, 3))
        triangles.append(np.repeat(use[large], len(share)))
    return np.concatenate(triangles), np.concatenate(points)


def _grid(tube):
    """Parameters, points and slab of samples of a tube: between all knots and between all sections."""
    (u0, u1), _ = tube.surface.domain
    count = _PER_SPAN * (len(np.unique(tube.surface.knots[0])) - 1)
    u = np.linspace(u0, u1, count, endpoint=not tube.closed)
    share = np.arange(_PER_SLAB) / _PER_SLAB
    v = np.append((tube.parameters[:-1, None] + np.diff(tube.parameters)[:, None] * share).ravel(), 1.0)
    slab = tube.first_layer + 1 + np.minimum(np.arange(len(v)) // _PER_SLAB, len(tube.parameters) - 2)
    points = tube.surface.grid(u, v).reshape(-1, 3)
    return np.repeat(u, len(v)), np.tile(v, len(u)), points, np.tile(slab, len(u))


def _distance_to(surface, points, u, v, closed):
    """Distance to a surface from starting parameters, by Gauss-Newton steps as long as they come nearer."""
    (u0, u1), (v0, v1) = surface.domain
    best = np.linalg.norm(surface(u, v) - points, axis=1)
    active = np.arange(len(points))
    for _ in range(_NEWTON_STEPS):
        if not active.size:
            break
        derivatives = surface.derivatives(u[active], v[active], (1, 1))
        along, across = derivatives[:, 1, 0], derivatives[:, 0, 1]
        residual = points[active] - derivatives[:, 0, 0]
        a, b, c = (
            np.einsum("ij,ij->i", x, y) for x, y in ((along, along), (along, across), (across, across))
        )
        r, s = np.einsum("ij,ij->i", along, residual), np.einsum("ij,ij->i", across, residual)
        determinant = a * c - b * b
        safe = determinant > 1e-12 * a * c
        determinant = np.where(safe, determinant, np.inf)
        new_u = u[active] + (c * r - b * s) / determinant
        new_u = u0 + (new_u - u0) % (u1 - u0) if closed else np.clip(new_u, u0, u1)
        new_v = np.clip(v[active] + (a * s - b * r) / determinant, v0, v1)
        distance = np.linalg.norm(surface(new_u, new_v) - points[active], axis=1)
        nearer = distance < best[active] * (1.0 - _WORTH_A_STEP)
        active = active[nearer]
        best[active], u[active], v[active] = distance[nearer], new_u[nearer], new_v[nearer]
    return best


def _distance_to_cap(junction, planar):
    """Height above the flat region that the contours of a junction bound together; infinite beside it."""
    contours = [c for c in junction.below + junction.above if c.closed]
    inside = np.zeros(len(planar), dtype=bool)
    for contour in contours:
        inside ^= _kernels.inside_many(contour.points, planar)
    heights = {contour.height for contour in contours}
    level = np.mean(list(heights)) if heights else np.inf
    return np.where(inside, np.abs(planar[:, 2] - level), np.inf)
