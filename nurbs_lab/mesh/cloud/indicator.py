"""A closed surface through points with outward normals: the level set of an indicator function.

The gradient of the function that is 1 inside a solid and 0 outside is the inward normal on its surface. So
the function solves a Poisson equation (Kazhdan et al. 2006), here on a regular grid by fast Fourier
transforms. Its values at the points are then brought to one half, and the surface is where it is one half.
The outermost nodes of the grid are outside, so the surface is closed whatever the points are.
"""

import numpy as np
import scipy.fft
from scipy.sparse import csc_array
from scipy.spatial import cKDTree

from nurbs_lab.mesh.core import enclosed_volume, vertex_normals
from nurbs_lab.mesh.distance import crossing_triangles

_CELL = 0.75  # of the grid, and standard deviation of the normals' blur, in spacings of the points
_MOST_CELLS = 8e6
_LEVELLING = 2.0  # standard deviation of the correction of the values at the points, in spacings
_NEAR = 20  # points that a vertex is moved towards
_REACH = 0.475  # of the farthest of them: 1.2 spacings


def closed_surface(points, normals, areas):
    """Vertices and triangles of the surface around points ``(n, 3)`` that each stand for an area."""
    spacing = np.sqrt(np.median(areas))
    margin = 2.0 * _LEVELLING * spacing  # of the grid, so that no blur comes round to the other side
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    cell = max(_CELL * spacing, np.cbrt(np.prod(high - low) / _MOST_CELLS))
    values = _indicator((points - low) / cell, normals, areas / cell**2, spacing / cell, (high - low) / cell)
    vertices, triangles = _contour(values)
    return low + cell * vertices, triangles


def moved_to(points, normals, vertices, triangles):
    """Vertices moved along their normals to the local mean of the points' planes, ``(v, 3)``.

    Each plane is taken with the mean of both normals, which cancels the error that the curvature of the
    surface makes to first order. Points that face away count nothing, so thin walls stay apart.
    """
    across = vertex_normals(vertices, triangles)[0]
    distances, near = cKDTree(points).query(vertices, k=min(_NEAR, len(points)))
    offsets, weights = np.zeros(len(vertices)), np.full(len(vertices), 1e-3)
    for j, gaps in zip(near.T, distances.T, strict=True):
        facing = np.maximum(np.einsum("ij,ij->i", normals[j], across), 0.0)
        heights = np.einsum("ij,ij->i", (normals[j] + across) / 2.0, points[j] - vertices)
        weight = facing**2 * np.exp(-0.5 * (gaps / (_REACH * distances[:, -1])) ** 2)
        offsets, weights = offsets + weight * heights, weights + weight
    offsets = np.clip(offsets / weights, -distances[:, 0], distances[:, 0])
    return _on_average(vertices + offsets[:, None] * across, triangles)


def uncrossed(moved, vertices, triangles):
    """Moved vertices, but where triangles cross, those that they had on the level set: there none cross."""
    while True:
        partner = crossing_triangles(moved, triangles)
        at = triangles[np.append(np.flatnonzero(partner >= 0), partner[partner >= 0])]
        if (moved[at] == vertices[at]).all():
            return moved
        moved[at] = vertices[at]


def _indicator(places, normals, areas, spacing, extent):
    """Values of the indicator function at the nodes of a grid of unit cells."""
    shape = [scipy.fft.next_fast_len(int(np.ceil(length)) + 2, real=True) for length in extent]
    waves = [2.0 * np.pi * np.fft.fftfreq(n) for n in shape[:2]] + [2.0 * np.pi * np.fft.rfftfreq(shape[2])]
    waves = [np.float32(wave).reshape(np.roll([-1, 1, 1], axis)) for axis, wave in enumerate(waves)]
    nodes = _nodes_of(places, shape)

    def blurred(amounts, width):
        grid = (nodes @ amounts).astype(np.float32).reshape(shape)
        spectrum = scipy.fft.rfftn(grid, overwrite_x=True)
        for wave in waves:
            spectrum *= np.exp(-0.5 * (float(width) * wave) ** 2)
        return spectrum

    width = max(_CELL * spacing, 0.6)
    total = sum(wave * blurred(-normals[:, axis] * areas, width) for axis, wave in enumerate(waves))
    laplacian = sum(wave**2 for wave in waves)
    laplacian[0, 0, 0] = 1.0
    total /= laplacian
    total *= np.complex64(-1j)
    values = scipy.fft.irfftn(total, s=shape, overwrite_x=True)
    values -= values[0, 0, 0]
    density = scipy.fft.irfftn(blurred(areas, _LEVELLING * spacing), s=shape)
    errors = (nodes.T @ values.ravel() - 0.5) * areas
    errors = scipy.fft.irfftn(blurred(errors, _LEVELLING * spacing), s=shape)
    values -= errors / (np.abs(density) + 0.02 * np.median(nodes.T @ density.ravel()))
    return values


def _nodes_of(places, shape):
    """Share of each of the eight nodes around every place, ``(nodes, places)``: trilinear interpolation."""
    low = places.astype(np.int64)
    above = places - low
    rows, shares = [], []
    for corner in np.ndindex(2, 2, 2):
        rows.append(np.ravel_multi_index((low + corner).T, shape))
        shares.append(np.where(corner, above, 1.0 - above).prod(axis=1))
    rows, shares = np.transpose(rows).ravel(), np.transpose(shares).ravel()
    return csc_array((shares, rows, 8 * np.arange(len(places) + 1)), shape=(np.prod(shape), len(places)))


def _contour(values):
    """Vertices and triangles where the values are one half."""
    import pyvista

    for axis in range(3):
        outermost = np.moveaxis(values, axis, 0)
        outermost[0] = outermost[-1] = 0.0
    values -= 0.5
    values[np.abs(values) < 1e-3] = 1e-3  # no vertex falls on a node, where two would be one
    grid = pyvista.ImageData(dimensions=values.shape)
    grid["values"] = values.ravel(order="F")
    surface = grid.contour(
        [0.0], scalars="values", method="flying_edges", compute_normals=False, compute_scalars=False
    )
    if not surface.n_points:
        return np.empty((0, 3)), np.empty((0, 3), np.int64)
    vertices, triangles = surface.points.astype(np.float64), surface.regular_faces
    outward = enclosed_volume(vertices, triangles) > 0.0
    return vertices, triangles if outward else triangles[:, ::-1]


def _on_average(vertices, triangles):
    """Move vertices out by the mean height of the surface above its triangles.

    Triangles with their corners on a curved surface lie inside it. On a sphere the mean distance is a
    quarter of the distance of a vertex from the mean of its neighbours.
    """
    across = vertex_normals(vertices, triangles)[0]
    corners, before = triangles.ravel(), np.roll(triangles, 1, axis=1).ravel()
    count = np.bincount(corners, minlength=len(vertices))
    sums = [np.bincount(corners, column[before], len(vertices)) for column in vertices.T]
    heights = np.einsum("ij,ij->i", vertices - (sums / np.maximum(count, 1)).T, across)
    return vertices + 0.25 * heights[:, None] * across
