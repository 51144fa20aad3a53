"""From a mesh to closed shells of NURBS faces that share their boundary curves."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import trimesh

from nurbs_lab.common.checks import as_count, as_number, as_positive
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.threads import over_slices
from nurbs_lab.common.values import Value
from nurbs_lab.mesh.core import MeshGraph, mesh_graph
from nurbs_lab.mesh.distance import Deviation, Spread
from nurbs_lab.mesh.read import without_cache
from nurbs_lab.mesh.repair import closed_surfaces
from nurbs_lab.mesh.slicing.contours import Layer
from nurbs_lab.mesh.slicing.planes import slice_mesh, uniform_heights
from nurbs_lab.mesh.solid.patches import Patches
from nurbs_lab.mesh.solid.shell_triangles import shell_triangles
from nurbs_lab.mesh.solid.shells import build
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface, approximate_curve

_SAME_PLACE = 1e-7  # of the size of a contour
_LAYERS = 30  # if neither layers nor layer_height is given
_MOST = 10**9  # faces and control points, if no limit is given


@dataclass(frozen=True, eq=False, repr=False)
class Shell(Value):
    """A closed surface of untrimmed NURBS faces; neighbours have equal control points along their edge.

    Attributes
    ----------
    patches : Patches
        The faces and how they hang together.
    body : int
        The solid that the shell bounds.
    is_void : bool
        Whether it bounds a void of that solid.
    """

    patches: Patches
    body: int
    is_void: bool

    @property
    def surfaces(self) -> tuple[NurbsSurface, ...]:
        """One surface a face; u and v run from 0 to 1, and the normal points out of the material."""
        return self.patches.surfaces

    @property
    def corners(self) -> np.ndarray:
        """Number of the vertex at (0, 0), (1, 0), (1, 1) and (0, 1) of every face, ``(faces, 4)``."""
        return self.patches.layout.corners

    @property
    def edges(self) -> np.ndarray:
        """Number of the edge on the side v = 0, u = 1, v = 1 and u = 0 of every face, ``(faces, 4)``."""
        return self.patches.layout.edges

    @property
    def forward(self) -> np.ndarray:
        """Whether the edge runs as the side does, counter-clockwise, ``(faces, 4)``."""
        return self.patches.layout.forward

    @property
    def sharp(self) -> np.ndarray:
        """Edges along which the tangent plane jumps, ``(edges,)``."""
        return self.patches.layout.sharp

    @property
    def closed(self) -> bool:
        """Whether every edge has two faces, which it has by construction."""
        return bool((np.bincount(self.edges.ravel()) == 2).all())

    @cached_property
    def seam_angles(self) -> np.ndarray:
        """Largest angle between the tangent planes along every edge, degrees, ``(edges,)``."""
        return self.patches.seam_angles(8).max(axis=1)

    def to_mesh(self, tolerance) -> trimesh.Trimesh:
        """Closed triangle mesh whose triangles are within ``tolerance`` mm of the faces."""
        return shell_triangles(self.patches, as_positive("tolerance", tolerance))


@dataclass(frozen=True, eq=False, repr=False)
class Reconstruction(Value):
    """Closed shells of NURBS faces made from a mesh, and how well they fit.

    Attributes
    ----------
    shells : tuple of Shell
        One for every outer boundary and every void.
    layers : tuple of Layer
        The ordered slices of the mesh, in rising order.
    tolerance : float
        As asked for, mm.
    graph : MeshGraph
        The mesh.
    repairs : tuple of str
        What was mended in the mesh first.
    """

    shells: tuple[Shell, ...]
    layers: tuple[Layer, ...]
    tolerance: float
    graph: MeshGraph
    repairs: tuple[str, ...]
    _deviation: Deviation

    def __repr__(self):
        solids = f"{len(self.bodies)} solid{'s' * (len(self.bodies) != 1)}"
        deviation = f"largest deviation {self._deviation.max:.4g} of {self.tolerance:.4g} mm"
        size = f"{len(self.surfaces)} faces, {self.control_points} control points"
        return f"Reconstruction({solids}, {size}, {deviation})"

    @property
    def surfaces(self) -> list[NurbsSurface]:
        """All faces, shell by shell."""
        return [surface for shell in self.shells for surface in shell.surfaces]

    @cached_property
    def curves(self) -> list[NurbsCurve]:
        """Every contour of the layers as a curve in space, within the tolerance (paper, section 2.2)."""
        contours = [contour for layer in self.layers for contour in layer.contours]
        return [contour_curve(c, self.tolerance) for c in contours if len(_distinct(c)) > 4]

    @property
    def bodies(self) -> list[list[Shell]]:
        """The shells of every solid, its outer boundary first."""
        out = [[] for _ in range(1 + max(shell.body for shell in self.shells))]
        for shell in sorted(self.shells, key=lambda shell: shell.is_void):
            out[shell.body].append(shell)
        return out

    @property
    def mesh(self) -> trimesh.Trimesh:
        """The mesh, equal vertices welded; `Deviation.vertices` has one value for each of its vertices."""
        return trimesh.Trimesh(self.graph.vertices, self.graph.triangles[~self.graph.junk], process=False)

    @property
    def volume(self) -> float:
        """Volume of the solids in mm³, integrated over the faces; exact to rounding."""
        return sum(shell.patches.volume_and_area()[0] for shell in self.shells)

    @property
    def area(self) -> float:
        """Area of all faces, in mm²."""
        return sum(shell.patches.volume_and_area()[1] for shell in self.shells)

    def deviation(self) -> Deviation:
        """The distance between all of the mesh and all of the faces, measured both ways."""
        return self._deviation

    @property
    def within_tolerance(self) -> bool:
        """Whether the largest distance, in both directions and everywhere, keeps the tolerance."""
        return self._deviation.max <= self.tolerance

    @property
    def control_points(self) -> int:
        """Number of control points of all faces."""
        return sum(shell.patches.points for shell in self.shells)

    @property
    def seam_angle(self) -> float:
        """Largest angle in degrees between tangent planes across edges that are not sharp."""
        return max((float(s.seam_angles[~s.sharp].max(initial=0.0)) for s in self.shells), default=0.0)

    def to_mesh(self, tolerance=None) -> trimesh.Trimesh:
        """All shells as one closed triangle mesh within ``tolerance`` mm of the faces.

        Parameters
        ----------
        tolerance : float, optional
            A tenth of `Reconstruction.tolerance` by default.
        """
        tolerance = self.tolerance / 10 if tolerance is None else as_positive("tolerance", tolerance)
        return trimesh.util.concatenate([shell.to_mesh(tolerance) for shell in self.shells])

    def report(self) -> str:
        """What a CAD user asks first, as lines of text."""
        mesh, deviation = self.mesh, self._deviation
        lines = [
            f"solids {len(self.bodies)}, shells {len(self.shells)}, faces {len(self.surfaces)}, "
            f"control points {self.control_points} ({self.control_points / len(mesh.faces):.2f} a triangle)",
            f"deviation: largest {deviation.max:.2g} mm, mean {deviation.mean:.2g} mm, "
            f"{100 * deviation.fraction_within(self.tolerance):.2f} % within {self.tolerance:g} mm",
            f"largest angle across smooth seams {self.seam_angle:.2g} degrees",
            f"volume {self.volume / mesh.volume:.3f} and area {self.area / mesh.area:.3f} of the mesh",
        ]
        if not self.within_tolerance:
            place = ", ".join(f"{x:.4g}" for x in deviation.worst_place)
            lines.append(f"the tolerance is missed, most at ({place}) mm")
        return "\n".join([*lines, *(f"mended: {repair}" for repair in self.repairs)])


def _distinct(contour):
    """Points of a contour in space, those left out that repeat their neighbour."""
    points = contour.points_3d
    size = np.linalg.norm(np.ptp(points, axis=0))
    steps = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    steps[-1] = steps[-1] if contour.closed else np.inf
    return points[steps > _SAME_PLACE * size]


def contour_curve(contour, tolerance) -> NurbsCurve:
    """A contour as a curve in space, within ``tolerance`` mm of its points (paper, section 2.2)."""
    return approximate_curve(_distinct(contour), tolerance=tolerance, closed=contour.closed)


@one_or_many(send=without_cache)
def reconstruct(
    mesh,
    *,
    layers=None,
    layer_height=None,
    tolerance,
    axis="z",
    sharp_angle=30.0,
    max_faces=None,
    max_control_points=None,
) -> Reconstruction:
    """Rebuild a closed triangle mesh as solids bounded by NURBS faces.

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph, or a list of them
        Closed; small defects are mended and named in `Reconstruction.repairs`.
    layers : int, optional
        Number of evenly spaced planes of the ordered slices, `Reconstruction.layers`; 30 by default.
    layer_height : float, optional
        Spacing of the planes in mm, instead of ``layers``.
    tolerance : float
        Largest distance between mesh and faces in mm, measured both ways and everywhere.
    axis : 'x', 'y', 'z' or (3,) array
        Normal of the planes.
    sharp_angle : float
        Edges that turn by more than this, in degrees, stay sharp and become edges of faces. The mesh must
        turn so within two tolerances on both sides, so noise and slivers make no sharp edges.
    max_faces, max_control_points : int, optional
        Limits of each shell. The best that was found within them is returned, whether or not it keeps
        the tolerance.
    executor : concurrent.futures.Executor, optional
        Workers for a list; this process by default. The results are equal bit for bit.

    Returns
    -------
    Reconstruction
        Its `deviation` says what was reached; `within_tolerance` compares it. A list for a list of meshes.

    Raises
    ------
    TypeError
        If both ``layers`` and ``layer_height`` are given.
    ValueError
        If a number is not positive, if the mesh is not closed and cannot be mended, or if the coarsest shell
        exceeds a limit.

    Notes
    -----
    If the sides of the triangles are shorter than about four tolerances, roughness below three tenths of the
    tolerance is taken off between sharp edges first.

    Every closed surface of the mesh is divided into four-sided patches (`mesh.solid.layout`), and one
    least-squares fit finds all bicubic patches together (`nurbs_lab.mesh.solid.patches`). Where the measured
    deviation misses the tolerance, the patches are made smaller and the fit is done again. Where only the
    volume is off, by more than 0.3 %, they move by one small length along their normals. Where patches turn
    over twice, or miss the tolerance by more than half of it four times, flat faces on pairs of triangles of
    the mesh take their place among smooth ones; their edges count as sharp. Sharp edges nearer to one another
    than a quarter of the tolerance are merged first. Where triangles are large beside the tolerance, sharp
    edges that end freely run on to where the mesh hardly turns, if that starts better. Where no such shell
    keeps the tolerance, within a limit that all attempts share, all its faces are flat: those of the coarsest
    mesh that keeps it.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> ball = trimesh.creation.icosphere(subdivisions=4, radius=10.0)
    >>> result = nl.reconstruct(ball, layers=12, tolerance=0.1)
    >>> len(result.shells), result.within_tolerance, result.to_mesh().is_watertight
    (1, True, True)
    """
    tolerance = as_positive("tolerance", tolerance)
    sharp_angle = as_number("sharp_angle", sharp_angle)
    if not 0.0 < sharp_angle < 180.0:
        raise ValueError(f"sharp_angle is {sharp_angle}; give degrees between 0 and 180")
    limits = ("max_faces", max_faces), ("max_control_points", max_control_points)
    most = [_MOST if limit is None else as_count(name, limit, most=_MOST) for name, limit in limits]
    graph = mesh_graph(mesh)
    layers = _LAYERS if layers is None and layer_height is None else layers
    heights = uniform_heights(graph, layers=layers, layer_height=layer_height, axis=axis)
    parts, repairs = closed_surfaces(graph)
    total = sum(len(part.triangles) for part in parts)

    def fitted(part):
        fraction = len(part.triangles) / total
        volume = float(np.mean([other.volume for other in parts if other.body == part.body]))
        return build(part, tolerance, sharp_angle, *most, fraction, volume)

    fits = over_slices(fitted, parts, "shells")
    shells = tuple(Shell(fit.patches, part.body, part.is_void) for fit, part in zip(fits, parts, strict=True))
    layers = tuple(slice_mesh(graph, heights, axis))
    return Reconstruction(shells, layers, tolerance, graph, repairs, _together(graph, fits))


def _together(graph, fits):
    """The deviation of all shells, and of every vertex of the mesh."""
    to_surface = np.concatenate([fit.to_surface for fit in fits])
    to_mesh = np.concatenate([fit.to_mesh for fit in fits])
    points = np.concatenate([fit.mesh_points for fit in fits])
    from scipy.spatial import cKDTree

    vertices = to_surface[cKDTree(points).query(graph.vertices)[1]]
    return Deviation(
        np.concatenate([to_surface, to_mesh]),
        Spread(to_surface),
        Spread(to_mesh),
        vertices,
        np.concatenate([points, *(fit.surface_points for fit in fits)]),
    )
