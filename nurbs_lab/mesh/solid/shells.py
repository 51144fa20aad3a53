"""One closed shell of patches for one closed surface of a mesh, refined until it keeps the tolerance."""

import itertools
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
from scipy.spatial import cKDTree

from nurbs_lab.mesh.distance import triangle_samples, triangle_tree
from nurbs_lab.mesh.solid.fit_patches import TURNED, fit
from nurbs_lab.mesh.solid.grids import even_grid, places
from nurbs_lab.mesh.solid.layout import FLAT, lay_out
from nurbs_lab.mesh.solid.patches import DEGREE, Patches, cell_normals, cells_of, linear
from nurbs_lab.mesh.solid.surfels import Surfels, face_normals, refine, surfels, unit, without_slivers

ATTEMPTS = 9
# Of the cost, to find a layout with few enough faces.
_FACTORS = (1.0, 1.3, 1.7, 2.2, *4.0 ** np.arange(1, 12))
SAFETY = 0.98  # of the tolerance is aimed at
SEAM_DEGREES = 0.5
_VOLUME = 0.003  # of the volume of a solid, that all of its shells may lose or gain
_SPANS, _MOST_SPANS = 2, 6  # along each side of a patch, more and more as long as they help
_DRAFTS = 2  # first layouts of a large mesh without sharp edges, which only show where patches are too large
_LARGE = 12_000  # triangles; fits of smaller meshes take little time
_MANY = 0.25  # of the faces: where more of them miss the tolerance, all patches get more spans
_FEW = 0.02  # of the faces: where fewer of them miss it, a finer layout costs less than a third span of all
_NEARLY_SMOOTH = 4.0  # degrees across seams, above which further spans hardly help
_CHEAP = 0.2  # control points a triangle, up to which patches that nearly keep the tolerance get a third span
_HELPED = 0.9  # of the score before: spans that lower it less do not help
EXTRA = 6  # attempts for smoother seams, once the tolerance is kept
_SLIVER = 0.25  # of the tolerance: sharp edges nearer than that to one another become one
_BESIDE = 2.0  # tolerances on both sides of an edge, along which the mesh must turn for the edge to be sharp
_COARSE = 3.75  # tolerances: mean side of the triangles of a mesh, above which it is coarse
_REFINED = 0.5, 1.0  # of the tolerance: patches that miss more are refined, on fine and on coarse meshes
_NEARLY_KEPT = SAFETY, 1.1  # of the tolerance: patches up to it get more spans, on fine and on coarse meshes
_LONGEST = 0.05  # edge of the mesh that is fitted, of its size
_FEWEST = 10_000  # triangles, up to which long edges are halved
_MOST_TURNED = 2  # faces at a vertex that turn over before flat ones replace them; later ones count more
_MOST_MISSED = 4  # the same for faces that are far from the mesh
_MISSED = 2.0  # of the tolerance: faces beyond it are far, and more spans are not tried
_SHORTEST = 0.5, 0.05  # chain of sharp edges with a free end, and set of sharp edges, of the size
_FADING = 0.05, 0.05  # the same where chains run on until they fade, which is tried too on coarse meshes
_FAR_FROM = 2.0  # times the most faces: if a first layout needs more, smooth patches are given up
_MOST_FACES = 2_000  # of smooth patches; fewer on meshes of fewer triangles, more on very fine ones
_WORK, _MORE = 40_000, 1.5  # control points of all attempts together, of a part, and more for each triangle
_FEW_WRONG = 0.1  # of the faces: an attempt with fewer of them takes nothing from that work
# Of the largest distance before, and of the tolerance: a layout beyond both is in vain.
_NEARER, _ALMOST = 0.9, 1.1
_MOST_IN_VAIN = 3  # such layouts in a row, after which smooth patches are given up
_NEEDLE = 1e-4  # area, of its squared size, below which a mesh gets no smooth patches
_SAMPLES = 400_000  # of the mesh, at most, inside its triangles
_FINER = 0.0625 * 0.5 ** np.arange(3)  # of the tolerance: mean distance to the mesh of flat faces
_LESS_WARP = 0.25  # from one layout of flat faces to the next
_FIRM = 0.1  # of the tolerance: the same of flat faces among smooth ones
_PLANE = 1e-12  # distance of triangles that are in one plane
_STRAIGHT = 1e-6  # sine of an angle between two triangles of one facet of a polyhedron


