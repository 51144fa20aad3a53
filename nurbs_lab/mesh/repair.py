"""From any triangles to closed surfaces: small defects are mended and named, the others refused."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order
from scipy.spatial import cKDTree

from nurbs_lab.mesh.core import components, enclosed_volume, opposite_of, tails_and_heads
from nurbs_lab.mesh.solid._kernels_ring import after

_SAME_PLACE = 1e-7  # of the size: vertices nearer than this are one
_PINHOLE = 0.03  # of the size: holes with a diameter up to this are filled
_MOST_HOLE_EDGES = 60


@dataclass(frozen=True, eq=False)
class ClosedSurface:
    """One closed surface: ``vertices (n, 3)``, and ``triangles (m, 3)`` wound away from the material.

    ``body`` numbers the solid that it bounds, and ``is_void`` says whether it is one of its voids; their
    ``volume`` is negative.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    body: int
    is_void: bool
    volume: float


def closed_surfaces(vertices, triangles) -> tuple[list[ClosedSurface], tuple[str, ...]]:
    """The closed surfaces of a mesh, and what was mended.

    Raises
    ------
    ValueError
        If the mesh has holes or edges with more than two triangles that are too large to mend; the message
        says how many and where.
    """
    repairs = []
    size = float(np.linalg.norm(np.ptp(vertices[triangles].reshape(-1, 3), axis=0)))
    if not size > 1e-90:
        raise ValueError(f"mesh has a size of {size} mm; there is nothing to reconstruct")
    triangles = _without_copies(triangles)
    if _open(triangles).any():
        vertices, triangles = _weld(vertices, triangles, _SAME_PLACE * size, repairs)
    if _open(triangles).any():
        triangles = _wind(triangles, repairs)
    if _open(triangles).any():
        vertices, triangles = _fill(vertices, triangles, _PINHOLE * size, repairs)
    wrong = _open(triangles)
    if wrong.any():
        tails = triangles.ravel()[wrong]
        place = ", ".join(f"{x:.4g}" for x in vertices[tails].mean(axis=0))
        raise ValueError(
            f"mesh is not closed: {wrong.sum()} edges do not join two triangles of one winding, around "
            f"({place}) mm; see nurbs_lab.mesh.check_mesh, close the holes or rebuild the mesh with "
            "nurbs_lab.mesh_from_points"
        )
    return _bodies(*_one_fan_a_vertex(vertices, triangles)), tuple(repairs)


def _open(triangles):
    return opposite_of(triangles) < 0


def _without_copies(triangles):
    """Triangles of three different corners, each once."""
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    _, first, count = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True, return_counts=True)
    return triangles[np.sort(first)] if (count > 1).any() else triangles


def _weld(vertices, triangles, distance, repairs):
    """Make vertices that are nearer than ``distance`` one."""
    pairs = cKDTree(vertices).query_pairs(distance, output_type="ndarray")
    if not len(pairs):
        return vertices, triangles
    count, label = components(len(vertices), *pairs.T)
    first = np.unique(label, return_index=True)[1]
    repairs.append(f"{len(vertices) - count} doubled vertices welded")
    return vertices[first], _without_copies(label[triangles])


