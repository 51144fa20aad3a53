"""From a mesh to NURBS surfaces: layers, tubes, sections, skins (paper 2.1 to 2.3, Fig. 7)."""

from dataclasses import dataclass

import numpy as np
import trimesh

from nurbs_lab.common.checks import LARGEST, as_flag, as_positive
from nurbs_lab.common.progress import heard
from nurbs_lab.mesh.connectivity import Junction, join_layers, place
from nurbs_lab.mesh.deviation import Deviation, measure
from nurbs_lab.mesh.graph import MeshGraph, mesh_graph
from nurbs_lab.mesh.heights import uniform_heights
from nurbs_lab.mesh.sections import fit_sections, skin_sections
from nurbs_lab.mesh.slicing import Contour, Layer, axis_frame, in_frame, slice_mesh
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

_FIT_SHARE = 0.4  # of the tolerance goes to the fit of the contours, the rest to what happens between layers
_THIN = 0.5  # of the tolerance: no slab of a tube is cut thinner; what misses the tolerance then is a step
_THINNEST = 0.1  # of the tolerance: no slab of a junction is cut thinner
_ROUNDS = 12


@dataclass(frozen=True, eq=False)
class Tube:
    """Contours that follow one another, and the surface through them.

    Attributes
    ----------
    contours : tuple of Contour
        Upwards, one of every layer from ``first_layer`` on.
    curves : tuple of NurbsCurve
        The section fitted to each contour, in space, all on the same knots.
    surface : NurbsSurface
        u runs around, v upwards; it passes through every section.
    parameters : (n,) array
        v of every section.
    first_layer : int
        Index of the lowest layer.
    fit_error : float
        Largest distance between a vertex of a contour and its curve, mm.
    """

    contours: tuple[Contour, ...]
    curves: tuple[NurbsCurve, ...]
    surface: NurbsSurface
    parameters: np.ndarray
    first_layer: int
    fit_error: float

    @property
    def closed(self) -> bool:
        """Whether the sections are closed."""
        return self.contours[0].closed

    @property
    def is_hole(self) -> bool:
        """Whether the tube bounds a hollow: the material is outside of it."""
        return self.contours[0].is_hole


@dataclass(frozen=True, eq=False)
class Reconstruction:
    """NURBS surfaces made from a mesh, and how well they fit.

    Attributes
    ----------
    layers : tuple of Layer
        In rising order, those that were put in by refinement included.
    tubes : tuple of Tube
    junctions : tuple of Junction
        Where tubes end: caps, branches, and bodies that no plane met.
    unskinned : tuple of Contour
        Contours without a partner above or below: too few layers for a surface there.
    tolerance : float
        As asked for, mm.
    graph : MeshGraph
        The mesh.
    frame : (3, 3) array
        Rows: the two directions of the planes and their normal.
    """

    layers: tuple[Layer, ...]
    tubes: tuple[Tube, ...]
    junctions: tuple[Junction, ...]
    unskinned: tuple[Contour, ...]
    tolerance: float
    graph: MeshGraph
    frame: np.ndarray
    _deviation: Deviation

    @property
    def surfaces(self) -> list[NurbsSurface]:
        """The surface of every tube."""
        return [tube.surface for tube in self.tubes]

    @property
    def curves(self) -> list[NurbsCurve]:
        """The sections of all tubes."""
        return [curve for tube in self.tubes for curve in tube.curves]

    @property
    def mesh(self) -> trimesh.Trimesh:
        """The mesh, equal vertices welded; `Deviation.vertices` has one value for each of its vertices."""
        return trimesh.Trimesh(self.graph.vertices, self.graph.triangles[~self.graph.junk], process=False)

    def deviation(self) -> Deviation:
        """The distance between mesh and surfaces, measured both ways when the surfaces were made."""
        return self._deviation

    @property
    def within_tolerance(self) -> bool:
        """Whether the measured maximum, away from caps and branch regions, keeps the tolerance."""
        return self._deviation.max <= self.tolerance


