"""Slicing in pictures: the contours of a layer, and the weighted graph (the paper's Figs. 1 and 2)."""

from string import ascii_uppercase

import numpy as np
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from nurbs_lab.nurbs.along import points_along
from nurbs_lab.plotting.style import BLACK, BLUE, GREY, MAGNITUDE, PALE, RED, canvas, equal_mm, takes_axes

BUBBLE = {"boxstyle": "circle,pad=0.3", "facecolor": "white", "edgecolor": BLUE}
LABEL = {"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"}


@takes_axes
def layer(layer, *, order=False, ax=None):
    """The contours of one layer: material filled, outlines blue, holes red, start and direction marked.

    Parameters
    ----------
    layer : Layer
    order : bool
        Colour the points in the order in which the traversal met them.
    """
    with canvas(6, 4.6, ax) as (figure, ax):
        loops = [c for c in layer.contours if c.closed]
        if loops:
            outline = Path.make_compound_path(*(Path(c.points[[*range(len(c.points)), 0]]) for c in loops))
            ax.add_patch(PathPatch(outline, facecolor=PALE, edgecolor="none", zorder=0))
        for contour in layer.contours:
            _contour(ax, contour, order)
        across, along, normal = _axis_names(layer)
        equal_mm(ax, (across, along))
        ax.autoscale_view()
        count, height = len(layer.contours), f"{layer.height:.4g}".replace("-", "−")
        ax.set_title(f"{normal} = {height} mm, {count} contour{'s' * (count != 1)}")
    return figure


def _axis_names(layer):
    """Names of the two directions of the plane and of its normal; a slanted one has letters of its own."""
    frame = layer.contours[0].frame if layer.contours else np.eye(3)
    return [
        "xyz"[row.argmax()] if np.count_nonzero(row) == 1 else name
        for row, name in zip(frame, "uvw", strict=True)
    ]


def _contour(ax, contour, order):
    points = contour.points
    path = np.vstack([points, points[:1]]) if contour.closed else points
    colour = RED if contour.is_hole else BLUE
    ax.plot(*path.T, color=GREY if order else colour, linestyle="-", linewidth=1.2)
    if order:
        ax.scatter(*points.T, c=np.arange(len(points)), cmap=MAGNITUDE, s=9, zorder=3)
    ax.plot(*points[0], "o", color=BLACK, markersize=5, zorder=4)
    tail, tip = points_along(path, contour.length * np.array([0.22, 0.24]))
    arrow = {"arrowstyle": "-|>", "color": BLACK if order else colour, "mutation_scale": 16}
    ax.annotate("", tip, tail, arrowprops=arrow)


def weighted_graph(graph):
    """The paper's Figs. 1 and 2 for a small closed mesh.

    Left the faces, unfolded around the last one, each corner with its number 0, 1 or 2 and each vertex with a
    letter; right an arrow from every face to each neighbour, with the weight of Eq. (1).

    Parameters
    ----------
    graph : MeshGraph

    Returns
    -------
    matplotlib Figure
    """
    count = len(graph.triangles)
    words = f"left, {count} faces unfolded, each corner numbered 0, 1 or 2; right, an arrow "
    words += "from every face to each neighbour, with its weight"
    with canvas(10, 4.6, columns=2, words=words) as (figure, (left, right)):
        flat = _unfold(graph, count - 1)
        _net(left, graph, flat, count - 1)
        _arrows(right, graph, flat, count - 1)
        for ax, title in ((left, "faces and their corner numbers"), (right, "weighted graph")):
            ax.set_title(title)
            ax.set_aspect("equal")
            ax.axis("off")
    return figure


