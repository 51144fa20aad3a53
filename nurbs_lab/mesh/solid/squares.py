"""Sums of squares of linear equations in the control points of one patch each, as sparse matrices.

All of them have the same pattern: the pairs of control points of a face. Only their values are added.
"""

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix

from nurbs_lab.common.threads import over_blocks
from nurbs_lab.mesh.solid import _kernels_patches as kernels
from nurbs_lab.mesh.solid.patches import DEGREE, basis_at, gauss_points


class Squares:
    """The pattern of patches with ``spans`` spans a side, and values of matrices that have it."""

    def __init__(self, net, count, spans):
        self.net, self.count, self.spans = net, count, spans
        numbers = net.reshape(len(net), -1)
        size = numbers.shape[1]
        pairs = np.repeat(numbers, size, axis=1).ravel(), np.tile(numbers, size).ravel()
        self.pattern = coo_matrix((np.ones(len(pairs[0])), pairs), shape=(count, count)).tocsc()
        self.slots = np.empty((len(net), size, size), dtype=np.int32)
        kernels.find_slots(numbers, self.pattern.indptr, self.pattern.indices, self.slots)
        self.diagonal = np.empty(count, dtype=np.int32)
        self.diagonal[numbers] = self.slots[:, np.arange(size), np.arange(size)]

    def matrix(self, values):
        """The symmetric matrix with these values."""
        return csc_matrix((values, self.pattern.indices, self.pattern.indptr), shape=self.pattern.shape)

    def values(self, face, uv):
        """Weights of the 16 control points at places."""
        out = np.empty((len(face), 16))
        over_blocks(lambda part: kernels.values(self.spans, uv[part], out[part]), len(out), "equations")
        return out

    def pulls(self, face, uv, values, vectors):
        """Vectors at places, times the weights of their control points, summed at each control point."""
        out = np.zeros((self.count, 3))
        kernels.add_vectors(self.net, self.spans, face, uv, values, vectors, out)
        return out

    def sums(self, face, uv, values, weight):
        """Weighted squares of the equations at places, ``values`` of 16 control points each, summed."""
        out = np.zeros(self.pattern.nnz)
        span = np.minimum((uv * self.spans).astype(np.int64), self.spans - 1)
        order = np.argsort((face * self.spans + span[:, 0]) * self.spans + span[:, 1], kind="stable")
        kernels.add_squares(self.slots, self.spans, order, face, uv, values, weight, out)
        return out

    def bending(self):
        """Integral of |S_uu|^2 + 2 |S_uv|^2 + |S_vv|^2 over all unit squares."""
        t, w = gauss_points(self.spans, DEGREE + 1)
        gram = [(b * w[:, None]).T @ b for b in basis_at(self.spans, t, 2)]
        local = np.kron(gram[2], gram[0]) + 2 * np.kron(gram[1], gram[1]) + np.kron(gram[0], gram[2])
        return np.bincount(self.slots.ravel(), np.tile(local.ravel(), len(self.net)), self.pattern.nnz)
