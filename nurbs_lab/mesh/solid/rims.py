"""Where the regions of a mesh meet: chains of its edges, and points moved onto the surfaces."""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.mesh.core import opposite_of, tails_and_heads

_TOUCH = np.cos(np.radians(3.0))  # between the normals of two surfaces that touch


@dataclass(frozen=True)
class Chain:
    """Vertices along the border of two regions, that on its left first; a closed one ends where it begins."""

    regions: tuple[int, int]
    vertices: np.ndarray

    @property
    def ends(self):
        """The first and the last vertex."""
        return int(self.vertices[0]), int(self.vertices[-1])


def chains_of(triangles, label) -> list[Chain]:
    """All chains between corners, where at least three regions meet, of regions ``label (m,)``."""
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
        chains.append(Chain((int(left[first]), int(right[first])), np.append(tails[path], heads[path[-1]])))
    return chains


def onto(surfaces, points, steps=20):
    """Points moved to where they lie on all surfaces, by Gauss-Newton; where two touch, normals agree too."""
    touching = []
    for i, one in enumerate(surfaces):
        for other in surfaces[:i]:
            a, b = (s.distances_and_normals(points)[1] for s in (one, other))
            cosine = np.einsum("ij,ij->i", a, b)
            if np.abs(cosine).mean() > _TOUCH:
                touching.append(
                    (one, other, np.sign(cosine.mean()), min(one.radius or 1.0, other.radius or 1.0))
                )

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
