"""Equal tangent planes of patches that meet in a smooth edge, as conditions of a least-squares fit.

The sine of the angle between the planes is linearised in the derivatives of both patches and of the edge,
which is a Gauss-Newton step.
"""

from functools import partial

import numpy as np
from scipy.sparse import vstack

from nurbs_lab.mesh.solid import _kernels_patches as kernels
from nurbs_lab.mesh.solid.grids import bilinear
from nurbs_lab.mesh.solid.patches import BESIDE_TIP, equations_at, in_parts, product, rows_of, side_places
from nurbs_lab.mesh.solid.surfels import components, unit

_INWARD = np.array([[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]])
_AHEAD = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
_POOR = 0.97  # cosine of an angle across a seam that shows a fold
_FASTER = 10.0  # factor of the weight of the derivatives where a seam shows a fold
_FIRMEST = 1e6
_SMALL = np.radians(0.3)  # angle across a seam, above which its sines get more weight
_MOST_MORE, _MOST_WEIGHT = 10.0, 300.0  # factor of it in one round, and of all rounds together


def samples_of(spans):
    """Number of samples along a seam: enough for the sine of two cubics, of degree eight in every span."""
    return 5 * spans + 2


class Seams:
    """Samples of the smooth seams, where three derivatives are to lie in one plane.

    They are those across the seam into its left and its right face, and the one along it; at the ends these
    are three neighbouring edges around a vertex. All are divided by their first sizes. Where a seam folds,
    which has no angle either, the derivatives are held near those of the even grid. These are turned into one
    plane first, also where the mesh itself turns: what holds a seam must not turn its planes apart. Neither
    sines nor derivatives count at a sharp point, where they would hold the patches flat.
    """

    def __init__(self, layout, nodes, squares):
        smooth = np.flatnonzero(~layout.sharp)
        t = np.linspace(0.0, 1.0, samples_of(squares.spans))
        n = nodes.shape[1] - 1
        slopes = np.gradient(nodes, 1.0 / n, axis=(1, 2))
        tips = layout.tips[smooth]
        weight = np.where(tips[:, :1], t, 1.0) * np.where(tips[:, 1:], 1.0 - t, 1.0)
        self.weight = weight.ravel()
        self.squares, self.equations, self.rows, self.wanted = squares, [], [], []
        for which, places, directions in ((0, t, (_INWARD, _AHEAD)), (1, 1.0 - t, (_INWARD,))):
            side = layout.sides[smooth, which]
            face, uv = np.repeat(side // 4, len(t)), side_places(side % 4, places)
            columns, (_, du, dv) = equations_at(squares.net, squares.spans, face, uv)
            first = [bilinear(slope, face, uv) for slope in slopes]
            for direction in directions:
                u, v = direction[np.repeat(side % 4, len(t))].T[:, :, None]
                wanted = u * first[0] + v * first[1]
                size = np.linalg.norm(wanted, axis=1, keepdims=True)
                size = np.maximum(size, 0.1 * np.median(size))
                values = du * (u / size) + dv * (v / size)
                self.equations.append((face, uv, values))
                self.rows.append(rows_of(columns, values.copy(), squares.count))
                self.rows[-1].eliminate_zeros()  # which moves the values
                self.wanted.append(wanted / size)
        left, along, right = self.wanted
        normals = unit(np.cross(along, left)), unit(np.cross(right, along))
        self.beside_tip = self.weight < BESIDE_TIP
        self.grip = self.weight**2
        planes = _one_at_vertices(layout, smooth, sum(normals))
        self.wanted = [_within_planes(vectors, planes) for vectors in self.wanted]
        self.all = vstack(self.rows).tocsr()
        by_sample = np.arange(self.all.shape[0]).reshape(3, -1).T.ravel()
        self.across = self.all[by_sample].T.tocsr()  # from the three derivatives of each sample back

    def linear(self, control, tangent):
        """Right-hand side of the linear equations at ``control``, and their matrix.

        The matrix is a function that applies it, and values of one that is about equal: without the terms
        that mix two derivatives or two coordinates. The equations are those of the sines, and ``tangent``
        times those of the derivatives within the planes. A sine is linear in each of its three derivatives,
        so its linear part at ``control`` is three times itself.
        """
        left, along, right = (rows @ control for rows in self.rows)
        sizes = [np.linalg.norm(np.cross(along, x), axis=1) for x in (left, right)]
        least = 0.1
        scale = np.linalg.norm(along, axis=1) / np.maximum(sizes[0] * sizes[1], least**2)
        scale = (self.weight * np.minimum(scale, 1.0 / least))[:, None]
        factors = scale * np.stack([np.cross(along, right), np.cross(right, left), np.cross(left, along)])
        sine = np.einsum("ij,ij->i", factors[0], left)
        normal = unit(unit(np.cross(along, left)) - unit(np.cross(along, right)))
        normal[self.grip > 1.0] = 0.0
        hold, wanted = tangent * self.grip, np.stack(self.wanted)
        flat = wanted - np.einsum("kij,ij->ki", wanted, normal)[..., None] * normal
        pull = self.all.T @ (2.0 * sine[:, None] * factors + hold[:, None] * flat).reshape(-1, 3)

        matrix = self.all.indptr, self.all.indices, self.all.data

        def push(x):
            one = partial(kernels.push_planes, *matrix, factors, normal, hold, x)
            slopes = in_parts(one, np.empty((len(normal), 3, 3)))
            return product(self.across, slopes.reshape(-1, 3))

        weights = np.einsum("kij,kij->ki", factors, factors) + hold
        about = sum(self.squares.sums(*one, w) for one, w in zip(self.equations, weights, strict=True))
        return pull, push, about

    def tighten(self, control, sines):
        """Hold the derivatives more firmly where the planes are far from equal.

        With ``sines``, the sines of large angles get more weight, too. Returns whether planes are far from
        equal anywhere, and the largest angle between them in degrees.
        """
        left, along, right = (rows @ control for rows in self.rows)
        cosine = np.einsum("ij,ij->i", unit(np.cross(along, left)), unit(np.cross(right, along)))
        poor = (cosine < _POOR) & ~self.beside_tip
        angles = np.arccos(np.clip(cosine, -1.0, 1.0))
        if sines:
            more = np.where(poor, 1.0, np.clip(angles / _SMALL, 1.0, _MOST_MORE))
            self.weight = np.minimum(self.weight * more, _MOST_WEIGHT)
        self.grip[poor] = np.minimum(_FASTER * self.grip[poor], _FIRMEST)
        return poor.any(), np.degrees(angles[~self.beside_tip].max(initial=0.0))


def _one_at_vertices(layout, smooth, normals):
    """Normals along smooth edges, with one direction at every vertex for all edges between sharp ones."""
    normals = normals.reshape(len(smooth), -1, 3)
    (left, right), count = layout.sides[smooth].T, layout.corners.size
    corners = np.stack([left, _after(left)], axis=1)
    across = np.stack([_after(right), right], axis=1)
    sector = components(count, corners.ravel(), across.ravel())[1][corners]
    total = np.zeros((count, 3))
    np.add.at(total, sector, normals[:, [0, -1]])
    normals[:, [0, -1]] = total[sector]
    return unit(normals.reshape(-1, 3))


def _after(side):
    """The next side of the same face, or the corner where a side ends."""
    return side - side % 4 + (side + 1) % 4


def _within_planes(vectors, normals):
    """Vectors turned into the planes with these normals, of the same lengths."""
    flat = vectors - np.einsum("ij,ij->i", vectors, normals)[:, None] * normals
    return unit(flat) * np.linalg.norm(vectors, axis=1, keepdims=True)
