"""From any triangles to closed surfaces: small defects are mended and named, the others refused."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import trimesh
from scipy.spatial import cKDTree

from nurbs_lab.common.checks import counted, extent, shown_place
from nurbs_lab.mesh._kernels_core import AGAINST, BOUNDARY, MANY, rims
from nurbs_lab.mesh.core import (
    bodies_of,
    components,
    edges_and_ways,
    enclosed_volume,
    face_normals,
    fans,
    linked,
    mesh_graph,
    opposite_of,
    tails_and_heads,
    unit,
    vertex_normals,
)  # fmt: skip
from nurbs_lab.mesh.distance import crossing_triangles

_NEAR = 0.01  # of the shortest edge beside them: open vertices nearer than this are one
_TOUCHING = 1e-6  # of the size: vertices nearer to edges divide them; surfaces that cross by less only touch
_PINHOLE = 0.03  # of the size: holes with a diameter up to this are filled, and all of three or four edges
NO_VOLUME = 1e-12  # of the cube of the size
#: Corners of the triangles that fill a hole of so many edges, in each way, and the triangle at every edge.
_SPLITS = {
    3: [([[0, 1, 2]], [0, 0, 0])],
    4: [([[0, 1, 2], [2, 3, 0]], [0, 0, 1, 1]), ([[1, 2, 3], [3, 0, 1]], [1, 0, 0, 1])],
}


@dataclass(frozen=True, eq=False)
class ClosedSurface:
    """One closed surface: ``vertices (n, 3)``, and ``triangles (m, 3)`` wound away from the material.

    Every edge has two triangles. ``body`` numbers the solid that it bounds, and ``is_void`` says whether it
    is one of its voids; their ``volume`` is negative. ``meets`` says whether it crosses or touches itself or
    another surface of its body.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    body: int
    is_void: bool
    volume: float
    meets: bool = False


def repair_mesh(mesh):
    """The closed surfaces of a damaged mesh as one mesh, such as `reconstruct` works on.

    Parameters
    ----------
    mesh : trimesh.Trimesh, pyvista.PolyData, file name or MeshGraph

    Returns
    -------
    trimesh.Trimesh
        Wound away from the material. Its ``metadata["repairs"]`` says what was mended, and what was not.

    Raises
    ------
    ValueError
        If a hole is too large to be filled, or the mesh encloses nothing; the message says where.

    Examples
    --------
    >>> import trimesh
    >>> import nurbs_lab as nl
    >>> box = trimesh.creation.box()
    >>> torn = trimesh.Trimesh(box.vertices, box.faces[1:])
    >>> whole = nl.mesh.repair_mesh(torn)
    >>> whole.is_watertight, whole.metadata["repairs"]
    (True, ('1 pinhole filled',))
    """
    surfaces, repairs = closed_surfaces(mesh_graph(mesh))
    return trimesh.Trimesh(*joined(surfaces), process=False, metadata={"repairs": repairs})


def closed_surfaces(graph) -> tuple[list[ClosedSurface], tuple[str, ...]]:
    """The closed surfaces of a `MeshGraph`, and what was mended or is still wrong.

    Bodies that touch in a face, an edge or a vertex come apart; where a body touches itself along an edge,
    its triangles there are divided. Surfaces that cross, and bodies inside one another, are named and stay.

    Raises
    ------
    ValueError
        If the mesh has holes or edges with more than two triangles that are too large to mend; the message
        says how many and where. If it encloses nothing.
    """
    repairs = []
    size = extent(graph.vertices[graph.triangles])
    if not size > 1e-90:
        raise ValueError(f"mesh has a size of {size} mm; there is nothing to reconstruct")
    if graph.junk.any():
        repairs.append(f"{graph.junk.sum()} triangles left out that repeat a corner or another triangle")
        graph = linked(graph.vertices, graph.triangles[~graph.junk])
    for mend in (_weld, _divide, _wind, _drop, _fill):
        if (graph.opposite < 0).any() or (graph.kinds == AGAINST).any():
            graph = mend(graph, size, repairs)
    _require_closed(graph)
    found = _bodies(*_one_fan_a_vertex(graph), size, repairs)
    return _compared(*found, size, repairs), tuple(repairs)


def _require_closed(graph):
    wrong = (graph.opposite < 0) | (graph.kinds == AGAINST)
    if not wrong.any():
        return
    reasons = (
        (BOUNDARY, "have one triangle only, as around a hole or a sheet"),
        (MANY, "join three or more triangles that enclose no material"),
        (AGAINST, "join triangles wound against each other, as on a one-sided strip"),
    )
    counts = [(np.count_nonzero(wrong & (graph.kinds == kind)), text) for kind, text in reasons]
    said = "; ".join(f"{count} edges {text}" for count, text in counts if count)
    place = shown_place(graph.vertices[graph.triangles.ravel()[wrong]].mean(axis=0))
    raise ValueError(
        f"mesh is not closed: {said}, around {place}; see nurbs_lab.mesh.check_mesh, mend it there "
        "or rebuild the mesh with nurbs_lab.mesh_from_points"
    )


