"""Bicubic B-spline patches fitted to a mesh, all of them at once.

The fit minimises the squared distance of samples of the mesh to the patches, a small bending energy, and the
angle between the tangent planes of patches that meet in a smooth edge. The nearest places of the samples are
taken from the fit before (Hoschek 1988). Samples that are far from the patches get more weight from round to
round, which lowers the largest distance (Lawson 1961), and the best of all rounds is taken. The sine of the
angle is linearised in the derivatives of both patches and of the edge, which is a Gauss-Newton step. The
derivatives keep about the lengths that they have on an even grid of points on the mesh; without this they
would vanish at corners, and patches would fold there.
"""

import numpy as np

from nurbs_lab.mesh.solid.grids import bilinear, even_places, places
from nurbs_lab.mesh.solid.layout import Layout
from nurbs_lab.mesh.solid.patches import (
    Patches,
    between_corners,
    cell_normals,
    cells_of,
    middle_places,
    number_control_points,
    product,
    side_places,
)
from nurbs_lab.mesh.solid.seams import Seams, samples_of
from nurbs_lab.mesh.solid.squares import Squares
from nurbs_lab.mesh.solid.surfels import face_normals, factorized, unit

_BENDING = (1e-5, 1e-6, *[1e-7] * 10)  # weight of the bending energy, round by round
_ROUNDS = 4  # after which the fit ends unless a seam shows a fold, or the aim is near
_NEARLY = 3.0  # tolerances: fits that miss by more are not near their aim
_AIM, _DEGREES = 0.85, 0.45  # of the tolerance, and across a seam
_TANGENT = (*[0.005] * 3, *[0.0005] * 9)  # weight of derivatives along the planes, of that of the planes
_SEAM = 0.3  # weight of the tangent planes
_ANCHOR = 0.1  # weight of the even grid on the mesh
_FIRMER = 30.0  # factor of that weight on faces that turn over
_FIRMEST = 1e5
_FLAT = 1e6  # that weight on flat faces
_STEPS = 4  # from control points that were fitted to those on the even grid
_FIRST = 2  # round after which faces that turn over are held, and samples that are far get more weight
_FAR = 1.5  # times the RMS distance: samples beyond it are far and get more weight from round to round
_LEAST_FACTOR, _MOST_PULL = 0.9, 1e3  # of that weight in one round, and of all rounds together
TURNED = -0.3  # cosine between a cell of a patch and the mesh, below which it turns over
_CREASE = 4.0  # weight of a sharp edge
_LEAST_POINTS, _MOST_POINTS = 4, 12  # of the mesh for every control point
_LEAST_AREA = 1e-12  # of a sample, of the squared size
_LEAST_GAP = 1e-12  # RMS distance, of the size, below which samples count alike
_TURNS = 40  # of conjugate gradients in a round


