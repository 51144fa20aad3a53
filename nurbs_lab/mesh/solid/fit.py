"""Smooth patches fitted to a mesh, all at once: sparse least squares in a space that is smooth anyway.

The fit minimises a symmetric sum of squares: from samples of the mesh to their nearest places on the patches,
and from a grid on every patch to the nearest points of the mesh, which are both taken from the fit before
(Hoschek 1988). Without the second half patches would overshoot where there are no samples. The energy of a
thin plate in (u, v) fades out from round to round. Samples that stay far away get more weight (Lawson 1961),
and the best of all rounds is taken. Every round keeps the volume of the mesh.
"""

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.sparse import coo_array
from trimesh.triangles import closest_point

from nurbs_lab.mesh.core import face_normals, unit, vertex_normals
from nurbs_lab.mesh.distance import triangle_tree
from nurbs_lab.mesh.solid.faces import ALONG
from nurbs_lab.mesh.solid.features import factorized
from nurbs_lab.mesh.solid.grids import even_places, places
from nurbs_lab.mesh.solid.net import DEGREE, number_nodes, side_places, sides_of, turned
from nurbs_lab.mesh.solid.patches import Patches, basis_at
from nurbs_lab.mesh.solid.rims import onto
from nurbs_lab.mesh.solid.space import smooth_conditions

ENERGY = 1e-3, 3e-4, 1e-4, 3e-5, 1e-5  # weight of the thin plate, round by round
ROUNDS = 14  # at most
HOPELESS = 2.0  # tolerances off the mesh, from which no more rounds than those of ENERGY are made
STIFFER = 10.0  # factor of the energy of a patch that folds, from round to round
PENALTY, CORRECTIONS = 1e3, 4  # of the conditions of smooth edges, and how often its force is corrected
GRID = DEGREE + 2  # cells of the grid on a patch
RIM = 1e5  # weight of edges that are held on surfaces, in the last fit


def fit(target, layout, nodes, within, rims) -> Patches:
    """Patches on a layout, near a target `Target` to about ``within``; ``nodes`` are its even grids.

    ``rims`` are edges of the layout which are held on a surface each: pairs of both.
    """
    net, count = number_nodes(layout, DEGREE + 1)
    equations = _Equations(net, smooth_conditions(layout, net, _angles(nodes)))
    faces, cells = len(nodes), nodes.shape[1] - 1
    even, grid = even_places(cells), even_places(GRID)
    face, uv = np.repeat(np.arange(faces), len(even)), np.tile(even, (faces, 1))
    start = face, uv, np.full(len(uv), 1.0 / len(even)), nodes.reshape(-1, 3)
    solve = equations.solver(np.full(faces, ENERGY[0]), start, _creases(layout))
    patches = Patches(layout, net, solve())
    points, normals, weight = target.samples(count)
    own = np.repeat(np.arange(faces), len(grid)), np.tile(grid, (faces, 1))
    pulls = np.ones(len(points)), np.ones(len(own[0]))
    best, least, stiff, order = patches, np.inf, np.ones(faces), None
    for k in range(1, ROUNDS + 1):
        face, uv, order = places(patches.grid(np.arange(9) / 8), points, normals, order)
        gaps = patches.nearest(points, face, uv)
        on_grid = patches.grid(np.arange(GRID + 1) / GRID).reshape(-1, 3)
        feet = target.feet(on_grid)
        back = np.linalg.norm(on_grid - feet, axis=1)
        folded = patches.flipped()
        worst = max(gaps.max(), back.max()) / within
        if k > 1 and worst + folded.sum() < least:
            best, least = patches, worst + folded.sum()
        if least < 1.0 or k == ROUNDS or (k > len(ENERGY) and worst > HOPELESS):
            break
        if k > 2:
            stiff[folded] *= STIFFER
            far = 1.5 * max(np.sqrt(np.mean(gaps**2)), 1e-9)
            pulls = tuple(
                np.maximum(pull * np.maximum((gap / far) ** 2, 0.9), 1.0)
                for pull, gap in zip(pulls, (gaps, back), strict=True)
            )
        total = weight * pulls[0]
        mesh_part = face, uv, total * (faces / total.sum()), points
        grid_part = *own, pulls[1] * (faces / pulls[1].sum()), feet
        energy = stiff * ENERGY[min(k, len(ENERGY)) - 1]
        solve = equations.solver(energy, mesh_part, grid_part, _creases(layout, patches))
        patches = Patches(layout, net, solve())
        patches = Patches(layout, net, _with_volume(patches, solve, target.volume))
    if rims:
        best = Patches(layout, net, equations.solver(energy, mesh_part, grid_part, _held(best, rims))())
    return best


