"""One closed shell of patches for one closed surface of a mesh: fit, measure, and refine where it misses."""

from dataclasses import dataclass, replace
from itertools import count

import numpy as np

from nurbs_lab.mesh.core import face_normals, unit, vertex_normals
from nurbs_lab.mesh.distance import triangle_samples
from nurbs_lab.mesh.solid.features import refine, surfels, without_needles, without_slivers
from nurbs_lab.mesh.solid.fit import Target, fit
from nurbs_lab.mesh.solid.grids import even_grid, places
from nurbs_lab.mesh.solid.layout import lay_out
from nurbs_lab.mesh.solid.patches import Patches, basis_at
from nurbs_lab.mesh.solid.shell_triangles import crossed

IN_VAIN = 4  # attempts in a row that are not better than the best one, which ends the search; 1 if it fits
SAFETY = 0.98  # of the tolerance is aimed at
MOST_FACES = 3000  # of a shell, if it has no more triangles; and of all attempts after the first, together
DENSE = 0.67  # faces of a layout for each of enough, above which planes are as good
RAISE = 1.5  # times its ratio to the aim: the factor of the weight of a face that misses
COST = 0.03  # largest quadric error of the first layout at a tolerance of 1 / 200 of the size, as a length
_SLIVER = 0.5  # of the tolerance: sharp edges nearer to one another become one, others move less when turned
_BESIDE = 2.0  # tolerances on both sides of an edge, along which the mesh must turn for the edge to be sharp
_COARSE = 3.75  # tolerances: mean side of the triangles of a mesh, above which it is coarse
_LONGEST = 0.05  # edge of the divided mesh, of its size
_FEWEST = 10_000  # triangles, up to which long edges are halved
#: Along both sides of a patch that may be the best one, for distances: near corners patches can overshoot.
_CLOSE = 0.5 - 0.5 * np.cos(np.pi * np.arange(33) / 32)
_INSIDE = np.array([(i, j, 10 - i - j) for i in range(11) for j in range(11 - i)]) / 10


@dataclass(frozen=True, eq=False)
class Fitted:
    """Patches, and how far they are from the mesh in both directions."""

    patches: Patches
    mesh_points: np.ndarray
    to_surface: np.ndarray
    surface_points: np.ndarray
    to_mesh: np.ndarray
    bad: np.ndarray  # of every face, the largest distance but for those of the second look
    faulty: np.ndarray  # faces that fold, or pass through others
    face_of_vertex: np.ndarray  # the face nearest to every vertex of the mesh that is divided
    rims: dict | None = None  # of edges with a single face, the regions on the other side

    @property
    def worst(self):
        """Largest distance in either direction."""
        return max(self.to_surface.max(), self.to_mesh.max())