def fit(mesh, layout: Layout, grid, spans, within, smooth=True) -> tuple[Patches, np.ndarray]:
    """Fit patches with ``spans`` spans a side to a mesh; which of them may turn over somewhere, too.

    ``grid(cells)`` returns an `even_grid` on the layout. The fit goes on for longer where it nearly keeps the
    distance ``within``. Without ``smooth`` tangent planes are left alone.
    """
    net, count = number_control_points(layout, spans)
    faces = len(net)
    squares = Squares(net, count, spans)
    energy = squares.bending()
    on_creases, crease_points = _creases(layout)
    crease = squares.values(*on_creases)
    crease_weight = _CREASE / layout.curves.shape[1]
    crease_left = squares.sums(*on_creases, crease, np.full(len(crease), crease_weight))
    crease_right = crease_weight * squares.pulls(*on_creases, crease, crease_points)

    smooth_vertices = np.bincount(mesh.triangles.ravel(), mesh.sharp) == 0
    free = np.flatnonzero(smooth_vertices if smooth_vertices.any() else ~smooth_vertices)
    nodes, normals = grid(4 if spans < 3 else 8)
    anchor = _Anchor(nodes, normals, squares, layout)
    control = factorized(squares.matrix(anchor.left + crease_left + 1e-6 * energy))(
        anchor.right + crease_right
    )
    points, directions, weight = _samples(mesh, free, count)
    weight *= faces / weight.sum()
    face, uv, _ = places(nodes, points, directions)
    seams = None if layout.sharp.all() or not smooth else Seams(layout, nodes, squares)
    scale = _SEAM / samples_of(spans)
    pull = np.ones(len(points))
    best, least, degrees = control, (faces, np.inf), np.inf
    folded, turned = True, faces
    for k in range(len(_BENDING) + 1):
        gaps = Patches(layout, spans, net, control).nearest(points, face, uv)
        missed = gaps.max() / within
        if k > 0 and seams is not None:
            score = max(missed / _AIM, degrees / _DEGREES)
            rank = (turned if k > _FIRST else faces), score  # first rounds do not look for such faces
            if rank <= least:
                best, least = control, rank
            near = missed < _NEARLY and score > 1.0
            if k > _ROUNDS and not (folded or turned or near):
                break
        elif k > _ROUNDS and not turned:
            break
        if k == len(_BENDING):
            break
        bending, tangent = _BENDING[k], _TANGENT[k]
        if k >= _FIRST:
            far = _FAR * max(np.sqrt(np.mean(gaps**2)), _LEAST_GAP)
            pull = np.clip(pull * np.maximum((gaps / far) ** 2, _LEAST_FACTOR), 1.0, _MOST_PULL)
        pulled = weight * pull
        pulled *= faces / pulled.sum()
        values = squares.values(face, uv)
        sums = squares.sums(face, uv, values, pulled) + crease_left
        sums += bending * energy + _ANCHOR * anchor.left
        right = squares.pulls(face, uv, values, pulled[:, None] * points)
        right += crease_right + _ANCHOR * anchor.right
        if seams is None:
            control = factorized(squares.matrix(sums))(right)
        else:
            left, (level, push, about) = squares.matrix(sums).tocsr(), seams.linear(control, tangent)
            precondition = factorized(squares.matrix(sums + scale * about))
            left.eliminate_zeros()

            def apply(x, left=left, push=push):
                x = np.ascontiguousarray(x)
                return product(left, x) + scale * push(x)

            better = _conjugate_gradients(apply, precondition, right + scale * level, control, _TURNS)
            if not np.abs(better).max() < 2.0 * np.abs(mesh.vertices).max():
                break
            control = better
            folded, degrees = seams.tighten(control, k >= _FIRST)
        turned = anchor.tighten(control) if k >= _FIRST else 0
    if np.isfinite(least[1]):
        control = best
    control = anchor.unfolded(control)
    control[net[layout.flat]] = between_corners(layout, layout.flat, middle_places(spans))
    return Patches(layout, spans, net, control), anchor.turned(control) & ~layout.flat


class _Anchor:
    """The even grid as equations, and as control points for faces that turn over somewhere.

    Control points on a grid that does not turn over make a patch that hardly does (Schoenberg's operator).
    """

    def __init__(self, nodes, normals, squares, layout):
        cells, checked = nodes.shape[1] - 1, 4 * squares.spans + 2
        faces = np.arange(len(nodes))
        self.squares, self.net, self.layout, self.checked = squares, squares.net, layout, checked

        def everywhere(uv):
            return np.repeat(faces, len(uv)), np.tile(uv, (len(faces), 1))

        uv = even_places(cells)
        values = squares.values(*everywhere(uv))
        sums = squares.sums(*everywhere(uv), values, np.full(len(values), 1.0 / len(uv)))
        self.first = sums, squares.pulls(*everywhere(uv), values, nodes.reshape(-1, 3)) / len(uv)
        beside = (np.arange(checked) + 0.5).astype(int) * cells // checked
        self.normals = unit(sum(cells_of(normals)))[:, beside[:, None], beside]
        middles = np.meshgrid(*[middle_places(squares.spans)] * 2, indexing="ij")
        drawn = bilinear(nodes, *everywhere(np.stack(middles, axis=-1).reshape(-1, 2)))
        self.targets = np.zeros((squares.count, 3))
        self.targets[self.net] = drawn.reshape(*self.net.shape, 3)
        self.weight = np.where(layout.flat, _FLAT, 0.0)
        self._weigh()

    def _weigh(self):
        each = np.broadcast_to(self.weight[:, None, None], self.net.shape).ravel() / self.net[0].size
        each = np.bincount(self.net.ravel(), each, len(self.targets))
        self.left, self.right = self.first[0].copy(), self.first[1] + each[:, None] * self.targets
        self.left[self.squares.diagonal] += each

    def turned(self, control):
        """Faces whose normal is at more than a right angle to that of the mesh somewhere."""
        normals = cell_normals(Patches(self.layout, self.squares.spans, self.net, control).grid(self.checked))
        cosine = np.einsum("fijk,fijk->fij", normals, self.normals)
        return (cosine < TURNED).any(axis=(1, 2))

    def tighten(self, control):
        """Hold faces that turn over more firmly; the number of them."""
        turned = self.turned(control) & (self.weight < _FIRMEST)
        self.weight[turned] = np.maximum(_FIRMER * self.weight[turned], 1.0)
        if turned.any():
            self._weigh()
        return int(turned.sum())

    def unfolded(self, control):
        """Control points moved towards the even grid, step by step, on the faces that turn over."""
        amount = np.zeros((len(control), 1))
        for _ in range(2 * _STEPS):
            blended = control + amount * (self.targets - control)
            turned = self.turned(blended)
            if not turned.any():
                break
            moved = np.unique(self.net[turned])
            amount[moved] = np.minimum(amount[moved] + 1.0 / _STEPS, 1.0)
        return blended


