"""Curves and surfaces beside SciPy, splipy, geomdl and OpenCASCADE."""

from __future__ import annotations

import multiprocessing
import resource
import sys
import time
from dataclasses import replace
from functools import partial

import numpy as np
import splipy
from geomdl import NURBS, fitting
from OCP.GeomAPI import GeomAPI_Interpolate, GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_HArray1OfPnt
from scipy.interpolate import BSpline, NdBSpline, make_interp_spline

import nurbs_lab as nl
from benchmarks.harness import Bar, compare
from nurbs_lab.interchange._opencascade import surface_of


def ring(count):
    """Points on a closed space curve."""
    turn = 2 * np.pi * np.arange(count) / count
    return np.column_stack([np.cos(turn) * (2 + np.cos(5 * turn)), np.sin(turn) * 2, np.sin(3 * turn)])


def height(x, y):
    """A smooth surface over the unit square."""
    return 0.3 * np.sin(5 * x) * np.cos(4 * y)


def height_field(count):
    """A grid of points of it."""
    x = np.linspace(0, 1, count)
    x, y = np.meshgrid(x, x, indexing="ij")
    return np.stack([x, y, height(x, y)], axis=-1)


def off_the_field(points):
    """How far above or below the surface points are at most."""
    x, y, z = np.moveaxis(points, -1, 0)
    return float(np.abs(z - height(x, y)).max())


def chord_parameters(points):
    """Chord-length parameters on [0, 1] along axis 0, the mean over the rows of a grid."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=-1).reshape(len(points) - 1, -1)
    t = np.concatenate([[0], np.cumsum((steps / steps.sum(axis=0)).mean(axis=1))])
    t[-1] = 1
    return t


def with_slow_peer(row, peer, call, fraction, what, answer):
    """The row with a peer that is timed once, on a fraction of the work, its time divided by that fraction.

    Where its time grows faster than the work, ``what`` must say that this is a lower bound. ``answer`` takes
    what the call returns and says how good it is.
    """
    start = time.perf_counter()
    result = call()
    seconds = row.seconds | {peer: (time.perf_counter() - start) / fraction}
    answers = row.answers | {peer: answer(result)}
    notes = "; ".join(filter(None, [row.notes, f"{peer} timed {what}"]))
    return replace(row, seconds=seconds, answers=answers, notes=notes)


def apart(ours, theirs):
    """Largest difference of two arrays."""
    return float(np.abs(np.asarray(ours) - theirs).max())


def seam_jump(second, domain, count):
    """Jump of C'' where a closed cubic through points begins and ends, as a part of its largest value.

    ``second(u)`` is only asked inside: some libraries take the end for the start. C'' is linear there.
    """
    start, end = domain
    near = 0.1 * (end - start) / count
    before, after = (2 * second(u + step) - second(u + 2 * step) for u, step in ((end, -near), (start, near)))
    largest = max(np.linalg.norm(second(u)) for u in np.linspace(start, end, 1001)[1:-1])
    return float(np.linalg.norm(after - before) / largest)


def closed_curve(count, bars, *, slow_peers):
    """A closed cubic through points in space."""
    points = ring(count)
    closing = np.vstack([points, points[:1]])
    contestants = {
        "nurbs_lab": lambda: nl.interpolate_curve(points, 3, closed=True),
        "scipy": lambda: make_interp_spline(chord_parameters(closing), closing, bc_type="periodic"),
    }
    judges = {
        "nurbs_lab": lambda fit: seam_jump(partial(fit.derivative, order=2), fit.domain, count),
        "scipy": lambda fit: seam_jump(fit.derivative(2), (0, 1), count),
    }
    if slow_peers:
        array = TColgp_HArray1OfPnt(1, count)
        for i, point in enumerate(points):
            array.SetValue(i + 1, gp_Pnt(*point))

        def occ():
            maker = GeomAPI_Interpolate(array, True, 1e-9)
            maker.Perform()
            return maker.Curve()

        def occ_jump(fit):
            def second(u):
                value = fit.DN(u, 2)
                return np.array([value.X(), value.Y(), value.Z()])

            return seam_jump(second, (fit.FirstParameter(), fit.LastParameter()), count)

        contestants["opencascade"] = occ
        judges["opencascade"] = occ_jump
    memory = "memory / data of 2,000,000 points"
    row = compare(
        "nurbs",
        f"closed cubic through {count:,} points",
        contestants,
        bars,
        repeats=25 if slow_peers else 7,
        budget_s=5.0,
        measure="jump of C'' at the seam, relative",
        judges=judges,
        most={} if slow_peers else {memory: 10},
    )
    u = np.linspace(0, 1, 10_001)
    row.figures["apart from scipy"] = apart(*(contestants[name]()(u) for name in ("nurbs_lab", "scipy")))
    if not slow_peers:
        row.figures[memory] = memory_ratio(2_000_000)
    else:

        def jump(fit):
            return seam_jump(lambda u: np.array(fit.derivatives(u, 2)[2]), (0, 1), count)

        ring_again = closing.tolist()
        what = "once, with the first point repeated: it has no closed fit"
        row = with_slow_peer(row, "geomdl", lambda: fitting.interpolate_curve(ring_again, 3), 1, what, jump)
    return row


def memory_ratio(count):
    """Growth of the peak memory during the closed fit, over the size of the points; in a fresh process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(_memory_ratio, (count,))


