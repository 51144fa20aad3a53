"""Random splines, and points on a knot and on a torus, for the tests of the room."""

import numpy as np

import nurbs_lab as nl


def random_knots(rng, degree, count):
    inner = np.sort(rng.uniform(0.05, 0.95, count - degree - 1))
    return np.r_[np.zeros(degree + 1), inner, np.ones(degree + 1)]


def random_curve(seed, degree, rational=True, scale=1.0, dim=3):
    rng = np.random.default_rng(seed)
    count = degree + int(rng.integers(1, 9))
    weights = rng.uniform(0.3, 3, count) if rational else None
    return nl.NurbsCurve(
        degree, random_knots(rng, degree, count), scale * rng.normal(size=(count, dim)), weights
    )


def random_surface(seed, degrees, rational=True, scale=1.0):
    rng = np.random.default_rng(seed)
    counts = [p + int(rng.integers(1, 6)) for p in degrees]
    knots = [random_knots(rng, p, n) for p, n in zip(degrees, counts, strict=True)]
    weights = rng.uniform(0.3, 3, counts) if rational else None
    return nl.NurbsSurface(degrees, knots, scale * rng.normal(size=(*counts, 3)), weights)


def trefoil(t, scale=1.0):
    t = 2 * np.pi * np.asarray(t)
    radius = 2 + np.cos(3 * t)
    return scale * np.stack([radius * np.cos(2 * t), radius * np.sin(2 * t), np.sin(3 * t)], axis=-1)


def chord_parameters(points):
    t = np.r_[0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    return t / t[-1]


def torus(u, v, scale=1.0):
    a, b = 2 * np.pi * u[:, None], 2 * np.pi * v[None]
    ring = 2 + np.cos(b)
    return scale * np.stack([ring * np.cos(a), ring * np.sin(a), np.sin(b) + 0 * a], axis=-1)
