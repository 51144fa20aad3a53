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

from nurbs_lab.mesh.core import opposite_of
from nurbs_lab.mesh.solid.quadrics import ROUND, UNKNOWNS, Quadric, fit, improved

_FLAT = 2e-6  # of the size: triangles so near to one plane are one facet
_ON = 1e-5  # of the size: vertices so near to a surface lie on it
_AT_ALL = np.cos(np.radians(75.0))  # the same for bad triangles amid a region
_BETTER = 0.1  # of the distance to the surface of its region: a facet so near to the next one belongs there
_SEARCHES = 3
_ROUNDS = 12  # of fitting and taking facets
_TURN = np.cos(np.radians(40.0))  # between a facet and its surface
_TOUCH = np.radians(0.3)  # between neighbouring surfaces that touch
_FREE_FORM = 4  # connected facets left over, from which on they are free form
_WIDE = 20.0  # times the mean area of connected facets, left over: larger ones are planes
_IN_VAIN = 25  # seeds in a row that give no surface, after which the rest has none
_OPEN = 0.5  # of the smooth border of a region may lead to no surface that touches its own


@dataclass(frozen=True)
class Facets:
    """Coplanar connected triangles of a mesh; ``of`` numbers them for every triangle."""

    points: np.ndarray
    of: np.ndarray
    corners: np.ndarray  # vertices, facet after facet
    first: np.ndarray  # where those of every facet begin, and the end
    normals: np.ndarray
    areas: np.ndarray
    centres: np.ndarray  # of all triangles
    rounds: np.ndarray  # centres of the circles around the facets
    sides: np.ndarray  # pairs of neighbouring facets, each edge of the mesh once in either direction
    ends: np.ndarray  # the two vertices of these edges
    lengths: np.ndarray
    smooth: np.ndarray  # which of these edges turn by less than the sharp angle

    @property
    def count(self):
        """Number of facets."""
        return len(self.areas)

    @property
    def reach(self):
        """Largest distance of a corner from the first one, of every facet."""
        away = self.points[self.corners] - self.points[self.corners[self.first[:-1]]][self.owners]
        return np.maximum.reduceat(np.linalg.norm(away, axis=1), self.first[:-1])

    @property
    def owners(self):
        """The facet of every corner."""
        return np.repeat(np.arange(self.count), np.diff(self.first))

    def vertices(self, facets):
        """Distinct vertices of some facets."""
        return np.unique(np.concatenate([self.corners[self.first[f] : self.first[f + 1]] for f in facets]))


@dataclass(frozen=True)
class Found:
    """A surface, the facets on it, and on which side of it the material is."""

    surface: Quadric
    facets: np.ndarray
    sign: float


def facets_of(points, triangles, sharp_angle) -> Facets:
    """The facets of a closed mesh with a size of about one."""
    opposite = opposite_of(triangles)
    corners = points[triangles]
    vectors = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(vectors, axis=1)
    edges = np.roll(corners, -1, axis=1) - corners
    longest = np.linalg.norm(edges, axis=2).max(axis=1)
    needle = doubled < 4.0 * _FLAT * longest
    normals = vectors / np.maximum(doubled, 1e-300)[:, None]
    half = np.arange(len(opposite))
    f, g = half // 3, opposite // 3
    apex = points[triangles.ravel()[3 * g + (opposite % 3 + 2) % 3]]
    height = np.abs(np.einsum("ij,ij->i", apex - corners[f, half % 3], normals[f]))
    flat = (height < _FLAT) & (height[opposite] < _FLAT) & ~needle[f] & ~needle[g]
    flat &= np.einsum("ij,ij->i", normals[f], normals[g]) > 0.5
    of = _components(len(triangles), f[flat], g[flat])
    curved = _off_plane(corners, vectors, of) > 2.0 * _FLAT
    flat &= ~curved[of[f]]
    # needles belong to the facet across their longest edge
    across = opposite[3 * np.arange(len(triangles)) + np.linalg.norm(edges, axis=2).argmax(axis=1)] // 3
    n = np.flatnonzero(needle)
    of = _components(len(triangles), np.append(f[flat], n), np.append(g[flat], across[n]))
    vectors = np.stack([np.bincount(of, np.where(needle, 0.0, vectors[:, k])) for k in range(3)], axis=1)
    areas = np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)
    normals = vectors / areas[:, None]
    pairs = np.unique(np.column_stack([np.repeat(of, 3), triangles.ravel()]), axis=0)
    first = np.searchsorted(pairs[:, 0], np.arange(len(areas) + 1))
    order = np.lexsort((doubled, of))
    largest = order[np.searchsorted(of[order], np.arange(len(areas)), side="right") - 1]
    kept = of[f] != of[g]
    sides = np.column_stack([of[f], of[g]])[kept]
    ends = np.column_stack([triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()])[kept]
    turn = np.einsum("ij,ij->i", normals[sides[:, 0]], normals[sides[:, 1]])
    lengths = np.linalg.norm(edges, axis=2).ravel()[kept]
    return Facets(
        points, of, pairs[:, 1], first, normals, areas / 2, corners.mean(axis=1),
        _circumcentres(corners[largest]), sides, ends, lengths, turn > np.cos(np.radians(sharp_angle)),
    )  # fmt: skip