def _memory_ratio(count):
    nl.interpolate_curve(ring(50), 3, closed=True)
    points = ring(count)
    unit = 1 if sys.platform == "darwin" else 1024
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    nl.interpolate_curve(points, 3, closed=True)
    return (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * unit / points.nbytes


def curve_points():
    """A million points of a cubic."""
    curve = nl.interpolate_curve(ring(100), 3)
    spline = curve.to_scipy()
    u = np.linspace(0, 1, 1_000_000)
    mixed = np.random.default_rng(0).permutation(u)
    for order, at in (("in order", u), ("at random", mixed)):
        yield compare(
            "nurbs",
            f"1,000,000 points of a cubic, parameters {order}",
            {"nurbs_lab": lambda at=at: curve(at), "scipy": lambda at=at: spline(at)},
            [Bar("scipy", 2.0)],
            measure="apart from nurbs_lab",
            judges={"scipy": lambda theirs, at=at: apart(curve(at), theirs)},
        )


def surface_grid(count=1000):
    """A grid of points of a rational bicubic surface."""
    plain = nl.interpolate_surface(height_field(20))
    weights = np.random.default_rng(0).uniform(0.5, 2, (20, 20))
    surface = nl.NurbsSurface(plain.degrees, plain.knots, plain.control_points, weights)
    u = np.linspace(0, 1, count)
    lifted = NdBSpline(surface.knots, surface.homogeneous, (3, 3))
    pairs = np.stack(np.meshgrid(u, u, indexing="ij"), axis=-1)

    def divide(rows):
        return rows[..., :3] / rows[..., 3:]

    def two_pass():
        across = BSpline(surface.knots[0], surface.homogeneous, 3)(u)
        return divide(BSpline(surface.knots[1], across, 3, axis=1)(u))

    contestants = {
        "nurbs_lab": lambda: surface.grid(u, u),
        "scipy NdBSpline": lambda: divide(lifted(pairs)),
        "scipy two-pass": two_pass,
    }
    bars = [Bar("scipy NdBSpline", 5), Bar("scipy two-pass", 1.5), Bar("splipy", 50), Bar("geomdl", 50)]
    bases = [splipy.BSplineBasis(4, k) for k in surface.knots]
    # splipy wants the first direction fastest
    controls = surface.homogeneous.transpose(1, 0, 2).reshape(-1, 4)
    peer = splipy.Surface(*bases, controls, rational=True, raw=False)
    contestants["splipy"] = lambda: peer(u, u)
    row = compare(
        "nurbs",
        f"{count} x {count} grid of a rational bicubic surface",
        contestants,
        bars,
        reason="50 times splipy's speed is faster than memory takes the points",
        measure="apart from nurbs_lab",
        judges=dict.fromkeys([*contestants][1:], lambda theirs: apart(surface.grid(u, u), theirs)),
    )
    slow = NURBS.Surface()
    slow.degree_u = slow.degree_v = 3
    slow.set_ctrlpts(surface.homogeneous.reshape(-1, 4).tolist(), 20, 20)
    slow.knotvector_u, slow.knotvector_v = (k.tolist() for k in surface.knots)
    slow.sample_size = count // 5
    coarse = np.linspace(0, 1, count // 5)
    what = "once on a 25th of the grid's points and scaled"
    return with_slow_peer(
        row,
        "geomdl",
        slow.evaluate,
        1 / 25,
        what,
        lambda _: apart(surface.grid(coarse, coarse).reshape(-1, 3), slow.evalpts),
    )


def surface_fit(count=200):
    """A bicubic surface through a grid of points."""
    net = height_field(count)

    def scipy_fit():
        across = make_interp_spline(chord_parameters(net), net, 3)
        return make_interp_spline(chord_parameters(net.swapaxes(0, 1)), across.c, 3, axis=1)

    contestants = {"nurbs_lab": lambda: nl.interpolate_surface(net), "scipy two-pass": scipy_fit}
    bars = [Bar("scipy two-pass", 1), Bar("geomdl", 1000)]
    u = np.linspace(0, 1, 401)
    along = make_interp_spline(chord_parameters(net), net, 3)
    judges = {
        "nurbs_lab": lambda fit: off_the_field(fit.grid(u, u)),
        "scipy two-pass": lambda fit: off_the_field(BSpline(along.t, fit(u), 3)(u)),
    }
    row = compare(
        "nurbs",
        f"surface through {count} x {count} points",
        contestants,
        bars,
        measure="off the true surface",
        judges=judges,
    )
    coarse = np.linspace(0, 1, 41)  # geomdl needs long for every point

    def answer(surface):
        surface.sample_size = len(coarse)
        return off_the_field(np.array(surface.evalpts))

    half = count // 2
    flat = height_field(half)
    fit = nl.interpolate_surface(flat)
    row.answers["nurbs_lab on a quarter"] = off_the_field(fit.grid(coarse, coarse))
    flat = flat.reshape(-1, 3).tolist()
    what = "once on a quarter of the points and scaled by four, a lower bound: its time grows faster"
    return with_slow_peer(
        row, "geomdl", lambda: fitting.interpolate_surface(flat, half, half, 3, 3), 1 / 4, what, answer
    )


def closest_points(count=100_000, asked=500):
    """Closest points on a bicubic surface; OpenCASCADE is called point by point on some of them."""
    surface = nl.interpolate_surface(height_field(20))
    rng = np.random.default_rng(0)
    points = surface(*rng.uniform(0.02, 0.98, (2, count))) + rng.normal(size=(count, 3)) * 0.05
    row = compare(
        "nurbs",
        f"closest points on a bicubic surface for {count:,} points",
        {"nurbs_lab": lambda: surface.closest_point(points)},
        [Bar("opencascade", 20)],
    )
    face = surface_of(surface)

    def occ():
        projector = GeomAPI_ProjectPointOnSurf()
        distances = []
        for point in points[:asked]:
            projector.Init(gp_Pnt(*point), face)
            distances.append(projector.LowerDistance() if projector.NbPoints() else np.inf)
        return np.array(distances)

    theirs = occ()
    uv, _ = surface.closest_point(points[:asked])
    ours = np.linalg.norm(surface(*uv.T) - points[:asked], axis=1)
    best, extent = np.minimum(ours, theirs), float(np.ptp(surface.control_points, axis=(0, 1)).max())
    farther, found = "farther than opencascade, of the extent", np.isfinite(theirs)
    row = replace(
        row,
        measure="farther than the nearest found by either",
        answers={"nurbs_lab": float((ours - best).max())},
        figures={
            farther: float((ours - best).max() / extent),
            "of them without an answer by opencascade": int((~found).sum()),
        },
        most={farther: 1e-9},
    )
    what = f"on {asked} points and scaled"
    return with_slow_peer(
        row, "opencascade", occ, asked / count, what, lambda d: float((d - best)[found].max())
    )


def rows():
    """The table of the room."""
    fast = [Bar("opencascade", 1), Bar("scipy", 2), Bar("geomdl", 10_000)]
    return [
        closed_curve(800, fast, slow_peers=True),
        closed_curve(100_000, [Bar("scipy", 1)], slow_peers=False),
        *curve_points(),
        surface_grid(),
        surface_fit(),
        closest_points(),
    ]