def _open_ends(graph):
    return np.unique(np.concatenate([ends[graph.opposite < 0] for ends in tails_and_heads(graph.triangles)]))


def _weld(graph, size, repairs):
    """Make open vertices one that are near one another beside the edges there."""
    tails, heads = tails_and_heads(graph.triangles)
    lengths = np.linalg.norm(graph.vertices[heads] - graph.vertices[tails], axis=1)
    shortest = np.full(len(graph.vertices), np.inf)
    for ends in (tails, heads):
        np.minimum.at(shortest, ends, lengths)
    some = _open_ends(graph)
    if not len(some):
        return graph
    gaps, near = cKDTree(graph.vertices[some]).query(graph.vertices[some], k=min(9, len(some)))
    first, second = np.repeat(some, near.shape[1]), some[near.ravel()]
    close = gaps.ravel() < _NEAR * np.minimum(shortest[first], shortest[second])
    count, label = components(len(shortest), first[close], second[close])
    if count == len(shortest):
        return graph
    doubled = counted(len(shortest) - count, "doubled vertex", "doubled vertices")
    repairs.append(f"{doubled} welded")
    triangles = label[graph.triangles]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    return _relinked(graph.vertices[np.unique(label, return_index=True)[1]], triangles)


def _relinked(vertices, triangles):
    graph = linked(vertices, np.ascontiguousarray(triangles, dtype=np.int32))
    return _relinked(vertices, graph.triangles[~graph.junk]) if graph.junk.any() else graph


