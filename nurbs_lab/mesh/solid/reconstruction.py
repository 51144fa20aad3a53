"""From a mesh to closed shells of NURBS faces that share their boundary curves."""

from dataclasses import dataclass

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from nurbs_lab.common.checks import as_choice, as_count, as_number, as_positive, counted, extent, shown_place
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.common.threads import over_slices
from nurbs_lab.common.values import Value
from nurbs_lab.mesh.core import enclosed_volume, mesh_graph
from nurbs_lab.mesh.distance import Deviation, crossing_triangles
from nurbs_lab.mesh.read import without_cache
from nurbs_lab.mesh.repair import closed_surfaces, joined
from nurbs_lab.mesh.solid.faces import ALONG, Face, kinds_of_faces, patch
from nurbs_lab.mesh.solid.net import side_places
from nurbs_lab.mesh.solid.patches import Patches
from nurbs_lab.mesh.solid.refine import Fitted, build
from nurbs_lab.mesh.solid.regions import facets_of
from nurbs_lab.mesh.solid.shell_triangles import finest, shell_triangles
from nurbs_lab.mesh.solid.trimmed import SHARP, Measured, TrimmedShell, exact_shell, fine_enough
from nurbs_lab.nurbs import NurbsSurface


@dataclass(frozen=True, eq=False, repr=False)
class Shell(Value):
    """A closed surface of NURBS faces; neighbours have equal control points along their edge.

    Attributes
    ----------
    faces : tuple of Face
        Each is a surface with its loops; the normal points out of the material.
    patches : Patches
        The same faces as arrays, and how they hang together.
    body : int
        The solid that the shell bounds.
    is_void : bool
        Whether it bounds a void of that solid.
    """

    faces: tuple[Face, ...]
    patches: Patches
    body: int
    is_void: bool

    @property
    def surfaces(self) -> tuple[NurbsSurface, ...]:
        """One surface a face; u and v run from 0 to 1."""
        return tuple(face.surface for face in self.faces)

    @property
    def sharp(self) -> np.ndarray:
        """Edges along which the tangent plane jumps, ``(edges,)``."""
        return self.patches.layout.sharp

    @property
    def closed(self) -> bool:
        """Whether every edge has two faces, which it has by construction."""
        return bool((np.bincount(self.patches.layout.edges.ravel()) == 2).all())

    def seam_angles(self) -> np.ndarray:
        """Largest angle between the tangent planes along every edge, in degrees, ``(edges,)``.

        The surfaces themselves are evaluated, at both ends of the edge too.
        """
        u, v = side_places(np.arange(4), np.linspace(0.0, 1.0, ALONG)).T
        slopes = [
            [surface.derivative(u, v, order) for order in ((1, 0), (0, 1))] for surface in self.surfaces
        ]
        normals = np.cross(*np.swapaxes(slopes, 0, 1)).reshape(-1, ALONG, 3)
        sides = self.patches.layout.sides
        here, there = normals[sides[:, 0]], normals[sides[:, 1], ::-1]
        sine = np.linalg.norm(np.cross(here, there), axis=-1)
        return np.degrees(np.arctan2(sine, np.einsum("eki,eki->ek", here, there))).max(axis=1)

    @property
    def volume(self) -> float:
        """The volume inside, negative for a void, in mm³, exact to rounding."""
        return self.patches.volume_slopes()[0]

    @property
    def area(self) -> float:
        """Nearly the area of the faces, in mm²."""
        return float(np.linalg.norm(self.patches.area_vectors()[0], axis=-1).sum())

    def to_mesh(self, tolerance) -> trimesh.Trimesh:
        """Closed triangle mesh whose triangles are within ``tolerance`` mm of the faces.

        ValueError below `finest`.
        """
        return shell_triangles(self.patches, fine_enough(self, tolerance))

    @property
    def finest(self) -> float:
        """The least tolerance of `to_mesh`, mm: a finer one would need more than five million triangles."""
        return finest(self.patches)


