"""Bicubic B-spline patches on a layout, fitted to a mesh all at once.

Neighbouring patches have the same control points along their common edge, so the shell is closed. The fit
minimises the squared distance of samples of the mesh to the patches, a small bending energy, and the angle
between the tangent planes of patches that meet in a smooth edge. The nearest places of the samples are taken
from the fit before (Hoschek 1988). The sine of the angle is linearised in the derivatives of both patches
and of the edge, which is a Gauss-Newton step. The derivatives keep about the lengths that they have on an
even grid of points on the mesh; without this they would vanish at corners, and patches would fold there.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import trimesh
from scipy.interpolate import BSpline
from scipy.sparse import coo_matrix, csr_matrix, vstack
from scipy.sparse.linalg import splu

from nurbs_lab.common.values import Value
from nurbs_lab.mesh import _kernels_patches as kernels
from nurbs_lab.mesh.closest import triangle_tree
from nurbs_lab.mesh.layout import Layout, face_normals, unit
from nurbs_lab.nurbs import NurbsSurface

DEGREE = 3
_BENDING = (1e-5, 1e-6, 1e-7, 1e-7, 1e-7)  # weight of the bending energy, round by round
_INWARD = np.array([[0.0, 1.0], [-1.0, 0.0], [0.0, -1.0], [1.0, 0.0]])
_AHEAD = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
_TANGENT = 0.005  # weight of the derivatives along the tangent planes, of that of the planes
_CREASED = 0.7  # cosine of the turn of the mesh across a seam, below which the seam is not made smooth
_SEAM = 0.3  # weight of the tangent planes
_ANCHOR = 0.01  # weight of the even grid on the mesh
_CREASE = 4.0  # weight of a sharp edge
_POINTS = 12  # of the mesh for every control point, at most
_DAMPING = 0.7  # of a step to the middle of the neighbours
_LEVELS = ((1, 5), (2, 10), (4, 15), (8, 10))  # cells of even grids, and how often each is relaxed
_LEAST_AREA = 1e-12  # of a sample, of the squared size
_TURNS = 40  # of conjugate gradients in a round


@dataclass(frozen=True, eq=False, repr=False)
class Patches(Value):
    """Fitted patches.

    Attributes
    ----------
    layout : Layout
    spans : int
        Of every patch along each side.
    net : (faces, spans + 3, spans + 3) array
        Number of every control point; equal numbers are one point.
    control : (n, 3) array
    degree : int
        3; 1 if all patches are bilinear, which needs only their corners.
    """

    layout: Layout
    spans: int
    net: np.ndarray
    control: np.ndarray
    degree: int = DEGREE

    @cached_property
    def surfaces(self) -> tuple[NurbsSurface, ...]:
        """One untrimmed surface a face."""
        spans, p = (self.spans, DEGREE) if self.degree == DEGREE else (1, 1)
        knots = np.concatenate([[0.0] * p, np.arange(spans + 1) / spans, [1.0] * p])
        net = self.net if p == DEGREE else self.net[:, ::DEGREE, ::DEGREE]
        return tuple(NurbsSurface((p, p), (knots, knots), rows) for rows in self.control[net])

    def grid(self, cells):
        """Points of every face on an even grid, ``(faces, cells + 1, cells + 1, 3)``."""
        out = np.empty((len(self.net), cells + 1, cells + 1, 3))
        kernels.grids(self.control, self.net, self.spans, np.arange(cells + 1) / cells, out)
        return out

    @cached_property
    def twin(self) -> np.ndarray:
        """The side across every side."""
        edges = self.layout.edges.ravel()
        return self.layout.sides[edges].sum(axis=1) - np.arange(len(edges))

    @property
    def points(self) -> int:
        """Number of control points of all faces, common ones counted for each."""
        return self.net.size if self.degree == DEGREE else 4 * len(self.net)

    def triangles(self, cells) -> trimesh.Trimesh:
        """The shell as triangles, two for each of ``cells`` squared cells of a face; closed."""
        net, count = number_control_points(self.layout, cells + 1 - DEGREE)
        points = np.empty((count, 3))
        points[net] = self.grid(cells)
        a, b, c, d = net[:, :-1, :-1], net[:, 1:, :-1], net[:, 1:, 1:], net[:, :-1, 1:]
        faces = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], -2).reshape(-1, 3)
        return trimesh.Trimesh(points, faces, process=False)

    def seam_angles(self, samples):
        """Angle in degrees between the two faces at even places along every edge, ``(edges, samples)``."""
        t = (np.arange(samples) + 0.5) / samples
        normals = []
        for which, along in ((0, t), (1, t[::-1])):
            side = self.layout.sides[:, which]
            uv = _side_places(side % 4, along)
            _, du, dv = rows_at(self.net, len(self.control), self.spans, np.repeat(side // 4, samples), uv)
            normals.append(np.cross(du @ self.control, dv @ self.control))
        sine = np.linalg.norm(np.cross(*normals), axis=1)
        return np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", *normals))).reshape(-1, samples)


def number_control_points(layout: Layout, spans):
    """Numbers of the control points of all patches: those of vertices, of edges, of the inside of faces."""
    vertices, edges, faces = int(layout.corners.max()) + 1, len(layout.sides), len(layout.corners)
    n = spans + DEGREE
    inner = n - 2
    net = np.empty((faces, n, n), dtype=np.int64)
    on_edge = vertices + inner * layout.edges[:, :, None] + np.arange(inner)
    on_edge = np.where(layout.forward[:, :, None], on_edge, on_edge[:, :, ::-1])
    net[:, 0, 0], net[:, -1, 0], net[:, -1, -1], net[:, 0, -1] = layout.corners.T
    net[:, 1:-1, 0], net[:, -1, 1:-1] = on_edge[:, 0], on_edge[:, 1]
    net[:, 1:-1, -1], net[:, 0, 1:-1] = on_edge[:, 2, ::-1], on_edge[:, 3, ::-1]
    first = vertices + inner * edges
    net[:, 1:-1, 1:-1] = first + np.arange(faces * inner**2).reshape(faces, inner, inner)
    return net, first + faces * inner**2


def rows_at(net, count, spans, face, uv):
    """Sparse matrices from control points to points and their derivatives along u and v."""
    shape = (len(face), 16)
    columns = np.empty(shape, dtype=np.int64)
    weights = [np.empty(shape) for _ in range(3)]
    kernels.equations(net, spans, face, uv, columns, *weights)
    ends = np.arange(0, 16 * len(face) + 1, 16)
    return [csr_matrix((w.ravel(), columns.ravel(), ends), shape=(len(face), count)) for w in weights]


def _bending(net, count, spans):
    """Matrix of the integral of |S_uu|^2 + 2 |S_uv|^2 + |S_vv|^2 over all unit squares."""
    knots = np.concatenate([[0.0] * DEGREE, np.arange(spans + 1) / spans, [1.0] * DEGREE])
    nodes, weights = np.polynomial.legendre.leggauss(DEGREE + 1)
    t = ((np.arange(spans)[:, None] + (nodes + 1) / 2) / spans).ravel()
    w = np.tile(weights, spans) / (2 * spans)
    spline = BSpline(knots, np.eye(spans + DEGREE), DEGREE)
    gram = [(b * w[:, None]).T @ b for b in (spline(t, order) for order in range(3))]
    local = np.kron(gram[2], gram[0]) + 2 * np.kron(gram[1], gram[1]) + np.kron(gram[0], gram[2])
    flat = net.reshape(len(net), -1)
    rows, columns = np.repeat(flat, flat.shape[1], axis=1), np.tile(flat, flat.shape[1])
    values = np.tile(local.ravel(), len(net))
    return coo_matrix((values, (rows.ravel(), columns.ravel())), shape=(count, count)).tocsr()


class _Seams:
    """Samples of the smooth seams, where three derivatives are to lie in one plane.

    They are those across the seam into its left and its right face, and the one along it; at the ends these
    are three neighbouring edges around a vertex. All are divided by their first sizes.
    """

    def __init__(self, layout, nodes, net, count, spans):
        smooth = np.flatnonzero(~layout.sharp)
        t = np.linspace(0.0, 1.0, 3 * spans + 2)
        n = nodes.shape[1] - 1
        slopes = np.gradient(nodes, 1.0 / n, axis=(1, 2))
        pointed = layout.fixed.copy()
        pointed[layout.corners.ravel()[layout.sides[layout.sharp]]] = False
        ends = layout.corners.ravel()[layout.sides[smooth]]
        weight = np.where(pointed[ends[:, :1]], t, 1.0) * np.where(pointed[ends[:, 1:]], 1.0 - t, 1.0)
        self.weight = weight.ravel()
        self.rows, self.wanted = [], []
        for which, places, directions in ((0, t, (_INWARD, _AHEAD)), (1, 1.0 - t, (_INWARD,))):
            side = layout.sides[smooth, which]
            face, uv = np.repeat(side // 4, len(t)), _side_places(side % 4, places)
            _, du, dv = rows_at(net, count, spans, face, uv)
            first = [_bilinear(slope, face, uv) for slope in slopes]
            for direction in directions:
                u, v = direction[np.repeat(side % 4, len(t))].T[:, :, None]
                wanted = u * first[0] + v * first[1]
                size = np.linalg.norm(wanted, axis=1, keepdims=True)
                size = np.maximum(size, 0.1 * np.median(size))
                self.rows.append((du.multiply(u / size) + dv.multiply(v / size)).tocsr())
                self.wanted.append(wanted / size)
        left, along, right = self.wanted
        turn = np.einsum("ij,ij->i", unit(np.cross(along, left)), unit(np.cross(right, along)))
        self.weight[turn < _CREASED] = 0.0
        self.all = vstack(self.rows).tocsr()
        self.matrix = (self.all.T @ self.all).tocsr()

    def linear(self, control):
        """Sines of the angles out of the plane, their derivatives by the three, normals and pull."""
        left, along, right = (rows @ control for rows in self.rows)
        sizes = [np.linalg.norm(np.cross(along, x), axis=1) for x in (left, right)]
        least = 0.1
        scale = np.linalg.norm(along, axis=1) / np.maximum(sizes[0] * sizes[1], least**2)
        scale = (self.weight * np.minimum(scale, 1.0 / least))[:, None]
        factors = scale * np.cross(along, right), scale * np.cross(right, left), scale * np.cross(left, along)
        sine = np.einsum("ij,ij->i", factors[0], left)
        normal = unit(unit(np.cross(along, left)) - unit(np.cross(along, right)))
        flat = [x - np.einsum("ij,ij->i", x, normal)[:, None] * normal for x in self.wanted]
        return sine, factors, normal, self.all.T @ np.concatenate(flat)

    def change(self, factors, x):
        """Of the sines."""
        return sum(np.einsum("ij,ij->i", f, rows @ x) for f, rows in zip(factors, self.rows, strict=True))

    def push(self, factors, change):
        """The transposed of `change`."""
        return self.all.T @ np.concatenate([f * change[:, None] for f in factors])

    def hold(self, normal, x):
        """Sum of squared derivatives within the planes."""
        slope = self.all @ x
        normal = np.tile(normal, (3, 1))
        return self.all.T @ (slope - np.einsum("ij,ij->i", slope, normal)[:, None] * normal)


def _bilinear(values, face, uv):
    """Values between those on an even grid of every face."""
    n = values.shape[1] - 1
    low = np.minimum((uv * n).astype(int), n - 1)
    u, v = (uv * n - low).T[:, :, None]
    i, j = low.T
    near = values[face, i, j] * (1 - u) + values[face, i + 1, j] * u
    return near * (1 - v) + (values[face, i, j + 1] * (1 - u) + values[face, i + 1, j + 1] * u) * v


def _side_places(side, t):
    """(u, v) at parameters t along sides, ``(len(side) len(t), 2)``."""
    zero, one = np.zeros_like(t), np.ones_like(t)
    table = np.stack([np.column_stack(p) for p in ((t, zero), (one, t), (1 - t, one), (zero, 1 - t))])
    return table[side].reshape(-1, 2)


def _conjugate_gradients(apply, precondition, right, x, turns):
    """Preconditioned conjugate gradients for a symmetric system of three coupled columns."""
    residual = right - apply(x)
    z = precondition(residual)
    direction, rho = z, np.vdot(residual, z)
    start = np.vdot(right, precondition(right))
    for _ in range(turns):
        image = apply(direction)
        step = rho / np.vdot(direction, image)
        x = x + step * direction
        residual = residual - step * image
        z = precondition(residual)
        rho, before = np.vdot(residual, z), rho
        if rho <= 1e-14 * start:
            break
        direction = z + rho / before * direction
    return x


class _Grid:
    """A grid of points on every face of a layout, common along edges: the linear counterpart of the net."""

    def __init__(self, layout, cells):
        self.net, self.count = number_control_points(layout, cells + 1 - DEGREE)
        pairs = [(self.net[:, 1:], self.net[:, :-1]), (self.net[:, :, 1:], self.net[:, :, :-1])]
        a = np.concatenate([p.ravel() for p, _ in pairs])
        b = np.concatenate([q.ravel() for _, q in pairs])
        links = coo_matrix((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(self.count,) * 2).tocsr()
        links.data[:] = 1.0
        self.mean = links.multiply(1.0 / links.sum(axis=1)).tocsr()
        side = layout.sides[layout.sharp, 0]
        round_faces = (self.net[:, :, 0], self.net[:, -1], self.net[:, ::-1, -1], self.net[:, 0, ::-1])
        self.on_creases = np.stack(round_faces, axis=1).reshape(-1, cells + 1)[side]
        self.free = np.ones(self.count, dtype=bool)
        self.free[self.on_creases] = False
        self.free[: len(layout.points)] &= ~layout.fixed

    def spacing(self, points):
        """Root mean square distance to the neighbours."""
        squares, mean = np.einsum("ij,ij->i", points, points), self.mean @ points
        between = self.mean @ squares + squares - 2 * np.einsum("ij,ij->i", points, mean)
        return np.sqrt(np.maximum(between, 0.0))

    def relax(self, points, normals, tree, times):
        """Even out the spacing of the nodes on the mesh, whose normals are given; fixed ones stay."""
        free = self.free
        points, normals = points.copy(), normals.copy()
        for k in range(times + 1):
            step = self.mean @ points - points
            along = step - np.einsum("ij,ij->i", step, normals)[:, None] * normals
            moved = points + (_DAMPING * along if k else 0.0)
            around = unit(normals + self.mean @ normals)
            feet, found = tree.feet(moved[free], around[free], self.spacing(points)[free])
            points[free], normals[free] = feet, found
        return points, normals


def places(values, points, normals):
    """Face and (u, v) of the nearest places on grids of points of all faces ``(faces, n + 1, n + 1, 3)``.

    Cells that face away from the normal of a point do not count. Returns the distances to the cells, too.
    """
    a, b, c, d = values[:, :-1, :-1], values[:, 1:, :-1], values[:, 1:, 1:], values[:, :-1, 1:]
    corners = np.stack([np.stack([a, b, c], -2), np.stack([a, c, d], -2)], -3).reshape(-1, 3, 3)
    tree = triangle_tree(corners)
    gaps, which = tree.nearest(points, normals)
    lost = which < 0
    if lost.any():
        gaps[lost], which[lost] = tree.nearest(points[lost])
    origin = corners[which, 0]
    first, second, w = corners[which, 1] - origin, corners[which, 2] - origin, points - origin
    pairs = (first, first), (first, second), (second, second), (w, first), (w, second)
    uu, uv, vv, wu, wv = (np.einsum("ij,ij->i", x, y) for x, y in pairs)
    det = np.maximum(uu * vv - uv * uv, 1e-300)
    s, t = (vv * wu - uv * wv) / det, (uu * wv - uv * wu) / det
    upper = (
        which % 2 == 1
    )  # its corners are (0, 0), (1, 1), (0, 1); those of the lower (0, 0), (1, 0), (1, 1)
    local = np.column_stack([np.where(upper, s, s + t), np.where(upper, s + t, t)]).clip(0.0, 1.0)
    cell, n = which // 2, values.shape[1] - 1
    corner = np.column_stack([cell // n % n, cell % n])
    return cell // n**2, np.clip((corner + local) / n, 0.0, 1.0), gaps


def _creases(layout):
    """Places and points on the sharp edges."""
    side = layout.sides[layout.sharp, 0]
    samples = layout.curves.shape[1]
    uv = _side_places(side % 4, np.linspace(0.0, 1.0, samples))
    return (np.repeat(side // 4, samples), uv), layout.curves[layout.sharp].reshape(-1, 3)


def fit(mesh, layout: Layout, spans, tree) -> Patches:
    """Fit patches with ``spans`` spans a side to a mesh, whose triangles are in ``tree``."""
    net, count = number_control_points(layout, spans)
    faces = len(net)
    energy = _bending(net, count, spans)
    on_creases, crease_points = _creases(layout)
    crease = rows_at(net, count, spans, *on_creases)[0]
    crease_weight = _CREASE / layout.curves.shape[1]
    crease_left, crease_right = (
        crease_weight * (crease.T @ crease),
        crease_weight * (crease.T @ crease_points),
    )

    def system(face, uv, points, weight, bending):
        at = rows_at(net, count, spans, face, uv)[0]
        weighted = at.T.multiply(weight * (faces / weight.sum())).tocsr()
        return weighted @ at + crease_left + bending * energy, weighted @ points + crease_right

    def anchored(system):
        return system[0] + _ANCHOR * anchor_left, system[1] + _ANCHOR * anchor_right

    free = np.flatnonzero(mesh.kinds == 0) if (mesh.kinds == 0).any() else np.arange(len(mesh.vertices))
    nodes = _relaxed(layout, tree, spans)
    grid_uv = _grid_places(nodes.shape[1] - 1)
    at = rows_at(net, count, spans, np.repeat(np.arange(faces), len(grid_uv)), np.tile(grid_uv, (faces, 1)))[
        0
    ]
    anchor_left, anchor_right = at.T @ at / len(grid_uv), at.T @ nodes.reshape(-1, 3) / len(grid_uv)
    control = _solver(anchor_left + crease_left + 1e-6 * energy)(anchor_right + crease_right)
    points, normals, weight = _samples(mesh, free, _POINTS * count)
    face, uv, _ = places(nodes, points, normals)
    seams = None if layout.sharp.all() else _Seams(layout, nodes, net, count, spans)
    sharp = layout.sharp[layout.edges].ravel()
    twin = Patches(layout, spans, net, control).twin
    scale = _SEAM / (3 * spans + 2)
    for bending in _BENDING:
        kernels.nearest_places(control, net, spans, twin, sharp, points, face, uv)
        left, right = anchored(system(face, uv, points, weight, bending))
        if seams is None:
            control = _solver(left)(right)
            continue
        precondition = _solver(left + scale * seams.matrix)
        sine, factors, normal, pull = seams.linear(control)
        aim = seams.change(factors, control) - sine

        def apply(x, left=left, factors=factors, normal=normal):
            sines = seams.push(factors, seams.change(factors, x))
            return left @ x + scale * (sines + _TANGENT * seams.hold(normal, x))

        right = right + scale * (seams.push(factors, aim) + _TANGENT * pull)
        better = _conjugate_gradients(apply, precondition, right, control, _TURNS)
        if not np.abs(better).max() < 2.0 * np.abs(mesh.vertices).max():
            break
        control = better
    return Patches(layout, spans, net, control)


def _samples(mesh, free, most):
    """Points of the mesh, their normals and weights: a formula for integrals that is exact for parabolas.

    Vertices have a quarter of the weight, the middles of triangles the rest, so that the patches run
    between the corners of the mesh and its flat triangles, and keep its volume.
    """
    vectors = face_normals(mesh.vertices, mesh.triangles)
    areas = np.linalg.norm(vectors, axis=1) / 2
    points = np.concatenate([mesh.vertices[free], mesh.vertices[mesh.triangles].mean(axis=1)])
    normals = np.concatenate([mesh.normals[free], unit(vectors)])
    weight = np.maximum(np.concatenate([mesh.areas[free] / 4, 0.75 * areas]), _LEAST_AREA)
    step = max(1, len(points) // most)
    return points[::step], normals[::step], weight[::step]


def _solver(left):
    options = {"SymmetricMode": True}
    return splu(left.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options).solve


def _relaxed(layout, tree, spans):
    """Points of every face on an even grid, on the mesh and evenly spaced, coarse grids first."""
    values = None
    for cells, times in _LEVELS[: 3 if spans < 3 else 4]:
        grid = _Grid(layout, cells)
        if values is None:
            points, normals = layout.points, layout.normals
        else:
            finer = np.empty((len(values), cells + 1, cells + 1, 6))
            finer[:, ::2, ::2] = values
            finer[:, 1::2, ::2] = (values[:, 1:] + values[:, :-1]) / 2
            finer[:, :, 1::2] = (finer[:, :, 2::2] + finer[:, :, :-2:2]) / 2
            both = np.empty((grid.count, 6))
            both[grid.net] = finer
            points, normals = both[:, :3], unit(both[:, 3:])
            points[grid.on_creases] = _evenly(layout.curves[layout.sharp], cells)
        points, normals = grid.relax(points, normals, tree, times)
        values = np.concatenate([points, normals], axis=1)[grid.net]
    return values[..., :3]


def _evenly(curves, cells):
    """Every curve's points at cells + 1 even places."""
    at = np.arange(cells + 1) * (curves.shape[1] - 1) / cells
    low = np.minimum(at.astype(int), curves.shape[1] - 2)
    rest = (at - low)[:, None]
    return curves[:, low] * (1.0 - rest) + curves[:, low + 1] * rest


def _grid_places(cells):
    t = np.arange(cells + 1) / cells
    return np.stack(np.meshgrid(t, t, indexing="ij"), axis=-1).reshape(-1, 2)


def linear(layout: Layout) -> Patches:
    """Patches that are bilinear between the corners of the layout."""
    net, count = number_control_points(layout, 1)
    t = np.arange(DEGREE + 1) / DEGREE
    a, b, c, d = (layout.points[layout.corners[:, k]][:, None, None] for k in range(4))
    u, v = t[:, None, None], t[None, :, None]
    control = np.empty((count, 3))
    control[net] = (a * (1 - u) + b * u) * (1 - v) + (d * (1 - u) + c * u) * v
    return Patches(layout, 1, net, control, 1)