def _divide(graph, size, repairs):
    """Divide triangles where open vertices lie on their open edges (T-junctions)."""
    total, least = 0, _TOUCHING * size
    for _ in range(3):  # a round for each edge of a triangle
        points, some = graph.vertices, _open_ends(graph)
        tree, fans = cKDTree(points[some]) if len(some) else None, {}
        for half in np.flatnonzero(graph.opposite < 0):
            a, b, apex = np.roll(graph.triangles[half // 3], -(half % 3))
            length = np.linalg.norm(points[b] - points[a])
            near = some[tree.query_ball_point((points[a] + points[b]) / 2, length / 2)]
            steps, along = points[near] - points[a], (points[b] - points[a]) / max(length, least)
            at = steps @ along
            aside = np.linalg.norm(steps - at[:, None] * along, axis=1)
            on = (aside < least) & (at > least) & (at < length - least)
            if on.any() and half // 3 not in fans:
                line = [a, *near[on][at[on].argsort()], b]
                fans[half // 3] = [(tail, head, apex) for tail, head in pairwise(line)]
        if not fans:
            break
        total += sum(map(len, fans.values())) - len(fans)
        kept = np.delete(graph.triangles, list(fans), axis=0)
        graph = _relinked(points, np.concatenate([kept, *fans.values()]))
    if total:
        repairs.append(f"{counted(total, 'T-junction')} closed")
    return graph


def _wind(graph, size, repairs):
    """Turn triangles that are wound against their neighbours, the fewer ones of every connected part."""
    halves = np.flatnonzero((graph.opposite >= 0) & (graph.kinds != MANY))
    one, other, against = halves // 3, graph.opposite[halves] // 3, graph.kinds[halves] == AGAINST
    first, second = np.concatenate([2 * one, 2 * one + 1]), np.concatenate([2 * other, 2 * other + 1])
    count, label = components(2 * len(graph.triangles), first, second ^ np.tile(against, 2))
    # every triangle as it is and turned: two parts, unless the surface has one side
    sides = label.reshape(-1, 2)
    held = np.bincount(sides[:, 0], minlength=count)[sides]
    turned = (held[:, 0] < held[:, 1]) | ((held[:, 0] == held[:, 1]) & (sides[:, 0] > sides[:, 1]))
    if not turned.any():
        return graph
    repairs.append(f"{counted(turned.sum(), 'flipped triangle')} turned")
    return _relinked(graph.vertices, np.where(turned[:, None], graph.triangles[:, ::-1], graph.triangles))


def _drop(graph, size, repairs):
    """Leave out sheets that end at other triangles all around, such as second skins and inner walls.

    Where one triangle too many runs along an edge in one direction, it is that of the smallest sheet.
    """
    many = np.flatnonzero(graph.kinds == MANY)
    regular = graph.opposite.copy()
    regular[many] = -1
    count, label = bodies_of(regular)
    areas = np.bincount(label, np.linalg.norm(face_normals(graph.vertices, graph.triangles), axis=1))
    (edge, way), sheet = edges_and_ways(graph.triangles, many), label[many // 3]
    odd = np.flatnonzero(np.bincount(edge, way)[edge] == way)
    order = odd[np.lexsort((areas[sheet[odd]], edge[odd]))]
    spare = order[np.unique(edge[order], return_index=True)[1]]
    stray, kept = np.zeros(count, bool), label[np.flatnonzero(graph.kinds == BOUNDARY) // 3]
    stray[sheet[spare]] = True
    stray[sheet[np.setdiff1d(odd, spare)]] = stray[kept] = False
    if not stray.any():
        return graph
    repairs.append(f"{counted(np.count_nonzero(stray[label]), 'stray triangle')} left out")
    return _relinked(graph.vertices, graph.triangles[~stray[label]])


def _fill(graph, size, repairs):
    """Fill holes of three and four edges, and small ones by triangles around their middle."""
    if (graph.kinds == AGAINST).any():
        return graph
    after = dict(zip(*rims(graph.opposite), strict=True))
    tails, normals = graph.triangles.ravel(), unit(face_normals(graph.vertices, graph.triangles))
    filled, vertices, triangles = 0, [graph.vertices], [graph.triangles]
    count = len(graph.vertices)
    while after:
        half, step = after.popitem()
        loop = [half]
        while step != half:
            loop.append(step)
            step = after.pop(step)
        loop = np.array(loop[::-1])
        line = tails[loop]  # along the hole, the mesh is on the other side
        if len(line) in _SPLITS:
            triangles.append(_flattest(graph.vertices, line, normals[np.roll(loop, -1) // 3]))
        elif len(line) > 4 and extent(graph.vertices[line]) <= _PINHOLE * size:
            vertices.append(graph.vertices[line].mean(axis=0, keepdims=True))
            triangles.append(np.column_stack([line, np.roll(line, -1), np.full(len(line), count)]))
            count += 1
        else:
            continue
        filled += 1
    if not filled:
        return graph
    repairs.append(f"{counted(filled, 'pinhole')} filled")
    return _relinked(np.concatenate(vertices), np.concatenate(triangles))


def _flattest(vertices, line, beside):
    """One or two triangles in a hole that turn least against those beside its edges."""
    splits = [(line[np.array(corners)], owner) for corners, owner in _SPLITS[len(line)]]
    turns = [np.einsum("ij,ij->", unit(face_normals(vertices, way))[owner], beside) for way, owner in splits]
    return splits[int(np.argmax(turns))][0]


def _one_fan_a_vertex(graph):
    """Part vertices where several fans of triangles touch; leave out vertices that no triangle has."""
    count, label = fans(graph.opposite, graph.opposite >= 0)
    owner = np.empty(count, dtype=np.int64)
    owner[label] = graph.triangles.ravel()
    corners, opposite = label.reshape(-1, 3).astype(np.int64), graph.opposite.astype(np.int64)
    return _halved(graph.vertices[owner], corners, opposite, np.flatnonzero(graph.kinds == MANY))


def _halved(vertices, triangles, opposite, shared):
    """Part edges of which several pairs of triangles have both ends: every pair gets a middle of its own.

    So it is where a body touches itself along an edge. ``shared`` are the half-edges in question.
    """
    ends = np.column_stack(tails_and_heads(triangles))
    _, edge, counts = np.unique(ends[shared], axis=0, return_inverse=True, return_counts=True)
    several = shared[counts[edge] > 1]
    if not len(several):
        return vertices, triangles, opposite
    pairs, pair = np.unique(np.minimum(several, opposite[several]), return_inverse=True)
    middle = dict(zip(several.tolist(), (len(vertices) + pair).tolist(), strict=True))
    divided, fans = np.unique(several // 3), []
    for hub, f in enumerate(divided.tolist(), start=len(vertices) + len(pairs)):
        line = []
        for half, corner in enumerate(triangles[f].tolist(), start=3 * f):
            line += [corner, middle[half]] if half in middle else [corner]
        fans += [(tail, head, hub) for tail, head in pairwise([*line, line[0]])]
    added = vertices[ends[pairs]].mean(axis=1), vertices[triangles[divided]].mean(axis=1)
    triangles = np.concatenate([np.delete(triangles, divided, axis=0), fans])
    return np.concatenate([vertices, *added]), triangles, opposite_of(triangles)


def _bodies(vertices, triangles, opposite, size, repairs):
    """Every closed part, outwards or as a void of the body around it; and which bodies are inside another.

    An outermost surface that points inwards is turned with all that it contains, as a mirrored mesh has it.
    """
    every = parts_of(vertices, triangles, bodies_of(opposite)[1])
    parts = [part for part in every if abs(part[2]) > NO_VOLUME * size**3]
    if not parts:
        raise ValueError("mesh encloses no volume; there is no solid to reconstruct")
    if empty := len(every) - len(parts):
        repairs.append(f"{counted(empty, 'part')} without volume left out")
    around = around_of(parts)
    turned = [k for k, some in enumerate(around) if parts[some[0] if some else k][2] < 0]
    for k, (points, corners, volume) in [(k, parts[k]) for k in turned]:
        parts[k] = points, corners[:, ::-1].copy(), -volume
    if turned:
        repairs.append(f"{counted(len(turned), 'surface')} turned, whose normals pointed into the material")
    void = np.array([part[2] < 0 for part in parts])
    body = np.cumsum(~void) - 1
    for k in sorted(np.flatnonzero(void), key=lambda k: parts[k][2]):
        body[k] = body[around[k][-1]]
    order = np.argsort(void, kind="stable").tolist()
    surfaces = [ClosedSurface(*parts[k][:2], int(body[k]), bool(void[k]), parts[k][2]) for k in order]
    return surfaces, [body[k] for k in np.flatnonzero(~void) if np.sum(1 - 2 * void[around[k]]) > 0]


def parts_of(vertices, triangles, label):
    """Vertices, triangles and volume of every part, of which ``label`` is the number for each triangle."""
    parts, order = [], np.argsort(label, kind="stable")
    for mine in np.split(order, np.cumsum(np.bincount(label))[:-1]):
        used, corners = np.unique(triangles[mine], return_inverse=True)
        points, corners = vertices[used], corners.reshape(-1, 3)
        parts.append((points, corners, float(enclosed_volume(points, corners))))
    return parts


def around_of(parts):
    """For every part those around it, the largest first: its box is within theirs, and a vertex inside."""
    lows, highs = (np.array([end(part[0], axis=0) for part in parts]) for end in (np.min, np.max))
    order, around = np.argsort([-abs(part[2]) for part in parts], kind="stable"), [[] for _ in parts]
    for i, k in enumerate(order):
        larger = order[:i]
        boxes = larger[((lows[larger] <= lows[k]) & (highs[larger] >= highs[k])).all(axis=1)]
        around[k] = [o for o in boxes if _inside(parts[k][0][0], parts[o])]
    return around


def joined(surfaces):
    """Vertices and triangles of all surfaces."""
    return trimesh.util.append_faces([one.vertices for one in surfaces], [one.triangles for one in surfaces])


def _compared(surfaces, doubled, size, repairs):
    """The surfaces, told which meet; those that cross and bodies inside others, counted twice, are named."""
    owner = np.repeat(np.arange(len(surfaces)), [len(one.triangles) for one in surfaces])
    points, corners = joined(surfaces)
    inwards = -np.concatenate([vertex_normals(one.vertices, one.triangles)[0] for one in surfaces])
    partner = crossing_triangles(points, corners)
    near, body = np.flatnonzero(partner >= 0), np.array([one.body for one in surfaces])[owner]
    meeting = set(owner[near[body[near] == body[partner[near]]]].tolist())
    if len(near):  # or only touch
        moved = crossing_triangles(points + _TOUCHING * size * inwards, corners)
        partner = np.where(moved >= 0, partner, -1)
    crossed = np.flatnonzero(partner >= 0)
    alone = owner[crossed] == owner[partner[crossed]]
    for some, text in ((crossed[alone], "a surface crosses itself"), (crossed[~alone], "bodies overlap")):
        if len(some):
            place = shown_place(points[corners[some[0]]].mean(axis=0))
            repairs.append(f"not mended: {text}, as around {place}; what lies in both counts twice")
    for k in [] if len(crossed) else doubled:
        place = shown_place(surfaces[k].vertices.mean(axis=0))
        repairs.append(
            f"not mended: the body around {place} lies inside another and counts twice; turn its "
            "triangles if it is a void"
        )
    return [replace(one, meets=k in meeting) for k, one in enumerate(surfaces)]


def _inside(point, part):
    """Whether a point is inside: the solid angles of all triangles add up to a full turn (van Oosterom)."""
    a, b, c = (part[0][part[1][:, k]] - point for k in range(3))
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = x * y * z + np.einsum("ij,ij->i", a, b) * z + np.einsum("ij,ij->i", b, c) * x
    below += np.einsum("ij,ij->i", c, a) * y
    return abs(np.arctan2(above, below).sum()) > np.pi
