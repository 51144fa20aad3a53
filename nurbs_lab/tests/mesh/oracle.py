"""Slow, plain answers to compare with."""

from collections import defaultdict

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def count_contours(mesh, height, axis=2):
    """Contours of a manifold mesh: components of the crossed triangles, joined over their crossed edges."""
    above = mesh.vertices[:, axis] >= height
    side = above[mesh.faces]
    crossed = np.flatnonzero(side.any(axis=1) & ~side.all(axis=1))
    if not crossed.size:
        return 0
    _, welded = np.unique(mesh.vertices, axis=0, return_inverse=True)
    edges = defaultdict(list)
    for row, face in enumerate(mesh.faces[crossed]):
        for a, b in ((0, 1), (1, 2), (2, 0)):
            if above[face[a]] != above[face[b]]:
                edges[tuple(sorted((int(welded[face[a]]), int(welded[face[b]]))))].append(row)
    pairs = np.array([two for two in edges.values() if len(two) == 2]).reshape(-1, 2).T
    links = coo_array((np.ones(pairs.shape[1]), pairs), shape=(crossed.size, crossed.size))
    return connected_components(links, directed=False)[0]


def inner_heights(mesh, count):
    """Heights in the middles of equal layers."""
    low, high = mesh.bounds[:, 2]
    return low + (high - low) * (np.arange(count) + 0.5) / count


def polygon_area(points):
    """Signed area, vertex by vertex."""
    x, y = np.asarray(points).T
    return 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)


def same_layers(one, other):
    """Whether two results have the same contours, bit for bit, in the same order."""
    return len(one) == len(other) and all(
        a.height == b.height
        and len(a.contours) == len(b.contours)
        and all(
            p.closed == q.closed and p.depth == q.depth and np.array_equal(p.points, q.points)
            for p, q in zip(a.contours, b.contours, strict=True)
        )
        for a, b in zip(one, other, strict=True)
    )
