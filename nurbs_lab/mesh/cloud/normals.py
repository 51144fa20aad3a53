"""Outward normals of a point cloud that has none.

The normal of a point is the direction in which its neighbours spread least. Signs are carried along links
between neighbours (Hoppe et al. 1992), all links of a part together. A part that no link joins to others
points outwards, or inwards if the winding number of the others (Barill et al. 2018) says that it is a void.
"""

import numpy as np
from scipy.sparse import coo_array

from nurbs_lab.common.checks import lengths

NEIGHBOURHOODS = (9, 16, 24)  # points; each point takes the flattest one
_LINKS = 10  # neighbours that a point may be linked to
_MOST_AREA = 4.0  # of a point, in medians


def directions_of(points, neighbours):
    """Normals without a sign ``(n, 3)``, and flatness of the cloud around each point, ``(n,)``.

    Flatness is the smallest eigenvalue of the covariance over the middle one: it is 0 in a plane.
    """
    flattest = np.full(len(points), np.inf)
    directions = np.zeros_like(points)
    steps = points[neighbours] - points[:, None]
    for count in NEIGHBOURHOODS:
        some = steps[:, :count] - steps[:, :count].mean(axis=1, keepdims=True)
        values, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", some, some))
        flatness = np.abs(values[:, 0]) / np.maximum(values[:, 1], np.finfo(float).tiny)
        better = flatness / (1.0 - 2.5 / count) < flattest  # few points are flat by chance
        flattest[better] = flatness[better] / (1.0 - 2.5 / count)
        directions[better] = vectors[better, :, 0]
    return directions, flattest


def outward(points, neighbours, areas) -> np.ndarray:
    """Unit outward normals ``(n, 3)`` of points with known neighbours that each stand for an area."""
    directions = directions_of(points, neighbours)[0]
    links = neighbours[:, 1 : _LINKS + 1]

    def agreement(i, j):
        """Product of direction i with direction j mirrored at the plane halfway between the points.

        On a circular arc the mirror image of an outward normal is the outward normal of the other point, so
        the product is +1 if both directions point to the same side. Points close to each other are mirrored
        less, because chance decides in which direction one sees the other.
        """
        steps = points[j] - points[i]
        a, b = (np.einsum("...d,...d", steps, directions[k]) for k in (i, j))
        squares = np.einsum("...d,...d", steps, steps)
        away = 2.0 * a * b / np.maximum(squares, areas[i])
        return np.einsum("...d,...d", directions[i], directions[j]) - away

    tails = np.repeat(np.arange(len(points)), links.shape[1])
    signs, part = _joined(tails, links.ravel(), agreement(tails, links.ravel()))
    normals = directions * signs[:, None]
    most = _MOST_AREA * np.median(areas)  # a point far from others would outweigh the rest
    return normals * _part_signs(points, normals * np.minimum(areas, most)[:, None], part)[part][:, None]


def _joined(tails, heads, agreement):
    """Sign of every point, and the connected part that it belongs to.

    In every round each part joins the one with which the sum over all links between them is clearest, and is
    turned if this is negative (Boruvka). So many links decide, and not a few through a stray point.
    """
    signs, part = np.ones(tails.max() + 1), np.arange(tails.max() + 1)
    while True:
        count = part.max() + 1
        weights = agreement * signs[tails] * signs[heads]
        sums = coo_array((weights, (part[tails], part[heads])), shape=(count, count)).tocsr()
        sums = (sums + sums.T).tocoo()
        own = sums.row == sums.col
        if own.all():
            return signs, part
        a, b, total = sums.row[~own], sums.col[~own], sums.data[~own]
        order = np.lexsort((np.maximum(a, b), np.minimum(a, b), np.abs(total), a))
        best = order[np.append(np.diff(a[order]) > 0, True)]
        to, turn = np.arange(count), np.ones(count)
        to[a[best]], turn[a[best]] = b[best], np.where(total[best] < 0.0, -1.0, 1.0)
        first = (to[to] == np.arange(count)) & (np.arange(count) < to)  # of two that join each other
        to[first], turn[first] = np.flatnonzero(first), 1.0
        while (to != to[to]).any():
            turn, to = turn * turn[to], to[to]
        signs, part = signs * turn[part], np.unique(to, return_inverse=True)[1][part]


def _part_signs(points, vectors, part):
    """Sign of every part: outwards as seen from its middle, or inwards if it is a void of others."""
    count = np.bincount(part)
    middles = np.column_stack([np.bincount(part, column) / count for column in points.T])
    flux = np.bincount(part, np.einsum("ij,ij->i", points - middles[part], vectors))
    outwards = np.where(flux < 0.0, -1.0, 1.0)
    vectors, signs = vectors * outwards[part][:, None], outwards.copy()
    for k in range(len(count)) if len(count) > 1 else ():
        steps = points[part != k] - points[np.argmax(part == k)]
        angles = np.einsum("ij,ij->i", steps, vectors[part != k]) / lengths(steps) ** 3
        signs[k] *= (-1.0) ** round(np.sum(angles) / (4.0 * np.pi))
    return signs
