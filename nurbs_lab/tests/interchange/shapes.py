"""Shapes that the tests of this folder send out and get back."""

from types import SimpleNamespace

import numpy as np

import nurbs_lab as nl
from benchmarks.programs import facets
from nurbs_lab.interchange._moves import polyline
from nurbs_lab.machining.program import Move, Program
from nurbs_lab.tests.nurbs.samples import random_knots

#: What a program of moves with feeds of their own asks for, a curve in space and one in the plane.
MOVES = {"tolerance": 0.01, "units": "mm", "axes": "XYZ"}
ASKED = {"feed": 10.0, **MOVES}
PLANE = {**ASKED, "axes": "XY"}


def curve(degree=3, count=9, dim=3, rational=True, seed=0):
    rng = np.random.default_rng(seed)
    weights = rng.uniform(0.5, 2, count) if rational else None
    return nl.NurbsCurve(
        degree, random_knots(rng, degree, count), rng.normal(size=(count, dim)) * 50, weights
    )


def surface(degrees=(3, 2), size=(7, 5), rational=True, seed=1):
    rng = np.random.default_rng(seed)
    net = np.stack(np.meshgrid(*map(np.arange, size), indexing="ij"), axis=-1) * 10.0
    net = np.concatenate([net + rng.uniform(-2, 2, net.shape), rng.uniform(0, 9, (*size, 1))], axis=-1)
    u, v = (random_knots(rng, p, n) for n, p in zip(size, degrees, strict=True))
    return nl.NurbsSurface(degrees, (u, v), net, rng.uniform(0.5, 2, size) if rational else None)


def path(dim=2):
    """A stand-in for a tool path: a quarter of a circle of 10 mm in 5 periods of 1 ms."""
    t = np.arange(6) * 1e-3
    angle = np.linspace(0, np.pi / 2, 6)
    points = np.column_stack([10 * np.cos(angle), 10 * np.sin(angle), angle])[:, :dim]
    return SimpleNamespace(t=t, u=angle / angle[-1], points=points)


def assert_same(one, other, within=1e-9):
    """The same shape as a function of its parameter, not only as a set of points."""
    if isinstance(one, nl.NurbsCurve):
        u = np.linspace(*one.domain, 101)
        expected, got = one(u), other(u)
    else:
        u, v = (np.linspace(*span, n) for span, n in zip(one.domain, (41, 31), strict=True))
        expected, got = one.grid(u, v), other.grid(u, v)
    if expected.shape[-1] == 2 and got.shape[-1] == 3:
        assert not got[..., 2].any()
        got = got[..., :2]
    extent = np.ptp(expected.reshape(-1, expected.shape[-1]), axis=0).max()
    np.testing.assert_allclose(got, expected, rtol=0, atol=within * extent)


def milling():
    """Down, along a curve in the plane, up and over, down and along another."""
    cut = nl.paper.CURVE.transform([(1, 0), (0, 1), (0, 0)])
    start, end = cut(cut.domain)
    up, side = np.array([0, 0, 5]), np.array([0, 9, 0])
    return Program(
        (
            Move("rapid", polyline(start + 2 * up, start + up), 200.0),
            Move("plunge", polyline(start + up, start), 2.0),
            Move("cut", cut, 10.0),
            Move("rapid", polyline(end, end + up, start + side + up), 200.0),
            Move("plunge", polyline(start + side + up, start + side), 2.0),
            Move("cut", cut.transform(np.eye(3), side), 10.0),
        )
    )


def wave(count=600, rows=1, step=0.12):
    """Rows to and fro over a wavy surface, in short segments."""
    return facets(count * rows - 1, count, step)


def text_of(points):
    blocks = "\n".join(f"X{x:.3f} Y{y:.3f} Z{z:.3f}" for x, y, z in points)
    return f"G21 G90\nG0 X0 Y0 Z20\nF1200\nG1 {blocks}\nF600\nG1 X0 Y0\nG2 X5 Y5 R9\nG0 Z50\nM2\n"
