"""How a plane cuts triangles, in space: the paper's Figs. 3 and 4 from data."""

import numpy as np
import pyvista as pv

from nurbs_lab.plotting.solids import MATERIAL
from nurbs_lab.plotting.stage import INK, frame, name_points, polylines, takes_stage
from nurbs_lab.plotting.style import BLUE, ORANGE, RED, SKY

THIN, THICK, DOT = 0.004, 0.009, 0.02  # radii of edges, of the cut and of its points, over the size


@takes_stage
def plane_and_triangle(graph, contour, *, at=0, stage=None, title=None):
    """The paper's Fig. 3 from data: a triangle Q1 Q2 Q3, the plane, and Qk where it cuts the edge Q1 Q2.

    Parameters
    ----------
    graph : MeshGraph
    contour : Contour
    at : int
        Which segment of the contour.
    """
    ends = _segment(contour, at)
    corners = graph.vertices[graph.triangles[contour.triangles[at]]]
    corners = np.roll(corners, -_edge_of(ends[0], corners), axis=0)  # the paper has Qk on the edge Q1 Q2
    name_points(stage, _outside(corners, corners, 0.1), ["Q₁", "Q₂", "Q₃"], BLUE)
    name_points(stage, _outside(ends, corners, 0.25), ["Qₖ", "Qₖ₊₁"], INK)
    return _framed(stage, title, corners[None], contour, ends)


@takes_stage
def repeating_node(graph, contour, *, at=0, stage=None, title=None):
    """The paper's Fig. 4 from data: two neighbouring triangles; the point on their common edge is met twice.

    Parameters
    ----------
    graph : MeshGraph
    contour : Contour
    at : int
        Which segment of the contour; the next one is drawn with it.
    """
    triangles = graph.vertices[graph.triangles[contour.triangles[[at, (at + 1) % len(contour.triangles)]]]]
    first, second = _segment(contour, at), _segment(contour, at + 1)
    left = 0.3 * np.ptp(first, axis=0).max() * _view(triangles)[1]  # half of a name
    name_points(stage, triangles.mean(axis=1) - left, ["first", "second"], BLUE)
    above = first[1] + [0.0, 0.0, 1.2 * (triangles[..., 2].max() - first[1, 2])]
    stage.add_mesh(polylines([np.array([first[1], above])]), color=INK, line_width=1)
    name_points(stage, above[None], ["  repeating node"], INK)
    return _framed(stage, title, triangles, contour, np.vstack([first, second[1:]]))


def _segment(contour, at):
    points = contour.points_3d
    return points[[at % len(points), (at + 1) % len(points)]]


def _edge_of(point, corners):
    """Number of the corner at which the edge of a triangle begins that a point lies on."""
    along = np.roll(corners, -1, axis=0) - corners
    off = np.linalg.norm(np.cross(point - corners, along), axis=1) / np.linalg.norm(along, axis=1)
    return int(off.argmin())


def _outside(points, corners, part):
    """Places for names beside points, away from their middle by a part of a triangle's size."""
    size, right = np.ptp(corners, axis=0).max(), _view(corners[None])[1]
    away = points - points.mean(axis=0)
    away *= size / np.linalg.norm(away, axis=1)[:, None]
    return points + part * away - 0.05 * size * right - [0.0, 0.0, 0.03 * size]  # by half a name


def _framed(stage, title, triangles, contour, cut):
    """The triangles, the plane behind and around them, the cut, and the directions of the axes."""
    corners = triangles.reshape(-1, 3)
    size = np.ptp(corners, axis=0).max()
    flat = corners @ contour.frame[:2].T
    low, high = flat.min(axis=0) - 0.15 * size, flat.max(axis=0) + 0.15 * size
    square = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    plane = square @ contour.frame[:2] + contour.height * contour.frame[2]
    order = np.arange(len(corners)).reshape(-1, 3)
    stage.add_mesh(pv.PolyData.from_regular_faces(corners, order), color=SKY, opacity=0.45, **MATERIAL)
    stage.add_mesh(pv.PolyData.from_regular_faces(plane, [range(4)]), color=ORANGE, opacity=0.3, **MATERIAL)
    for lines, colour, radius in ((triangles[:, [0, 1, 2, 0]], BLUE, THIN), ([cut], RED, THICK)):
        tubes = polylines(lines).tube(radius=radius * size).triangulate()
        stage.add_mesh(tubes, color=colour, **MATERIAL)
    dots = pv.PolyData(cut).glyph(geom=pv.Sphere(radius=DOT * size), orient=False, scale=False)
    stage.add_mesh(dots, color=RED, smooth_shading=True, **MATERIAL)
    length = float(f"{size / 4:.0e}")  # of the axes: one digit
    towards, right = _view(triangles)
    origin = plane[np.argmin(plane @ right)] - 1.6 * length * right  # left of everything
    tips = origin + length * np.eye(3)
    stage.add_mesh(polylines([np.array([origin, tip]) for tip in tips]), color=INK, line_width=2)
    name_points(stage, tips, ["x", "y", f"z, {length:g} mm"], INK)
    frame(stage, title=title, direction=towards)
    stage.camera.zoom(0.85)  # room for names
    return stage


def _view(triangles):
    """From where the triangles are seen, and what is to the right there."""
    facing = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]).sum(axis=0)
    turn = np.arctan2(facing[1], facing[0]) + 0.6
    return np.array([np.cos(turn), np.sin(turn), 0.4]), np.array([-np.sin(turn), np.cos(turn), 0.0])
