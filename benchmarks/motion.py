"""Steppers beside the same steppers on SciPy's BSpline, feed plans beside toppra."""

from __future__ import annotations

import tracemalloc
from functools import partial
from importlib.util import find_spec

import numpy as np
from scipy.interpolate import BSpline

import nurbs_lab as nl
from benchmarks import counts
from benchmarks.harness import Bar, Row, compare, medians
from nurbs_lab.motion import Job, benchmark_curves
from nurbs_lab.motion.feed import constant_feed
from nurbs_lab.motion.limits import Limits, scan
from nurbs_lab.motion.track import prepare

SPEED = nl.paper.SPEED
#: Published for these limits by Erwinski et al. 2022, Table III: speed, acceleration, jerk, time in s.
PUBLISHED = ((40.0, 500.0, 2e4, 4.61), (250.0, 2000.0, 2e4, 6.31), (300.0, 2500.0, 5e4, 8.8))


def adams_on_scipy(slope):
    """Fourth-order Adams with |C'| by ``slope(u, points)`` of the past; Euler for the first four steps."""

    def run(curve, period):
        spline = BSpline(curve.knots, curve.control_points, curve.degree)
        rate = spline.derivative()
        u, points, slopes = [0.0], [spline(0.0)], []
        while u[-1] < 1.0:
            slopes.insert(0, SPEED / (slope(u, points) if len(u) > 1 else np.linalg.norm(rate(0.0))))
            if len(u) < 5:
                step = slopes[0]
            else:
                step = (55 * slopes[0] - 59 * slopes[1] + 37 * slopes[2] - 9 * slopes[3]) / 24
            u.append(min(u[-1] + period * step, 1.0))
            points.append(spline(u[-1]))
            del slopes[3:]
        return np.array(u)

    return run


def quotient(u, points):
    """Eq. (16)."""
    return np.linalg.norm(points[-1] - points[-2]) / (u[-1] - u[-2])


def backward_difference(u, points):
    """Derivative of the polynomial through the last five points."""
    count = min(5, len(u))
    nodes = np.array(u[-count:]) - u[-1]
    weights = np.linalg.solve(np.vander(nodes, increasing=True).T, np.eye(count)[1])
    return np.linalg.norm(weights @ np.array(points[-count:]))


def neville(x, nodes, values):
    """Value at x of the polynomial through the values at the nodes."""
    values = list(values)
    for width in range(1, len(values)):
        for k in range(len(values) - width):
            slope = (values[k + 1] - values[k]) / (nodes[k + width] - nodes[k])
            values[k] += (x - nodes[k]) * slope
    return values[0]


def chord_corrected_on_scipy(curve, period):
    """Cubic prediction, two trial chords, inverse interpolation."""
    spline = BSpline(curve.knots, curve.control_points, curve.degree)
    length = SPEED * period
    u = [0.0, length / np.linalg.norm(spline.derivative()(0.0))]
    while u[-1] < 1.0:
        guess = neville(1.0, (0, -1, -2, -3), u[: -min(len(u), 4) - 1 : -1])
        here = spline(u[-1])
        chords, tried = [0.0], [u[-1]]
        for _ in range(2):
            chord = np.linalg.norm(spline(min(guess, 1.0)) - here)
            if chord == chords[-1] or abs(chord - length) < 1e-15:
                break
            chords.append(chord)
            tried.append(min(guess, 1.0))
            guess = neville(length, chords, tried)
        u.append(min(guess, 1.0))
    return np.array(u)


SCIPY = {
    "paper": adams_on_scipy(quotient),
    "history": adams_on_scipy(backward_difference),
    "chord-corrected": chord_corrected_on_scipy,
}


