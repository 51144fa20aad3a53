"""Bezier patches of degree 5 on a layout: neighbours have the same control points along their common edge."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.special import binom

from nurbs_lab.common.threads import over_blocks
from nurbs_lab.common.values import Value
from nurbs_lab.mesh.solid import _kernels_patches as kernels
from nurbs_lab.mesh.solid.layout import Layout
from nurbs_lab.mesh.solid.net import DEGREE
from nurbs_lab.nurbs import NurbsSurface


@dataclass(frozen=True, eq=False, repr=False)
class Patches(Value):
    """Fitted patches.

    Attributes
    ----------
    layout : Layout
    net : (faces, 6, 6) array
        Number of every control point; equal numbers are one point.
    control : (n, 3) array
    """

    layout: Layout
    net: np.ndarray
    control: np.ndarray

    def some(self, faces):
        """Only some faces, as an open surface; control points and edges keep their numbers."""
        layout, names = self.layout, ("corners", "edges", "forward")
        layout = replace(layout, **{name: getattr(layout, name)[faces] for name in names})
        return replace(self, layout=layout, net=self.net[faces])

    def surfaces(self) -> tuple[NurbsSurface, ...]:
        """One untrimmed surface a face."""
        knots = np.repeat([0.0, 1.0], DEGREE + 1)
        return tuple(NurbsSurface((DEGREE, DEGREE), (knots, knots), net) for net in self.nets)

    @property
    def nets(self) -> np.ndarray:
        """Control points of every face, ``(faces, 6, 6, 3)``."""
        return self.control[self.net]

    def grid(self, t, u_order=0, v_order=0):
        """Points or derivatives of every face at parameters t along both, ``(faces, len(t), len(t), 3)``."""
        u, v = basis_at(t, u_order), basis_at(t, v_order)
        return np.einsum("ai,bj,fijx->fabx", u, v, self.nets, optimize=True)

    def normals(self, t):
        """Normals of every face at parameters t, as long as |S_u x S_v|, ``(faces, len(t), len(t), 3)``."""
        return np.cross(self.grid(t, 1, 0), self.grid(t, 0, 1))

    def nearest(self, points, face, uv):
        """Distances of points to their faces; the ``uv`` of their places are moved to the nearest ones."""
        nets, gaps = self.nets, np.empty(len(points))

        over_blocks(
            lambda part: kernels.nearest_places(nets, points[part], face[part], uv[part], gaps[part]),
            len(points),
            "distances to patches",
        )
        return gaps

    def area_vectors(self):
        """Weighted normals of pieces of all faces, points there, and the basis along a side there.

        Eight Gauss points along a side make volumes exact to rounding. The mean of the control points is the
        origin.
        """
        x, w = leggauss(8)
        t, w = (x + 1.0) / 2.0, w / 2.0
        points = self.grid(t) - self.control.mean(axis=0)
        return self.normals(t) * np.outer(w, w)[..., None], points, basis_at(t, 0)

    def volume_slopes(self):
        """The volume by the divergence theorem, and its derivatives by the control points ``(n, 3)``.

        The patches must be closed.
        """
        vectors, points, basis = self.area_vectors()
        slopes = np.zeros_like(self.control)
        np.add.at(slopes, self.net, np.einsum("fabx,ai,bj->fijx", vectors, basis, basis, optimize=True))
        return float(np.einsum("fabx,fabx->", points, vectors)) / 3.0, slopes

    def flat(self) -> np.ndarray:
        """Faces whose control points lie in a plane, within a millionth of their extent."""
        points = self.nets.reshape(len(self.net), -1, 3)
        sizes = np.linalg.svd(points - points.mean(axis=1, keepdims=True), compute_uv=False)
        return sizes[:, 2] < 1e-6 * sizes[:, 0]

    def flipped(self) -> np.ndarray:
        """Faces that fold: neighbouring normals of 25 along each side are more than 90 degrees apart."""
        n = self.normals(np.arange(25) / 24)
        along = (
            np.einsum("fabx,fabx->fab", n[:, 1:], n[:, :-1]),
            np.einsum("fabx,fabx->fab", n[:, :, 1:], n[:, :, :-1]),
        )
        return (along[0] < 0.0).any(axis=(1, 2)) | (along[1] < 0.0).any(axis=(1, 2))


def basis_at(t, order=0):
    """The Bernstein polynomials of degree 5 or their derivatives at t, ``(..., 6)``."""
    p, t = DEGREE - order, np.asarray(t, dtype=float)[..., None]
    i = np.arange(p + 1)
    out = binom(p, i) * t**i * (1.0 - t) ** (p - i)
    for _ in range(order):
        p += 1
        zero = np.zeros_like(t)
        out = p * (np.concatenate([zero, out], axis=-1) - np.concatenate([out, zero], axis=-1))
    return out
