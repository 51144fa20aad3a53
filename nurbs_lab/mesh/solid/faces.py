"""A face of a solid: a surface and the loops of curves that bound it; what kinds of faces a solid has."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.values import Value
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface

ALONG = 33  # places along an edge, as of a mesh before its halves become edges of faces
#: Kinds of exact faces, simplest first, and their names when there are several; then fitted ones.
KINDS = {
    "plane": "planes",
    "cylinder": "cylinders",
    "cone": "cones",
    "sphere": "spheres",
    "torus": "tori",
    "patch": "patches",
}


@dataclass(frozen=True, eq=False, repr=False)
class Face(Value):
    """A part of a surface, bounded by closed loops of curves.

    Attributes
    ----------
    kind : str
        'plane', 'cylinder', 'cone', 'sphere', 'torus', or 'patch' for any other surface.
    surface : NurbsSurface
        The exact surface, rational for round kinds, at least as large as the face.
    loops : tuple of tuples of NurbsCurve
        Closed loops of curves in space, the outer one first, each counter-clockwise as seen from outside.
        A face without a rim, such as a whole sphere, has none. A cylinder has two, neither of them outer.
    outward : bool
        Whether the normal of the surface points out of the material.
    point : (3,) array or None
        A point of the plane, the apex of a cone, the centre of a sphere or torus, a point of the axis of a
        cylinder, mm. None for a patch.
    axis : (3,) array or None
        Unit normal of a plane, direction of the axis of the other kinds; None for spheres and patches.
    radius : float or None
        Of a cylinder or a sphere, and of the tube of a torus, mm.
    major_radius : float or None
        From the centre of a torus to the middle of its tube, mm.
    half_angle : float or None
        Of a cone, degrees.
    """

    kind: str
    surface: NurbsSurface
    loops: tuple[tuple[NurbsCurve, ...], ...]
    outward: bool = True
    point: np.ndarray | None = None
    axis: np.ndarray | None = None
    radius: float | None = None
    major_radius: float | None = None
    half_angle: float | None = None

    def __post_init__(self):
        super().__post_init__()
        if self.kind not in KINDS:
            raise ValueError(f"kind is {self.kind!r}; give one of {', '.join(KINDS)}")


def patch(surface: NurbsSurface) -> Face:
    """An untrimmed surface as a face: its loop is its four sides, v = 0, u = 1, v = 1 and u = 0."""
    (left, right), (low, high) = surface.domain
    there = surface.iso_curve(v=low), surface.iso_curve(u=right)
    back = surface.iso_curve(v=high).reverse(), surface.iso_curve(u=left).reverse()
    return Face("patch", surface, ((*there, *back),))


def kinds_of_faces(faces) -> str:
    """Numbers and sizes of the faces in a line: '6 planes, 4 cylinders of 8 mm, 1 cylinder of 9 mm'."""
    counts = Counter()
    for face in faces:
        size = "" if face.radius is None else f"{face.radius:.4g} mm"
        if face.kind == "torus":
            size = f"{face.major_radius:.4g} and {size}"
        counts[face.kind, f"{face.half_angle:.4g} degrees" if face.kind == "cone" else size] += 1
    order = sorted(counts.items(), key=lambda item: (list(KINDS).index(item[0][0]), -item[1], item[0][1]))
    return ", ".join(
        f"{count} {KINDS[kind] if count > 1 else kind}{f' of {size}' * bool(size)}"
        for (kind, size), count in order
    )