def _components(count, f, g):
    return connected_components(csr_matrix((np.ones(len(f), bool), (f, g)), (count, count)), False)[1]


def _off_plane(corners, vectors, of):
    """Largest distance of the corners of connected triangles from the plane of their mean normal."""
    normals = np.stack([np.bincount(of, vectors[:, k]) for k in range(3)], axis=1)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    heights = np.einsum("fkj,fj->fk", corners, normals[of])
    low, high = np.full(len(normals), np.inf), np.full(len(normals), -np.inf)
    np.minimum.at(low, of, heights.min(axis=1))
    np.maximum.at(high, of, heights.max(axis=1))
    return high - low


def _circumcentres(corners):
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(a, b)
    up = np.cross(normal, a) * (b**2).sum(axis=1)[:, None] + np.cross(b, normal) * (a**2).sum(axis=1)[:, None]
    return corners[:, 0] + up / np.maximum(2.0 * (normal**2).sum(axis=1), 1e-300)[:, None]


def regions_of(facets: Facets) -> tuple[np.ndarray, list[Found]]:
    """Number of the region of every facet, -1 for free form, and the surfaces of the regions."""
    smooth = facets.sides[facets.smooth]
    links = csr_matrix(
        (facets.lengths[facets.smooth], (smooth[:, 0], smooth[:, 1])), (facets.count, facets.count)
    )
    label, found = np.full(facets.count, -1), []
    for k in range(_SEARCHES):
        new = _search(facets, links, label < 0, k)
        for one in new:
            label[one.facets] = len(found)
            found.append(one)
        _absorb(facets, found, label)
        found, label = _consistent(facets, found, label)
        _absorb(facets, found, label)
        if not new:
            break
    for f in _planes(facets, links, label):
        vertices = facets.vertices([f])
        plane = fit("plane", facets.points[vertices], None, facets.normals[[f]], facets.areas[[f]])
        label[f] = len(found)
        found.append(Found(plane, np.array([f]), 1.0))
    for _ in range(_ROUNDS):
        if not _settle(facets, found, label):
            break
    return label, found


def _search(facets, links, free, number):
    """Round surfaces through free facets, none of which overlap."""
    found, vain = [], 0
    lonely = np.diff(links.indptr) == 0
    for seed in np.random.default_rng(number).permutation(facets.count):
        if not free[seed] or lonely[seed] or vain > _IN_VAIN:
            continue
        best = _surface_at(facets, links, free, seed)
        vain = max(0.0, vain + 1.0 - 0.5 * len(best.facets)) if best else vain + 1.0
        if best:
            free[best.facets] = False
            found.append(best)
    return found