def _net(ax, graph, flat, root):
    centre = flat[root].mean(axis=0)
    size = np.ptp(np.concatenate(list(flat.values())), axis=0).max()
    named = {}
    for face, corners in flat.items():
        middle = corners.mean(axis=0)
        ax.fill(*corners.T, facecolor=PALE, edgecolor=BLUE, linestyle="-", linewidth=1.6)
        ax.text(*middle, str(face), ha="center", va="center", fontsize=13, bbox=BUBBLE)
        for number, (corner, vertex) in enumerate(zip(corners, graph.triangles[face], strict=True)):
            spot = corner + 0.32 * (middle - corner)
            ax.text(*spot, f"$v_{number}$", ha="center", va="center", color=RED)
            named[(*np.round(corner / size, 6), vertex)] = corner
    for (*_, vertex), corner in named.items():
        out = corner - centre
        spot = corner + 0.06 * size * out / np.linalg.norm(out)
        ax.text(*spot, ascii_uppercase[vertex], ha="center", va="center", fontweight="bold", fontsize=13)
    ax.margins(0.1)


def _unfold(graph, root):
    """Corners in the plane of every face, each face laid beside the one from which it was reached."""
    flat = {root: _seen_from_outside(graph, root)}
    waiting = [root]
    while waiting:
        face = waiting.pop(0)
        for other in graph.neighbours[face]:
            if other < 0 or other in flat:
                continue
            shared = [i for i, v in enumerate(graph.triangles[face]) if v in graph.triangles[other]]
            at = dict(zip(graph.triangles[face][shared], flat[face][shared], strict=True))
            flat[int(other)] = _beside(graph, other, at, flat[face].mean(axis=0))
            waiting.append(int(other))
    return flat


def _seen_from_outside(graph, face):
    """Corners of a face in its plane, the z axis up and the inside of the mesh behind it."""
    corners = graph.vertices[graph.triangles[face]]
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal *= np.copysign(1.0, normal @ (corners.mean(axis=0) - graph.vertices.mean(axis=0)))
    normal /= np.linalg.norm(normal)
    upright = np.array([0.0, 0.0, 1.0] if abs(normal[2]) < 0.99 else [0.0, 1.0, 0.0])
    up = upright - (upright @ normal) * normal
    up /= np.linalg.norm(up)
    return corners @ np.column_stack([np.cross(up, normal), up])


def _beside(graph, face, at, away):
    """Corners of a face in the plane, on the other side of the common edge than its neighbour."""
    corners = graph.triangles[face]
    (free,) = (v for v in corners if v not in at)
    (p, q), (flat_p, flat_q) = list(at), list(at.values())
    edge = graph.vertices[q] - graph.vertices[p]
    offset = graph.vertices[free] - graph.vertices[p]
    x = offset @ edge / (edge @ edge)
    along = flat_q - flat_p
    up = np.array([-along[1], along[0]])
    up *= -np.sign(up @ (away - flat_p))
    y = np.sqrt(max(offset @ offset - x**2 * (edge @ edge), 0) / (edge @ edge))
    return np.array([at[v] if v in at else flat_p + x * along + y * up for v in corners])


def _arrows(ax, graph, flat, root):
    """An arrow from every face to its neighbours, between the places that the faces have in the net."""
    place = {face: corners.mean(axis=0) - flat[root].mean(axis=0) for face, corners in flat.items()}
    for face, (others, weights) in enumerate(zip(graph.neighbours, graph.weights, strict=True)):
        for other, weight in zip(others, weights, strict=True):
            if other < 0:
                continue
            start, end = place[face], place[int(other)]
            step = end - start
            arc = 0.2
            if root not in (face, other):  # both arrows keep clear of the middle
                outwards = np.sign(np.array([step[1], -step[0]]) @ (start + end))
                arc = outwards * (0.15 if face < other else 0.35)
            style = {
                "arrowstyle": "-|>", "color": BLUE, "mutation_scale": 14, "shrinkA": 17, "shrinkB": 17,
                "connectionstyle": f"arc3,rad={arc}", "linewidth": 1.4,
            }  # fmt: skip
            ax.annotate("", end, start, arrowprops=style)
            label = start + 0.5 * step + 0.5 * arc * np.array([step[1], -step[0]])
            ax.text(*label, str(weight), color=RED, ha="center", va="center", bbox=LABEL)
    for face, spot in place.items():
        ax.text(*spot, str(face), ha="center", va="center", fontsize=13, bbox=BUBBLE)
    ax.update_datalim([*place.values()])
    ax.margins(0.15, 0.25)