@dataclass(frozen=True, eq=False, repr=False)
class Reconstruction(Value):
    """Closed shells of NURBS faces made from a mesh, and how well they fit.

    Attributes
    ----------
    shells : tuple of Shell or TrimmedShell
        One for every outer boundary and every void.
    tolerance : float
        As asked for, mm.
    vertices, triangles : (n, 3) and (m, 3) arrays
        Of the mesh after small defects were mended.
    repairs : tuple of str
        What was mended in the mesh first.
    deviation : Deviation
        The distance between all of the mesh and all of the faces, measured both ways; without samples where
        sections were given and no mesh.
    seam_angle : float
        Largest angle in degrees between tangent planes across edges that are not sharp in the mesh.
    crossings : (k, 3) array
        Where faces of a solid pass through each other though its mesh does not: middles of their triangles.
        Nobody looks where faces of the solid fold.
    """

    shells: tuple[Shell | TrimmedShell, ...]
    tolerance: float
    vertices: np.ndarray
    triangles: np.ndarray
    repairs: tuple[str, ...]
    deviation: Deviation
    seam_angle: float
    crossings: np.ndarray

    def __repr__(self):
        solids = f"{len(self.bodies)} solid{'s' * (len(self.bodies) != 1)}"
        size = f"{len(self.surfaces)} faces, {self.control_point_count} control points"
        deviation = f", largest deviation {self.deviation.max:.4g} of {self.tolerance:.4g} mm"
        return f"Reconstruction({solids}, {size}{deviation * bool(self.deviation.count)})"

    @property
    def faces(self) -> list[Face]:
        """All faces, shell by shell."""
        return [face for shell in self.shells for face in shell.faces]

    @property
    def surfaces(self) -> list[NurbsSurface]:
        """The surfaces of all faces, shell by shell."""
        return [face.surface for face in self.faces]

    @property
    def bodies(self) -> list[list[Shell]]:
        """The shells of every solid, its outer boundary first."""
        out = [[] for _ in range(1 + max(shell.body for shell in self.shells))]
        for shell in sorted(self.shells, key=lambda shell: shell.is_void):
            out[shell.body].append(shell)
        return out

    @property
    def mesh(self) -> trimesh.Trimesh:
        """The mended mesh, as of `repair_mesh`; `Deviation.vertices` has a value for each of its vertices."""
        return trimesh.Trimesh(self.vertices, self.triangles, process=False)

    @property
    def volume(self) -> float:
        """Volume of the solids in mm³, integrated over the faces: to rounding, within 1e-6 of exact ones."""
        return sum(shell.volume for shell in self.shells)

    @property
    def area(self) -> float:
        """Area of all faces, in mm²."""
        return sum(shell.area for shell in self.shells)

    @property
    def within_tolerance(self) -> bool:
        """Whether the largest distance keeps the tolerance, both ways, and no face folds or crosses one."""
        return self.deviation.max <= self.tolerance and not self.folded_faces and not len(self.crossings)

    @property
    def folded_faces(self) -> int:
        """Number of fitted faces that fold: neighbouring normals of theirs are more than 90 degrees apart."""
        return sum(int(shell.patches.flipped().sum()) for shell in self.shells if isinstance(shell, Shell))

    @property
    def control_point_count(self) -> int:
        """Number of control points of all faces, common ones counted for each."""
        return sum(surface.control_points[..., 0].size for surface in self.surfaces)

    def to_mesh(self, tolerance=None) -> trimesh.Trimesh:
        """All shells as one closed triangle mesh within ``tolerance`` mm of the faces.

        Parameters
        ----------
        tolerance : float, optional
            A tenth of `Reconstruction.tolerance` by default, or the finest of a shell where that is larger.
        """
        least = self.tolerance / 10
        return trimesh.util.concatenate(
            [s.to_mesh(max(least, s.finest) if tolerance is None else tolerance) for s in self.shells]
        )

    def to_pyvista(self, tolerance=None):
        """`to_mesh` as a `pyvista.PolyData`."""
        import pyvista

        mesh = self.to_mesh(tolerance)
        return pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.faces)

    def report(self) -> str:
        """What a CAD user asks first, as lines of text."""
        deviation, faces, folded = self.deviation, self.faces, self.folded_faces
        flat = sum(int(shell.patches.flat().sum()) for shell in self.shells if isinstance(shell, Shell))
        exact = sum(face.kind != "patch" for face in faces)
        lines = [
            f"solids {len(self.bodies)}, shells {len(self.shells)}, faces {len(faces)}: "
            f"{exact} exact, {len(faces) - exact - flat} smooth, {flat} flat, {folded} of them fold",
            f"kinds: {kinds_of_faces(faces)}",
            *(self._beside_mesh() if deviation.count else [f"volume {self.volume:.6g} mm³"]),
        ]
        equal = [shell for shell in self.shells if isinstance(shell, TrimmedShell) and shell.made_equal]
        change = max((shell.change for shell in equal), default=0.0)
        if change >= 1e-9:
            same = counted(sum(shell.made_equal for shell in equal), "face")
            lines.append(f"axes and sizes of {same} made equal to others, by at most {change:.1g} mm")
        if deviation.max > self.tolerance:
            lines.append(f"the tolerance is missed, most at {shown_place(deviation.worst_place)}")
        if folded:
            lines.append(f"{folded} faces fold over themselves: do not mill or exchange this solid")
        if len(self.crossings):
            place = shown_place(self.crossings[0])
            lines.append(
                f"faces pass through each other, as at {place}: do not mill or exchange this solid; "
                "where walls of the mesh are thinner than the tolerance, give a smaller one"
            )
        lines += [text if text.startswith("not mended") else f"mended: {text}" for text in self.repairs]
        return "\n".join(lines)

    def _beside_mesh(self):
        deviation, points = self.deviation, self.control_point_count
        volume = enclosed_volume(self.vertices, self.triangles)
        # What rounding leaves differs between processors
        values = (deviation.max, deviation.mean, self.seam_angle)
        largest, mean, angle = ("below 1e-9" if value < 1e-9 else f"{value:.2g}" for value in values)
        return (
            f"control points {points} ({points / len(self.triangles):.2f} per triangle)",
            f"deviation: largest {largest} mm, mean {mean} mm, "
            f"{100 * deviation.fraction_within(self.tolerance):.2f} % within {self.tolerance:g} mm",
            f"angle between normals at smooth edges: largest {angle} degrees",
            f"volume {self.volume / volume:.5f} and area {self.area / self.mesh.area:.3f} of the mesh",
        )