def _samples(mesh, free, count):
    """Points of the mesh, their normals and weights, for integrals over it.

    The vertices are enough where triangles are small beside the patches. Else they are joined by the middles
    of all triangles that come from cutting every side in equal parts, a formula that is exact for parabolas:
    so the patches run between the corners of the mesh and its flat triangles, and keep its volume.
    ``count`` is the number of control points.
    """
    if len(free) >= _LEAST_POINTS * count:
        step = len(free) // (_MOST_POINTS * count) + 1
        return mesh.vertices[free][::step], mesh.normals[free][::step], mesh.areas[free][::step]
    vectors = face_normals(mesh.vertices, mesh.triangles)
    areas = np.linalg.norm(vectors, axis=1) / 2
    parts = int(np.ceil(np.sqrt(_LEAST_POINTS * count / len(areas))))
    at = np.array([(i, j) for i in range(parts) for j in range(parts - i)]) + 1 / 3
    at = np.concatenate([at, at[at.sum(axis=1) < parts - 1] + 1 / 3]) / parts
    weights = np.column_stack([1.0 - at.sum(axis=1), at])
    inside = np.einsum("kc,fcx->fkx", weights, mesh.vertices[mesh.triangles]).reshape(-1, 3)
    points = np.concatenate([mesh.vertices[free], inside])
    normals = np.concatenate([mesh.normals[free], np.repeat(unit(vectors), parts**2, axis=0)])
    share = 1.0 / (3 * parts**2 + 1)  # of the vertices
    weight = [share * mesh.areas[free], np.repeat((1.0 - share) / parts**2 * areas, parts**2)]
    weight = np.maximum(np.concatenate(weight), _LEAST_AREA)
    step = max(1, len(points) // (_MOST_POINTS * count))
    return points[::step], normals[::step], weight[::step]


def _creases(layout):
    """Places and points on the sharp edges."""
    side = layout.sides[layout.sharp, 0]
    samples = layout.curves.shape[1]
    uv = side_places(side % 4, np.linspace(0.0, 1.0, samples))
    return (np.repeat(side // 4, samples), uv), layout.curves[layout.sharp].reshape(-1, 3)


def _conjugate_gradients(apply, precondition, right, x, turns):
    """Preconditioned conjugate gradients for a symmetric system of three coupled columns."""
    residual = right - apply(x)
    z = precondition(residual)
    direction, rho = z, (residual * z).sum()
    start = (right * precondition(right)).sum()
    for _ in range(turns):
        image = apply(direction)
        step = rho / (direction * image).sum()
        x = x + step * direction
        residual = residual - step * image
        z = precondition(residual)
        rho, before = (residual * z).sum(), rho
        if rho <= 1e-14 * start:
            break
        direction = z + rho / before * direction
    return x