def _surface_at(facets, links, free, seed):
    """The round surface through a facet that takes most others, of some sets of its neighbours."""
    best = None
    for group in _groups(links, free, facets.areas, seed):
        vertices = facets.vertices(group)
        points, seen = facets.points[vertices], None
        for kind in ROUND:
            given = facets.rounds[group], facets.normals[group], facets.areas[group]
            surface = fit(kind, points, *given)
            if surface is not None and np.abs(surface.distances(points)).max() < _ON:
                grown = _grown(facets, links, free, surface, seed)
                if grown and (seen is None or _better(facets, grown, seen)):
                    seen = grown
        if seen and len(seen.facets) > 1 and (best is None or len(seen.facets) > len(best.facets)):
            best = seen
            if len(best.facets) > 2 * len(group):
                break
    return best


def _better(facets, one, other):
    """Whether a surface takes more facets, or as many that lie nearer to it."""
    if len(one.facets) != len(other.facets):
        return len(one.facets) > len(other.facets)
    centres = facets.centres[np.isin(facets.of, one.facets)]
    off = [np.abs(found.surface.distances(centres)).mean() for found in (one, other)]
    return off[0] < off[1]


def _groups(links, free, areas, seed):
    """Sets of facets with a seed: two rings, one ring, and neighbours over the longest edges."""
    near = links[seed].indices
    near = near[free[near] & (areas[near] < 50.0 * areas[seed])]
    second = np.unique(links[near].indices) if len(near) else near
    second = second[free[second] & (areas[second] < 50.0 * areas[seed])]
    wide = near[np.argsort(-links[seed, near].toarray().ravel())]
    rings = [np.unique(np.append(second, seed)), np.append(near, seed)]
    few = [np.array([seed, *wide[:2]]), *(np.array([seed, w]) for w in wide[:2])]
    return [group for group in (*rings, *few) if len(group) > 1]


def _grown(facets, links, free, surface, seed):
    """A surface fitted again and again to all connected facets on it; None if it loses its seed."""
    taken = None
    for _ in range(_ROUNDS):
        at = facets.corners[facets.first[seed] : facets.first[seed + 1]]
        normals = surface.distances_and_normals(facets.points[at])[1]
        sign = 1.0 if (normals @ facets.normals[seed]).sum() > 0.0 else -1.0
        on = _on(facets, surface, free, sign)
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
    if len(facets.vertices(taken)) <= UNKNOWNS[surface.kind]:
        return None
    return Found(surface, taken, sign)


def _on(facets, surface, free, sign, turn=_TURN):
    """Which facets lie on a surface whose normals, times a sign, point out of the material.

    Their vertices do, and their normals are near to those there; and the centres of their triangles are only
    as far from the surface as chords may be that make such angles with it, unlike a plane that touches it.
    """
    gaps, normals = surface.distances_and_normals(facets.points)
    on = np.logical_and.reduceat(np.abs(gaps)[facets.corners] < _ON, facets.first[:-1]) & free
    cosine = sign * np.einsum("ij,ij->i", normals[facets.corners], facets.normals[facets.owners])
    apex = np.linalg.norm(normals[facets.corners], axis=1) < 0.999
    least = np.minimum.reduceat(np.where(apex, 1.0, cosine), facets.first[:-1])
    on &= least > turn
    inside = np.flatnonzero(on[facets.of])
    of, gaps = facets.of[inside], np.abs(surface.distances(facets.centres[inside]))
    bound = facets.reach[of] * np.sqrt(np.maximum(1.0 - least[of] ** 2, 0.0)) + _ON
    on[of[gaps > bound]] = False
    return on


def _absorb(facets, found, label):
    """Bad triangles beside a region and smaller regions join it if they lie on its surface."""
    a, b = facets.sides.T
    few = np.bincount(facets.of, minlength=facets.count) <= 2  # triangles
    for k in sorted(range(len(found)), key=lambda k: -len(found[k].facets)):
        beside = (label[a] == k) & (label[b] != k)
        if not beside.any():
            continue
        on = _on(facets, found[k].surface, np.ones(facets.count, bool), found[k].sign, _AT_ALL)
        for j in np.unique(label[b[beside]]):
            if j >= 0 and on[label == j].all() and (label == j).sum() < (label == k).sum():
                label[label == j] = k
        while (new := np.unique(b[(label[a] == k) & on[b] & few[b] & (label[b] < 0)])).size:
            label[new] = k