@one_or_many(send=without_cache)
def reconstruct(mesh, *, tolerance, sharp_angle=30.0, faces="auto", max_faces=None) -> Reconstruction:
    """Rebuild a closed triangle mesh as solids bounded by NURBS faces.

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph, or a list of them
        Closed; small defects are mended and named in `Reconstruction.repairs`.
    tolerance : float
        Largest distance between mesh and faces in mm, measured both ways and everywhere.
    sharp_angle : float
        Edges that turn by more than this, in degrees, stay sharp and become edges of faces. The mesh must
        turn so within two tolerances on both sides, so noise and slivers make no sharp edges.
    faces : 'auto' or 'patches'
        Whether what lies on planes, cylinders, cones, spheres and tori gets exact faces on these, which needs
        the extra ``cad``; else all faces are fitted.
    max_faces : int, optional
        Of each shell. The best that was found within it is returned, whether or not it keeps the tolerance.
        By default 3,000 fitted faces, or as many as there are triangles: a solid with more is of no use.

    Returns
    -------
    Reconstruction
        Its `deviation` says what was reached; `within_tolerance` compares it. A list for a list of meshes.

    Raises
    ------
    ValueError
        If a number is not positive, if the tolerance exceeds the size of the mesh, if the mesh is not closed
        and cannot be mended, or if the coarsest shell exceeds a limit.

    Notes
    -----
    Where all vertices lie on planes and round surfaces, those become trimmed faces (`mesh.solid.regions`,
    `mesh.solid.exact`), if they keep the tolerance. Where only some do, and the rest meets them at sharp
    edges, the rest is fitted and its rim held on them. Every other closed surface of the mesh is divided into
    four-sided patches (`mesh.solid.layout`). Patches of degree 5 whose tangent planes agree along all smooth
    edges, ends included, form a linear space (`mesh.solid.space`), in which one sparse least-squares fit
    finds all of them together (`mesh.solid.fit`); it keeps the volume of the mesh. Where the measured
    deviation misses the tolerance, the patches are made smaller and the fit is done again
    (`mesh.solid.refine`). A polyhedron has flat faces, and so has a coarse mesh of which patches in about the
    number of its triangles do not keep the tolerance.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> ball = trimesh.creation.icosphere(subdivisions=4, radius=10.0)
    >>> result = nl.reconstruct(ball, tolerance=0.1)
    >>> len(result.shells), result.within_tolerance, result.to_mesh().is_watertight
    (1, True, True)
    """
    tolerance = as_positive("tolerance", tolerance)
    sharp_angle = as_number("sharp_angle", sharp_angle)
    if not 0.0 < sharp_angle < 180.0:
        raise ValueError(f"sharp_angle is {sharp_angle}; give degrees between 0 and 180")
    as_choice("faces", faces, ("auto", "patches"))
    most = np.inf if max_faces is None else as_count("max_faces", max_faces, most=np.inf)
    graph = mesh_graph(mesh)
    if tolerance > (size := extent(graph.vertices)):
        raise ValueError(f"tolerance = {tolerance:g} mm is larger than the mesh, {size:.3g} mm: check units")
    parts, repairs = closed_surfaces(graph)

    def best(part):
        # surfaces that meet at less than the sharp angle are told apart at a third of it
        ways = ((sharp_angle,), (sharp_angle / 3.0,), (sharp_angle, True)) if faces == "auto" else ()
        facets = facets_of(part) if ways else None
        exact = next(filter(None, (exact_shell(facets, tolerance, *way) for way in ways)), None)
        if exact and len(exact.shell.faces) <= most:
            return exact
        count = len(part.triangles)
        fitted = build(part, tolerance, sharp_angle, max_faces, count if ways and count <= most else np.inf)
        # the planes of so coarse a mesh that fewer patches do not keep the tolerance
        return fitted or exact_shell(facets, tolerance, 0.0) or build(part, tolerance, sharp_angle, max_faces)

    fits = over_slices(best, parts, "shells")
    shells = tuple(
        fit.shell
        if isinstance(fit, Measured)
        else Shell(tuple(map(patch, fit.patches.surfaces())), fit.patches, part.body, part.is_void)
        for fit, part in zip(fits, parts, strict=True)
    )
    seams = [
        angles[~shell.sharp if isinstance(shell, Shell) else angles <= SHARP].max(initial=0.0)
        for shell, angles in ((shell, shell.seam_angles()) for shell in shells)
    ]
    crossings = _crossings(parts, fits, shells, tolerance)
    deviation, seam = _together(parts, fits), float(max(seams))
    return Reconstruction(shells, tolerance, *joined(parts), repairs, deviation, seam, crossings)