def steppers():
    """Time a step of the three steppers that need C alone."""
    period = 2e-4
    track = prepare(nl.paper.CURVE)
    job = Job(track, constant_feed(track.length, SPEED, period), period)
    for name, peer in SCIPY.items():
        ours = nl.STEPPERS[name].run
        steps = len(ours(job).u) - 1
        theirs = peer(nl.paper.CURVE, period)
        shared = min(steps, len(theirs) - 1)
        apart = np.abs(ours(job).u[:shared] - theirs[:shared]).max()
        if apart > 1e-3:
            raise AssertionError(f"{name} on SciPy is another stepper: u differs by {apart:g}")
        row = compare(
            "motion",
            f"stepper {name}, {steps} steps on the paper's curve",
            {
                "nurbs_lab": lambda ours=ours: ours(job),
                "scipy": lambda peer=peer: peer(nl.paper.CURVE, period),
            },
            [Bar("scipy", 100.0)],
            repeats=5,
            notes="the same rule in Python on scipy.interpolate.BSpline",
            figures=counts.steps(name, steps, nl.paper.CURVE.degree),
        )
        row.figures["ns_per_step"] = 1e9 * row.seconds["nurbs_lab"] / steps
        row.figures["u_apart"] = float(apart)
        yield row


def growth():
    """Whole traces, measured errors included: time and memory against the number of steps."""
    length = prepare(nl.paper.CURVE).length
    for count in (100_000, 1_000_000, 10_000_000):
        period = length / SPEED / count
        call = partial(nl.trace, nl.paper.CURVE, SPEED, stepper="chord-corrected", period_s=period)
        seconds, first = medians({"nurbs_lab": call}, repeats=1 if count > 1_000_000 else 3)
        tracemalloc.start()
        path = call()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        kept = sum(value.nbytes for value in vars(path).values() if isinstance(value, np.ndarray))
        yield Row(
            "motion",
            f"trace of {count:,} steps with its error figures",
            seconds,
            first_call=first["nurbs_lab"],
            figures={"output_MB": kept / 1e6, "peak_MB": peak / 1e6},
            series="traces in steps",
            size=count,
        )


def toppra_plan(path, speed, acceleration):
    """toppra on the path's own length, with the speed limit of the same scan."""
    import toppra
    from toppra import algorithm, constraint

    toppra.setup_logging("ERROR")
    line = toppra.SplineInterpolator(path.lengths[[0, -1]], path.lengths[[0, -1], None], bc_type="natural")

    def bounds(s):
        most = np.interp(s, path.lengths, path.speeds)
        return np.array([[-most, most]])

    limits = [
        constraint.JointVelocityConstraintVarying(bounds),
        constraint.JointAccelerationConstraint([[-acceleration, acceleration]]),
    ]
    plan = algorithm.TOPPRA(limits, line, gridpoints=path.lengths, solver_wrapper="seidel")
    speeds = plan.compute_parameterization(0.0, 0.0)[1]
    return float(np.sum(2.0 * np.diff(path.lengths) / (speeds[1:] + speeds[:-1])))


def plans():
    """Feed plans of the butterfly, without and with jerk."""
    curve = benchmark_curves()["butterfly"].curve
    for speed, acceleration, jerk, published in PUBLISHED:
        limits = {"speed": speed, "acceleration": acceleration, "chord_error": 1e-3, "period_s": 1e-3}
        contestants = {"nurbs_lab": lambda limits=limits: nl.plan_feed(curve, **limits)}
        figures = {
            "time_s": nl.plan_feed(curve, **limits).duration,
            "time_with_jerk_s": nl.plan_feed(curve, jerk=jerk, **limits).duration,
        }
        notes = (
            f"Erwinski 2022 prints {published} s with jerk for a butterfly of unknown scale: not comparable "
            f"({curve.length():.2f} mm at {speed:g} mm/s take at least {curve.length() / speed:.2f} s)"
        )
        if find_spec("toppra"):
            path = scan(prepare(curve), Limits(speed, acceleration, 1e-3, chord_error=1e-3))
            figures["toppra_time_s"] = toppra_plan(path, speed, acceleration)
            contestants["toppra"] = lambda path=path, s=speed, a=acceleration: toppra_plan(path, s, a)
            notes += "; toppra gets the speed limits ready made, ours scans the curve for them"
        else:
            notes += "; not installed: toppra"
        work = f"feed plan of the butterfly, {speed:g} mm/s, {acceleration:g} mm/s²"
        yield compare("motion", work, contestants, repeats=5, notes=notes, figures=figures)


def rows():
    """All rows of this room."""
    return [*steppers(), *plans(), *growth()]
