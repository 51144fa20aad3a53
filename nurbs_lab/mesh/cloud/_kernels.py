"""Hot loops of the surface reconstruction from points, on plain arrays."""

import numpy as np
from numba import njit

NOISE = 16.0  # variances; three standard deviations across two points make no link sure and wrong


@njit(cache=True, nogil=True)
def mirrored(points, directions, i, j, area, noise):
    """Product of direction i with direction j mirrored at the plane halfway between the points.

    On a circular arc the mirror image of an outward normal is the outward normal of the other point, so the
    product is +1 if both directions point to the same side. Points that are closer to each other than the
    side of the ``area`` around them, or than a few deviations of the ``noise`` (a variance), are mirrored
    less, because chance decides in which direction one sees the other.
    """
    a, b, c = 0.0, 0.0, 0.0
    squared = 0.0
    for d in range(3):
        step = points[j, d] - points[i, d]
        a += step * directions[i, d]
        b += step * directions[j, d]
        c += directions[i, d] * directions[j, d]
        squared += step * step
    return c - 2.0 * a * b / (max(squared, area) + NOISE * noise)


@njit(cache=True, nogil=True)
def link_doubts(points, directions, neighbours, areas, noise):
    """How doubtful it is that two neighbours have a common side, ``(n, k)``: 0 is sure, 1 is unknown."""
    doubts = np.empty(neighbours.shape)
    for i in range(len(points)):
        for k in range(neighbours.shape[1]):
            product = mirrored(points, directions, i, neighbours[i, k], areas[i], noise[i])
            doubts[i, k] = 1.0 - min(abs(product), 1.0)
    return doubts


@njit(cache=True, nogil=True)
def spread_signs(order, before, points, directions, areas, noise):
    """The sign of every direction, carried from the first point along a spanning tree, ``(n,)``."""
    signs = np.ones(len(points))
    for i in order[1:]:
        product = mirrored(points, directions, i, before[i], areas[i], noise[i])
        signs[i] = signs[before[i]] * (1.0 if product >= 0.0 else -1.0)
    return signs


@njit(cache=True, nogil=True)
def splat(grid, places, values):
    """Add each value to the eight nodes around its place, in proportion (cloud in cell)."""
    for i in range(len(places)):
        x, y, z = places[i]
        a, b, c = int(x), int(y), int(z)
        for corner in range(8):
            u, v, w = corner & 1, (corner >> 1) & 1, corner >> 2
            part = (1.0 - abs(x - a - u)) * (1.0 - abs(y - b - v)) * (1.0 - abs(z - c - w))
            grid[a + u, b + v, c + w] += values[i] * part


@njit(cache=True, nogil=True)
def gather(grid, places):
    """Trilinear interpolation of a grid."""
    out = np.zeros(len(places))
    for i in range(len(places)):
        x, y, z = places[i]
        a, b, c = int(x), int(y), int(z)
        for corner in range(8):
            u, v, w = corner & 1, (corner >> 1) & 1, corner >> 2
            part = (1.0 - abs(x - a - u)) * (1.0 - abs(y - b - v)) * (1.0 - abs(z - c - w))
            out[i] += part * grid[a + u, b + v, c + w]
    return out


@njit(cache=True, nogil=True)
def surface_offsets(vertices, vertex_normals, near, distances, points, normals):
    """Signed distance, along the normal of each vertex, to the local mean of the planes of its near points.

    Each plane is taken with the mean of both normals, which cancels the error that the curvature of the
    surface makes to first order. Points that face away count nothing, so thin walls stay apart.
    """
    out = np.zeros(len(vertices))
    for i in range(len(vertices)):
        reach = 0.475 * distances[i, -1]  # 1.2 times the spacing, for twenty neighbours
        total, weights = 0.0, 1e-3
        for k in range(near.shape[1]):
            j = near[i, k]
            facing, height = 0.0, 0.0
            for d in range(3):
                facing += normals[j, d] * vertex_normals[i, d]
                height += (normals[j, d] + vertex_normals[i, d]) * (points[j, d] - vertices[i, d])
            if facing > 0.0:
                weight = facing * facing * np.exp(-0.5 * (distances[i, k] / reach) ** 2)
                weights += weight
                total += 0.5 * weight * height
        out[i] = total / weights
    return out
