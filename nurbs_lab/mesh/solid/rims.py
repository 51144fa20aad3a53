"""Where the regions of a mesh meet: chains of edges between corners, and the curves that replace them."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from nurbs_lab.mesh.core import opposite_of
from nurbs_lab.mesh.solid.quadrics import Quadric, across, round_through
from nurbs_lab.nurbs import NurbsCurve, interpolate_curve

_TOUCH = np.cos(np.radians(3.0))  # between the normals of two surfaces that touch
_FINE = 1e-7  # of the size: how far a curve may be from its surfaces, where that can be reached
_PLACES = 8, 400  # on a curve: at first, and at most
_SAME = 1e-6  # of the size: points nearer than this are one


@dataclass
class Chain:
    """A polyline between two regions, that on its left first; a closed one ends where it begins."""

    regions: tuple[int, int]
    points: np.ndarray
    first: int
    last: int


@dataclass
class Rims:
    """Chains of a mesh, and for every region its loops of (chain, forward), counter-clockwise from outside.

    The ends of the chains are numbered ``places``.
    """

    chains: list[Chain]
    loops: list[list[list[tuple[int, bool]]]]
    places: dict[int, np.ndarray]
    fixed: set[int]  # ends that are corners, or where seams begin

    def polyline(self, loop):
        """Points of a loop in order, the first one not repeated."""
        parts = [self.chains[k].points[:: 1 if forward else -1][:-1] for k, forward in loop]
        return np.concatenate(parts)

    def start_of(self, loop):
        """The end of a chain with which a loop begins."""
        chain, forward = self.chains[loop[0][0]], loop[0][1]
        return chain.first if forward else chain.last

    def scaled(self, size, centre):
        """The same, larger by a factor and then moved."""
        chains = [replace(c, points=c.points * size + centre) for c in self.chains]
        return Rims(chains, self.loops, {n: p * size + centre for n, p in self.places.items()}, self.fixed)

    def start_at(self, region, k, after, point, surfaces):
        """Let loop k of a region begin near a point after one of its places, where it is on one surface more.

        A chain is cut there if need be.
        """
        loop = self.loops[region][k]
        counts = np.array([len(self.chains[number].points) - 1 for number, _ in loop])
        turn = int(np.searchsorted(np.cumsum(counts), after, side="right"))
        (number, forward), count = loop[turn], int(counts[turn])
        chain, after = self.chains[number], after - int(counts[:turn].sum())
        vertex = chain.first if forward else chain.last
        point = onto(surfaces(chain.regions), point[None])[0]
        if np.linalg.norm(self.places[vertex] - point) < _SAME:
            pass
        elif chain.first == chain.last and chain.first not in self.fixed:
            at = after if forward else count - 1 - after
            points = np.concatenate([[point], chain.points[at + 1 : -1], chain.points[: at + 1], [point]])
            self.chains[number] = Chain(chain.regions, points, chain.first, chain.last)
            self.places[vertex] = point
        else:
            self._cut(number, after if forward else count - 1 - after, point)
            loop = self.loops[region][k]
            turn += 1
        self.loops[region][k] = loop = loop[turn:] + loop[:turn]
        self.fixed.add(self.start_of(loop))

    def _cut(self, number, at, point):
        """Make two chains of one, at a point after place ``at``."""
        chain, vertex, other = self.chains[number], max(self.places) + 1, len(self.chains)
        self.places[vertex] = point
        left, right = (np.concatenate(p) for p in (
            (chain.points[: at + 1], [point]), ([point], chain.points[at + 1 :])))  # fmt: skip
        self.chains[number] = Chain(chain.regions, left, chain.first, vertex)
        self.chains.append(Chain(chain.regions, right, vertex, chain.last))
        for region in chain.regions:
            for loop in self.loops[region]:
                for i in reversed(range(len(loop))):
                    if loop[i][0] == number:
                        forward = loop[i][1]
                        loop[i : i + 1] = [(number, True), (other, True)] if forward else [
                            (other, False), (number, False)]  # fmt: skip


def rims_of(points, triangles, label, surfaces) -> Rims:
    """The borders of regions, ``label (m,)``, of a closed mesh; their corners are moved onto the surfaces."""
    opposite = opposite_of(triangles)
    tails, heads = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    left = np.repeat(label, 3)
    right = left[opposite]
    border = np.flatnonzero(left != right)
    corner = np.bincount(tails[border], minlength=len(points)) > 2
    following = {h: _next(h, opposite, left) for h in border.tolist()}
    chain_of, chains, places = {}, [], {}
    for first in (*border[corner[tails[border]]].tolist(), *border.tolist()):
        if first in chain_of:
            continue
        path = [first]
        while not corner[heads[path[-1]]] and (h := following[path[-1]]) != first:
            path.append(h)
        for h in path:
            chain_of[h], chain_of[int(opposite[h])] = (len(chains), True), (len(chains), False)
        ends = int(tails[first]), int(heads[path[-1]])
        on = [surfaces[left[first]], surfaces[right[first]]]
        line = points[np.append(tails[path], heads[path[-1]])]
        for k, v in zip((0, -1), ends, strict=True):
            if v not in places:
                around = [surfaces[r] for r in np.unique(left[tails == v])] if corner[v] else on
                places[v] = onto(around, points[[v]])[0]
            line[k] = places[v]
        chains.append(Chain((int(left[first]), int(right[first])), line, *ends))
    loops = _loops(border, following, chain_of, corner[tails], left, len(surfaces))
    return Rims(chains, loops, places, set(np.flatnonzero(corner).tolist()))


def _next(h, opposite, left):
    """The half-edge after one along the border of its region."""
    n = h - 2 if h % 3 == 2 else h + 1
    while left[opposite[n]] == left[h]:
        n = opposite[n]
        n = n - 2 if n % 3 == 2 else n + 1
    return int(n)


def _loops(border, following, chain_of, at_corner, left, count):
    loops, seen = [[] for _ in range(count)], set()
    for first in border.tolist():
        if first in seen:
            continue
        path = [first]
        while (h := following[path[-1]]) != first:
            path.append(h)
        seen.update(path)
        starts = [k for k, h in enumerate(path) if at_corner[h]] or [0]
        loops[left[first]].append([chain_of[path[k]] for k in starts])
    return loops


def onto(surfaces, points, steps=20):
    """Points moved to where they lie on all surfaces, by Gauss-Newton; where two touch, normals agree too."""
    touching = []
    for i, one in enumerate(surfaces):
        for other in surfaces[:i]:
            a, b = (s.distances_and_normals(points)[1] for s in (one, other))
            cosine = np.einsum("ij,ij->i", a, b)
            if np.abs(cosine).mean() > _TOUCH:
                touching.append((one, other, np.sign(cosine.mean()), min(one.curving, other.curving)))

    def residuals(at):
        rows = [s.distances(at)[:, None] for s in surfaces]
        for one, other, sign, size in touching:
            a, b = (s.distances_and_normals(at)[1] for s in (one, other))
            rows.append(size * (a - sign * b))
        return np.concatenate(rows, axis=1)

    for _ in range(steps):
        gaps, h = residuals(points), 1e-6
        slopes = [(residuals(points + h * e) - residuals(points - h * e)) / (2 * h) for e in np.eye(3)]
        move = -np.einsum("nij,nj->ni", np.linalg.pinv(np.stack(slopes, axis=2), rcond=1e-3), gaps)
        points = points + move
        if np.abs(move).max() < 1e-14:
            break
    return points


def _off(surfaces, points):
    """Largest distance of points from surfaces."""
    return max(float(np.abs(s.distances(points)).max()) for s in surfaces)


@dataclass(frozen=True)
class Curve:
    """A curve from start to end, the same for a closed one.

    A line has only these, a circle a centre and an axis, about which it turns counter-clockwise by an angle;
    any other curve is a spline. ``off`` says how far it is from its surfaces.
    """

    start: np.ndarray
    end: np.ndarray
    kind: str
    off: float
    centre: np.ndarray | None = None
    axis: np.ndarray | None = None
    angle: float = 0.0
    spline: NurbsCurve | None = None

    def scaled(self, size, centre):
        """The same, larger by a factor and then moved."""
        places = {n: getattr(self, n) for n in ("start", "end", "centre")}
        places = {n: None if p is None else p * size + centre for n, p in places.items()}
        c = self.spline
        spline = c and NurbsCurve(c.degree, c.knots, c.control_points * size + centre)
        return replace(self, off=self.off * size, spline=spline, **places)


def curve_along(surfaces: list[Quadric], points, closed) -> Curve:
    """The curve on two surfaces along a polyline, whose ends lie on it."""
    count = max(1, -(-_PLACES[0] // (len(points) - 1)))
    t = np.arange(count)[:, None] / count
    between = [a * (1 - t) + b * t for a, b in pairwise(points)]
    at = np.concatenate([*between, points[-1:]])
    at[1:-1] = onto(surfaces, at[1:-1])
    start, end = at[0], at[-1]
    if not closed:
        along = (end - start) / np.linalg.norm(end - start)
        sideways = np.linalg.norm(np.cross(at - start, along), axis=1).max()
        if sideways < _FINE:
            return Curve(start, end, "line", max(_off(surfaces, at), sideways))
    circle = _circle(at, closed)
    if circle:
        centre, axis, angle, beside = circle
        return Curve(start, end, "circle", max(_off(surfaces, at), beside), centre, axis, angle)
    return _spline(surfaces, at, closed)


def _circle(at, closed):
    middle = at.mean(axis=0)
    axis = np.linalg.svd(at - middle, full_matrices=False)[2][2]
    frame = np.stack(across(axis), axis=1)
    flat, radius = round_through((at - middle) @ frame)
    centre = middle + frame @ flat
    round_off = np.abs(np.linalg.norm(at - centre, axis=1) - radius).max()
    beside = max(np.abs((at - middle) @ axis).max(), round_off)
    if not beside < _FINE:
        return None
    turns = np.cross(at[:-1] - centre, at[1:] - centre) @ axis
    axis = axis if turns.sum() > 0.0 else -axis
    x = (at[0] - centre) / np.linalg.norm(at[0] - centre)
    angle = 2 * np.pi if closed else np.arctan2((at[-1] - centre) @ np.cross(axis, x), (at[-1] - centre) @ x)
    return centre, axis, float(angle % (2 * np.pi) or 2 * np.pi), float(beside)


def _spline(surfaces, at, closed):
    while True:
        spline = interpolate_curve(at[:-1] if closed else at, 3, closed=closed)
        error = _off(surfaces, spline(np.linspace(*spline.domain, 4 * len(at) + 1)))
        if error < _FINE or len(at) > _PLACES[1]:
            return Curve(at[0], at[-1], "spline", error, spline=spline.clamped())
        finer = np.empty((2 * len(at) - 1, 3))
        finer[::2], finer[1::2] = at, onto(surfaces, (at[1:] + at[:-1]) / 2)
        at = finer