@dataclass(frozen=True, eq=False)
class Fitted:
    """Patches, and how far they are from the mesh in both directions; lengths in the units of the mesh."""

    patches: Patches
    mesh_points: np.ndarray
    to_surface: np.ndarray
    surface_points: np.ndarray
    to_mesh: np.ndarray
    bad: np.ndarray  # of every face, the largest distance
    turned: np.ndarray  # faces that turn over somewhere
    seam: float  # largest angle across smooth edges, degrees
    seams: np.ndarray  # largest angle across the smooth edges of every face
    face_of_vertex: np.ndarray
    volume_error: float  # over the mean volume of the shells of its solid; 0 where the tolerance is missed

    @property
    def worst(self):
        """Largest distance in either direction."""
        return max(self.to_surface.max(), self.to_mesh.max())


def build(part, tolerance, sharp_angle, most_faces, most_points, fraction, volume) -> Fitted:
    """Fit a shell to a closed surface; the best of the attempts if none keeps the tolerance.

    ``fraction`` is that of the triangles of all surfaces which are on this one, and ``volume`` the mean of
    the signed volumes of the shells of its solid.

    Raises
    ------
    ValueError
        If every attempt has too many faces or control points.
    """
    vertices, triangles = part.vertices, part.triangles.astype(np.int64)
    centre = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    unit_vertices, within = (vertices - centre) / size, tolerance / size
    volumes = part.volume / size**3, volume / size**3
    clean = without_slivers(unit_vertices, triangles, sharp_angle, _SLIVER * within)
    fine, parts = refine(*clean, _LONGEST, _FEWEST)
    coarse = bool(np.sqrt(np.linalg.norm(face_normals(*clean), axis=1).mean() / 2) > _COARSE * within)
    mesh = surfels(fine, parts, sharp_angle, _SHORTEST, _BESIDE * within, rough=not coarse)
    tree = triangle_tree(unit_vertices[triangles])
    inside = triangle_samples(unit_vertices, triangles, 0.02, _SAMPLES)
    own = 0 if np.array_equal(fine, unit_vertices) else len(fine)  # samples that are not of the mesh given
    samples = np.concatenate([fine[:own], unit_vertices, inside])
    best, spare = None, EXTRA
    needle = mesh.areas.sum() < _NEEDLE
    most = 0 if needle else min(len(triangles), max(_MOST_FACES, len(parts) // 4))
    work = _WORK * fraction + _MORE * len(triangles)
    raw = surfels(unit_vertices, triangles, sharp_angle, (0.0, 0.0), _BESIDE * within)
    first = len(samples) if coarse else len(samples) - len(inside)
    full = partial(measure, mesh=mesh, tree=tree, samples=samples, own=own, volumes=volumes, within=within)
    judge = partial(_judge, partial(full, first=first), volumes[0], within)
    polyhedron = [judge(_flat(raw, 1.0), True)] if _is_polyhedron(raw) else []
    too_many = []

    def allowed(fits):
        for fitted in fits:
            if len(fitted.patches.net) > most_faces or fitted.patches.points > most_points:
                too_many.append(fitted.patches)
                return
            yield fitted

    few_enough = min(most_faces, most_points // _points(1, _SPANS))
    settings = judge, within, coarse, few_enough, most, work
    attempts = _attempts(mesh, *settings)
    if coarse:
        fading = surfels(fine, parts, sharp_angle, _FADING, _BESIDE * within, fading=True)
        if (fading.sharp != mesh.sharp).any():
            attempts = _better(attempts, allowed(_attempts(fading, *settings)), work / 4, within)

    for fitted in allowed(itertools.chain(polyhedron, attempts)):
        if best is None or _score(fitted, within) < _score(best, within):
            best = fitted
        kept = best.worst <= SAFETY * within
        good = _score(best, within) == 0.0
        if kept and (good or spare == 0 or best.patches.degree == 1 or len(best.bad) > _MOST_FACES):
            break
        spare -= kept and not best.turned.any()
    needed = best is None or not _sound(best, within)
    for fitted in allowed(_flats(raw, judge, within) if needed or best.seam > sharp_angle else ()):
        if not needed and fitted.patches.points > best.patches.points:
            break
        # Where the mesh itself folds, flat faces turn over too, which is no reason to miss the tolerance.
        nearer = best is None or fitted.worst <= within < best.worst
        if nearer or _score(fitted, within) < _score(best, within):
            best = fitted
        if _sound(fitted, within) and fitted.volume_error <= _VOLUME:
            break
    if best is None:
        least = min(too_many, key=lambda patches: len(patches.net))
        name, most, count = "max_faces", most_faces, len(least.net)
        if count <= most_faces:
            name, most, count = "max_control_points", most_points, least.points
        raise ValueError(f"{name} {most} is too small: the coarsest shell that was found has {count}")
    if len(best.to_surface) < len(samples) - own:
        best = full(best.patches, best.turned)
    return replace(
        best,
        patches=replace(best.patches, control=best.patches.control * size + centre),
        **{name: getattr(best, name) * size + centre for name in ("mesh_points", "surface_points")},
        **{name: getattr(best, name) * size for name in ("to_surface", "to_mesh", "bad")},
    )


def _better(attempts, others, few, within):
    """The others if those start twice as well, which is not tried if a fit has more than ``few`` points."""
    first = next(attempts, None)
    if first is not None and _score(first, within) > 0.0 and first.patches.points <= few:
        other = next(others, None)
        if other is not None and 2.0 * _score(other, within) < _score(first, within):
            first, attempts = other, others
    if first is not None:
        yield first
        yield from attempts


def _sound(fitted, within):
    """Whether the tolerance is kept and no face turns over."""
    return fitted.worst <= within and not fitted.turned.any()


def _score(fitted, within):
    """Zero if all is well; smaller is better."""
    miss = max(0.0, fitted.worst / (SAFETY * within) - 1.0)
    seam = max(0.0, fitted.seam / SEAM_DEGREES - 1.0) / 1000.0
    volume = max(0.0, fitted.volume_error / _VOLUME - 1.0) / 100.0
    return 10.0 * miss + min(seam, 0.3) + min(volume, 0.3) + (5.0 if fitted.turned.any() else 0.0)


def _attempts(mesh: Surfels, judge, within, coarse, most_faces, most, work):
    """Patches on finer and finer layouts, up to ``most`` faces, finer where the last ones missed too much.

    Patches get more spans, for as long as that helps, where many of them miss the tolerance, where it is
    kept or nearly so, where a finer layout came no nearer, and where few control points are enough; those on
    the next layout start with as many. On a ``coarse`` mesh, whose triangles are large beside the tolerance,
    spans come sooner than finer layouts.

    Drafts leave the seams alone, which is faster and depends less on rounding where patches are far too
    large. The attempts end before those together have more than ``work`` control points, of which the first
    one may have more, or when layouts in a row come no nearer to the mesh and miss the tolerance. Attempts
    with few wrong faces do not count, and the next one may have more faces.
    """
    ones = np.ones(len(mesh.vertices))
    weight, turned, missed = ones, np.zeros(len(ones)), np.zeros(len(ones))
    cost, first = (0.03 * np.sqrt(within / 0.005)) ** 2, _SPANS
    nearest, in_vain, nearly_right = np.inf, 0, False
    nearly_kept = _NEARLY_KEPT[coarse] * within
    few = _CHEAP * len(mesh.triangles) / _points(1, _SPANS + 1)
    draft = len(mesh.triangles) > _LARGE and not mesh.sharp.any()
    corners = np.empty(0)
    for k in range(ATTEMPTS):
        layout, chart = _whole_layout(mesh, weight, cost, _FIRM * within, most_faces)
        if np.array_equal(layout.corners, corners):  # the mesh has no vertices for smaller patches
            first = min(first + 1, _MOST_SPANS)
        corners = layout.corners
        faces = len(corners)
        if k == 0:
            too_many = faces > _FAR_FROM * most or _points(faces, first) > max(work, _WORK)
        else:
            too_many = faces > most * (_FAR_FROM if nearly_right else 1.0) or _points(faces, first) > work
        if too_many:
            break
        grid, least, before = cache(partial(even_grid, mesh, layout, chart)), np.inf, nearest
        draft = draft and k < _DRAFTS
        if draft:
            fitted = judge(*fit(mesh, layout, grid, first, within, smooth=False))
            yield fitted
            draft = fitted.worst > _MISSED * within
        for spans in range(first, first if draft else _MOST_SPANS + 1):
            fitted = judge(*fit(mesh, layout, grid, spans, within))
            yield fitted
            wrong = (fitted.bad > SAFETY * within) | fitted.turned | (fitted.seams > SEAM_DEGREES)
            nearly_right = wrong.mean() < _FEW_WRONG
            work -= 0 if nearly_right else fitted.patches.points
            nearest = min(nearest, fitted.worst)
            nearer = nearest <= max(_NEARER * before, _ALMOST * within)
            score = _score(fitted, within)
            if score >= _HELPED * least:
                break
            least, first = score, spans
            smooth, missing = fitted.seam < _NEARLY_SMOOTH, (fitted.bad > SAFETY * within).mean()
            nearly = fitted.worst <= nearly_kept and smooth
            many = missing > _MANY and smooth
            affordable = _points(faces, spans + 1) <= work
            cheap = spans == _SPANS and faces < few and fitted.worst <= _MISSED * within
            cheap &= missing > _FEW
            if fitted.turned.any() or not affordable or not (nearly or many or cheap or not nearer):
                break
        in_vain = 0 if draft or nearer else in_vain + 1
        if in_vain == _MOST_IN_VAIN:
            break
        needed = np.sqrt(np.maximum(fitted.bad / within, 1.0)).sum()  # distances fall with the squared area
        if needed > _FAR_FROM * most and most_faces > most and not nearly_right:
            break
        folded = fitted.turned & (not draft)  # seams that are left alone let faces turn over
        turned += _touched(mesh, fitted, folded) * (1 + k // 2)
        missed += _touched(mesh, fitted, (fitted.bad > _MISSED * within) & (not draft))
        ratio = np.maximum(fitted.bad / (SAFETY * within), np.where(folded, 8.0, 0.0))
        seams = fitted.seams / SEAM_DEGREES
        ratio = np.maximum(ratio, np.where((seams > 1.0) & (not draft), np.minimum(seams, 4.0), 0.0))
        raised = np.where(ratio > _REFINED[coarse], np.clip(2.0 * ratio, 1.0, 16.0), 1.0)
        weight = weight * raised[fitted.face_of_vertex]
        hopeless = (turned >= _MOST_TURNED) | (missed >= _MOST_MISSED)
        weight[mesh.triangles[hopeless[mesh.triangles].any(axis=1)]] = FLAT


def _points(faces, spans):
    """Number of control points of faces with ``spans`` spans a side."""
    return faces * (spans + DEGREE) ** 2


def _flat(mesh, error):
    """Flat patches on a mesh coarsened by an error."""
    return linear(lay_out(mesh, np.full(len(mesh.vertices), FLAT), error**2, error)[0])


def _touched(mesh, fitted, faces):
    """Which vertices are nearest to some faces, or nearest to a point of them."""
    touched = faces[fitted.face_of_vertex]
    points = fitted.surface_points.reshape(len(faces), -1, 3)[faces].reshape(-1, 3)
    touched[cKDTree(mesh.vertices).query(points)[1]] = True
    return touched


def _flats(mesh, judge, within):
    """Flat patches on finer layouts and with less warp, the last ones on the triangles of the mesh."""
    for k, error in enumerate((*within * _FINER, _PLANE)):
        straighter = replace(mesh, most_warp=mesh.most_warp * _LESS_WARP**k)
        yield judge(_flat(straighter, error), True)


def _whole_layout(mesh, weight, cost, flat_error, most_faces):
    """The first layout with few enough faces, coarser and coarser ones; the coarsest if none has."""
    for factor in _FACTORS:
        layout, chart = lay_out(mesh, weight, factor * cost, flat_error)
        if len(layout.corners) <= most_faces:
            break
    return layout, chart


def _is_polyhedron(mesh):
    """Whether every edge is sharp or flat."""
    normals = unit(face_normals(mesh.vertices, mesh.triangles))
    first, second = np.repeat(normals, 3, axis=0)[~mesh.sharp], normals[mesh.opposite[~mesh.sharp] // 3]
    return bool(np.linalg.norm(np.cross(first, second), axis=1).max(initial=0.0) < _STRAIGHT)


def _judge(measured, volume, within, patches, suspected):
    """Patches as they are, or moved a little along their normals where only the volume is wrong."""
    fitted = measured(patches, suspected)
    if fitted.volume_error > _VOLUME and not patches.layout.flat.all():
        moved = measured(patches.enclosing(volume), suspected)
        return min(fitted, moved, key=partial(_score, within=within))
    return fitted


def measure(
    patches: Patches, suspected, mesh: Surfels, tree, samples, own, volumes, within, first=0
) -> Fitted:
    """Distances from samples of the mesh to the patches, and from a grid on each patch to the mesh.

    The first samples are the vertices of the mesh that is fitted, of which ``own`` are none of the mesh given
    and do not count. Where those up to ``first`` are farther than ``within``, the others are left out. Faces
    that are ``suspected`` have turned over if the mesh next to them faces the other way. ``volumes`` are
    those of the mesh, and the mean of the shells of its solid.
    """
    most = 4 * patches.spans + 2
    cells = most if patches.degree > 1 else int(np.clip(np.sqrt(_SAMPLES / len(patches.net)), 2, most))
    values = patches.grid(cells)
    grid_gaps, nearest = tree.nearest(values.reshape(-1, 3))
    bad, gaps, faces = grid_gaps.reshape(len(values), -1).max(axis=1), np.empty(0), np.empty(0, int)
    for part in samples[:first], samples[first:]:
        if gaps[own:].max(initial=0.0) > within or not len(part):
            continue
        face, uv, _ = places(values, part, np.empty((0, 3)))
        gaps, faces = np.append(gaps, patches.nearest(part, face, uv)), np.append(faces, face)
    np.maximum.at(bad, faces, gaps)
    angles = patches.seam_angles(8)
    smooth = np.where(patches.layout.sharp[:, None], 0.0, angles).max(axis=1)
    normals, beside = cell_normals(values), unit(tree.normals[tree.place[nearest]]).reshape(values.shape)
    around = [np.einsum("fijk,fijk->fij", normals, corner) for corner in cells_of(beside)]
    turned = suspected & (np.max(around, axis=0) < TURNED).any(axis=(1, 2))
    volume_error = 0.0
    if max(gaps[own:].max(), grid_gaps.max()) <= within and volumes[1] > 0.0:
        volume_error = abs(patches.volume_and_area()[0] - volumes[0]) / volumes[1]
    return Fitted(
        patches, samples[own : len(gaps)], gaps[own:], values.reshape(-1, 3), grid_gaps, bad, turned,
        float(smooth.max(initial=0.0)), smooth[patches.layout.edges].max(axis=1),
        faces[: len(mesh.vertices)], volume_error,
    )  # fmt: skip
