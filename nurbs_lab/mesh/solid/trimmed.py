"""Closed shells of exact trimmed faces, for surfaces of a mesh that lie on planes and round surfaces."""

from dataclasses import dataclass

import numpy as np
import trimesh

from nurbs_lab.common.checks import as_positive
from nurbs_lab.common.values import Value
from nurbs_lab.mesh.distance import triangle_samples, triangle_tree
from nurbs_lab.mesh.solid.faces import Face
from nurbs_lab.mesh.solid.regions import facets_of, regions_of
from nurbs_lab.mesh.solid.rims import curve_along, rims_of
from nurbs_lab.nurbs import NurbsSurface

_FINE = 0.05  # of the tolerance: triangles so near to the faces stand for them when distances are measured
_SIZES, _LEAST = (0.1, 1e5), 1e-5  # mm, of parts and of the tolerance: OpenCASCADE works to 1e-7 mm
_SAMPLES = 200_000  # of the mesh, at most


@dataclass(frozen=True, eq=False, repr=False)
class TrimmedShell(Value):
    """A closed surface of exact faces, which are bounded by curves.

    Attributes
    ----------
    faces : tuple of Face
    brep : bytes
        The same faces and their common edges in OpenCASCADE's binary format.
    body : int
        The solid that the shell bounds.
    is_void : bool
        Whether it bounds a void of that solid.
    angles : (edges,) array
        Largest angle between the tangent planes along every edge, degrees.
    sharp : (edges,) array of bool
        Edges along which the mesh turns as the faces do.
    """

    faces: tuple[Face, ...]
    brep: bytes
    body: int
    is_void: bool
    angles: np.ndarray
    sharp: np.ndarray

    @property
    def surfaces(self) -> tuple[NurbsSurface, ...]:
        """The surfaces of the faces, which are larger than these."""
        return tuple(face.surface for face in self.faces)

    @property
    def closed(self) -> bool:
        """Whether every edge has two faces, which it has by construction."""
        return True

    def seam_angles(self) -> np.ndarray:
        """Largest angle between the tangent planes along every edge, in degrees, ``(edges,)``."""
        return self.angles

    def shape(self):
        """The shell as OpenCASCADE's shape."""
        from nurbs_lab.mesh.solid.opencascade import from_bytes

        return from_bytes(self.brep)

    def volume_and_area(self) -> tuple[float, float]:
        """The volume inside, negative for a void, in mm³, and the area in mm²; exact to rounding."""
        from nurbs_lab.mesh.solid.opencascade import volume_and_area

        return volume_and_area(self.shape())

    def to_mesh(self, tolerance) -> trimesh.Trimesh:
        """Closed triangle mesh whose triangles are within ``tolerance`` mm of the faces."""
        from nurbs_lab.mesh.solid.opencascade import triangles_of

        return triangles_of(self.shape(), as_positive("tolerance", tolerance))


@dataclass(frozen=True, eq=False)
class Measured:
    """A shell, and how far it and the mesh are from one another; lengths in the units of the mesh."""

    shell: TrimmedShell
    mesh_points: np.ndarray
    to_surface: np.ndarray
    surface_points: np.ndarray
    to_mesh: np.ndarray

    @property
    def worst(self):
        """Largest distance in either direction."""
        return max(self.to_surface.max(), self.to_mesh.max())


def exact_shell(part, tolerance, sharp_angle) -> Measured | None:
    """Exact faces for a closed surface of a mesh; None if it has others, or if those miss the tolerance.

    None too where OpenCASCADE is not there, or does not find the shell valid.
    """
    try:
        from nurbs_lab.mesh.solid import exact
    except ImportError:
        return None
    points, triangles = part.vertices, part.triangles.astype(np.int64)
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    if not (_SIZES[0] < size < _SIZES[1] and tolerance > _LEAST):
        return None
    unit = (points - centre) / size
    facets = facets_of(unit, triangles, sharp_angle)
    label, found = regions_of(facets)
    label = label[facets.of]
    if (label < 0).any():
        return None
    surfaces, signs = [one.surface for one in found], [one.sign for one in found]
    try:
        rims = rims_of(unit, triangles, label, surfaces)
        inside = [unit[np.unique(triangles[label == k])] for k in range(len(found))]
        sheets = exact.sheets_of(rims, surfaces, signs, inside)
        curves = [
            curve_along([surfaces[k] for k in c.regions], c.points, c.first == c.last).scaled(size, centre)
            for c in rims.chains
        ]
        surfaces = [surface.scaled(size, centre) for surface in surfaces]
        shape = exact.Builder(rims.scaled(size, centre), curves, surfaces, sheets, signs).shell()
    except (exact.Standard_Failure, ValueError, IndexError, np.linalg.LinAlgError):
        return None  # borders that are no curves on their surfaces
    if not exact.is_valid(shape):
        return None
    shell = TrimmedShell(
        exact.oc.faces_of(shape), exact.oc.to_bytes(shape), part.body, part.is_void,
        *_seams(rims, surfaces, signs, size, centre),
    )  # fmt: skip
    measured = _measured(shell, points, triangles, tolerance)
    return measured if measured.worst <= tolerance else None


def _seams(rims, surfaces, signs, size, centre):
    """Angles between the faces along all chains, and whether those are edges of the mesh too."""
    angles = np.zeros(len(rims.chains))
    for k, chain in enumerate(rims.chains):
        points = chain.points * size + centre
        a, b = (signs[r] * surfaces[r].distances_and_normals(points)[1] for r in chain.regions)
        sine = np.linalg.norm(np.cross(a, b), axis=1)
        angles[k] = np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", a, b))).max()
    return angles, angles > 1.0


def _measured(shell, points, triangles, tolerance):
    fine = shell.to_mesh(_FINE * tolerance)
    samples = np.concatenate([points, triangle_samples(points, triangles, np.inf, _SAMPLES)])
    places = np.concatenate([fine.vertices, fine.triangles_center])
    to_surface = triangle_tree(fine.triangles).distances(samples)
    return Measured(shell, samples, to_surface, places, triangle_tree(points[triangles]).distances(places))
