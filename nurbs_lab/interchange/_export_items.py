"""What an export was given, sorted by kind and made ready for other programs."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np

from nurbs_lab.common.checks import extent
from nurbs_lab.machining.program import Program
from nurbs_lab.nurbs import NurbsCurve, NurbsSurface
from nurbs_lab.nurbs.curve import CLOSED_WITHIN

_NAMES = {
    "curves": "a curve",
    "surfaces": "a surface",
    "solids": "a reconstruction",
    "paths": "a tool path",
    "programs": "a program",
}
_INSTEAD = {
    "curves": ".step .igs .3dm .json",
    "surfaces": ".step .igs .3dm .json .obj .stl",
    "solids": ".step .igs .3dm .json .obj .stl",
    "paths": ".ngc .csv",
    "programs": ".ngc",
}


@runtime_checkable
class Solids(Protocol):
    """What a `Reconstruction` is to an export."""

    surfaces: Sequence
    bodies: Sequence


@runtime_checkable
class Samples(Protocol):
    """What a `ToolPath` is to an export."""

    t: np.ndarray
    u: np.ndarray
    points: np.ndarray


@dataclass
class Parts:
    """Curves, surfaces, reconstructions, tool paths and programs, in the order given."""

    curves: list = field(default_factory=list)
    surfaces: list = field(default_factory=list)
    solids: list = field(default_factory=list)
    paths: list = field(default_factory=list)
    programs: list = field(default_factory=list)

    @property
    def all_surfaces(self):
        """The surfaces, and those of the reconstructions."""
        return [*self.surfaces, *(s for solid in self.solids for s in solid.surfaces)]

    def require(self, suffix, holds):
        """Refuse what a format cannot hold."""
        for kind, name in _NAMES.items():
            if getattr(self, kind) and kind not in holds:
                raise ValueError(f"a {suffix} file cannot hold {name}; write it to {_INSTEAD[kind]}")


def gather(items):
    """Sort the items of an export by what they are."""
    parts = Parts()
    for item in _flat(items):
        if isinstance(item, NurbsCurve):
            parts.curves.append(item)
        elif isinstance(item, NurbsSurface):
            parts.surfaces.append(item)
        elif isinstance(item, Solids):
            parts.solids.append(item)
        elif isinstance(item, Samples):
            parts.paths.append(item)
        elif isinstance(item, Program):
            parts.programs.append(item)
        else:
            raise TypeError(
                "items must be NurbsCurve, NurbsSurface, Reconstruction, ToolPath or Program, "
                f"got {type(item).__name__}"
            )
    if not (parts.curves or parts.all_surfaces or parts.paths or parts.programs):
        raise ValueError(
            "items: nothing to write; give a curve, a surface, a reconstruction, a tool path or a program"
        )
    return parts


def _flat(items):
    for item in items:
        if isinstance(item, (list, tuple)):
            yield from _flat(item)
        else:
            yield item


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
    if isinstance(shape, NurbsSurface):
        return NurbsSurface(shape.degrees, shape.knots, points, weights)
    return NurbsCurve(shape.degree, shape.knots, points, weights)


def in_space(points):
    """Control points with three coordinates; plane ones lie at z = 0."""
    dim = points.shape[-1]
    if dim not in (2, 3):
        raise ValueError(f"only shapes in 2 or 3 dimensions can be exported, got {dim}")
    return points if dim == 3 else np.concatenate([points, np.zeros((*points.shape[:-1], 1))], axis=-1)
