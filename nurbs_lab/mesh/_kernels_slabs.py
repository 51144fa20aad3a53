"""Connected pieces of a mesh between neighbouring planes, by union-find over (triangle, slab) pairs.

Slab s lies between planes s - 1 and s; a vertex of level s is in slab s, a triangle in all slabs between the
levels of its corners.
"""

import numpy as np
from numba import njit

from nurbs_lab.mesh._kernels_graph import HEAD, TAIL


@njit(cache=True, nogil=True)
def find(parent, i):
    """Root of node i, halving the path on the way."""
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@njit(cache=True, nogil=True)
def slab_pieces(triangles, twins, junk, level):
    """Number the connected pieces of the mesh within every slab.

    Returns the first node of every triangle, its lowest slab, the piece of every node and the slab of every
    piece.
    """
    m = len(triangles)
    first = np.zeros(m + 1, np.int64)
    low = np.zeros(m, np.int32)
    for f in range(m):
        a, b, c = level[triangles[f, 0]], level[triangles[f, 1]], level[triangles[f, 2]]
        low[f] = min(a, b, c)
        first[f + 1] = first[f] + (0 if junk[f] else max(a, b, c) - low[f] + 1)
    parent = np.arange(first[m])
    for half in range(3 * m):
        twin = twins[half]
        if twin > half:
            f, g, e = half // 3, twin // 3, half % 3
            a, b = level[triangles[f, TAIL[e]]], level[triangles[f, HEAD[e]]]
            for s in range(min(a, b), max(a, b) + 1):
                i = find(parent, first[f] + s - low[f])
                j = find(parent, first[g] + s - low[g])
                parent[max(i, j)] = min(i, j)
    piece = np.empty(first[m], np.int32)
    slab = np.empty(first[m], np.int32)
    count = 0
    for f in range(m):
        for i in range(first[f], first[f + 1]):
            root = find(parent, i)
            if root == i:
                piece[i] = count
                slab[count] = low[f] + i - first[f]
                count += 1
            else:
                piece[i] = piece[root]
    return first, low, piece, slab[:count].copy()
