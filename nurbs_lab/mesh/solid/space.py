"""Patches that meet with one tangent plane, by construction: a linear space of control points.

Every face of a layout is a Bezier patch of degree 5. Let f and g be the patches on both sides of a smooth
edge, t the parameter along it in f, and D the derivative into a patch. They meet with one tangent plane if
``D f(t) + D g(1 - t) = a(t) f'(t)`` with any function a. Here it is ``2 (1 - t)^2 cos p - 2 t^2 cos q``,
where p and q are the angles between edges at both ends in the parameter plane: the full angle, or that
between two sharp edges, over the number of its faces. So a depends on the layout alone, and the condition is
linear in the control points. With a linear function a, tangents would have to vanish at vertices of four
faces (Peters 1994; Bercovier and Matskewich 2017). Sharp edges have no condition.

The space is solved in four steps, each of which gives control points from those before and from new free
ones: the tangents at vertices, the curves of edges, the twists at vertices, and the rest beside edges.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr
from scipy.sparse import coo_matrix, csr_matrix, identity, vstack
from scipy.sparse.linalg import splu

from nurbs_lab.mesh.core import components
from nurbs_lab.mesh.solid.net import DEGREE, number_nodes, turned

_STRAIGHT = 20.0  # degrees from 180, within which two sharp edges at a corner run straight on
_LEAST_ANGLE = 20.0  # degrees of a sector between sharp edges


@dataclass(frozen=True, eq=False)
class Space:
    """Control points of smooth patches on a layout.

    Attributes
    ----------
    net : (faces, 6, 6) array
        Number of every control point; equal numbers are one point.
    basis : sparse (points, dimension) array
        Control points from free parameters, for each coordinate alike.
    """

    net: np.ndarray
    basis: csr_matrix


def smooth_space(layout, angles) -> Space:
    """The space of a layout; ``angles (faces, 4)`` are those of the faces at their corners, in degrees.

    They count at corners of sharp edges only.
    """
    return _Steps(layout, angles).space()


def sectors(layout, angles):
    """The corners of faces in order around vertices, from sharp edge to sharp edge or all around.

    Returns for every corner the number of its sector and its position there, counter-clockwise, and for
    every sector its corners in order ``(sectors, most)``, how many there are, whether it goes all around,
    the angle between its edges in radians, and whether its first and last edge run straight on.
    """
    corners, edges = layout.corners.ravel(), layout.edges.ravel()
    count = len(corners)
    smooth = ~layout.sharp & (layout.sides[:, 1] >= 0)
    opposite = layout.sides[edges].sum(axis=1) - np.arange(count)
    last = np.arange(count) - np.arange(count) % 4 + (np.arange(count) + 3) % 4  # the side that ends here
    onward = np.where(smooth[edges[last]], opposite[last], -1)
    linked = np.flatnonzero(onward >= 0)
    _, sector = components(count, linked, onward[linked])
    size = np.bincount(sector)
    first = np.full(len(size), count)
    np.minimum.at(first, sector, np.arange(count))
    starts = np.flatnonzero(~smooth[edges])
    closed = np.ones(len(size), dtype=bool)
    closed[sector[starts]] = False
    first[sector[starts]] = starts
    order, here = np.full((len(size), size.max()), -1), first.copy()
    position = np.empty(count, dtype=np.int64)
    for k in range(size.max()):
        some = np.flatnonzero(size > k)
        order[some, k], position[here[some]] = here[some], k
        here[some] = onward[here[some]]
    vertex, ends = corners[first], _ends(layout)
    sharp = np.bincount(ends[~smooth].ravel(), minlength=len(layout.points))[vertex]
    angle = np.clip(np.bincount(sector, angles.ravel()), _LEAST_ANGLE, 360.0 - _LEAST_ANGLE)
    off = np.abs(angle - 180.0)
    nearest, farthest = np.full(len(layout.points), np.inf), np.zeros(len(layout.points))
    np.minimum.at(nearest, vertex, off)
    np.maximum.at(farthest, vertex, off)
    through = (sharp == 2) & (~layout.fixed[vertex] | (farthest[vertex] < _STRAIGHT))
    lone = np.zeros(len(layout.points), dtype=bool)
    lone[vertex[size == 1]] = True
    through &= ~lone[vertex]
    straight = through | ((sharp > 2) & (off < _STRAIGHT) & (off == nearest[vertex]))
    beside = np.where(angle < 180.0, 180.0 - _STRAIGHT, 180.0 + _STRAIGHT)
    angle = np.where(straight, 180.0, np.where(off < _STRAIGHT, beside, angle))
    angle = np.where(sharp < 2, 360.0, angle)
    return sector, position, order, size, closed, np.radians(angle) / size, straight


def _ends(layout):
    """The two vertices of every edge, ``(edges, 2)``."""
    side = layout.sides[:, 0]
    return np.stack([layout.corners.ravel()[side], np.roll(layout.corners, -1, axis=1).ravel()[side]], axis=1)


class _Steps:
    """Builds the basis: rows of control points are filled step by step."""

    def __init__(self, layout, angles):
        self.layout = layout
        self.net, self.count = number_nodes(layout, DEGREE + 1)
        self.sector, self.position, self.order, self.size, self.closed, self.phi, self.straight = sectors(
            layout, angles
        )
        sides = np.stack(turned(self.net), axis=1).reshape(-1, DEGREE + 1, DEGREE + 1)
        self.sides, self.first = sides, sides[layout.sides[:, 0]]
        self.smooth = ~layout.sharp & (layout.sides[:, 1] >= 0)
        self.dofs = 0
        self.basis = csr_matrix((self.count, 0))
        a = layout.sides[:, 0]
        after = a - a % 4 + (a + 1) % 4
        cosine = np.cos(np.stack([self.phi[self.sector[a]], self.phi[self.sector[after]]], axis=1))
        self.cosine = np.where(np.abs(cosine) < 1e-12, 0.0, cosine) * self.smooth[:, None]

    def space(self):
        self._tangents()
        self._curves()
        self._even_vertices()
        self._twists()
        self._beside_edges()
        inside = self.net[:, 2:-2, 2:-2].ravel()
        self._add(inside, self._new(len(inside)), np.ones(len(inside)))
        self.basis.sum_duplicates()
        return Space(self.net, self.basis)

    def _new(self, count):
        """Numbers of new free parameters."""
        self.dofs += count
        return np.arange(self.dofs - count, self.dofs)

    def _add(self, points, dofs, weights, known=None):
        """Let points be sums of free parameters, and of ``known`` points as ``(points, known, weights)``."""
        shape = (self.count, self.dofs)
        self.basis = csr_matrix((self.basis.data, self.basis.indices, self.basis.indptr), shape=shape)
        here = csr_matrix((weights, (points, dofs)), shape=shape)
        if known is not None:
            rows, columns, values = (
                np.concatenate([np.ravel(x) for x in part]) for part in zip(*known, strict=True)
            )
            here = here + csr_matrix((values, (rows, columns)), shape=(self.count, self.count)) @ self.basis
        self.basis = self.basis + here

    def _tangents(self):
        """Vertices, and the control points next to them on edges.

        The tangents of a sector are ``A cos j p + B sin j p``. A is that of its first edge. B is free where
        the sector goes all around, or straight on so that it ends in -A, and else follows from the last edge.
        """
        layout, corners = self.layout, self.layout.corners.ravel()
        vertices = np.unique(corners)
        at = np.empty(len(layout.points), dtype=np.int64)
        at[vertices] = self._new(len(vertices))
        start = self.order[:, 0]
        stop = self.order[np.arange(len(self.size)), self.size - 1]
        last = stop - stop % 4 + (stop + 3) % 4
        sides, edges = self.sides, layout.edges.ravel()
        forward = layout.forward.ravel()
        a = 2 * edges[start] + ~forward[start]  # ends of edges where sectors begin and end
        b = 2 * edges[last] + forward[last]
        lone = (a == b) | self.closed  # smooth vertices, and those where one sharp edge ends
        owner, sign = np.arange(2 * len(layout.sides)), np.ones(2 * len(layout.sides))
        pair = np.flatnonzero(self.straight & ~lone)
        low, high = np.minimum(a, b)[pair], np.maximum(a, b)[pair]
        owner[high], sign[high] = low, -1.0
        own = np.zeros(len(owner), dtype=bool)
        own[np.concatenate([a, b])] = True
        used = own & (owner == np.arange(len(owner)))
        tangent = np.empty(len(owner), dtype=np.int64)
        tangent[used] = self._new(used.sum())
        tangent = tangent[owner]
        turning = (lone | self.straight) & (self.size > 1)
        second = np.full(len(self.size), -1)
        second[turning] = self._new(turning.sum())
        points, dofs, weights = [vertices], [at[vertices]], [np.ones(len(vertices))]
        ends = np.flatnonzero(own)
        edge, head = np.divmod(ends, 2)
        points += [self.first[edge, np.where(head, -2, 1), 0]] * 2
        dofs += [at[self.first[edge, np.where(head, -1, 0), 0]], tangent[ends]]
        weights += [np.ones(len(ends)), sign[ends]]
        for j in range(1, self.order.shape[1]):
            s = np.flatnonzero(self.size > j)
            side = self.order[s, j]
            angle, full = j * self.phi[s], self.size[s] * self.phi[s]
            turns = turning[s]
            sine = np.where(turns, 1.0, np.sin(full))
            of_a = np.where(turns, np.cos(angle), np.sin(full - angle) / sine)
            points += [sides[side, 1, 0]] * 3
            dofs += [at[corners[side]], tangent[a[s]], np.where(turns, second[s], tangent[b[s]])]
            weights += [
                np.ones(len(s)),
                of_a * sign[a[s]],
                np.sin(angle) / sine * np.where(turns, 1.0, sign[b[s]]),
            ]
        self._add(*(np.concatenate(part) for part in (points, dofs, weights)))

    def _curves(self):
        """The two middle control points of edges; where a is quadratic, the curve is of degree 4."""
        curve, (c, d) = self.first[:, :, 0], self.cosine.T
        low = c == d
        at_tail, at_head = ~low & (d == 0.0), ~low & (c == 0.0)
        both = ~(low | at_tail | at_head)
        free = [curve[low, 2], curve[low, 3], curve[at_tail, 2], curve[at_head, 3]]
        points = np.concatenate(free)
        middle = self._new(both.sum())
        self.middles = np.arange(self.dofs - both.sum(), self.dofs + len(points))
        points = np.concatenate([points, curve[both, 2], curve[both, 3]])
        dofs = np.concatenate([self._new(sum(map(len, free))), middle, middle])
        known = []
        for chosen, point, part in ((both, 2, -0.5), (both, 3, 0.5), (at_head, 2, -1.0), (at_tail, 3, 1.0)):
            some = curve[chosen]
            for k, weight in ((0, 0.1), (1, -0.5), (4, 0.5), (5, -0.1)):
                known.append((some[:, point], some[:, k], np.full(len(some), part * weight)))
        # where one of the two is free, the other one follows from it
        self._add(points, dofs, np.ones(len(dofs)), known)
        follows = [(curve[at_head, 2], curve[at_head, 3]), (curve[at_tail, 3], curve[at_tail, 2])]
        self._add(
            np.empty(0, int), np.empty(0, int), np.empty(0),
            [(p, q, np.ones(len(p))) for p, q in follows],
        )  # fmt: skip

    def _even_vertices(self):
        """At smooth vertices of 6, 8, ... faces second points of the edges have an alternating sum of 0."""
        even = np.flatnonzero(self.closed & (self.size % 2 == 0) & (self.size > 4))
        if not len(even):
            return
        rows, k = np.nonzero(self.order[even] >= 0)
        columns = self.sides[self.order[even][rows, k], 2, 0]
        shape = (len(even), self.count)
        sums = (csr_matrix(((-1.0) ** k, (rows, columns)), shape=shape) @ self.basis).tocsr()
        sums.data[np.abs(sums.data) < 1e-12] = 0.0
        sums.eliminate_zeros()
        pivots = _pivots(sums, self.middles)
        chosen = pivots >= 0
        sums, pivots = sums[chosen], pivots[chosen]
        rest = np.setdiff1d(np.arange(self.dofs), pivots)
        solved = splu(sums[:, pivots].tocsc())
        known = sums[:, rest].tocsc()
        touched = np.flatnonzero(np.diff(known.indptr))
        values = -solved.solve(known[:, touched].toarray())
        values[np.abs(values) < 1e-14] = 0.0
        local = coo_matrix(values)
        step = csr_matrix((local.data, (local.row, touched[local.col])), shape=(len(pivots), len(rest)))
        order = np.argsort(np.concatenate([rest, pivots]))
        change = vstack([identity(len(rest), format="csr"), step]).tocsr()[order]
        self.basis, self.dofs = (self.basis @ change).tocsr(), len(rest)

    def _twists(self):
        """The control points inside faces next to vertices, from sums of neighbours across smooth edges."""
        none = np.empty(0, dtype=np.int64)
        points, dofs, weights, known = [none], [none], [np.empty(0)], []
        for closed, k in sorted(set(zip(self.closed.tolist(), self.size.tolist(), strict=True))):
            s = np.flatnonzero((self.closed == closed) & (self.size == k))
            order = self.order[s, :k]
            twist = self.sides[order, 1, 1]
            if not closed or k % 2 == 0:
                new = self._new(len(s))
                points.append(twist.ravel())
                dofs.append(np.repeat(new, k))
                weights.append(np.tile((-1.0) ** np.arange(k), len(s)))
            edges = np.arange(0 if closed else 1, k)
            if not len(edges):
                continue
            sums = np.zeros((len(edges), k))
            sums[np.arange(len(edges)), edges], sums[np.arange(len(edges)), edges - 1] = 1.0, 1.0
            inverse = np.linalg.pinv(sums)
            c = np.cos(self.phi[s])[:, None]
            c = np.where(np.abs(c) < 1e-12, 0.0, c)
            for j, edge in enumerate(edges):
                line = self.sides[order[:, edge], :, 0]
                for node, weight in ((0, 0.4 * c), (1, 2.0 - 2.0 * c), (2, 1.6 * c)):
                    known.append((twist, np.repeat(line[:, [node]], k, axis=1), weight * inverse[:, j]))
        self._add(*(np.concatenate(part) for part in (points, dofs, weights)), known)

    def _beside_edges(self):
        """The middle control points in the rows next to edges; they differ freely across smooth ones."""
        layout, smooth = self.layout, self.smooth
        f, g = self.first[smooth], self.sides[layout.sides[smooth, 1]][:, ::-1]
        a, (c, d) = f[:, :, 0], self.cosine[smooth].T
        difference = np.eye(DEGREE + 1)[1:] - np.eye(DEGREE + 1)[:-1]
        c, d = c[:, None], d[:, None]
        first = (8.0 * c * difference[1] - 2.0 * c * difference[0]) / 5.0
        fourth = (2.0 * d * difference[4] - 8.0 * d * difference[3]) / 5.0
        second = (4.8 * c * difference[2] - 0.8 * d * difference[0] - 2.0 * first) / 4.0
        third = (0.8 * c * difference[4] - 4.8 * d * difference[2] - 2.0 * fourth) / 4.0
        known, points, dofs, weights = [], [], [], []
        for j, half in ((2, second / 2.0), (3, third / 2.0)):
            half[:, j] += 1.0
            new = self._new(len(a))
            for row, sign in ((f, 1.0), (g, -1.0)):
                known.append((np.repeat(row[:, [j], 1], DEGREE + 1, axis=1), a, half))
                points.append(row[:, j, 1])
                dofs.append(new)
                weights.append(np.full(len(a), sign))
        sides = layout.sides[~smooth].ravel()
        for j in (2, 3):
            points.append(self.sides[sides[sides >= 0], j, 1])
            dofs.append(self._new(len(points[-1])))
            weights.append(np.ones(len(points[-1])))
        self._add(*(np.concatenate(part) for part in (points, dofs, weights)), known)


def _pivots(sums, preferred):
    """A column for every row of equations, such that these make a regular square.

    A row takes one of the ``preferred`` columns that no other row has, if there is one. The columns of other
    rows come from a QR decomposition with pivoting; rows that follow from others get -1.
    """
    alone = np.flatnonzero(sums[:, preferred].getnnz(axis=0) == 1)
    part = sums[:, preferred[alone]].tocsc()
    pivots = np.full(sums.shape[0], -1)
    pivots[part.indices[::-1]] = preferred[alone[::-1]]
    left = np.flatnonzero(pivots < 0)
    if len(left):
        rest = sums[left].toarray()
        triangle, order = qr(rest.T, mode="r", pivoting=True)
        kept = np.sort(order[np.abs(np.diag(triangle)) > 1e-9])
        order = qr(rest[kept], mode="r", pivoting=True)[1]
        pivots[left[kept]] = order[: len(kept)]
    return pivots