def _crossings(parts, fits, shells, tolerance):
    """Middles of fine triangles of a body that others of it pass through, where the mesh has none."""
    out = [np.empty((0, 3))]
    for body in range(1 + max(part.body for part in parts)):
        mine = [k for k, part in enumerate(parts) if part.body == body]
        patches = [fits[k] for k in mine if isinstance(fits[k], Fitted)]
        sound = len(mine) == len(patches) == 1 and not patches[0].faulty.any()  # `build` has looked
        folded = any(fit.patches.flipped().any() for fit in patches)
        if sound or folded or any(parts[k].meets for k in mine):
            continue
        made = [(fits[k], shells[k]) for k in mine]
        fine = trimesh.util.concatenate(
            [a.fine if isinstance(a, Measured) else b.to_mesh(max(tolerance / 10, b.finest)) for a, b in made]
        )
        out.append(fine.triangles_center[crossing_triangles(fine.vertices, fine.faces) >= 0])
    return np.concatenate(out)


def _together(parts, fits):
    """The deviation of all shells, and of every vertex of the mended mesh."""
    to_surface = np.concatenate([fit.to_surface for fit in fits])
    to_mesh = np.concatenate([fit.to_mesh for fit in fits])
    points = [fit.mesh_points for fit in fits]
    own = [cKDTree(some).query(part.vertices)[1] for some, part in zip(points, parts, strict=True)]
    vertices = np.concatenate([fit.to_surface[rows] for fit, rows in zip(fits, own, strict=True)])
    return Deviation(
        np.concatenate([to_surface, to_mesh]),
        vertices,
        np.concatenate([*points, *(fit.surface_points for fit in fits)]),
    )
