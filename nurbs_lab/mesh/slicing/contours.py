"""Ordered contours of a triangle mesh by traversal of its weighted graph (paper, section 2.1).

One rule decides every degenerate case, without a tolerance: a vertex *on* a plane counts as above it. So

- a plane through a flat top face gives the outline of that face;
- a plane through a flat bottom face gives nothing there;
- a plane through a vertex or an edge gives the contours of the plane just below it, equal points merged;
- a plane that touches a tip or a ridge from below or above gives no contour there (`Layer.collapsed`);
- two contours that meet in a point (a saddle) stay two contours.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from nurbs_lab.common.checks import as_floats, shown
from nurbs_lab.common.threads import even_slices, over_slices
from nurbs_lab.common.values import Value
from nurbs_lab.mesh.slicing import _kernels

_MANY = 20_000  # crossed triangles; fewer are not worth a second thread


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Contour(Value):
    """One ordered polyline of one cutting plane.

    Attributes
    ----------
    points : (n, 2) array
        In the plane. A closed contour does not repeat its first point. The material is on the left: outlines
        run counter-clockwise, holes clockwise. A loop starts at its least point (x, then y).
    closed : bool
        False for a contour that runs from one open edge of the mesh to another.
    triangles : (n,) or (n - 1,) array
        ``triangles[i]`` carries the segment that starts at ``points[i]``.
    height : float
        Height of the plane along the axis.
    depth : int
        How many contours of the layer surround this one; odd means that it bounds a hole.
    parent : int
        Index within the layer of the closest surrounding contour, -1 for none.
    area : float
        Enclosed area, negative for a hole, 0 for an open contour.
    frame : (3, 3) array
        Rows: the two directions of the plane and its normal.
    """

    points: np.ndarray
    closed: bool
    triangles: np.ndarray
    height: float
    depth: int
    parent: int
    area: float
    frame: np.ndarray

    @property
    def is_hole(self) -> bool:
        """Whether the inside of this contour is empty space."""
        return self.depth % 2 == 1

    @property
    def points_3d(self) -> np.ndarray:
        """The points where they lie in space, ``(n, 3)``."""
        return self.points @ self.frame[:2] + self.height * self.frame[2]

    @property
    def ring_3d(self) -> np.ndarray:
        """The same, and of a closed contour the first point again."""
        return np.concatenate([self.points_3d, self.points_3d[: int(self.closed)]])

    @property
    def length(self) -> float:
        """Length of the polyline, closing segment included."""
        ends = np.roll(self.points, -1, axis=0) if self.closed else self.points[1:]
        return float(np.hypot(*(ends - self.points[: len(ends)]).T).sum())


@dataclass(frozen=True, eq=False, repr=False, slots=True)
class Layer(Value):
    """All contours of one plane, closed ones first, from the largest area to the smallest.

    Attributes
    ----------
    height : float
        Height of the plane along the axis.
    contours : tuple of Contour
    open_ends : int
        Ends of contours that meet no other: 0 on a closed mesh.
    collapsed : int
        Contours left out because they shrank to a point or to one edge: the plane touches a tip or a ridge.
    """

    height: float
    contours: tuple[Contour, ...]
    open_ends: int
    collapsed: int

    @property
    def area(self) -> float:
        """Area of the material: outlines less holes."""
        return sum(contour.area for contour in self.contours)


def axis_frame(axis) -> np.ndarray:
    """Right-handed frame ``(3, 3)``: two rows that span the planes, then the unit normal along ``axis``."""
    named = dict(zip("xyz", np.eye(3), strict=True))
    normal = named.get(axis) if isinstance(axis, str) else as_floats("axis", axis)
    if normal is None or normal.shape != (3,) or not normal.any():
        raise ValueError(f"axis is {shown(axis)}; give 'x', 'y', 'z' or a direction of three numbers")
    normal = normal / np.abs(normal).max()
    normal /= np.linalg.norm(normal)
    if np.count_nonzero(normal) == 1 and normal.max() > 0:
        frame = np.roll(np.eye(3), 2 - normal.argmax(), axis=0)
    else:
        first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        first /= np.linalg.norm(first)
        frame = np.array([first, np.cross(normal, first), normal])
    frame.setflags(write=False)
    return frame


def in_frame(vertices, frame) -> np.ndarray:
    """Coordinates ``(n, 3)`` along the rows of a frame; exact for planes across a coordinate axis."""
    if np.array_equal(frame, np.eye(3)):
        return vertices
    if np.count_nonzero(frame) == 3:
        turned = np.ascontiguousarray(vertices[:, np.abs(frame).argmax(axis=1)] * frame.sum(axis=1))
    else:  # row by row, so that a vertex gets the same bits in any array
        turned = sum(vertices[:, [d]] * frame[:, d] for d in range(3))
    turned.setflags(write=False)  # as the vertices of a graph: one type for the kernels to be compiled for
    return turned


def layers_of(graph, heights, frame, fill) -> list[Layer]:
    """Layers of planes in rising order."""
    xyz = in_frame(graph.vertices, frame)
    offsets, crossing = _crossings(graph, xyz[:, 2], heights)
    parts = even_slices(offsets) if len(crossing) > _MANY else [slice(0, len(heights))]
    has_ends = not graph.closed

    def cut(part):
        begins = offsets[part.start : part.stop + 1]
        mine, begins = crossing[begins[0] : begins[-1]], begins - begins[0]
        walked = _kernels.walk(graph.triangles, graph.opposite, xyz, heights[part], begins, mine, has_ends)
        return _layers_of_planes(walked, heights[part], frame, fill == "nonzero")

    return list(itertools.chain.from_iterable(over_slices(cut, parts, "slicing")))


def _crossings(graph, z, heights):
    """Where the triangles of each plane begin and end, and these triangles."""
    level = np.empty(len(z), np.int32)
    _kernels.vertex_levels(z, heights, level)
    crossed, many = _kernels.count_crossings(graph.triangles, graph.junk, level, len(heights))
    offsets = np.concatenate([[0], np.cumsum(many)])
    crossing = np.empty(offsets[-1], np.int32)
    _kernels.place_crossings(graph.triangles, crossed, level, offsets[:-1].copy(), crossing)
    return offsets, crossing


def _layers_of_planes(walked, heights, frame, nonzero):
    points, carriers, begins, plane, closed, collapsed = walked
    area, depth, parent, left_out = _kernels.nest(points, begins, plane, closed, nonzero)
    turned = closed & (area != 0.0) & ((area > 0.0) == (depth % 2 == 1))
    for c in np.flatnonzero(turned):  # so that the material is on their left
        a, b = begins[c], begins[c + 1]
        points[a + 1 : b] = points[a + 1 : b][::-1]
        carriers[a:b] = carriers[a:b][::-1]
    area[turned] *= -1.0

    start = points[begins[:-1]]
    order = np.lexsort((start[:, 1], start[:, 0], -np.abs(area), ~closed, left_out, plane))
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    first = np.searchsorted(plane, np.arange(len(heights) + 1))
    kept = first[1:] - np.bincount(plane[left_out], minlength=len(heights))
    parent = np.where(parent < 0, -1, rank[parent] - first[plane])
    columns = begins[:-1], begins[1:], closed, depth, parent, area
    rows = list(zip(*(column[order].tolist() for column in columns), strict=True))
    return [
        Layer(
            height,
            tuple(
                Contour(points[a:b], loop, carriers[a : b if loop else b - 1], height, *known, frame)
                for a, b, loop, *known in rows[first[k] : kept[k]]
            ),
            open_ends=2 * int(np.count_nonzero(~closed[first[k] : first[k + 1]])),
            collapsed=int(collapsed[k]),
        )
        for k, height in enumerate(heights.tolist())
    ]
