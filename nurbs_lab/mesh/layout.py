"""A closed mesh divided into four-sided patches: the layout of a reconstruction.

The mesh is coarsened to a few large triangles that know which part of the mesh they stand for, and pairs of
triangles are joined to quadrilaterals (Eck and Hoppe 1996). Edges of the mesh that are sharper than an angle
stay edges of the layout.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from nurbs_lab.common.values import Value
from nurbs_lab.mesh import _kernels_layout, _kernels_matching
from nurbs_lab.mesh.surfels import Surfels, corner_angles, unit

_WORST_CORNER = 80.0  # degrees from a right angle, of a corner of two joined triangles
_ATTEMPTS = 8
_TIP = 0.8  # height of a tip over the mean distance to its neighbours
_SAMPLES = 32  # of a sharp edge
_FINER = 2  # of an edge that may be halved


@dataclass(frozen=True, eq=False, repr=False)
class Layout(Value):
    """Quadrilaterals on a mesh.

    Attributes
    ----------
    points : (vertices, 3) array
        Of the layout, as first placed.
    normals : (vertices, 3) array
        Of the mesh at these points.
    fixed : (vertices,) array of bool
        Vertices that stay there: corners of sharp curves, and tips of the shape.
    corners : (faces, 4) array
        Vertices of the layout, counter-clockwise from outside; corners 0 to 3 are at
        (0, 0), (1, 0), (1, 1) and (0, 1).
    edges : (faces, 4) array
        Edge of the layout on side k, from corner k to the next.
    forward : (faces, 4) array of bool
        Whether the edge runs along the side.
    sides : (edges, 2) array
        The two sides, ``4 face + side``, that meet in every edge; the first one runs forward.
    sharp : (edges,) array of bool
    sectors : (faces, 4) array
        Corners between which no sharp edge lies have the same number: they share a tangent plane.
    halved : bool
        Whether triangles without a partner made it necessary to halve every edge.
    curves : (edges, samples, 3) array
        Points of the sharp edges, evenly spaced along the mesh, in the direction of the edge; else zeros.
    """

    points: np.ndarray
    normals: np.ndarray
    fixed: np.ndarray
    corners: np.ndarray
    edges: np.ndarray
    forward: np.ndarray
    sides: np.ndarray
    sharp: np.ndarray
    sectors: np.ndarray
    curves: np.ndarray
    halved: bool


def lay_out(mesh: Surfels, weight, most_cost, joined=True) -> Layout:
    """Divide a mesh; ``most_cost`` is the largest quadric error of a collapse, in mm squared.

    ``weight`` of the vertices multiplies the error. Triangles are joined in pairs, or every one of them is
    split into three faces.
    """
    triangles, opposite, sharp = mesh.triangles.copy(), mesh.opposite.copy(), mesh.sharp.copy()
    alive, begin = _kernels_layout.coarsen(
        mesh.vertices, mesh.normals, triangles, opposite, sharp, mesh.kinds, weight, most_cost
    )
    number = np.cumsum(alive) - 1
    old = (3 * np.flatnonzero(alive)[:, None] + np.arange(3)).ravel()
    opposite = opposite[old]
    opposite = 3 * number[opposite // 3] + opposite % 3
    triangles, sharp, begin = triangles[alive], sharp[old], begin[old]
    mate = _pair(mesh, triangles, opposite, sharp) if joined else np.full(len(triangles), -1)
    curves = _curves(mesh, triangles, opposite, sharp, begin)
    fixed = (mesh.kinds == _kernels_layout.CORNER) | _tips(mesh.vertices, triangles)
    if (mate < 0).any():
        return _split(mesh, fixed, triangles, opposite, sharp, mate, curves)
    return _join(mesh, fixed, triangles, opposite, sharp, mate, curves)


def _tips(vertices, triangles):
    """Vertices that stand out from the mean of their neighbours by a good part of the distance to them."""
    tails, heads = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    steps = vertices[heads] - vertices[tails]
    count = np.maximum(np.bincount(tails, minlength=len(vertices)), 1)
    mean, length = np.zeros_like(vertices), np.bincount(tails, np.linalg.norm(steps, axis=1), len(vertices))
    np.add.at(mean, tails, steps)
    return np.linalg.norm(mean, axis=1) / count > _TIP * length / count


def _curves(mesh, triangles, opposite, sharp, begin):
    """Points evenly spaced along the part of the mesh that every sharp half-edge stands for."""
    curves = np.zeros((len(sharp), _FINER * _SAMPLES + 1, 3))
    tails, heads = mesh.triangles.ravel(), np.roll(mesh.triangles, -1, axis=1).ravel()
    halves = np.flatnonzero(mesh.sharp)
    sums = np.bincount(tails[halves], halves, len(mesh.vertices)).astype(int)  # of the two leaving a vertex
    for h in np.flatnonzero(sharp & (np.arange(len(sharp)) < opposite)).tolist():
        half, end = begin[h], triangles[h // 3, (h + 1) % 3]
        along = [tails[half], heads[half]]
        while along[-1] != end:
            half = sums[along[-1]] - mesh.opposite[half]
            along.append(heads[half])
        path = mesh.vertices[along]
        s = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
        t = np.linspace(0.0, s[-1], curves.shape[1])
        curves[h] = np.column_stack([np.interp(t, s, x) for x in path.T])
        curves[opposite[h]] = curves[h, ::-1]
    return curves


def _sectors(opposite, sharp, face_size):
    """Components of corners of faces around a vertex, joined across edges that are not sharp."""
    joined = np.flatnonzero(~sharp)
    after = joined - joined % face_size + (joined + 1) % face_size
    across = opposite[joined]
    after_across = across - across % face_size + (across + 1) % face_size
    rows, columns = np.concatenate([joined, after]), np.concatenate([after_across, across])
    return connected_components(
        coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(len(opposite),) * 2)
    )[1]


def _pair(mesh, triangles, opposite, sharp):
    """The half-edge across which every triangle is joined to its partner; -1 for those left alone.

    The best shapes are joined first; then the matching is completed, and pairs that would leave too few
    faces around a vertex are parted again.
    """
    m = len(triangles)
    angles = corner_angles(mesh.vertices, triangles).ravel()
    sector = _sectors(opposite, sharp, 3)
    around = np.bincount(sector, weights=angles)
    kinds = np.empty(len(around), dtype=np.int64)
    kinds[sector] = mesh.kinds[triangles.ravel()]
    at_corner = np.where(around > 230.0, 3, np.where(around > 140.0, 2, 1))
    smooth = np.zeros(len(around), dtype=bool)
    smooth[sector] = ~np.isin(triangles.ravel(), triangles.ravel()[sharp])
    at_corner = np.where(smooth, 3, at_corner)
    spare_at_first = np.bincount(sector) - np.choose(kinds, [3, 2, at_corner])
    spare = spare_at_first.copy()

    half = np.arange(3 * m)
    after, before = half - half % 3 + (half + 1) % 3, half - half % 3 + (half + 2) % 3
    across = opposite
    scale = np.choose(kinds, [360.0, 180.0, around]) / np.maximum(around, 1.0)  # angles as on a smooth mesh
    flat = angles * scale[sector]
    tail = flat[half] + flat[across - across % 3 + (across + 1) % 3]
    head = flat[after] + flat[across]
    worst = np.abs(np.stack([tail, head, flat[before], flat[before[across]]]) - 90.0).max(axis=0)
    chosen = np.flatnonzero(~sharp & (half < opposite))
    chosen = chosen[np.argsort(worst[chosen], kind="stable")]
    mate = np.full(m, -1, dtype=np.int64)
    for h in chosen.tolist():
        f, g = h // 3, int(opposite[h]) // 3
        ends = int(sector[h]), int(sector[after[h]])
        if mate[f] < 0 and mate[g] < 0 and worst[h] < 70.0 and min(spare[ends[0]], spare[ends[1]]) > 0:
            mate[f], mate[g] = g, f
            spare[ends[0]] -= 1
            spare[ends[1]] -= 1
    usable = ~sharp & (worst < _WORST_CORNER)
    for _ in range(_ATTEMPTS):
        edges = np.flatnonzero(usable)
        first = np.searchsorted(edges // 3, np.arange(m + 1))
        _kernels_matching.complete_matching(first, opposite[edges] // 3, mate)
        joint = _diagonals(opposite, mate)
        broken = _crowded(joint, opposite, sector, spare_at_first)
        if not len(broken):
            break
        usable[broken] = usable[opposite[broken]] = False
        mate[broken // 3] = mate[opposite[broken] // 3] = -1
        joint[broken // 3] = joint[opposite[broken] // 3] = -1
    return joint


def _diagonals(opposite, mate):
    """The half-edge across which every triangle meets its mate; -1 without one."""
    met = (opposite.reshape(-1, 3) // 3 == mate[:, None]) & (mate[:, None] >= 0)
    return np.where(met.any(axis=1), 3 * np.arange(len(mate)) + met.argmax(axis=1), -1)


def _crowded(joint, opposite, sector, spare):
    """Diagonals of a matching that leave too few faces around one of their ends."""
    spare, broken = spare.copy(), []
    chosen = joint[(joint >= 0) & (joint < opposite[joint])]
    ends = np.column_stack([sector[chosen], sector[chosen - chosen % 3 + (chosen + 1) % 3]])
    np.subtract.at(spare, ends, 1)
    for h, (tail, head) in zip(chosen.tolist(), ends.tolist(), strict=True):
        if min(spare[tail], spare[head]) < 0:
            broken.append(h)
            spare[tail] += 1
            spare[head] += 1
    return np.array(broken, dtype=np.int64)


def _join(mesh, fixed, triangles, opposite, sharp, mate, curves):
    """Quadrilaterals of two triangles each."""
    quads, sides = _quads(triangles, opposite, mate[mate < opposite[mate]])
    return _layout(mesh.vertices, mesh.normals, fixed, quads, sharp[sides], curves[sides, ::_FINER], False)


def _quads(triangles, opposite, halves):
    """Corners and sides of the quadrilaterals around the diagonals ``halves``."""
    step = lambda h, k: h - h % 3 + (h + k) % 3  # noqa: E731
    across = opposite[halves]
    sides = np.column_stack([step(halves, 1), step(halves, 2), step(across, 1), step(across, 2)])
    return triangles.ravel()[sides], sides


def _split(mesh, fixed, triangles, opposite, sharp, mate, curves):
    """Every edge halved: four faces of a quadrilateral, three of a triangle that found no partner."""
    m, vertices = len(triangles), mesh.vertices
    halves = np.flatnonzero(np.isin(np.arange(3 * m), mate[mate >= 0]) & (np.arange(3 * m) < opposite))
    quads, quad_sides = _quads(triangles, opposite, halves)
    alone = np.flatnonzero(mate < 0)
    first_half, edge = np.unique(np.minimum(np.arange(3 * m), opposite), return_inverse=True)
    edge += len(vertices)
    ends = triangles.ravel()[first_half], np.roll(triangles, -1, axis=1).ravel()[first_half]
    halfway = (vertices[ends[0]] + vertices[ends[1]]) / 2
    bent = sharp[first_half]
    halfway[bent] = curves[first_half[bent], (curves.shape[1] - 1) // 2]
    points = [vertices, halfway]
    normals = [mesh.normals, mesh.normals[ends[0]] + mesh.normals[ends[1]]]
    centre = edge.max() + 1
    polygons = [(quads, quad_sides), (triangles[alone], 3 * alone[:, None] + np.arange(3))]
    corners, marks, paths = [], [], []
    middle_of = (curves.shape[1] - 1) // 2
    for polygon, sides in polygons:
        size = polygon.shape[1]
        points.append(vertices[polygon].mean(axis=1))
        normals.append(mesh.normals[polygon].sum(axis=1))
        middle = edge[sides]
        hub = centre + np.arange(len(polygon))
        centre += len(polygon)
        for k in range(size):
            corners.append(np.column_stack([polygon[:, k], middle[:, k], hub, middle[:, k - 1]]))
            none = np.zeros(len(polygon), dtype=bool)
            marks.append(np.column_stack([sharp[sides[:, k]], none, none, sharp[sides[:, k - 1]]]))
            ahead, behind = curves[sides[:, k], : middle_of + 1], curves[sides[:, k - 1], middle_of:]
            inside = np.zeros_like(ahead)
            paths.append(np.stack([ahead, inside, inside, behind], axis=1))
    points = np.concatenate(points)
    fixed = np.concatenate([fixed, np.zeros(len(points) - len(fixed), dtype=bool)])
    return _layout(
        points, unit(np.concatenate(normals)), fixed, np.concatenate(corners), np.concatenate(marks),
        np.concatenate(paths), True,
    )  # fmt: skip


def _layout(points, normals, fixed, corners, sharp, curves, halved):
    """Number the edges and sectors of quadrilaterals."""
    used, corners = np.unique(corners, return_inverse=True)
    points, normals, fixed, corners = points[used], normals[used], fixed[used], corners.reshape(-1, 4)
    tails, heads = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    pairs = np.column_stack([np.minimum(tails, heads), np.maximum(tails, heads)])
    _, edges = np.unique(pairs, axis=0, return_inverse=True)
    forward = tails < heads
    count = int(edges.max()) + 1
    if len(edges) != 2 * count or np.bincount(edges[forward], minlength=count).max() != 1:
        raise ArithmeticError("the layout is not a closed surface")
    sides = np.empty((count, 2), dtype=np.int64)
    sides[edges[forward], 0] = np.flatnonzero(forward)
    sides[edges[~forward], 1] = np.flatnonzero(~forward)
    opposite = sides[edges].sum(axis=1) - np.arange(len(edges))
    sharp = sharp.ravel()
    shape = edges.reshape(-1, 4)
    sectors = _sectors(opposite, sharp, 4).reshape(-1, 4)
    return Layout(
        points, normals, fixed, corners, shape, forward.reshape(-1, 4), sides, sharp[sides[:, 0]], sectors,
        curves.reshape(len(edges), *curves.shape[2:])[sides[:, 0]], halved,
    )  # fmt: skip
