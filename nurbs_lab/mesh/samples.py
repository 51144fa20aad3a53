"""Real meshes that every installation already has: they come with PyVista's wheel, nothing is downloaded.

The frog is a volume of tissue labels, 500 x 470 x 136 voxels (spacing 1, 1, 1.5), from the Whole Frog Project
of the Lawrence Berkeley National Laboratory. Its label numbers are those of VTK's frog example.
"""

import numpy as np
import trimesh
from scipy.ndimage import find_objects, gaussian_filter

from nurbs_lab.common.checks import as_positive

FROG_ORGANS = dict(enumerate((
    "blood", "brain", "duodenum", "eye_retina", "eye_white", "heart", "ileum", "kidney", "l_intestine",
    "liver", "lung", "nerve", "skeleton", "spleen", "stomach",
), 1))  # fmt: skip


def frog_organ(label=5, *, blur_mm=None) -> trimesh.Trimesh:
    """One organ of the frog as a smooth closed mesh, outward normals, in voxels of the volume (taken as mm).

    The mask of the label is contoured at 0.5, and the largest part is kept.

    Parameters
    ----------
    label : int or str
        Number or name in `FROG_ORGANS`. Labels 5 and 14 have the topology of a sphere.
    blur_mm : float, optional
        Standard deviation of a Gaussian filter that smooths the mask before it is contoured; about 2 mm
        removes the stairs of the voxels. Without it Taubin's filter smooths the triangles and keeps the
        stairs as ripples.

    Raises
    ------
    ValueError
        If there is no such organ, or ``blur_mm`` is not positive.
    """
    number = {name: number for number, name in FROG_ORGANS.items()}.get(label, label)
    if number not in FROG_ORGANS:
        known = ", ".join(f"{number} {name}" for number, name in FROG_ORGANS.items())
        raise ValueError(f"label {label!r} is no organ of the frog; it has {known}")
    blur_mm = None if blur_mm is None else as_positive("blur_mm", blur_mm)
    mesh = _frog(lambda labels: labels == number, True, blur_mm)
    mesh.metadata["name"] = FROG_ORGANS[number]
    return mesh


def frog_thigh_bone() -> trimesh.Trimesh:
    """A thigh bone of the frog, upright along z, knee up: a smooth closed mesh of 7,984 triangles.

    The skeleton fuses the thigh bone and the pelvis, so the bone is cut off below the hip. The mask is
    smoothed by a Gaussian filter of 2 mm and contoured on a grid of 2 mm.
    """
    volume = _volume()
    bone = (volume.active_scalars == 13).reshape(volume.dimensions, order="F")[128:206, 45:207, 60:]
    inside = gaussian_filter(np.pad(bone, 9).astype(np.float32), 2.0 / np.array(volume.spacing), truncate=4.0)
    mesh = _trimesh_of(_contoured(inside[::2, ::2], (2.0, 2.0, 1.5), (0.0, 0.0, 0.0), largest=True))
    up = np.array([0.41, -0.91, -0.06])  # from the hip to the knee
    up /= np.linalg.norm(up)
    side = np.cross([0.0, 0.0, 1.0], up)
    side /= np.linalg.norm(side)
    upright = np.eye(4)
    upright[:3, :3] = np.vstack([np.cross(side, up), side, up])
    mesh.apply_transform(upright)
    mesh.apply_translation(-np.append(mesh.bounds.mean(axis=0)[:2], mesh.bounds[0, 2]))
    mesh.metadata["name"] = "thigh_bone"
    return mesh


def whole_frog() -> trimesh.Trimesh:
    """All tissues of the frog together: about 1.5 million triangles in hundreds of bodies."""
    mesh = _frog(lambda labels: labels > 0, False, None)
    mesh.metadata["name"] = "frog"
    return mesh


def ant() -> trimesh.Trimesh:
    """A closed mesh with six legs and two feelers."""
    return _example("antfile")


def nut() -> trimesh.Trimesh:
    """An octagonal nut: a closed mesh with one hole."""
    return _example("nutfile")


def airplane() -> trimesh.Trimesh:
    """An open mesh of several parts."""
    return _example("planefile")


def _frog(chosen, largest, blur_mm):
    volume = _volume()
    spacing = np.array(volume.spacing)
    margin = 1 if blur_mm is None else int(np.ceil(4 * blur_mm))  # a bone meets the border
    inside = chosen(volume.active_scalars).reshape(volume.dimensions, order="F")
    (box,) = find_objects(inside.view(np.int8))  # the rest of the volume is empty, and most of the work
    inside = np.pad(inside[box], margin).astype(np.float32)
    if blur_mm is not None:
        inside = gaussian_filter(inside, blur_mm / spacing, truncate=3.0)
    start = volume.origin + (np.array([side.start for side in box]) - margin) * spacing
    surface = _contoured(inside, spacing, start, largest)
    return _trimesh_of(surface.smooth_taubin() if blur_mm is None else surface)


def _volume():
    import pyvista
    from pyvista import examples

    return pyvista.read(examples.frogtissuesfile)


def _contoured(inside, spacing, origin, largest):
    """The surface at 0.5 of a field on a grid, as triangles of PyVista."""
    import pyvista

    grid = pyvista.ImageData(dimensions=inside.shape, spacing=spacing, origin=origin)
    grid["inside"] = inside.ravel(order="F")
    surface = grid.contour([0.5], scalars="inside")
    if largest:
        surface = surface.connectivity("largest").extract_surface(algorithm=None)
    return surface.triangulate()


def _example(name):
    import pyvista
    from pyvista import examples

    return _trimesh_of(pyvista.read(getattr(examples, name)).triangulate())


def _trimesh_of(surface):
    mesh = trimesh.Trimesh(np.asarray(surface.points), surface.regular_faces, process=False)
    if mesh.volume < 0.0:
        mesh.invert()
    return mesh
