"""The space of smooth patches: its dimension, and tangent planes that agree for any free parameters."""

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.special import binom

from nurbs_lab.mesh.solid.layout import _layout
from nurbs_lab.mesh.solid.net import number_nodes
from nurbs_lab.mesh.solid.patches import Patches
from nurbs_lab.mesh.solid.space import smooth_conditions
from nurbs_lab.nurbs import NurbsSurface

CUBE = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


def in_four(quads):
    """Every quadrilateral divided in four."""
    numbers, out = {}, []

    def vertex(*corners):
        return numbers.setdefault(tuple(sorted(corners)), len(numbers))

    for a, b, c, d in quads:
        middle, sides = vertex(a, b, c, d), [vertex(a, b), vertex(b, c), vertex(c, d), vertex(d, a)]
        for k, corner in enumerate((a, b, c, d)):
            out.append([vertex(corner), sides[k], middle, sides[k - 1]])
    return out


def torus(n, m):
    return [
        [i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m]
        for i in range(n)
        for j in range(m)
    ]


def trapezohedron(n):
    """Two vertices of n faces and 2 n of three."""
    ring = 2 + np.arange(2 * n + 2) % (2 * n)
    top = [[0, ring[2 * i], ring[2 * i + 1], ring[2 * i + 2]] for i in range(n)]
    return top + [[1, ring[2 * i + 3 - 0], ring[2 * i + 2], ring[2 * i + 1]] for i in range(n)]


LAYOUTS = {
    "cube": CUBE,
    "cube in 24": in_four(CUBE),
    "torus": torus(4, 5),
    **{f"trapezohedron {n}": trapezohedron(n) for n in (5, 6, 8)},
    "trapezohedron in four": in_four(trapezohedron(6)),
}


def layout(name, sharp=(), fixed=()):
    """A layout; ``sharp`` are pairs of vertices."""
    quads = np.array(LAYOUTS[name])
    marks = [
        [{a, b} in map(set, sharp) for a, b in zip(q, np.roll(q, -1), strict=True)] for q in quads.tolist()
    ]
    count = quads.max() + 1
    fixed = np.isin(np.arange(count), fixed)
    marks, curves = np.array(marks), np.zeros((len(quads), 4, 3, 3))
    return _layout(fixed, quads, marks, curves)


def smooth_patches(layout, angle=90.0, seed=0):
    """Patches of random control points that meet the conditions."""
    net, _ = number_nodes(layout, 6)
    space = null_space(smooth_conditions(layout, net, np.full(layout.corners.shape, angle)).toarray())
    return Patches(layout, net, space @ np.random.default_rng(seed).normal(size=(space.shape[1], 3)))


def angles_across(patches):
    """Angles in degrees at 65 places along every edge."""
    t = np.linspace(0.0, 1.0, 65)
    layout, knots = patches.layout, np.repeat([0.0, 1.0], 6)
    normals = []
    for net in patches.control[patches.net]:
        surface = NurbsSurface((5, 5), (knots, knots), net)
        for u, v in ((t, 0 * t), (0 * t + 1, t), (1 - t, 0 * t + 1), (0 * t, 1 - t)):
            n = np.cross(surface.derivative(u, v, (1, 0)), surface.derivative(u, v, (0, 1)))
            normals.append(n / np.linalg.norm(n, axis=-1, keepdims=True))
    here, there = np.array(normals)[layout.sides[:, 0]], np.array(normals)[layout.sides[:, 1], ::-1]
    sine = np.linalg.norm(np.cross(here, there), axis=-1)
    return np.degrees(np.arctan2(sine, np.abs(np.einsum("eki,eki->ek", here, there))))


@pytest.mark.parametrize("name", LAYOUTS)
def test_the_dimension_is_that_of_the_conditions(name):
    """3 V + V(of 4 faces) + E + E(a affine) + 2 E + 4 F, and the conditions themselves give the same."""
    one = layout(name)
    net, points = number_nodes(one, 6)
    ours = smooth_conditions(one, net, np.full(one.corners.shape, 90.0)).toarray()
    faces = np.bincount(one.corners.ravel())
    ends = np.sort(faces[np.stack([one.corners.ravel(), np.roll(one.corners, -1, axis=1).ravel()])], axis=0)
    affine = (ends[0] == ends[1]).sum() / 2
    count = 3 * len(faces) + (faces == 4).sum() + 3 * len(one.sides) + affine + 4 * len(one.corners)
    theirs = conditions(one, net)
    for rows in (ours, theirs, np.vstack([ours, theirs])):
        assert points - np.linalg.matrix_rank(rows) == count


