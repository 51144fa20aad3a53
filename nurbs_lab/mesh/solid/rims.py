"""Where the regions of a mesh meet: chains of its edges, and points moved onto the surfaces."""

import numpy as np

from nurbs_lab.mesh.core import opposite_of, tails_and_heads


def chains_of(triangles, label) -> list[tuple[tuple[int, int], np.ndarray]]:
    """All chains between corners, where at least three regions meet, of regions ``label (m,)``.

    Each has its two regions, that on its left first, and its vertices; a closed one ends where it begins.
    """
    (tails, heads), left = tails_and_heads(triangles), np.repeat(label, 3)
    right = left[opposite_of(triangles)]
    border = np.flatnonzero(left < right)
    corner = np.bincount(np.append(tails[border], heads[border]), minlength=tails.max() + 1) > 2
    leaving, seen, chains = dict(zip(tails[border].tolist(), border.tolist(), strict=True)), set(), []
    for first in (*border[corner[tails[border]]].tolist(), *border.tolist()):
        if first in seen:
            continue
        path = [first]
        while not corner[heads[path[-1]]] and (h := leaving[int(heads[path[-1]])]) != first:
            path.append(h)
        seen.update(path)
        chains.append(((int(left[first]), int(right[first])), np.append(tails[path], heads[path[-1]])))
    return chains


def onto(surfaces, points):
    """Points moved to where they lie on all surfaces, by Gauss-Newton."""
    for _ in range(20):
        gaps, normals = zip(*(s.distances_and_normals(points) for s in surfaces), strict=True)
        slopes = np.linalg.pinv(np.stack(normals, axis=1), rcond=1e-3)
        move = -np.einsum("nij,jn->ni", slopes, np.stack(gaps))
        points = points + move
        if np.abs(move).max() < 1e-14:
            break
    return points
