"""A closed surface through points with outward normals: the level set of an indicator function.

The gradient of the function that is 1 inside a solid and 0 outside is the inward normal on its surface. So
the function solves a Poisson equation (Kazhdan et al. 2006), here on a regular grid by fast Fourier
transforms. Its values at the points are then brought to one half, and the surface is where it is one half.
The outermost nodes of the grid are outside, so the surface is closed whatever the points are.
"""

import numpy as np
import scipy.fft
from scipy.spatial import cKDTree

from nurbs_lab.mesh.cloud import _kernels
from nurbs_lab.mesh.core import enclosed_volume, vertex_normals

_CELL = 0.75  # of the grid, in spacings of the points
_MARGIN = 4.0  # of the grid around the points, in spacings
_MOST_CELLS = 8_000_000
_CELLS_A_POINT = 500
_MOST_OCTAVES = 3  # between the widest blur and the narrowest
_BLUR = 0.75  # standard deviation of the normals' blur, in spacings
_LEVELLING = 2.0  # standard deviation of the correction of the values at the points, in spacings
_NEAR = 20  # points that a vertex is moved towards
_SMALLEST_GROUP = 0.02  # of the points


def closed_surface(points, normals, areas):
    """Vertices and triangles of the surface around points ``(n, 3)`` that each stand for an area."""
    spacing = np.sqrt(np.median(areas))
    low, high = points.min(axis=0) - _MARGIN * spacing, points.max(axis=0) + _MARGIN * spacing
    most = min(_MOST_CELLS, _CELLS_A_POINT * len(points))
    cell = max(_CELL * spacing, (np.prod(high - low) / most) ** (1.0 / 3.0))
    values = _indicator((points - low) / cell, normals, areas / cell**2, spacing / cell, (high - low) / cell)
    vertices, triangles = _contour(values)
    return low + cell * vertices, triangles


def moved_to(points, normals, vertices, triangles):
    """Vertices moved along their normals to the local mean of the points' planes, ``(v, 3)``."""
    across = vertex_normals(vertices, triangles)[0]
    distances, near = cKDTree(points).query(vertices, k=min(_NEAR, len(points)))
    offsets = _kernels.surface_offsets(vertices, across, near, distances, points, normals)
    vertices = vertices + np.clip(offsets, -distances[:, 0], distances[:, 0])[:, None] * across
    return _on_average(vertices, triangles)


def _indicator(places, normals, areas, spacing, extent):
    """Values of the indicator function at the nodes of a grid of unit cells."""
    shape = [scipy.fft.next_fast_len(int(np.ceil(length)) + 2, real=True) for length in extent]
    waves = [2.0 * np.pi * np.fft.fftfreq(n) for n in shape[:2]] + [2.0 * np.pi * np.fft.rfftfreq(shape[2])]
    waves = [np.float32(wave).reshape(np.roll([-1, 1, 1], axis)) for axis, wave in enumerate(waves)]

    def spread(amounts, chosen=slice(None)):
        grid = np.zeros(shape, np.float32)
        _kernels.splat(grid, places[chosen], amounts[chosen])
        return scipy.fft.rfftn(grid, overwrite_x=True)

    def blurred(spectrum, width):
        for wave in waves:
            spectrum *= np.exp(-0.5 * (float(width) * wave) ** 2)
        return spectrum

    total = 0.0
    for widening, chosen in _groups(np.sqrt(areas) / spacing):
        divergence = 0.0
        for axis, wave in enumerate(waves):
            part = spread(-normals[:, axis] * areas, chosen)
            part *= wave
            divergence = divergence + part
        total = total + blurred(divergence, max(_BLUR * spacing * widening, 0.6))
    laplacian = sum(wave**2 for wave in waves)
    laplacian[0, 0, 0] = 1.0
    total /= laplacian
    total *= np.complex64(-1j)
    values = scipy.fft.irfftn(total, s=shape, overwrite_x=True)
    values -= values[0, 0, 0]
    density = scipy.fft.irfftn(blurred(spread(areas), _LEVELLING * spacing), s=shape)
    errors = (_kernels.gather(values, places) - 0.5) * areas
    errors = scipy.fft.irfftn(blurred(spread(errors), _LEVELLING * spacing), s=shape)
    least = 0.02 * float(np.median(_kernels.gather(density, places)))
    values -= errors / (np.abs(density) + least)
    return values


def _groups(widths):
    """Points of like spacing: ``(factor of the blur, which points)``, in octaves."""
    octave = np.clip(np.rint(np.log2(widths)), 0, _MOST_OCTAVES).astype(int)
    for level in range(octave.max(), 0, -1):  # a few points are no group of their own
        if np.count_nonzero(octave == level) < _SMALLEST_GROUP * len(octave):
            octave[octave == level] = level - 1
    return [(2.0**level, np.flatnonzero(octave == level)) for level in np.unique(octave)]


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
    count = np.bincount(triangles.ravel(), minlength=len(vertices))
    means = np.column_stack(
        [
            sum(
                np.bincount(triangles[:, k], vertices[triangles[:, k - 1], d], len(vertices))
                for k in range(3)
            )
            for d in range(3)
        ]
    )
    heights = np.einsum("ij,ij->i", vertices - means / np.maximum(count, 1)[:, None], across)
    return vertices + 0.25 * heights[:, None] * across