def _wind(triangles, repairs):
    """Turn triangles that are wound against their neighbours, the fewer ones of every connected part."""
    m = len(triangles)
    tails, heads = tails_and_heads(triangles)
    key = np.minimum(tails, heads) * (int(triangles.max()) + 1) + np.maximum(tails, heads)
    _, edge, count = np.unique(key, return_inverse=True, return_counts=True)
    half = np.argsort(edge, kind="stable")
    half = half[count[edge[half]] == 2].reshape(-1, 2)
    against = tails[half[:, 0]] == tails[half[:, 1]]
    f, g = (half // 3).T
    clash = dict(zip((f * m + g).tolist(), against.tolist(), strict=True))
    links = coo_matrix((np.ones(len(f)), (f, g)), shape=(m, m)).tocsr()
    parts, label = components(m, f, g)
    turned = np.zeros(m, dtype=bool)
    for first in np.unique(label, return_index=True)[1].tolist():
        order, before = breadth_first_order(links, first, directed=False)
        for here, there in zip(order[1:].tolist(), before[order[1:]].tolist(), strict=True):
            turned[here] = turned[there] ^ clash.get(here * m + there, clash.get(there * m + here, False))
    many = np.bincount(label, turned, parts) * 2 > np.bincount(label, minlength=parts)
    turned ^= many[label]
    if turned.any():
        repairs.append(f"{turned.sum()} flipped triangles turned")
    return np.where(turned[:, None], triangles[:, ::-1], triangles)


def _fill(vertices, triangles, largest, repairs):
    """Fill holes with a diameter up to ``largest`` by triangles around their middle.

    Every open edge is walked along once.
    """
    wrong = np.flatnonzero(_open(triangles))
    tails, heads = (ends[wrong] for ends in tails_and_heads(triangles))
    after = dict(zip(heads.tolist(), tails.tolist(), strict=True))  # along a hole, the mesh on the other side
    if len(after) < len(tails):
        return vertices, triangles
    filled, new_vertices, new_triangles = 0, [vertices], [triangles]
    count, left = len(vertices), set(after)
    while left:
        loop = [min(left)]
        while (
            (follower := after.get(loop[-1])) is not None and follower != loop[0] and len(loop) <= len(after)
        ):
            loop.append(follower)
        left -= set(loop)
        if after.get(loop[-1]) != loop[0] or len(loop) > _MOST_HOLE_EDGES or len(loop) < 3:
            continue
        rim = vertices[loop]
        if np.linalg.norm(np.ptp(rim, axis=0)) > largest:
            continue
        if len(loop) == 3:
            new_triangles.append(np.array([loop]))
        else:
            new_vertices.append(rim.mean(axis=0, keepdims=True))
            new_triangles.append(
                np.array([[a, b, count] for a, b in zip(loop, loop[1:] + loop[:1], strict=True)])
            )
            count += 1
        filled += 1
    if filled:
        repairs.append(f"{filled} pinholes filled")
    return np.concatenate(new_vertices), np.concatenate(new_triangles)


def _one_fan_a_vertex(vertices, triangles):
    """Part vertices where several fans of triangles touch; leave out vertices that no triangle has."""
    opposite = opposite_of(triangles)
    across = after(opposite)  # the same vertex in the neighbour
    count, label = components(len(across), np.arange(len(across)), across)
    owner = np.empty(count, dtype=np.int64)
    owner[label] = triangles.ravel()
    return vertices[owner], label.reshape(-1, 3).astype(np.int64)


def _bodies(vertices, triangles):
    opposite = opposite_of(triangles)
    count, label = components(len(triangles), np.arange(len(opposite)) // 3, opposite // 3)
    parts = []
    for k in range(count):
        used, corners = np.unique(triangles[label == k], return_inverse=True)
        corners = corners.reshape(-1, 3)
        points = vertices[used]
        parts.append((points, corners, float(enclosed_volume(points - points.mean(axis=0), corners))))
    outer = [k for k, part in enumerate(parts) if part[2] > 0]
    out, body_of = [], {}
    for k in outer:
        body_of[k] = len(body_of)
        out.append(ClosedSurface(*parts[k][:2], body_of[k], False, parts[k][2]))
    for points, corners, volume in (part for part in parts if part[2] <= 0):
        around = [k for k in outer if parts[k][2] > -volume and _inside(points[0], parts[k])]
        if around:
            owner = min(around, key=lambda k: parts[k][2])
            out.append(ClosedSurface(points, corners, body_of[owner], True, volume))
        else:
            body_of[points.tobytes()] = len(body_of)
            out.append(ClosedSurface(points, corners[:, ::-1].copy(), len(body_of) - 1, False, -volume))
    return out


def _inside(point, part):
    """Whether a point is inside: the solid angles of all triangles add up to a full turn (van Oosterom)."""
    a, b, c = (part[0][part[1][:, k]] - point for k in range(3))
    x, y, z = (np.linalg.norm(v, axis=1) for v in (a, b, c))
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = x * y * z + np.einsum("ij,ij->i", a, b) * z + np.einsum("ij,ij->i", b, c) * x
    below += np.einsum("ij,ij->i", c, a) * y
    return abs(np.arctan2(above, below).sum()) > np.pi
