"""Contours joined from layer to layer, by the mesh itself.

Two contours belong together when one connected piece of the mesh between their planes ends in them and in no
other contour. Every other piece is a junction: a cap (contours on one side only), a branch (several on a
side), or a body that no plane met. So handles, holes and several bodies need no guess about which contours
look alike. A step is a piece that could be a tube, but whose contours differ so abruptly that the caller cuts
it: a ledge.
"""

from dataclasses import dataclass

import numpy as np

from nurbs_lab.mesh import _kernels, _kernels_slabs
from nurbs_lab.mesh.slicing import Contour, Layer, in_frame


@dataclass(frozen=True, eq=False)
class Junction:
    """A piece of the mesh between two planes that is no tube.

    Attributes
    ----------
    slab : int
        It lies between planes ``slab - 1`` and ``slab``.
    below, above : tuple of Contour
        The contours it ends in.
    """

    slab: int
    below: tuple[Contour, ...]
    above: tuple[Contour, ...]

    @property
    def kind(self) -> str:
        """'cap', 'branch', 'step' or 'missed'."""
        if not self.below or not self.above:
            return "cap" if self.below or self.above else "missed"
        return "step" if len(self.below) == len(self.above) == 1 else "branch"


@dataclass(frozen=True, eq=False)
class Pieces:
    """How the contours of all layers hang together.

    Attributes
    ----------
    chains : list of tuple of Contour
        Contours of every tube, upwards; contours that stand alone come last.
    starts : list of int
        Index of the layer that each chain starts in.
    junctions : list of Junction
    owner_of_piece : (pieces,) array
        Index into ``chains`` of the tube a piece is part of, or -1 - index into ``junctions``.
    """

    chains: list[tuple[Contour, ...]]
    starts: list[int]
    junctions: list[Junction]
    owner_of_piece: np.ndarray
    _first: np.ndarray
    _low: np.ndarray
    _piece: np.ndarray

    def owner_at(self, triangles, slabs) -> np.ndarray:
        """What each place of the mesh belongs to, given its triangle and its slab, see ``owner_of_piece``."""
        return self.owner_of_piece[self._piece[self._first[triangles] + slabs - self._low[triangles]]]


def place(contour) -> tuple:
    """What tells a contour from all others of the same mesh."""
    return contour.height, *contour.points[0].tolist()


def join_layers(graph, layers: list[Layer], frame, steps=frozenset()) -> Pieces:
    """Join the contours of layers in rising order, except above those whose `place` is in ``steps``."""
    heights = np.array([layer.height for layer in layers])
    level = _kernels.vertex_levels(in_frame(graph.vertices, frame)[:, 2], heights)
    first, low, piece, slab = _kernels_slabs.slab_pieces(graph.triangles, graph.twins, graph.junk, level)
    contours, planes = [], []
    for k, layer in enumerate(layers):
        contours.extend(layer.contours)
        planes.extend([k] * len(layer.contours))
    planes = np.array(planes, dtype=np.int64)
    carrier = np.array([contour.triangles[0] for contour in contours], dtype=np.int64)
    under = piece[first[carrier] + planes - low[carrier]]
    over = piece[first[carrier] + planes + 1 - low[carrier]]

    below = [[] for _ in slab]
    above = [[] for _ in slab]
    for c in range(len(contours)):
        above[under[c]].append(c)
        below[over[c]].append(c)
    after = {
        b[0]: a[0]
        for b, a in zip(below, above, strict=True)
        if len(a) == len(b) == 1
        and contours[a[0]].closed == contours[b[0]].closed
        and place(contours[b[0]]) not in steps
    }
    chains = []
    for start in sorted(set(range(len(contours))) - set(after.values())):
        chain = [start]
        while chain[-1] in after:
            chain.append(after[chain[-1]])
        chains.append(chain)
    chains.sort(key=lambda chain: len(chain) == 1)
    chain_of = {c: i for i, chain in enumerate(chains) for c in chain}
    owner = np.array([chain_of[b[0]] if b and b[0] in after else -1 for b in below])
    apart = np.flatnonzero(owner < 0)
    owner[apart] = -1 - np.arange(len(apart))
    pick = contours.__getitem__
    return Pieces(
        [tuple(map(pick, chain)) for chain in chains],
        [int(planes[chain[0]]) for chain in chains],
        [Junction(int(slab[p]), tuple(map(pick, below[p])), tuple(map(pick, above[p]))) for p in apart],
        owner,
        first,
        low,
        piece,
    )
