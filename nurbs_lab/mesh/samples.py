"""Real meshes that every installation already has: they come with PyVista's wheel, nothing is downloaded.

The frog is a volume of tissue labels, 500 x 470 x 136 voxels (spacing 1, 1, 1.5), from the Whole Frog Project
of the Lawrence Berkeley National Laboratory. Its label numbers are those of VTK's frog example.
"""

import numpy as np
import trimesh
from scipy.ndimage import gaussian_filter

_BLUR_MM = 2.0  # standard deviation of the filter that removes the stairs of the voxels

FROG_ORGANS = {
    1: "blood",
    2: "brain",
    3: "duodenum",
    4: "eye_retina",
    5: "eye_white",
    6: "heart",
    7: "ileum",
    8: "kidney",
    9: "l_intestine",
    10: "liver",
    11: "lung",
    12: "nerve",
    13: "skeleton",
    14: "spleen",
    15: "stomach",
}


def frog_organ(label=5, *, largest=True) -> trimesh.Trimesh:
    """One organ of the frog as a smooth closed mesh, outward normals, in voxels of the volume (taken as mm).

    The mask of the label is smoothed by a Gaussian filter of 2 mm, which removes the stairs of the voxels,
    and contoured at 0.5; the largest part is kept.

    Parameters
    ----------
    label : int or str
        Number or name in `FROG_ORGANS`. Labels 5 and 14 have the topology of a sphere.
    largest : bool
        Keep only the largest connected part.

    Raises
    ------
    ValueError
        If there is no such organ.
    """
    number = {name: number for number, name in FROG_ORGANS.items()}.get(label, label)
    if number not in FROG_ORGANS:
        known = ", ".join(f"{number} {name}" for number, name in FROG_ORGANS.items())
        raise ValueError(f"label {label!r} is no organ of the frog; it has {known}")
    mesh = _frog(lambda labels: labels == number, largest)
    mesh.metadata["name"] = FROG_ORGANS[number]
    return mesh


def whole_frog() -> trimesh.Trimesh:
    """All tissues of the frog together: about 1.5 million triangles in hundreds of bodies."""
    mesh = _frog(lambda labels: labels > 0, largest=False)
    mesh.metadata["name"] = "frog"
    return mesh


def ant() -> trimesh.Trimesh:
    """A closed mesh with six legs and two feelers."""
    return _example("antfile")


def nut() -> trimesh.Trimesh:
    """A hexagonal nut: a closed mesh with one hole."""
    return _example("nutfile")


def airplane() -> trimesh.Trimesh:
    """An open mesh of several parts."""
    return _example("planefile")


def _frog(chosen, largest):
    import pyvista
    from pyvista import examples

    volume = pyvista.read(examples.frogtissuesfile)
    margin = int(np.ceil(4 * _BLUR_MM))  # a bone meets the border
    inside = np.pad(chosen(volume.active_scalars).reshape(volume.dimensions, order="F"), margin)
    spacing = np.array(volume.spacing)
    blurred = gaussian_filter(inside.astype(np.float32), _BLUR_MM / spacing, truncate=3.0)
    origin = np.array(volume.origin) - margin * spacing
    grid = pyvista.ImageData(dimensions=blurred.shape, spacing=volume.spacing, origin=origin)
    grid["inside"] = blurred.ravel(order="F")
    surface = grid.contour([0.5], scalars="inside")
    if largest:
        surface = surface.connectivity("largest").extract_surface(algorithm=None)
    return _trimesh_of(surface.triangulate())


def _example(name):
    import pyvista
    from pyvista import examples

    return _trimesh_of(pyvista.read(getattr(examples, name)).triangulate())


def _trimesh_of(surface):
    mesh = trimesh.Trimesh(np.asarray(surface.points), surface.regular_faces, process=False)
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh
