"""Closed shells of exact trimmed faces, where a mesh lies on planes and round surfaces, and of patches."""

from dataclasses import dataclass, replace

import numpy as np
import trimesh

from nurbs_lab.common.checks import as_positive
from nurbs_lab.common.values import Value
from nurbs_lab.mesh.distance import triangle_samples, triangle_tree
from nurbs_lab.mesh.solid.faces import Face
from nurbs_lab.mesh.solid.refine import build
from nurbs_lab.mesh.solid.regions import regions_of
from nurbs_lab.nurbs import NurbsSurface

_FINE = 0.05  # of the tolerance: triangles so near to the faces stand for them when distances are measured
_FINEST = 2e-6  # of the square root of the area: finer triangles of round faces take many minutes
_WIDE = 4.0  # tolerances: exact faces beside free form are as large as such a square
SHARP = 1.0  # degrees: faces of CAD parts that meet at a smaller angle were made to touch


@dataclass(frozen=True, eq=False, repr=False)
class TrimmedShell(Value):
    """A closed surface of exact faces, and of patches beside them, which are bounded by curves.

    Attributes
    ----------
    faces : tuple of Face
    brep : bytes
        The same faces and their common edges in OpenCASCADE's binary format, in units of their own.
    body : int
        The solid that the shell bounds.
    is_void : bool
        Whether it bounds a void of that solid.
    made_equal : int
        Faces of which axis, radius or angle almost agreed with those of another face and was made equal.
    change : float
        The largest change of these, mm.
    unit : float
        Of ``brep``, mm: a power of ten, in which every part is as large as OpenCASCADE's limits are made for.
    """

    faces: tuple[Face, ...]
    brep: bytes
    body: int
    is_void: bool
    made_equal: int = 0
    change: float = 0.0
    unit: float = 1.0

    @classmethod
    def of(cls, shape, unit, *others):
        """The shell of a shape in such units; then its other values in their order."""
        oc = _opencascade()
        return cls(oc.faces_of(oc.scaled(shape, unit)), oc.to_bytes(shape), *others, unit=unit)

    @property
    def surfaces(self) -> tuple[NurbsSurface, ...]:
        """The surfaces of the faces, which are larger than these."""
        return tuple(face.surface for face in self.faces)

    @property
    def closed(self) -> bool:
        """Whether every edge has two faces, which it has by construction."""
        return True

    @property
    def sharp(self) -> np.ndarray:
        """Edges along which the tangent plane jumps, ``(edges,)``."""
        return self.seam_angles() > SHARP

    def seam_angles(self) -> np.ndarray:
        """Largest angle between the tangent planes along every edge, in degrees, ``(edges,)``.

        OpenCASCADE evaluates the faces where their curves in the parameters say that the edge is.
        """
        return _opencascade().angles_of(self._in_units)

    def shape(self):
        """The shell as OpenCASCADE's shape, in mm."""
        return _opencascade().scaled(self._in_units, self.unit)

    @property
    def _in_units(self):
        """The shell as OpenCASCADE's shape, in its own units."""
        return _opencascade().from_bytes(self.brep)

    @property
    def volume(self) -> float:
        """The volume inside, negative for a void, in mm³, within 1e-6 of itself."""
        return _opencascade().volume(self._in_units) * self.unit**3

    @property
    def area(self) -> float:
        """Area of the faces in mm², within 1e-6 of itself."""
        return _opencascade().area(self._in_units) * self.unit**2

    def to_mesh(self, tolerance) -> trimesh.Trimesh:
        """Closed triangle mesh whose triangles are within ``tolerance`` mm of the faces.

        ValueError below `finest`.
        """
        tolerance = fine_enough(self, tolerance) / self.unit
        return _opencascade().triangles_of(self._in_units, tolerance).apply_scale(self.unit)

    @property
    def finest(self) -> float:
        """The least tolerance of `to_mesh`, mm: finer triangles of round faces take many minutes."""
        return _FINEST * np.sqrt(self.area)


def fine_enough(shell, tolerance):
    """A tolerance for the triangles of a shell, not below its `finest`."""
    tolerance = as_positive("tolerance", tolerance)
    if tolerance < shell.finest:
        raise ValueError(f"tolerance is {tolerance:g} mm; give {shell.finest:.2g} mm or more for this shell")
    return tolerance


def unit_of(size):
    """The power of ten, in mm, in which a part measures about a hundred: OpenCASCADE works to 1e-7."""
    return float(10.0 ** (np.round(np.log10(size)) - 2.0))


def _opencascade():
    """The module that needs the extra ``cad``."""
    from nurbs_lab.mesh.solid import opencascade

    return opencascade


@dataclass(frozen=True, eq=False)
class Measured:
    """A shell, and how far it and the mesh are from one another; lengths in the units of the mesh."""

    shell: TrimmedShell
    fine: trimesh.Trimesh
    mesh_points: np.ndarray
    to_surface: np.ndarray
    surface_points: np.ndarray
    to_mesh: np.ndarray


def exact_shell(facets, tolerance, sharp_angle, partly=False) -> Measured | None:
    """Exact faces for the facets of a mesh; None if it has others, or if those miss the tolerance.

    If ``partly``, it has others, to which patches are fitted that end on the exact faces. None too where
    OpenCASCADE is not there, or does not find the shell valid.
    """
    try:
        from nurbs_lab.mesh.solid import exact
        from nurbs_lab.mesh.solid import opencascade as oc
    except ImportError:
        return None
    part, even, triangles = facets.part, facets.points, facets.triangles
    points, size, centre = part.vertices, facets.size, facets.centre
    unit = unit_of(size)
    least = (_WIDE * tolerance / size) ** 2 if partly else None
    regions, rest = regions_of(facets, sharp_angle, least), None
    if regions is None or (regions[0].min() < 0) != partly:
        return None
    label, found, changes = regions
    if partly:
        mm = [one.scaled(size, centre) for one in found]
        fitted = build(part, tolerance, sharp_angle, regions=(label, mm))
        if fitted.worst > tolerance or fitted.faulty.any():
            return None
        rest = replace(fitted.patches, control=fitted.patches.control / unit), fitted.rims
    samples = np.concatenate([points, triangle_samples(points, triangles, np.inf)])
    # fine triangles lie between the middles of edges and of triangles, which are last, and the faces
    edges = np.nonzero(triangles < np.roll(triangles, -1, axis=1))[0]
    owners, middles = np.concatenate([label[edges], label]), samples[len(points) :]
    off = np.zeros(len(middles))
    for k, one in enumerate(found):
        mine = owners == k
        off[mine] = size * np.abs(one.distances((middles[mine] - centre) / size))
    if off.max() > tolerance:
        return None
    equal = int((changes > 0).sum()), changes.max() * size
    try:
        shape = exact.shell_of(even, triangles, label, found, (size / unit, centre / unit), rest)
        if shape is None:
            return None
        shell = TrimmedShell.of(shape, unit, part.body, part.is_void, *equal)
        fine = shell.to_mesh(max(_FINE * tolerance, shell.finest))
    except (*oc.FAILURES, ValueError, StopIteration, np.linalg.LinAlgError):
        return None  # borders that are no curves on their surfaces, or faces without triangles
    places = np.concatenate([fine.vertices, fine.triangles_center])
    to_surface = triangle_tree(fine.triangles).distances(samples)
    to_surface[len(points) :] = np.maximum(to_surface[len(points) :], off)
    to_mesh = triangle_tree(points[triangles]).distances(places)
    near = max(to_surface.max(), to_mesh.max()) <= tolerance
    return Measured(shell, fine, samples, to_surface, places, to_mesh) if near else None