def _consistent(facets, found, label):
    """Regions that are certain, or bounded only by sharp edges and by surfaces that touch them.

    The others are given up, smallest first, until none is left.
    """
    a, b = facets.sides[facets.smooth].T
    ends, lengths = facets.points[facets.ends[facets.smooth, 0]], facets.lengths[facets.smooth]
    alive = np.bincount(label[label >= 0], minlength=len(found)) > 0
    while True:
        rim = (label[a] >= 0) & (label[a] != label[b])
        here, there = (_normals(facets, found, label, side[rim], ends[rim]) for side in (a, b))
        apart = np.linalg.norm(np.cross(here, there), axis=1) > np.sin(_TOUCH)
        apart &= np.minimum(np.linalg.norm(here, axis=1), np.linalg.norm(there, axis=1)) > 0.999  # no apex
        total = np.bincount(label[a[rim]], lengths[rim], len(found))
        loose = np.bincount(label[a[rim]], lengths[rim] * apart, len(found))
        doubtful = [
            k for k in np.flatnonzero(alive & (loose > 1e-9 + 1e-6 * total))
            if loose[k] > _OPEN * total[k] or not _certain(facets, found[k].surface, label == k)
        ]  # fmt: skip
        if not doubtful:
            break
        worst = min(doubtful, key=lambda k: (label == k).sum())
        alive[worst] = False
        label[label == worst] = -1
    number = np.append(np.cumsum(alive) - 1, -1)
    kept = [replace(found[k], facets=np.flatnonzero(label == k)) for k in np.flatnonzero(alive)]
    return kept, number[label]


def _settle(facets, found, label):
    """Give facets on a border to the neighbour on whose surface they lie far better, and fit again.

    Returns whether there were any.
    """
    a, b = facets.sides[facets.smooth].T
    moved = {}
    for k in range(len(found)):
        for j in np.unique(label[b[(label[a] == k) & (label[b] != k) & (label[b] >= 0)]]):
            border = np.unique(a[(label[a] == k) & (label[b] == j)])
            gaps = np.array([[np.abs(found[r].surface.distances(facets.points[facets.vertices([f])])).max()
                              for r in (k, j)] for f in border])  # fmt: skip
            better = border[gaps[:, 1] < _BETTER * gaps[:, 0]]
            free = np.zeros(facets.count, bool)
            free[better] = True
            moved |= dict.fromkeys(np.flatnonzero(_on(facets, found[j].surface, free, found[j].sign)), j)
    touched = {label[f] for f in moved} | set(moved.values())
    for f, j in moved.items():
        label[f] = j
    for k in touched:
        mine = np.flatnonzero(label == k)
        points = facets.points[facets.vertices(mine)] if len(mine) else []
        better = (
            improved(found[k].surface, points) if len(points) >= UNKNOWNS[found[k].surface.kind] else None
        )
        found[k] = replace(found[k], surface=better or found[k].surface, facets=mine)
    return bool(moved)


def _normals(facets, found, label, at, places):
    """Outward normals of regions at places, and of facets that belong to none."""
    out = facets.normals[at].copy()
    for k in np.unique(label[at][label[at] >= 0]):
        mine = label[at] == k
        out[mine] = found[k].sign * found[k].surface.distances_and_normals(places[mine])[1]
    return out


def _certain(facets, surface, mine):
    """Whether so many facets lie on a surface that it cannot be by chance."""
    return len(facets.vertices(np.flatnonzero(mine))) >= 4 * UNKNOWNS[surface.kind]


def _planes(facets, links, label):
    """Facets that are left and are planes: those in small groups, and those larger than their neighbours."""
    left = np.flatnonzero(label < 0)
    if not len(left):
        return left
    group = connected_components(links[left][:, left], False)[1]
    count, area = np.bincount(group)[group], np.bincount(group, facets.areas[left])[group]
    return left[(count < _FREE_FORM) | (facets.areas[left] * count > _WIDE * area)]
