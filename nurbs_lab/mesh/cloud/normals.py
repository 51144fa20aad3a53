"""Outward normals of a point cloud that has none.

The normal of a point is the direction in which its neighbours spread least. Its sign is carried from point to
point along a spanning tree of the surest links (Hoppe et al. 1992). Where the tree had to use a doubtful
link, it is cut, and the signs of the patches are chosen so that the winding number of the whole cloud is as
close as possible to one half at the points themselves, as it is on every closed surface.
"""

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree

from nurbs_lab.mesh.cloud import _kernels

_NEIGHBOURHOODS = (9, 16, 24)  # points; each point takes the flattest one
_LINKS = 10  # neighbours that a point may be linked to
_DOUBT = 0.05  # of a link, times the root of the points that hang on it; links above it are cut
_SMALLEST_PATCH = 8  # points
_MOST_PATCHES = 450
_MOST_FLIPS = 400
_LEAST = 0.5  # lowering of the squared error, in units of 4, that is worth a flip
_MOST_PLACES = 2000  # where the winding number is asked
_MOST_SOURCES = 20_000  # points that the winding number is summed over


def directions_of(points, neighbours):
    """Normals without a sign ``(n, 3)``, and flatness and noise of the cloud around each point, ``(n,)``.

    Flatness is the smallest eigenvalue of the covariance over the middle one: it is 0 in a plane. Noise is
    the smallest eigenvalue, a variance.
    """
    flattest = np.full(len(points), np.inf)
    directions, noise = np.zeros_like(points), np.zeros(len(points))
    steps = points[neighbours] - points[:, None]
    for count in _NEIGHBOURHOODS:
        some = steps[:, :count] - steps[:, :count].mean(axis=1, keepdims=True)
        values, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", some, some))
        flatness = np.abs(values[:, 0]) / np.maximum(values[:, 1], np.finfo(float).tiny)
        better = flatness / (1.0 - 2.5 / count) < flattest  # few points are flat by chance
        flattest[better] = flatness[better] / (1.0 - 2.5 / count)
        directions[better] = vectors[better, :, 0]
        noise[better] = np.abs(values[better, 0]) / count
    return directions, flattest, noise


def outward(points, neighbours, areas) -> np.ndarray:
    """Unit outward normals ``(n, 3)`` of points with known neighbours that each stand for an area."""
    n = len(points)
    directions, _, noise = directions_of(points, neighbours)
    links = neighbours[:, 1 : _LINKS + 1]
    order, before, roots = _spanning_tree(
        links, _kernels.link_doubts(points, directions, links, areas, noise)
    )
    signs, doubts, sizes = _kernels.spread_signs(order, before, points, directions, areas, noise)
    sizes = np.minimum(sizes, n - sizes)
    harm = np.where(sizes < _SMALLEST_PATCH, 0.0, doubts * np.sqrt(sizes))
    harm[roots] = np.inf
    starts = np.zeros(n, bool)
    for rank in (harm, np.where(harm > 0.0, doubts, 0.0)):
        starts[np.argsort(-rank, kind="stable")[: _MOST_PATCHES // 2]] = True
    starts &= harm > _DOUBT
    starts[order[0]] = False
    patch, above = _kernels.cut_tree(order, before, starts)
    normals = directions * signs[:, None]
    return (
        normals
        * _patch_signs(points, normals * areas[:, None], patch, above, np.sqrt(np.median(areas)))[patch][
            :, None
        ]
    )


def _spanning_tree(links, doubts):
    """Order of a walk from the root, the point before each point, and the roots of separate parts."""
    n = len(links)
    tails = np.repeat(np.arange(n), links.shape[1])
    graph = coo_array((doubts.ravel() + 1e-4, (tails, links.ravel())), shape=(n, n)).tocsr()
    tree = minimum_spanning_tree(graph.maximum(graph.T))
    _, part = connected_components(tree, directed=False)
    _, roots = np.unique(part, return_index=True)
    bridges = coo_array((np.full(len(roots), 2.0), (np.full(len(roots), roots[0]), roots)), shape=(n, n))
    order, before = breadth_first_order((tree + bridges).tocsr(), roots[0], directed=False)
    return order, before, roots[1:]


def _patch_signs(points, vectors, patch, above, spacing):
    """Signs of the patches: a local search over flips of one patch, or of all that hang on one."""
    count = len(above)
    places = points[np.arange(0, len(points), -(-len(points) // _MOST_PLACES))]
    some = np.arange(0, len(points), -(-len(points) // _MOST_SOURCES))
    winding = _kernels.winding_numbers(
        points[some],
        vectors[some] * (len(points) / len(points[some])),
        patch[some],
        count,
        places,
        spacing,
    )
    hanging = np.eye(count)
    for i in range(count - 1, 0, -1):
        hanging[above[i]] += hanging[i]
    moves = np.vstack([hanging, np.eye(count)])
    gram, pull = winding.T @ winding, winding.sum(axis=0) / 2.0
    signs = np.ones(count) if pull.sum() >= 0.0 else -np.ones(count)
    for _ in range(_MOST_FLIPS):  # each lowers the squared error, |winding @ signs - 1/2|**2
        signed = gram * np.outer(signs, signs)
        gains = moves @ (signed.sum(axis=1) - pull * signs) - np.einsum("ij,ij->i", moves @ signed, moves)
        best = gains.argmax()
        if gains[best] <= _LEAST:
            break
        signs[moves[best] > 0.0] *= -1.0
    return signs
