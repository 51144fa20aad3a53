"""The items of an export, sorted by kind and made ready for other programs."""

import warnings

import numpy as np

from nurbs_lab.common.checks import extent
from nurbs_lab.machining.program import Program
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface
from nurbs_lab.nurbs.curve import CLOSED_WITHIN

#: Suffixes of programs: what is in them does not depend on the suffix, but a ``.h`` is one of Heidenhain's.
PROGRAMS = ".ngc", ".nc", ".mpf", ".h", ".gcode", ".tap", ".cnc", ".spf", ".min", ".eia", ".gco"
_CAD, _MESHES = ".step .stp .igs .iges .json", ".obj .stl"
#: Kind -> its name, the formats that hold it, and its class or the attributes that tell it.
_KINDS = {
    "curves": ("a curve", f"{_CAD} .ngc", NurbsCurve),
    "surfaces": ("a surface", f"{_CAD} {_MESHES}", NurbsSurface),
    "solids": ("a reconstruction", f"{_CAD} {_MESHES}", ("surfaces", "bodies")),
    "paths": ("a tool path", ".ngc .csv", ("t", "u", "points")),
    "programs": ("a program", ".ngc", Program),
}


class Parts:
    """The lists ``curves``, ``surfaces``, ``solids``, ``paths`` and ``programs``, in the order given."""

    def __init__(self, items):
        for kind in _KINDS:
            setattr(self, kind, [])
        for item in _flat(items):
            getattr(self, _kind_of(item)).append(item)
        if not any(getattr(self, kind) for kind in _KINDS):
            raise ValueError("items: nothing to write; give a curve, a surface, a solid, a path or a program")

    def require(self, suffix):
        """Refuse what a format cannot hold, and warn of faces that fold or cross."""
        for kind, (name, formats, _) in _KINDS.items():
            if getattr(self, kind) and (".ngc" if suffix in PROGRAMS else suffix) not in formats.split():
                raise ValueError(f"items: a {suffix} file cannot hold {name}; write it to {formats}")
        dims = {shape.dim for shape in (*self.curves, *self.surfaces)}
        if not dims <= {2, 3} and suffix not in (".json", *PROGRAMS):
            raise ValueError(f"items: only shapes in 2 or 3 dimensions can be exported, got {max(dims)}")
        folded = sum(solid.folded_faces for solid in self.solids)
        crossings = sum(len(solid.crossings) for solid in self.solids)
        for found, fault in (folded, f"{folded} faces of a reconstruction fold"), (crossings, "faces cross"):
            if found:
                warnings.warn(f"items: {fault}; do not use the file", stacklevel=3)


def _kind_of(item):
    for kind, (_, _, told) in _KINDS.items():
        if all(hasattr(item, name) for name in told) if isinstance(told, tuple) else isinstance(item, told):
            return kind
    kinds = "NurbsCurve, NurbsSurface, Reconstruction, ToolPath or Program"
    cure = "nurbs_lab.smooth makes a curve of points, such as the ring_3d of a contour"
    if hasattr(item, "faces") or hasattr(item, "geometry"):
        cure = "a mesh writes itself by its export or save, and nurbs_lab.reconstruct makes a solid of it"
    raise TypeError(f"items must be {kinds}, got {type(item).__name__}; {cure}")


def _flat(items, around=()):
    """The items, and those of lists."""
    if any(items is one for one in around):
        raise ValueError("items: a list holds itself; give what it holds beside that")
    for item in items:
        yield from _flat(item, (*around, items)) if isinstance(item, (list, tuple)) else [item]


def clamped(shape):
    """The same shape with end knots of full multiplicity; a closed one ends exactly where it starts.

    Only what rounding parted is made equal: a closed rational shape may well have another weight at its end.
    """
    shape = shape.clamped()
    points, weights = shape.control_points.copy(), shape.weights.copy()
    closed = shape.closed if isinstance(shape, NurbsSurface) else (shape.closed,)
    for axis in np.flatnonzero(closed):
        for array, size in ((points, extent(points)), (weights, weights.max())):
            along = np.moveaxis(array, axis, 0)
            near = np.abs(along[-1] - along[0]) <= CLOSED_WITHIN * size
            along[-1] = np.where(near, along[0], along[-1])
    degree = shape.degrees if isinstance(shape, NurbsSurface) else shape.degree
    return type(shape)(degree, shape.knots, points, weights)
