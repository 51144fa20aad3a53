"""Hostile values in the place of good ones: lists of them, and others drawn from a random generator."""

import decimal
from types import SimpleNamespace

import numpy as np
import trimesh

import nurbs_lab as nl
from nurbs_lab.tests.robust.calls import CURVE, SURFACE

NESTED = [1, 2]
NESTED.append(NESTED)
WORDS = [
    None, "nonsense", b"x", {}, object(), NESTED, iter([1]), [], [[1, 2], [3]], [None], range(3), CURVE,
    SURFACE, np.ma.masked, np.array([None, 1.0]), np.array([True]), np.datetime64("2020"),
    np.zeros(2, [("a", float)]), np.nan, np.inf, -np.inf, 1e300, 5e-324, -0.0, 0, -1, -0.5, 2**63, 10**400,
    True, 1j, np.longdouble("1e400"), decimal.Decimal("nan"), np.array(0.5), np.array([0.5]), np.float16(2),
    np.zeros((0, 3)), np.zeros((2, 2, 2, 2)), np.full((5, 3), np.nan), np.full((5, 3), 1e308),
]  # fmt: skip
SPOILS = [np.nan, np.inf, -np.inf, 1e300, 1e99, -1e99, 1e-300, 5e-324, -0.0]


def spline(rng, axes):
    """A random curve or surface, as hostile as the constructors accept."""
    degrees, counts = rng.integers(1, 6, axes), []
    knots = []
    for degree in degrees:
        count = int(degree + rng.integers(1, 8))
        inner = np.sort(rng.uniform(0, 1, count - degree - 1))
        if rng.random() < 0.3 and len(inner) > 1:
            inner[1:] = inner[0] + np.cumsum(10.0 ** rng.uniform(-12, -6, len(inner) - 1))
        vector = np.concatenate([np.zeros(degree + 1), np.minimum(inner, 1 - 1e-9), np.ones(degree + 1)])
        knots.append(vector * 10.0 ** rng.integers(-3, 4))
        counts.append(count)
    points = rng.normal(size=(*counts, int(rng.choice([2, 3])) if axes == 1 else 3))
    if rng.random() < 0.3:
        points = np.round(points)
    points = points * 10.0 ** rng.uniform(-9, 9) + rng.choice([0.0, 1e3, 1e6])
    if rng.random() < 0.2:
        points[-1] = points[0]
    weights = 10.0 ** rng.uniform(-4, 4, counts) if rng.random() < 0.4 else None
    kind = nl.NurbsCurve if axes == 1 else nl.NurbsSurface
    return kind(*((int(degrees[0]), knots[0]) if axes == 1 else (degrees.tolist(), knots)), points, weights)


def bad(rng, value):
    """Something hostile in the place of a good value."""
    if isinstance(value, bytes):
        return file(rng, value)
    if rng.random() < 0.8:
        if isinstance(value, (nl.NurbsCurve, nl.NurbsSurface)):
            return spline(rng, 1 if isinstance(value, nl.NurbsCurve) else 2)
        if isinstance(value, trimesh.Trimesh):
            return mesh(rng, value)
        if isinstance(value, np.ndarray) and value.size:
            return array(rng, value)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            return type(value)(np.clip(value * 10.0 ** rng.uniform(-9, 9), -1e18, 1e18))
        if isinstance(value, list) and value:
            spoiled, i = list(value), rng.integers(len(value))
            spoiled[i] = bad(rng, value[i])
            return spoiled
    return nonsense(rng, value)


def nonsense(rng, value):
    """What is of another kind than the good value, or far from everyday ones."""
    word = WORDS[rng.integers(len(WORDS))]
    return None if callable(value) and callable(word) else word  # what a function does is its author's


def array(rng, good):
    """An array with a bad number, at another scale, with rows doubled, equal, moved or lost."""
    spoiled = good.astype(float)
    way = rng.integers(6)
    if way == 0:
        spoiled.flat[rng.integers(good.size)] = rng.choice(SPOILS)
    elif way == 1:
        spoiled = spoiled * 10.0 ** rng.uniform(-12, 12)
    elif way == 2:
        spoiled = spoiled[rng.integers(0, len(spoiled), rng.integers(1, 2 * len(spoiled) + 1))]
    elif way == 3:
        spoiled[rng.integers(len(spoiled))] = spoiled[0]
    elif way == 4:
        spoiled = spoiled + rng.normal(size=spoiled.shape) * 10.0 ** rng.uniform(-12, 3)
    else:
        spoiled = spoiled[: rng.integers(len(spoiled) + 1)]
    return spoiled


def mesh(rng, good):
    """A mesh with bad vertices, or with triangles lost, doubled, turned round, without area, to nowhere."""
    vertices, faces = np.array(good.vertices), np.array(good.faces)
    some = rng.integers(0, len(faces), rng.integers(1, 6))
    way = rng.integers(8)
    if way == 0:
        faces = np.delete(faces, some, axis=0)
    elif way == 1:
        faces = np.concatenate([faces, faces[some]])
    elif way == 2:
        faces[some] = faces[some, ::-1]
    elif way == 3:
        faces[some, 0] = faces[some, 1]
    elif way == 4:
        faces[some, 0] = rng.integers(-2, len(vertices) + 2)
    elif way == 5:
        vertices[:, rng.integers(3)] *= rng.choice([0.0, 1e-9, 1e6])
    else:
        vertices = array(rng, vertices) if way == 6 else vertices * 10.0 ** rng.uniform(-9, 9)
    return SimpleNamespace(vertices=vertices, faces=faces)


def file(rng, data):
    """A file of which some bytes were changed, lost, doubled or exchanged, up to four times."""
    for _ in range(rng.integers(1, 5)):
        a, b = np.sort(rng.integers(0, len(data) + 1, 2))
        b = rng.choice([b, min(b, a + 20)])
        piece = data[a:b]
        way = rng.integers(4)
        if way == 0:
            piece = rng.bytes(rng.integers(1, 9))
        elif way == 1:
            piece = b""
        elif way == 2:
            piece *= 2
        else:
            piece = piece.replace(*rng.choice([(b"1", b"nan"), (b".", b"e9"), (b"0", b"-1")]))
        data = data[:a] + piece + data[b:]
    return data
