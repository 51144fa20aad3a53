"""Regions of a mesh that lie on planes, cylinders, cones, spheres and tori.

Coplanar triangles make facets. A facet and some neighbours give a surface, which takes all connected facets
that lie on it; facets that are left are planes, or free form. The vertices of a mesh made by CAD lie on its
surfaces to rounding, so the limits are narrow.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components

from nurbs_lab.common.checks import extent
from nurbs_lab.mesh.core import components, face_normals, opposite_of, unit
from nurbs_lab.mesh.repair import ClosedSurface
from nurbs_lab.mesh.solid.quadrics import ON, ROUND, SAME, circumcentres, fit, improved, made_equal

_TURN = np.cos(np.radians(40.0))  # between a facet and its surface
_IN_VAIN = 25  # seeds in a row that give no surface, after which the rest has none
_TOUCHING = 1e-4  # radians between normals of surfaces that touch
_FEWEST = 4  # facets of free form that are left over; a round surface has the vertices of so many in a row


@dataclass(frozen=True)
class Facets:
    """Coplanar connected triangles of a closed surface; ``of`` numbers them for every triangle."""

    part: ClosedSurface
    size: float
    centre: np.ndarray
    points: np.ndarray  # less the centre, over the size
    triangles: np.ndarray
    of: np.ndarray
    normals: np.ndarray
    areas: np.ndarray
    rounds: np.ndarray  # centres of the circles around the facets
    sides: np.ndarray  # pairs of neighbouring facets, for each edge of the mesh one in either direction
    ends: np.ndarray  # the vertex where each of these edges begins in that direction
    turn: np.ndarray  # the cosine of the angle between them there
    through: dict[bytes, list] = field(default_factory=dict)  # what `surfaces` found for groups

    def vertices(self, facets):
        """Distinct vertices of some facets."""
        return np.unique(self.triangles[np.isin(self.of, facets)])

    def on(self, found):
        """Which facets lie on a surface: all of their triangles do."""
        return np.bincount(self.of, ~self.triangles_on(found)) == 0

    def triangles_on(self, found):
        """Which triangles lie on a surface.

        Their vertices do, and the normals of their facets are near to those there; and their centres are only
        as far from it as chords may be that make such angles with it, unlike a plane that touches it.
        """
        gaps, normals = found.distances_and_normals(self.points)
        on = (np.abs(gaps) < ON)[self.triangles].all(axis=1)
        corners, normals = self.points[self.triangles[on]], normals[self.triangles[on]]
        cosine = found.sign * np.einsum("fkj,fj->fk", normals, self.normals[self.of[on]])
        cosine[np.linalg.norm(normals, axis=2) < 0.999] = 1.0  # at an apex
        least = cosine.min(axis=1)
        bound = np.ptp(corners, axis=1).max(axis=1) * np.sqrt(np.maximum(1.0 - least**2, 0.0)) + ON
        on[on] = (least > _TURN) & (np.abs(found.distances(corners.mean(axis=1))) <= bound)
        return on

    def surfaces(self, group):
        """Round surfaces, one of a kind at most, on which the vertices of some facets lie; found once."""
        if (key := group.tobytes()) not in self.through:
            points = self.points[self.vertices(group)]
            places, normals, areas = self.rounds[group], self.normals[group], self.areas[group]
            found = (fit(kind, points, places, normals, areas) for kind in ROUND)
            self.through[key] = [s for s in found if s and np.abs(s.distances(points)).max() <= ON]
        return self.through[key]


def facets_of(part, apart=False) -> Facets:
    """The facets of a `ClosedSurface`; triangles ``apart`` are facets of their own."""
    triangles, size = part.triangles.astype(np.int64), extent(part.vertices)
    centre = (part.vertices.min(axis=0) + part.vertices.max(axis=0)) / 2
    points = (part.vertices - centre) / size
    opposite, corners = opposite_of(triangles), points[triangles]
    vectors = face_normals(points, triangles)
    doubled = np.linalg.norm(vectors, axis=1)
    normals = unit(vectors)[_with_a_plane(corners, doubled, opposite)]
    of = _coplanar(corners, normals, opposite, np.broadcast_to(apart, doubled.shape))
    vectors = np.column_stack([np.bincount(of, column) for column in vectors.T])
    order = np.lexsort((doubled, of))
    largest = order[np.searchsorted(of[order], np.arange(len(vectors)), side="right") - 1]
    sides = np.column_stack([np.repeat(of, 3), of[opposite // 3]])
    kept, normals = sides[:, 0] != sides[:, 1], unit(vectors)
    turn = np.einsum("ij,ij->i", *normals[sides[kept]].swapaxes(0, 1))
    return Facets(
        part, size, centre, points, triangles, of, normals, np.linalg.norm(vectors, axis=1) / 2,
        circumcentres(corners[largest])[0], sides[kept], triangles.ravel()[kept], turn,
    )  # fmt: skip


def _with_a_plane(corners, doubled, opposite):
    """Every triangle itself, or, as a needle has no plane, the triangle at its side of middle length."""
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    own = np.arange(len(corners))
    beside = opposite[3 * own + lengths.argsort(axis=1)[:, 1]] // 3
    beside = np.where(doubled < SAME * lengths.max(axis=1), beside, own)
    for _ in range(6):  # from needle to needle
        beside = beside[beside]
    return beside


def _coplanar(corners, normals, opposite, apart):
    """Numbers of the facets of triangles."""
    count, half = len(corners), np.arange(len(opposite))
    f, g = half // 3, opposite // 3
    apex = corners.reshape(-1, 3)[3 * g + (opposite % 3 + 2) % 3]
    height = np.abs(np.einsum("ij,ij->i", apex - corners[f, half % 3], normals[f]))
    flat = (height < SAME) & (height[opposite] < SAME) & ~apart[f] & ~apart[g]
    flat &= np.einsum("ij,ij->i", normals[f], normals[g]) > 0.5
    return components(count, f[flat], g[flat])[1]


def regions_of(facets, sharp_angle, least=None):
    """Number of the region of every triangle, surfaces of the regions, and what made them equal changed.

    Where some of the mesh is free form, returns None; or, if a ``least`` area is given, numbers of -1 there.
    To free form belong smaller regions, and those that meet it, or one another, smoothly but do not touch.
    None if nothing else is left.
    """
    sharp = np.cos(np.radians(sharp_angle))
    links, label, found = _search(facets, sharp, least)
    if (apart := _of_several(facets, found, label)).any():
        facets = facets_of(facets.part, apart)
        links, label, found = _search(facets, sharp, least)
    _absorb(facets, found, label)
    left = np.flatnonzero(label < 0)
    group = connected_components(links[left][:, left], False)[1]
    free = (np.bincount(group) >= _FEWEST)[group]
    if free.any() and least is None:
        return None
    free |= free.any() & (np.bincount(facets.of)[left] == 1)  # any triangle has a plane
    left = left[~free]
    label[left] = len(found) + np.arange(len(left))
    for f in left:
        points = facets.points[facets.vertices(f)]
        found.append(fit("plane", points, None, facets.normals[[f]], facets.areas[[f]]))
    if least is not None:
        label[np.bincount(label + 1, facets.areas)[label + 1] < least] = -1
        _join_free(facets, sharp, found, label)
    label = label[facets.of]
    kept, counts = np.unique(label[label >= 0], return_counts=True)
    if not len(kept):
        return None
    order, number = kept[np.argsort(-counts, kind="stable")], np.full(len(found) + 1, -1)
    number[order] = np.arange(len(order))
    return number[label], *made_equal([found[k] for k in order])


def _join_free(facets, sharp, found, label):
    """Regions become free form that meet other regions smoothly where their surfaces do not touch."""
    smooth = (facets.turn > sharp) & (np.diff(label[facets.sides], axis=1)[:, 0] != 0)
    sides, points = label[facets.sides[smooth]].T, facets.points[facets.ends[smooth]]
    normals = np.zeros((2, len(points), 3))
    for side, beside in zip(sides, normals, strict=True):
        for k in np.unique(side[side >= 0]):
            beside[side == k] = found[k].sign * found[k].distances_and_normals(points[side == k])[1]
    off = np.linalg.norm(normals[0] - normals[1], axis=1) > _TOUCHING
    while len(joined := np.setdiff1d(sides[:, off | (sides < 0).any(axis=0)], [-1])):
        for numbers in (label, sides):
            numbers[np.isin(numbers, joined)] = -1


def _of_several(facets, found, label):
    """Triangles of facets left over that lie on several round surfaces: coplanar by chance."""
    on = np.any([facets.triangles_on(one) for one in found] or [facets.of < 0], axis=0)
    return ((np.bincount(facets.of, ~on) == 0) & (label < 0))[facets.of]


def _search(facets, sharp, least):
    """Links across smooth sides; round surfaces through facets, none of which overlap, and their numbers.

    If a ``least`` area is given, connected facets are searched on their own, for a search among others may be
    in vain; not those that are smaller together.
    """
    smooth, count = facets.sides[facets.turn > sharp], len(facets.areas)
    links = csr_matrix((np.ones(len(smooth)), tuple(smooth.T)), (count, count))
    label, found, vain = np.full(count, -1), [], np.zeros(count)
    part = np.zeros(count, int) if least is None else connected_components(links, False)[1]
    alone = (np.bincount(part, facets.areas)[part] < (least or 0.0)) | (np.diff(links.indptr) == 0)
    seeds = np.random.default_rng(0).permutation(count)
    seeds = seeds[~alone[seeds]]
    while len(seeds):
        seed, seeds = seeds[0], seeds[1:]
        if label[seed] >= 0:
            continue
        best = _surface_at(facets, links, label < 0, seed)
        more = 1.0 - 0.5 * len(best[1]) if best else 1.0
        vain[part[seed]] = max(0.0, vain[part[seed]] + more)
        if vain[part[seed]] > _IN_VAIN:
            seeds = seeds[part[seeds] != part[seed]]
        if best:
            label[best[1]] = len(found)
            found.append(best[0])
    return links, label, found


def _surface_at(facets, links, free, seed):
    """The round surface through a facet and two rings around it that takes most others, and these.

    Of surfaces that take as many, that which is nearer to their centres. All that the best one takes are
    tried together again: a few narrow facets of a cone lie on a cylinder too.
    """
    group, best = np.array([seed]), None
    for _ in range(2):
        ring = np.unique(links[group].indices)
        group = np.union1d(group, ring[free[ring]])
    while True:
        tried = [best] if best else []
        for surface in facets.surfaces(group):
            if grown := _grown(facets, links, free, surface, seed):
                centres = facets.points[facets.triangles[np.isin(facets.of, grown[1])]].mean(axis=1)
                off = np.abs(grown[0].distances(centres)).mean()
                tried.append((-len(grown[1]), off, grown))
        better = min(tried, key=lambda one: one[:2], default=None)
        if better is None or (best and better[0] == best[0]):
            return better and better[2]
        best, group = better, better[2][1]


def _grown(facets, links, free, surface, seed):
    """A surface fitted again and again to all connected facets on it; None if it loses its seed."""
    taken, at = None, facets.points[facets.vertices(seed)]
    while True:
        normals = surface.distances_and_normals(at)[1]
        surface = replace(surface, sign=1.0 if (normals @ facets.normals[seed]).sum() > 0.0 else -1.0)
        inside = np.flatnonzero(facets.on(surface) & free)
        local = np.searchsorted(inside, seed)
        if local == len(inside) or inside[local] != seed:
            return None
        now = inside[breadth_first_order(links[inside][:, inside], local, False, False)]
        if taken is not None and len(now) <= len(taken):
            break
        taken = now
        better = improved(surface, facets.points[facets.vertices(taken)])
        if better is None or not better.sound():
            break
        surface = better
    return (surface, taken) if len(facets.vertices(taken)) >= 2 * (_FEWEST + 1) else None


def _absorb(facets, found, label):
    """Bad triangles beside a region join it if they lie on its surface, those of the largest first."""
    a, b = facets.sides.T
    few = np.bincount(facets.of) <= 2  # triangles
    numbers, counts = np.unique(label[label >= 0], return_counts=True)
    for k in numbers[np.argsort(-counts, kind="stable")]:
        on = facets.on(found[k])
        while (new := np.unique(b[(label[a] == k) & on[b] & few[b] & (label[b] < 0)])).size:
            label[new] = k
