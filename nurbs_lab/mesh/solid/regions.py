"""Regions of a mesh that lie on planes, cylinders, cones, spheres and tori.

Coplanar triangles make facets. A facet and some neighbours give a surface, which takes all connected facets
that lie on it; facets that are left are planes, or free form. The vertices of a mesh made by CAD lie on its
surfaces to rounding, so the limits are narrow. What fits by chance, as rings of any surface of revolution fit
cones, shows by its neighbours: they go on smoothly, but no surface that touches theirs.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components

from nurbs_lab.mesh.core import components, face_normals, opposite_of
from nurbs_lab.mesh.solid.quadrics import ROUND, Quadric, circumcentres, fit, improved, made_equal

_FLAT = 2e-6  # of the size: triangles so near to one plane are one facet
_ON = 1e-5  # of the size: vertices so near to a surface lie on it
_SEARCHES = 3
_ROUNDS = 12  # of fitting and taking facets
_TURN = np.cos(np.radians(40.0))  # between a facet and its surface
_AT_ALL = np.cos(np.radians(75.0))  # the same for bad triangles amid a region
_TOUCH = np.sin(np.radians(0.3))  # between neighbouring surfaces that touch
_FREE_FORM = 4  # connected facets left over, from which on they are free form
_WIDE = 20.0  # times the mean area of connected facets, left over: larger ones are planes
_UNLIKE = 50.0  # times the area of a facet: larger neighbours are on other surfaces
_IN_VAIN = 25  # seeds in a row that give no surface, after which the rest has none
_FEWEST = 4  # facets of a round surface
_OPEN = 0.5  # of the border of a region may be smooth and lead to no surface that touches its own


@dataclass(frozen=True)
class Facets:
    """Coplanar connected triangles of a mesh; ``of`` numbers them for every triangle."""

    points: np.ndarray
    triangles: np.ndarray
    of: np.ndarray
    corners: np.ndarray  # vertices, facet after facet
    first: np.ndarray  # where those of every facet begin, and the end
    normals: np.ndarray
    areas: np.ndarray
    rounds: np.ndarray  # centres of the circles around the facets
    sides: np.ndarray  # pairs of neighbouring facets, each edge of the mesh once in either direction
    starts: np.ndarray  # the first vertices of these edges
    lengths: np.ndarray
    smooth: np.ndarray  # which of these edges turn by less than the sharp angle

    def vertices(self, facets):
        """Distinct vertices of some facets."""
        return np.unique(np.concatenate([self.corners[self.first[f] : self.first[f + 1]] for f in facets]))

    def on(self, found, turn=_TURN):
        """Which facets lie on a surface.

        Their vertices do, and their normals are near to those there; and the centres of their triangles are
        only as far from the surface as chords may be that make such angles with it, unlike a plane that
        touches it.
        """
        gaps, normals = found.surface.distances_and_normals(self.points)
        owners = np.repeat(np.arange(len(self.areas)), np.diff(self.first))
        on = np.logical_and.reduceat(np.abs(gaps)[self.corners] < _ON, self.first[:-1])
        cosine = found.sign * np.einsum("ij,ij->i", normals[self.corners], self.normals[owners])
        cosine[np.linalg.norm(normals[self.corners], axis=1) < 0.999] = 1.0  # at an apex
        least = np.minimum.reduceat(cosine, self.first[:-1])
        on &= least > turn
        away = np.linalg.norm(
            self.points[self.corners] - self.points[self.corners[self.first[owners]]], axis=1
        )
        bound = np.maximum.reduceat(away, self.first[:-1]) * np.sqrt(np.maximum(1.0 - least**2, 0.0)) + _ON
        inside = np.flatnonzero(on[self.of])
        centres = self.points[self.triangles[inside]].mean(axis=1)
        on[self.of[inside[np.abs(found.surface.distances(centres)) > bound[self.of[inside]]]]] = False
        return on

    def single(self):
        """Every triangle as a facet of its own, without neighbours."""
        count = len(self.of)
        return replace(
            self, of=np.arange(count), corners=self.triangles.ravel(), first=3 * np.arange(count + 1),
            normals=self.normals[self.of], areas=self.areas[self.of],
        )  # fmt: skip


@dataclass(frozen=True)
class Found:
    """A surface whose normals, times the sign, point out of the material."""

    surface: Quadric
    sign: float


def facets_of(points, triangles, sharp_angle) -> Facets:
    """The facets of a closed mesh with a size of about one."""
    opposite, corners = opposite_of(triangles), points[triangles]
    vectors = face_normals(points, triangles)
    doubled = np.linalg.norm(vectors, axis=1)
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    needle = doubled < 4.0 * _FLAT * lengths.max(axis=1)
    of = _coplanar(corners, vectors / np.maximum(doubled, 1e-300)[:, None], needle, opposite)
    vectors = _sums(of, np.where(needle[:, None], 0.0, vectors))
    areas = np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)
    normals = vectors / areas[:, None]
    pairs = np.unique(np.column_stack([np.repeat(of, 3), triangles.ravel()]), axis=0)
    order = np.lexsort((doubled, of))
    largest = order[np.searchsorted(of[order], np.arange(len(areas)), side="right") - 1]
    sides = np.column_stack([np.repeat(of, 3), of[opposite // 3]])
    kept = sides[:, 0] != sides[:, 1]
    sides = sides[kept]
    turn = np.einsum("ij,ij->i", normals[sides[:, 0]], normals[sides[:, 1]])
    return Facets(
        points, triangles, of, pairs[:, 1], np.searchsorted(pairs[:, 0], np.arange(len(areas) + 1)), normals,
        areas / 2, circumcentres(corners[largest])[0], sides, triangles.ravel()[kept], lengths.ravel()[kept],
        turn > np.cos(np.radians(sharp_angle)),
    )  # fmt: skip


def _coplanar(corners, normals, needle, opposite):
    """Numbers of the facets of triangles; needles belong to the facet across their longest edge."""
    count, half = len(corners), np.arange(len(opposite))
    f, g = half // 3, opposite // 3
    apex = corners.reshape(-1, 3)[3 * g + (opposite % 3 + 2) % 3]
    height = np.abs(np.einsum("ij,ij->i", apex - corners[f, half % 3], normals[f]))
    flat = (height < _FLAT) & (height[opposite] < _FLAT) & ~needle[f] & ~needle[g]
    flat &= np.einsum("ij,ij->i", normals[f], normals[g]) > 0.5
    of = components(count, f[flat], g[flat])[1]
    mean = _sums(of, normals)
    heights = np.einsum("fkj,fj->fk", corners, (mean / np.linalg.norm(mean, axis=1)[:, None])[of])
    reach = np.full((2, len(mean)), -np.inf)
    np.maximum.at(reach[0], of, heights.max(axis=1))
    np.maximum.at(reach[1], of, -heights.min(axis=1))
    flat &= (reach.sum(axis=0) < 2.0 * _FLAT)[of[f]]
    n = np.flatnonzero(needle)
    longest = np.linalg.norm(np.roll(corners[n], -1, axis=1) - corners[n], axis=2).argmax(axis=1)
    across = opposite[3 * n + longest] // 3
    return components(count, np.append(f[flat], n), np.append(g[flat], across))[1]


def _sums(of, vectors):
    return np.stack([np.bincount(of, vectors[:, k]) for k in range(3)], axis=1)


def regions_of(facets: Facets):
    """Number of the region of every triangle, surfaces of the regions, and what made them equal changed.

    Returns None if some of the mesh is free form.
    """
    smooth, count = facets.sides[facets.smooth], len(facets.areas)
    links = csr_matrix((facets.lengths[facets.smooth], (smooth[:, 0], smooth[:, 1])), (count, count))
    label, found = np.full(count, -1), []
    for k in range(_SEARCHES):
        new = _search(facets, links, label < 0, k)
        for one, taken in new:
            label[taken] = len(found)
            found.append(one)
        _absorb(facets, found, label)
        _give_up(facets, found, label)
        _absorb(facets, found, label)
        if not new:
            break
    left = np.flatnonzero(label < 0)
    group = connected_components(links[left][:, left], False)[1]
    few, area = np.bincount(group)[group], np.bincount(group, facets.areas[left])[group]
    planes = left[(few < _FREE_FORM) | (facets.areas[left] * few > _WIDE * area)]
    label[planes] = len(found) + np.arange(len(planes))
    for f in planes:
        plane = fit(
            "plane", facets.points[facets.vertices([f])], None, facets.normals[[f]], facets.areas[[f]]
        )
        found.append(Found(plane, 1.0))
    label = _without_strips(facets, found, label, planes)
    if (label < 0).any():
        return None
    kept, label, counts = np.unique(label, return_inverse=True, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    surfaces, changes = made_equal([found[k].surface for k in kept[order]])
    found = [Found(surface, found[k].sign) for surface, k in zip(surfaces, kept[order], strict=True)]
    return np.argsort(order)[label], found, changes


def _without_strips(facets, found, label, planes):
    """Regions of triangles; those of a flat strip that runs on from a round surface to another are parted."""
    (a, b), triangles, out = facets.sides[facets.smooth].T, facets.single(), label[facets.of]
    for f in planes:
        new = np.full(len(out), -1)
        for k in np.setdiff1d(label[b[a == f]], [-1, *label[planes]]):
            new[triangles.on(found[k])] = k
        if (new[facets.of == f] >= 0).all():
            out[facets.of == f] = new[facets.of == f]
    return out


def _search(facets, links, free, number):
    """Round surfaces through free facets, none of which overlap."""
    new, vain = [], 0
    lonely = np.diff(links.indptr) == 0
    for seed in np.random.default_rng(number).permutation(len(free)):
        if not free[seed] or lonely[seed] or vain > _IN_VAIN:
            continue
        best = _surface_at(facets, links, free, seed)
        vain = max(0.0, vain + 1.0 - 0.5 * len(best[1])) if best else vain + 1.0
        if best:
            free[best[1]] = False
            new.append(best)
    return new


def _surface_at(facets, links, free, seed):
    """The round surface through a facet that takes most others, and these."""
    best = None
    for group in _groups(links, free, facets.areas, seed):
        count = len(group)
        while group is not None:
            seen = _best_through(facets, links, free, group, seed)
            group = None
            if seen and len(seen[1]) > (len(best[1]) if best else 1):
                best, group = seen, seen[1]
        if best and len(best[1]) > 2 * count:
            break
    return best


def _best_through(facets, links, free, group, seed):
    """The surface near a set of facets that takes most others, or as many and is nearer to their centres."""
    points, best = facets.points[facets.vertices(group)], []
    for kind in ROUND:
        surface = fit(kind, points, facets.rounds[group], facets.normals[group], facets.areas[group])
        if surface is None or np.abs(surface.distances(points)).max() > _ON:
            continue
        if grown := _grown(facets, links, free, surface, seed):
            centres = facets.points[facets.triangles[np.isin(facets.of, grown[1])]].mean(axis=1)
            off = np.abs(grown[0].surface.distances(centres)).mean()
            best.append((-len(grown[1]), off, grown))
    return min(best, key=lambda one: one[:2])[2] if best else None


def _groups(links, free, areas, seed):
    """Sets of facets with a seed: two rings, and one ring."""
    near = links[seed].indices
    near = near[free[near] & (areas[near] < _UNLIKE * areas[seed])]
    second = np.unique(links[near].indices) if len(near) else near
    second = second[free[second] & (areas[second] < _UNLIKE * areas[seed])]
    return [np.unique(np.append(second, seed)), np.append(near, seed)] if len(near) else []


def _grown(facets, links, free, surface, seed):
    """A surface fitted again and again to all connected facets on it; None if it loses its seed."""
    taken, at = None, facets.corners[facets.first[seed] : facets.first[seed + 1]]
    for _ in range(_ROUNDS):
        normals = surface.distances_and_normals(facets.points[at])[1]
        found = Found(surface, 1.0 if (normals @ facets.normals[seed]).sum() > 0.0 else -1.0)
        on = facets.on(found) & free
        if not on[seed]:
            return None
        inside = np.flatnonzero(on)
        local = np.searchsorted(inside, seed)
        now = inside[breadth_first_order(links[inside][:, inside], local, False, False)]
        if taken is not None and len(now) <= len(taken):
            break
        taken = now
        better = improved(surface, facets.points[facets.vertices(taken)])
        if better is None or not better.sound():
            break
        surface = better
    return (Found(surface, found.sign), taken) if len(taken) >= _FEWEST else None


def _absorb(facets, found, label):
    """Bad triangles beside a region and smaller regions join it if they lie on its surface."""
    a, b = facets.sides.T
    few = np.bincount(facets.of) <= 2  # triangles
    numbers, counts = np.unique(label[label >= 0], return_counts=True)
    for k in numbers[np.argsort(-counts, kind="stable")]:
        on = facets.on(found[k], _AT_ALL)
        for j in np.unique(label[b[(label[a] == k) & (label[b] != k)]]):
            if j >= 0 and on[label == j].all() and (label == j).sum() < (label == k).sum():
                label[label == j] = k
        while (new := np.unique(b[(label[a] == k) & on[b] & few[b] & (label[b] < 0)])).size:
            label[new] = k


def _give_up(facets, found, label):
    """Leave only regions of enough facets, bounded by sharp edges and by surfaces that touch them.

    The others are given up, smallest first, until none is left.
    """
    a, b = facets.sides.T
    few = np.bincount(facets.of) <= 2  # triangles; others are planes or strips
    while True:
        rim = (label[a] >= 0) & (label[a] != label[b])
        at = facets.points[facets.starts[rim]]
        here, there = (_normals(facets, found, label, side[rim], at) for side in (a, b))
        apart = (np.linalg.norm(np.cross(here, there), axis=1) > _TOUCH) & facets.smooth[rim]
        apart &= np.minimum(np.linalg.norm(here, axis=1), np.linalg.norm(there, axis=1)) > 0.999  # no apex
        apart &= few[b[rim]] | (label[b[rim]] >= 0)
        total = np.bincount(label[a[rim]], facets.lengths[rim], len(found))
        loose = np.bincount(label[a[rim]], facets.lengths[rim] * apart, len(found))
        size = np.bincount(label[label >= 0], minlength=len(found))
        doubtful = np.flatnonzero((size > 0) & ((loose > _OPEN * total) | (size < _FEWEST)))
        if not len(doubtful):
            return
        label[label == min(doubtful, key=lambda k: size[k])] = -1


def _normals(facets, found, label, at, places):
    """Outward normals of regions at places, and of facets that belong to none."""
    out = facets.normals[at].copy()
    for k in np.unique(label[at][label[at] >= 0]):
        mine = label[at] == k
        out[mine] = found[k].sign * found[k].surface.distances_and_normals(places[mine])[1]
    return out