def build(part, tolerance, sharp_angle, most_faces=None, enough=np.inf, regions=None) -> Fitted | None:
    """Fit a shell to a closed surface; the best of the attempts if none keeps the tolerance.

    By default it has at most `MOST_FACES`, or as many faces as the surface has triangles. None if no fit
    keeps the tolerance, and the layouts have ``enough`` faces together, or one `DENSE` times as many.
    Of ``regions``, a number for every triangle and their surfaces, only those of number -1 are fitted, and
    their rims are held on the surfaces of the others.

    Raises
    ------
    ValueError
        If the coarsest layout has too many faces.
    """
    vertices, triangles = part.vertices, part.triangles.astype(np.int64)
    areas = vertex_normals(vertices, triangles)[1]
    centre = np.average(vertices, axis=0, weights=areas)
    size = np.sqrt(12.0 * np.average(((vertices - centre) ** 2).sum(axis=1), weights=areas))
    vertices, within = (vertices - centre) / size, tolerance / size
    label, surfaces = regions or (np.full(len(triangles), -1), [])
    target = own = Target(vertices, triangles, part.volume / size**3)
    if regions:
        own, clean = Target(vertices, triangles[label < 0], 0.0), (vertices, triangles)
    else:
        clean = without_slivers(vertices, triangles, sharp_angle, _SLIVER * within)
    fine, parts = refine(*clean, _LONGEST, _FEWEST)
    if len(parts) > 2 * len(clean[1]):  # most come from long triangles that were halved
        parts = without_needles(fine, parts, sharp_angle, _SLIVER * within)
    coarse = bool(np.sqrt(np.linalg.norm(face_normals(*clean), axis=1).mean() / 2) > _COARSE * within)
    nearest = target.tree.nearest(fine[parts].mean(axis=1), unit(face_normals(fine, parts)))[1]
    regions = label[nearest], [one.scaled(1.0 / size, -centre / size) for one in surfaces]
    mesh = surfels(fine, parts, sharp_angle, _BESIDE * within, not coarse, regions[0])
    samples = vertices[np.unique(own.triangles)], triangle_samples(vertices, own.triangles, 0.02)
    limits = most_faces or max(MOST_FACES, len(triangles)), enough
    best = _refined(mesh, (target, own), np.concatenate(samples), within, limits, part.meets, regions)
    if best is None:
        return None
    for_size = {name: getattr(best, name) * size + centre for name in ("mesh_points", "surface_points")}
    for_size |= {name: getattr(best, name) * size for name in ("to_surface", "to_mesh", "bad")}
    patches = replace(best.patches, control=best.patches.control * size + centre)
    return replace(best, patches=patches, **for_size)


def _refined(mesh, targets, samples, within, limits, meets, regions):
    """The first fit that keeps the tolerance, or the best one, on finer and finer layouts."""
    (most_faces, enough), (target, own), (region, surfaces) = limits, targets, regions
    free = np.unique(mesh.triangles[region < 0])
    weight, best, before, faces, vain = np.ones(len(mesh.vertices)), None, None, 0, 0
    kept, cost = False, COST**2 * within / 0.005
    for attempt in count():
        found, cost = _small_layout(mesh, weight, cost, most_faces, MOST_FACES - faces if attempt else np.inf)
        if found is None:
            break
        layout, chart = found
        faces += len(layout.corners)
        if not attempt and len(layout.corners) > most_faces:
            raise ValueError(
                f"max_faces {most_faces} is too small: the coarsest shell that was found has "
                f"{len(layout.corners)}, and {layout.sharp.mean():.0%} of its edges are sharp; give a larger "
                "sharp_angle or tolerance"
            )
        if len(layout.corners) > DENSE * enough:
            return best if kept else None
        if attempt and (faces > MOST_FACES or len(layout.corners) > most_faces):
            break
        nodes, middle = even_grid(mesh, layout, chart)
        if not np.array_equal(nodes, before):  # or the fit would be the same
            owner = region[middle]
            rims = _rims(layout, owner)
            on = [(edge, surfaces[k]) for edge, k in rims.items()]
            patches = fit(target, layout, nodes, SAFETY * within, on).some(owner < 0)
            fitted = replace(measure(patches, own, mesh.vertices[free], samples), rims=rims)
            if best is None or _score(fitted, within) < _score(best, within):
                fitted = _closely(fitted, own)
                if not meets:
                    # finely where nothing else is wrong: bad patches need many triangles
                    sound = _score(fitted, within) == (0, SAFETY)
                    fine = within / 10 if sound else max(within, fitted.worst / 10)
                    fitted = replace(fitted, faulty=fitted.faulty | crossed(fitted.patches, fine))
        before = nodes
        vain += 1
        if best is None or _score(fitted, within) < _score(best, within):
            best, vain = fitted, 0
        kept = _score(best, within) <= (0, 1.0)
        if _score(best, within) == (0, SAFETY) or vain == (1 if kept else IN_VAIN):
            break
        aim = SAFETY * min(within, fitted.bad.max())  # only the second look may miss
        ratio = np.maximum(fitted.bad / aim, np.where(fitted.faulty, 4.0, 0.0))
        raised = np.where(ratio > 1.0, RAISE * ratio, 1.0)
        weight[free] *= raised[fitted.face_of_vertex]
        if vain > 1:  # smaller faces where it misses did not help twice: smaller ones everywhere
            cost /= 2.0
    return best if kept or faces < enough else None