def _with_volume(patches, solve, volume):
    """Control points moved as little as the fit allows, to enclose a volume; one Newton step."""
    now, slopes = patches.volume_slopes()
    change = solve(slopes)
    return patches.control + change * ((volume - now) / max((slopes * change).sum(), 1e-300))


class _Equations:
    """Least squares of control points under the conditions of a space.

    The conditions are met by the method of multipliers: a penalty keeps the equations positive definite, and
    a few corrections of its force, with one factorisation, make the rest of the conditions vanish.
    """

    def __init__(self, net, conditions):
        flat = net.reshape(len(net), -1)
        self.net, self.conditions = net, conditions
        self.rows, self.columns = np.broadcast_arrays(flat[:, :, None], flat[:, None, :])
        self.penalty, self.energy = PENALTY * (conditions.T @ conditions), thin_plate()

    def solver(self, energy, *samples):
        """A function that gives the control points of the fit, or those of the least change along a slope.

        A sample is a face, (u, v), a weight and a target.
        """
        face, uv, weight, target = (np.concatenate(part) for part in zip(*samples, strict=True))
        order = np.argsort(face, kind="stable")
        ends = np.cumsum(np.bincount(face, minlength=len(self.net)))[:-1]
        u, v = basis_at(uv[order, 0]), basis_at(uv[order, 1])
        rows = np.einsum("ni,nj->nij", u, v).reshape(len(order), -1)
        weighted = weight[order, None] * rows
        parts = [np.split(values, ends) for values in (weighted, rows, target[order])]
        left = np.stack([a.T @ b for a, b, _ in zip(*parts, strict=True)])
        left += energy[:, None, None] * self.energy
        right = np.stack([a.T @ c for a, _, c in zip(*parts, strict=True)])
        squares = coo_array((left.ravel(), (self.rows.ravel(), self.columns.ravel())), self.penalty.shape)
        force = np.zeros((self.penalty.shape[0], 3))
        np.add.at(force, self.net.reshape(len(self.net), -1), right)
        solve = factorized(squares.tocsc() + self.penalty)

        def constrained(force=force):
            multipliers = np.zeros((self.conditions.shape[0], 3))
            for _ in range(CORRECTIONS):
                control = solve(force - self.conditions.T @ multipliers)
                multipliers += PENALTY * (self.conditions @ control)
            return control

        return constrained


def thin_plate():
    """The integral of |S_uu|^2 + 2 |S_uv|^2 + |S_vv|^2 over a patch, in its control points ``(36, 36)``."""
    x, w = leggauss(DEGREE + 1)
    parts = [basis_at((x + 1.0) / 2.0, k) for k in range(3)]
    zero, one, two = (part.T @ (part * w[:, None] / 2.0) for part in parts)
    return np.kron(two, zero) + 2.0 * np.kron(one, one) + np.kron(zero, two)