@heard()
def reconstruct(
    mesh, *, layers=None, layer_height=None, tolerance, axis="z", adaptive=True
) -> Reconstruction:
    """Rebuild a triangle mesh as NURBS surfaces through its contours.

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph
    layers : int
        Number of evenly spaced planes, the outer ones half a spacing inside the ends.
    layer_height : float
        Spacing of the planes in mm, instead of ``layers``.
    tolerance : float
        Largest deviation between mesh and surfaces in mm, away from caps and branch regions.
    axis : 'x', 'y', 'z' or (3,) array
        Normal of the planes.
    adaptive : bool
        Put in more layers wherever the measured deviation misses the tolerance, and where they come closer
        than the tolerance, at a ledge, end the tube with a step; False keeps the even layers.

    Returns
    -------
    Reconstruction
        Its `deviation` says what was reached; `within_tolerance` compares it.

    Raises
    ------
    TypeError
        If not exactly one of ``layers`` and ``layer_height`` is given.
    ValueError
        If a number is not positive, or no two neighbouring layers have a contour in common.

    Notes
    -----
    Every contour is fitted by least squares within 0.4 of the tolerance (`nurbs_lab.mesh.sections`); contours
    follow one another as the mesh connects them (`nurbs_lab.mesh.connectivity`).

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> ball = trimesh.creation.icosphere(subdivisions=4, radius=10.0)
    >>> result = nl.reconstruct(ball, layers=12, tolerance=0.1)
    >>> len(result.surfaces), result.within_tolerance
    (1, True)
    """
    tolerance, adaptive = as_positive("tolerance", tolerance), as_flag("adaptive", adaptive)
    graph = mesh_graph(mesh)
    frame = axis_frame(axis)
    heights = uniform_heights(graph, layers=layers, layer_height=layer_height, axis=axis)
    z = in_frame(graph.vertices[graph.triangles[~graph.junk]].reshape(-1, 3), frame)[:, 2]
    low, high = float(z.min()), float(z.max())
    if not high - low >= 1 / LARGEST:
        raise ValueError(f"mesh extends over {high - low} mm along the axis; there are no layers in it")
    steps = frozenset()
    result = _skin_all(graph, heights, axis, frame, tolerance, steps)
    for _ in range(_ROUNDS if adaptive else 0):
        first_layers = [tube.first_layer for tube in result.tubes]
        finer = _refined(heights, low, high, result.deviation(), first_layers, tolerance)
        cut = steps | _steps(result, tolerance)
        if len(finer) == len(heights) and cut == steps:
            break
        heights, steps = finer, cut
        result = _skin_all(graph, heights, axis, frame, tolerance, steps)
    return result


def _skin_all(graph, heights, axis, frame, tolerance, steps):
    layers = slice_mesh(graph, heights, axis)
    pieces = join_layers(graph, layers, frame, steps)
    tubes = tuple(
        _tube(chain, start, tolerance)
        for chain, start in zip(pieces.chains, pieces.starts, strict=True)
        if len(chain) > 1
    )
    if not tubes:
        raise ValueError(
            f"no contour goes on from one of the {len(layers)} layers to the next; use more layers, "
            "or a smaller layer_height"
        )
    unskinned = tuple(chain[0] for chain in pieces.chains[len(tubes) :])
    deviation = measure(graph, frame, heights, pieces, tubes)
    return Reconstruction(
        tuple(layers), tubes, tuple(pieces.junctions), unskinned, tolerance, graph, frame, deviation
    )


def _tube(contours, first_layer, tolerance):
    curves, error = fit_sections(contours, _FIT_SHARE * tolerance)
    surface, parameters = skin_sections(curves)
    return Tube(contours, tuple(curves), surface, parameters, first_layer, error)


def _refined(heights, low, high, deviation, first_layers, tolerance):
    """More planes in every slab that misses the tolerance and can still be cut."""
    ends = np.concatenate([[low], heights, [high]])
    thickness = np.diff(ends)
    in_tubes = np.zeros(len(thickness))
    for first, worst in zip(first_layers, deviation.tubes, strict=True):
        slabs = slice(first + 1, first + 1 + len(worst))
        in_tubes[slabs] = np.maximum(in_tubes[slabs], worst)
    parts = np.ones(len(thickness), dtype=int)
    for worst, thinnest in ((in_tubes, _THIN), (deviation.slabs, _THINNEST)):
        wanted = np.where(worst > tolerance, np.maximum(2, np.ceil(np.sqrt(worst / tolerance))), 1)
        parts = np.maximum(parts, np.minimum(wanted, thickness // (thinnest * tolerance)).astype(int))
    new = [ends[s] + thickness[s] * np.arange(1, parts[s]) / parts[s] for s in np.flatnonzero(parts > 1)]
    return np.sort(np.concatenate([heights, *new]))


def _steps(result, tolerance):
    """Contours above which a tube misses the tolerance though the slab is too thin to be cut: a ledge."""
    return {
        place(lower)
        for tube, worst in zip(result.tubes, result.deviation().tubes, strict=True)
        for lower, upper, distance in zip(tube.contours, tube.contours[1:], worst, strict=False)
        if distance > tolerance and upper.height - lower.height < 2 * _THIN * tolerance
    }