def conditions(layout, net):
    """Rows of D f + D g - a f' = 0 at nine places of every edge, of the control points."""
    t = (np.arange(9) + 0.5) / 9
    i = np.arange(6)
    basis = binom(5, i) * t[:, None] ** i * (1 - t[:, None]) ** (5 - i)
    small = binom(4, i[:5]) * t[:, None] ** i[:5] * (1 - t[:, None]) ** (4 - i[:5])
    slopes = 5 * (np.pad(small, ((0, 0), (1, 0))) - np.pad(small, ((0, 0), (0, 1))))
    turned = [net, net[:, ::-1].transpose(0, 2, 1), net[:, ::-1, ::-1], net[:, :, ::-1].transpose(0, 2, 1)]
    sides = np.stack(turned, axis=1).reshape(-1, 6, 6)
    faces = np.bincount(layout.corners.ravel())
    rows = np.zeros((len(layout.sides), 9, net.max() + 1))
    for row, (one, other) in zip(rows, layout.sides, strict=True):
        f, g = sides[one], sides[other][::-1]
        c, d = np.cos(2 * np.pi / faces[f[[0, 5], 0]])
        a = 2 * c * (1 - t) ** 2 - 2 * d * t**2
        for points, weights in (
            (f[:, 0], -10 * basis - a[:, None] * slopes), (f[:, 1], 5 * basis), (g[:, 1], 5 * basis)
        ):  # fmt: skip
            row[:, points] += weights
    return rows.reshape(-1, rows.shape[-1])


@pytest.mark.parametrize("name", LAYOUTS)
def test_tangent_planes_agree_for_any_parameters(name):
    one = layout(name)
    assert angles_across(smooth_patches(one)).max() < 1e-4


def test_sharp_edges_turn_and_fade_out_at_their_ends():
    """Two sharp edges in a row between smooth vertices: they fade at both ends and are one smooth curve."""
    one = layout("torus", sharp=[(0, 5), (5, 10)])
    angles = angles_across(smooth_patches(one))
    assert angles[~one.sharp].max() < 1e-4
    assert angles[one.sharp].max(axis=1).min() > 1.0
    ends = np.stack(
        [one.corners.ravel()[one.sides[:, 0]], np.roll(one.corners, -1, axis=1).ravel()[one.sides[:, 0]]]
    )
    assert angles[one.sharp][:, [0, -1]][ends[:, one.sharp].T != 5].max() < 1e-4
    assert angles[one.sharp][:, [0, -1]][ends[:, one.sharp].T == 5].min() > 1.0


@pytest.mark.parametrize("angle", [60.0, 90.0, 120.0])
def test_faces_between_sharp_edges_at_a_corner_stay_smooth(angle):
    one = layout("torus", sharp=[(0, 5), (0, 1), (0, 15)], fixed=[0])
    angles = angles_across(smooth_patches(one, angle))
    assert angles[~one.sharp].max() < 1e-4
    assert angles[one.sharp].max(axis=1).min() > 1.0


def test_the_volume_of_a_patch_and_its_slopes_are_exact():
    """Against the divergence theorem on a fine grid, and against a difference quotient."""
    one = layout("cube")
    patches = smooth_patches(one)
    control, random = patches.control, np.random.default_rng(3)
    volume, slopes = patches.volume_slopes()
    t = (np.arange(400) + 0.5) / 400
    parts = np.einsum("fabx,fabx->fab", patches.grid(t), patches.normals(t)) / 3 / 400**2
    assert volume == pytest.approx(parts.sum(), abs=1e-5 * np.abs(parts).sum())  # most of it cancels
    way = random.normal(size=control.shape)
    more, less = (Patches(one, patches.net, control + s * way).volume_slopes()[0] for s in (1e-4, -1e-4))
    assert (slopes * way).sum() == pytest.approx((more - less) / 2e-4, rel=1e-6)