def _creases(layout, patches=None):
    """Samples of sharp edges, those between the ends at the nearest parameters of the patches, if given."""
    chosen = np.flatnonzero(layout.sharp)
    side, points = layout.sides[chosen, 0], layout.curves[chosen]
    count = points.shape[1]
    t = np.tile(np.linspace(0.0, 1.0, count), (len(side), 1))
    if patches is not None:
        nets = np.stack(turned(patches.nets), axis=1).reshape(-1, DEGREE + 1, DEGREE + 1, 3)
        there = np.arange(65) / 64
        curve = basis_at(there) @ nets[side][:, :, 0]
        gaps = ((points[:, 1:-1, None] - curve[:, None]) ** 2).sum(axis=-1)
        t[:, 1:-1] = there[gaps.argmin(axis=2)]
    uv = side_places(np.arange(4), t.ravel()).reshape(4, -1, count, 2)[side % 4, np.arange(len(side))]
    return np.repeat(side // 4, count), uv.reshape(-1, 2), np.full(t.size, 1.0 / count), points.reshape(-1, 3)


def _held(patches, rims):
    """Samples of rims, at the places of their surfaces that are nearest to the curves there are."""
    side = patches.layout.sides[[edge for edge, _ in rims], 0]
    t = np.linspace(0.0, 1.0, ALONG)
    curves = basis_at(t) @ np.stack(sides_of(patches.nets), axis=1).reshape(-1, DEGREE + 1, 3)[side]
    at_end = {}
    for (_, surface), curve in zip(rims, curves, strict=True):
        for end in curve[0], curve[-1]:
            at_end.setdefault(tuple(end), []).append(surface)
    for (_, surface), curve in zip(rims, curves, strict=True):
        ends = [onto(at_end[tuple(curve[k])], curve[[k]])[0] for k in (0, -1)]
        curve[:] = onto([surface], curve)
        curve[0], curve[-1] = ends
    uv = side_places(np.arange(4), t).reshape(4, -1, 2)[side % 4].reshape(-1, 2)
    return np.repeat(side // 4, ALONG), uv, np.full(len(uv), RIM / ALONG), curves.reshape(-1, 3)


def _angles(nodes):
    """Angles of faces at their corners, ``(faces, 4)`` in degrees, from grids of nodes."""
    out = []
    for grid in turned(nodes):
        a, b = unit(grid[:, 1, 0] - grid[:, 0, 0]), unit(grid[:, 0, 1] - grid[:, 0, 0])
        out.append(np.degrees(np.arccos(np.clip(np.einsum("fx,fx->f", a, b), -1.0, 1.0))))
    return np.stack(out, axis=1)


class Target:
    """The mesh that patches are fitted to: samples of it, its volume, and the nearest points on it."""

    def __init__(self, vertices, triangles, volume):
        self.vertices, self.triangles, self.volume = vertices, triangles, volume
        self.tree = triangle_tree(vertices[triangles])

    def feet(self, points):
        """The nearest points of the mesh."""
        return closest_point(self.vertices[self.triangles[self.tree.nearest(points)[1]]], points)

    def samples(self, count):
        """Points of the mesh, their normals and weights, for integrals over it.

        The vertices are enough where triangles are small beside the patches. Else they are joined by the
        middles of all triangles that come from cutting every side in equal parts, a formula that is exact for
        parabolas: so the patches run between the corners of the mesh and its flat triangles. ``count`` is the
        number of control points; there are at least four and at most twelve samples for each.
        """
        vertices, triangles = self.vertices, self.triangles
        normals, areas = vertex_normals(vertices, triangles)
        if len(vertices) < 4 * count:
            parts = int(np.ceil(np.sqrt(4 * count / len(triangles))))
            at = np.array([(i, j) for i in range(parts) for j in range(parts - i)]) + 1 / 3
            at = np.concatenate([at, at[at.sum(axis=1) < parts - 1] + 1 / 3]) / parts
            weights = np.column_stack([1.0 - at.sum(axis=1), at])
            vectors = face_normals(vertices, triangles)
            inside = np.einsum("kc,fcx->fkx", weights, vertices[triangles]).reshape(-1, 3)
            vertices = np.concatenate([vertices, inside])
            normals = np.concatenate([normals, np.repeat(unit(vectors), parts**2, axis=0)])
            share = 1.0 / (3 * parts**2 + 1)  # of the vertices
            sizes = np.linalg.norm(vectors, axis=1) / 2.0
            areas = np.concatenate([share * areas, np.repeat((1.0 - share) / parts**2 * sizes, parts**2)])
        step = max(1, len(vertices) // (12 * count))
        return vertices[::step], normals[::step], np.maximum(areas[::step], 1e-12)
