"""Solids between sections: a skinned tube and its two caps (paper 2.3)."""

import numpy as np

from nurbs_lab.common.checks import as_flag, extent
from nurbs_lab.mesh.core import enclosed_volume
from nurbs_lab.mesh.distance import Deviation, crossing_triangles
from nurbs_lab.mesh.repair import NO_VOLUME
from nurbs_lab.mesh.slicing.contours import Layer
from nurbs_lab.mesh.solid.reconstruction import Reconstruction
from nurbs_lab.mesh.solid.trimmed import TrimmedShell, unit_of
from nurbs_lab.nurbs.skin import skin as skin_surface

_FINE = 2e-3  # of the size: tolerance of the triangles that stand for the solid


def skin(curves_or_contours, degrees=None, *, samples=None, closed=False, capped=False):
    """The surface through sections, or with ``capped`` the closed solid between the first and the last.

    Parameters
    ----------
    curves_or_contours, degrees, samples, closed
        As of `nurbs_lab.nurbs.skin`; a layer with one contour stands for this.
    capped : bool
        Close the tube by plane faces in its end sections, which have to be closed and plane. Needs the extra
        ``cad``.

    Returns
    -------
    NurbsSurface, or Reconstruction of one shell: the tube, a 'patch' between corners, and two planes.

    Raises
    ------
    ValueError
        If ``capped`` sections are open, are no plane curves at the ends, enclose no volume, or cross.

    Examples
    --------
    >>> import numpy as np
    >>> import nurbs_lab as nl
    >>> angle = np.linspace(0.0, 2.0 * np.pi, 65)
    >>> rings = [np.column_stack([np.cos(angle), np.sin(angle), 0 * angle + z]) for z in range(5)]
    >>> solid = nl.skin(rings, capped=True)
    >>> [face.kind for face in solid.faces], round(solid.volume / (4 * np.pi), 3)
    (['patch', 'plane', 'plane'], 1.0)
    """
    sections = curves_or_contours
    if isinstance(sections, (list, tuple)):
        sections = [_contour(i, one) if isinstance(one, Layer) else one for i, one in enumerate(sections)]
    tube = skin_surface(sections, degrees, samples=samples, closed=closed)
    if not as_flag("capped", capped):
        return tube
    if not tube.closed[0] or tube.closed[1]:
        raise ValueError(
            "capped needs closed sections, whose last point is the first one again, and closed=False; "
            "leave it out for a surface"
        )
    from nurbs_lab.mesh.solid import opencascade as oc

    size = extent(tube.control_points)
    unit = unit_of(size)
    shell = TrimmedShell.of(oc.capped_tube(tube.transform(np.eye(3) / unit)), unit, 0, False)
    mesh = _uncrossed(shell, size)
    none, nowhere = np.empty(0), np.empty((0, 3))  # there is no mesh to measure from
    unmeasured = Deviation(none, none, nowhere)
    return Reconstruction((shell,), _FINE * size, mesh.vertices, mesh.faces, (), unmeasured, 0.0, nowhere)


def _uncrossed(shell, size):
    """Triangles of a shell that does not pass through itself; where it does, a face may have none."""
    crossing = ValueError(
        "capped: the tube passes through itself or through its caps; give sections that do not cross "
        "themselves or each other, in the order of their heights"
    )
    try:
        mesh = shell.to_mesh(_FINE * size)
    except ValueError:
        raise crossing from None
    if not enclosed_volume(mesh.vertices, mesh.faces) > NO_VOLUME * size**3:
        raise ValueError("capped: the solid encloses no volume; give sections at different heights")
    if (crossing_triangles(mesh.vertices, mesh.faces) >= 0).any():
        raise crossing
    return mesh


def _contour(number, layer):
    if len(layer.contours) != 1:
        raise ValueError(
            f"curves_or_contours[{number}] has {len(layer.contours)} contours; give layers of a part without "
            "branches and holes, or the contours that belong together"
        )
    return layer.contours[0]