def _rims(layout, owner):
    """The exact owner of every edge of a layout between a face of that and one whose ``owner`` is -1."""
    sides = owner[layout.sides // 4]
    edges = np.flatnonzero((sides.min(axis=1) < 0) & (sides.max(axis=1) >= 0))
    return dict(zip(edges.tolist(), sides[edges].max(axis=1).tolist(), strict=True))


def _small_layout(mesh, weight, cost, most_faces, left):
    """The first of sixteen layouts, each coarser, with few enough faces, or the last one; its cost."""
    for coarser in cost * 2.0 ** np.arange(16):
        found = lay_out(mesh, weight, coarser, left)
        if found is None or len(found[0].corners) <= most_faces:
            break
    return found, coarser


def _score(fitted, within):
    """Smaller is better: fewer faulty faces, then the largest distance; none counts below the safe one."""
    return int(fitted.faulty.sum()), max(fitted.worst / within, SAFETY)


def measure(patches: Patches, target, inside, samples) -> Fitted:
    """Distances from samples of the mesh to the patches, and from a grid on each patch to the mesh.

    Of the vertices ``inside`` the mesh that is divided, which is not quite the mesh given, the nearest faces
    are found.
    """
    values = patches.grid(np.arange(11) / 10)
    back = target.tree.distances(values.reshape(-1, 3))
    bad = back.reshape(len(values), -1).max(axis=1)
    face, uv, _ = places(values, np.concatenate([samples, inside]))
    (face, face_of_vertex), uv = np.split(face, [len(samples)]), uv[: len(samples)]
    gaps = patches.nearest(samples, face, uv)
    np.maximum.at(bad, face, gaps)
    points, folds = values.reshape(-1, 3), patches.flipped()
    return Fitted(patches, samples, gaps, points, back, bad, folds, face_of_vertex)


def _closely(fitted, target):
    """The same, with more distances: of more places of the patches, the farthest of still more around the
    farthest of each, and those of places in the triangles of the mesh in which the farthest samples lie.
    These last two, the second look, decide, but do not enter ``bad``: layouts would follow single places.
    """
    patches, count = fitted.patches, len(fitted.bad)
    points = patches.grid(_CLOSE).reshape(-1, 3)
    back = target.tree.distances(points)
    bad = np.maximum(fitted.bad, back.reshape(count, -1).max(axis=1))
    farthest = np.array(np.divmod(back.reshape(count, -1).argmax(axis=1), len(_CLOSE)))
    ends = _CLOSE[(farthest - 1).clip(0)], _CLOSE[(farthest + 1).clip(None, len(_CLOSE) - 1)]
    u, v = basis_at(np.linspace(*ends, 9, axis=-1))
    around = np.einsum("fai,fbj,fijx->fabx", u, v, patches.nets, optimize=True).reshape(count, -1, 3)
    around, more = _farthest(around, target.tree.distances(around.reshape(-1, 3)))
    far = fitted.mesh_points[np.argsort(fitted.to_surface)[-count:]]
    corners = target.vertices[target.triangles[np.unique(target.tree.nearest(far)[1])]]
    inside = np.einsum("kc,fcx->fkx", _INSIDE, corners)
    face, uv, _ = places(patches.grid(np.arange(21) / 20), inside.reshape(-1, 3))
    inside, gaps = _farthest(inside, patches.nearest(inside.reshape(-1, 3), face, uv))
    return replace(
        fitted,
        mesh_points=np.concatenate([fitted.mesh_points, inside]),
        to_surface=np.concatenate([fitted.to_surface, gaps]),
        surface_points=np.concatenate([points, around]),
        to_mesh=np.concatenate([back, more]),
        bad=bad,
    )


def _farthest(points, gaps):
    """Of each row of points the farthest, and its distance."""
    gaps, rows = gaps.reshape(len(points), -1), np.arange(len(points))
    return points[rows, gaps.argmax(axis=1)], gaps.max(axis=1)
