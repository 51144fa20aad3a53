"""Steppers beside the same steppers on SciPy's BSpline, feed plans beside toppra."""

from __future__ import annotations

import itertools
import tracemalloc
from functools import partial

import numpy as np
from scipy.interpolate import BSpline

import benchmarks.peers  # noqa: F401  (registers the steppers of the literature)
import nurbs_lab as nl
from benchmarks.harness import Bar, Row, compare, medians
from nurbs_lab.motion import Job, benchmark_curves
from nurbs_lab.motion.feed import constant_feed
from nurbs_lab.motion.limits import Limits
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.scan import scan
from nurbs_lab.motion.steppers.registry import run

SPEED = nl.paper.SPEED
#: Published for these limits by Erwinski et al. 2022, Table III: speed, acceleration, jerk, time in s.
PUBLISHED = ((40.0, 500.0, 2e4, 4.61), (250.0, 2000.0, 2e4, 6.31), (300.0, 2500.0, 5e4, 8.8))

#: LinuxCNC's own configuration with S-curves, under which #4194 was reported.
S_CURVE = {"speed": 300.0, "acceleration": 1000.0, "jerk": 1e4, "period_s": 1e-3}

#: Why a plan with a limit of jerk takes longer than one without.
PRICE = (
    "toppra has no limit of jerk, and what the motion takes longer is the price of that limit, not of the "
    "plan: a grid five times finer gains less than 0.2 % (test_plan.py), and on the paper's curve linear "
    "programs by SciPy come to the same least time (test_scurve.py)"
)


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


def _steps(stepper, job):
    return run(stepper, job, stepper.checked({}))


def steppers():
    """Time a step of the three steppers that need C alone."""
    period = 2e-4
    track = prepare(nl.paper.CURVE)
    job = Job(track, constant_feed(track.length, SPEED, period), period)
    for name, peer in SCIPY.items():
        contestants = {
            "nurbs_lab": partial(_steps, nl.STEPPERS[name], job),
            "scipy": partial(peer, nl.paper.CURVE, period),
        }
        row = compare(
            "motion",
            f"stepper {name}, {int(np.ceil(job.feed.duration / period))} steps on the paper's curve",
            contestants,
            [Bar("scipy", 100.0)],
            repeats=5,
            notes="the same rule in Python on scipy.interpolate.BSpline, but for the first four steps; "
            "history is not cut at knots there",
            measure="chords are off by at most %",
            most={"ns per step": 300},
        )
        u = {"nurbs_lab": contestants["nurbs_lab"]().u, "scipy": contestants["scipy"]()}
        row.answers.update({who: chord_error(path, period) for who, path in u.items()})
        steps = min(map(len, u.values())) - 1
        apart = float(np.abs(u["nurbs_lab"][:steps] - u["scipy"][:steps]).max())
        if apart > 1e-3:
            raise AssertionError(f"{name} on SciPy is another stepper: u differs by {apart:g}")
        row.figures["ns per step"] = 1e9 * row.seconds["nurbs_lab"] / (len(u["nurbs_lab"]) - 1)
        row.figures["u apart"] = apart
        yield row


def chord_error(u, period):
    """Largest error of the chords in percent of what is commanded, first four and last steps left out."""
    chords = np.linalg.norm(np.diff(nl.paper.CURVE(u), axis=0), axis=1)[4:-1]
    return float(100 * np.abs(chords / (SPEED * period) - 1).max())


#: What is asked of the steppers at 1 ms: curve, stepper, options, which steps, and the largest error in
#: percent of what a period moves, by chord or by arc; None where the figure is another's, shown beside ours.
EVERY, INSIDE, MIDDLE = "", " inside spans", " without the first and last 20 steps"
ACCURACY = (
    ("paper", "paper", {}, EVERY, "chord", None),
    ("paper", "history", {}, INSIDE, "chord", 6e-4),
    ("paper", "history", {}, EVERY, "chord", 0.1),
    ("paper", "history-arc", {}, EVERY, "arc", 1e-5),
    ("paper", "chord-corrected", {"trials": 1}, EVERY, "chord", 3e-4),
    ("paper", "chord-corrected", {"trials": 2}, EVERY, "chord", 1e-9),
    ("butterfly", "chord-corrected", {"trials": 2}, EVERY, "chord", 2e-3),
    ("butterfly", "chord-corrected", {"trials": 3}, EVERY, "chord", 1e-7),
    ("butterfly", "exact", {}, EVERY, "arc", 1e-8),
    ("zigzag", "taylor1", {}, MIDDLE, "chord", None),
    ("zigzag", "taylor2", {}, MIDDLE, "chord", None),
    ("zigzag", "inverse-length", {}, MIDDLE, "chord", None),
    ("zigzag", "chord-corrected", {}, MIDDLE, "chord", 2.4e-3),
)


def feed_on(name):
    """A curve of `ACCURACY` and the feed along it."""
    curve = benchmark_curves()[name].curve
    limits = {
        "speed": 100.0,
        "acceleration": 1000.0,
        "jerk": 20000.0,
        "period_s": 1e-3,
        "tangential_only": True,
    }
    return curve, {"paper": SPEED, "butterfly": 10.0}.get(name) or nl.plan_feed(curve, **limits)


def largest_error(curve, feed, stepper, options, which, metric):
    """Of the chosen steps at 1 ms, in percent of what a period moves."""
    path = nl.trace(curve, feed, stepper=stepper, period_s=1e-3, **options)
    errors = 100 * np.abs(getattr(path, f"{metric}_fluctuation"))
    return errors[{EVERY: slice(None), INSIDE: ~path.knot_steps, MIDDLE: slice(20, -20)}[which]].max()


def accuracy():
    """How exactly the steppers move what is commanded, beside what is asked."""
    notes = {
        "paper": "4 mm/s",
        "butterfly": "10 mm/s",
        "zigzag": "100 mm/s, 1000 mm/s², 20,000 mm/s³; cnc5x, whose curve it is, tells of about 5 % for "
        "taylor1, 0.08 % for taylor2 and 0.0024 % for its table, which is how far a chord is from its arc",
    }
    for where, note in notes.items():
        on_curve = feed_on(where)
        call = partial(nl.trace, *on_curve, stepper="chord-corrected", period_s=1e-3)
        work = f"trace by chord-corrected, {where}, 1 ms"
        row = compare("motion", work, {"nurbs_lab": call}, repeats=5, notes=note)
        for _, stepper, options, which, metric, asked in (one for one in ACCURACY if one[0] == where):
            trials = f", trials {options['trials']}" if options else ""
            name = f"{stepper}{trials}, {metric}s off by %{which}"
            row.figures[name] = float(largest_error(*on_curve, stepper, options, which, metric))
            if asked:
                row.most[name] = asked
        yield row


def growth():
    """Whole traces, measured errors included: time and memory against the number of steps."""
    length = prepare(nl.paper.CURVE).length
    for count in (100_000, 1_000_000, 4_000_000):
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
        )


def toppra_plan(path, speed, acceleration, grid):
    """Duration by toppra on a grid of the path's own length, with the speed limit of the same scan."""
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
    plan = algorithm.TOPPRA(limits, line, gridpoints=grid, solver_wrapper="seidel")
    speeds = plan.compute_parameterization(0.0, 0.0)[1]
    return float(np.sum(2.0 * np.diff(grid) / (speeds[1:] + speeds[:-1])))


def plans():
    """Feed plans of the butterfly, without and with jerk: how long they take to make, and to run."""
    curve = benchmark_curves()["butterfly"].curve
    for speed, acceleration, jerk, published in PUBLISHED:
        limits = {"speed": speed, "acceleration": acceleration, "chord_error": 1e-3, "period_s": 1e-3}
        limits["tangential_only"] = True  # as toppra's limit of a path has it
        free, soft = (partial(nl.plan_feed, curve, **limits, **more) for more in ({}, {"jerk": jerk}))
        path = scan(prepare(curve), Limits(**limits))
        peer = partial(toppra_plan, path, speed, acceleration, path.lengths)
        judges = {"nurbs_lab": lambda feed: feed.duration, "toppra": float}
        notes = "toppra gets the speed limits ready made, ours scans the curve for them"
        plan = {"measure": "motion takes s", "repeats": 5}
        work = f"feed plan of the butterfly, {speed:g} mm/s, {acceleration:g} mm/s²"
        row = compare("motion", work, {"nurbs_lab": free, "toppra": peer}, judges=judges, notes=notes, **plan)
        yield longer_than(row, "toppra", row.answers["toppra"], 2)
        notes = (
            f"Erwinski 2022 prints {published} s for a butterfly of unknown scale: not comparable "
            f"({curve.length():.2f} mm at {speed:g} mm/s take at least {curve.length() / speed:.2f} s)"
        )
        soft_row = compare(
            "motion",
            f"{work}, {jerk:g} mm/s³",
            {"nurbs_lab": soft},
            judges={"nurbs_lab": judges["nurbs_lab"]},
            notes=notes,
            reason=PRICE,
            **plan,
        )
        yield longer_than(soft_row, "toppra without limit of jerk", row.answers["toppra"])


def longer_than(row, peer, time_s, most=np.inf):
    """The row with a peer's time of motion, and by what part ours may be longer."""
    name = f"longer than {peer} by %"
    row.answers[peer] = time_s
    if most < np.inf:
        row.most[name] = most
    row.figures[name] = 100 * row.answers["nurbs_lab"] / time_s - 100
    return row


def polyline(points):
    """A curve of degree 1."""
    points = np.asarray(points, dtype=float)
    return nl.NurbsCurve(1, np.arange(len(points) + 2).clip(1, len(points)), points)


def s_curve_paths():
    """Curves by name: the segments of LinuxCNC #4149, micro segments as in #4194, and these smoothed."""
    x = np.arange(0.0, 40.0, 0.2)
    rows = [np.column_stack([x, 2.0 * k + np.sin(0.5 * x)])[:: 1 - 2 * (k % 2)] for k in range(6)]
    raster = np.round(np.concatenate(rows), 3)
    return {
        "line of LinuxCNC #4149": polyline(
            [(0, y) for y in (0, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 2, 5, 8, 20, 200)]
        ),
        "paper's curve": nl.paper.CURVE,
        "butterfly": benchmark_curves()["butterfly"].curve,
        "raster of 0.2 mm segments": polyline(raster),
        "that raster smoothed by 0.01 mm": nl.smooth(raster, tolerance=0.01),
    }


def ruckig_time(path):
    """From rest to rest between corners, at the one speed that each stretch allows everywhere."""
    import ruckig

    total, corners = 0.0, np.concatenate([[0.0], path.kinks[:, 0], [path.length]])
    for start, stop in itertools.pairwise(corners):
        inside = (path.lengths > start) & (path.lengths < stop)
        given, found = ruckig.InputParameter(1), ruckig.Trajectory(1)
        given.current_position, given.target_position = [start], [stop]
        given.max_velocity = [path.speeds[inside].min(initial=S_CURVE["speed"])]
        given.max_acceleration, given.max_jerk = [S_CURVE["acceleration"]], [S_CURVE["jerk"]]
        ruckig.Ruckig(1).calculate(given, found)
        total += found.duration
    return total


def s_curves():
    """Plans with jerk beside ruckig, on paths that LinuxCNC's planner with jerk is slow on."""
    notes = (
        "ours limits the vector's acceleration and the jerk along the path; ruckig, by which LinuxCNC 2.10 "
        "plans segment by segment, limits both along the path, knows no curve and stops at corners"
    )
    for name, curve in s_curve_paths().items():
        path = scan(prepare(curve), Limits(**S_CURVE))
        contestants = {
            "nurbs_lab": partial(nl.plan_feed, curve, **S_CURVE),
            "ruckig": partial(ruckig_time, path),
        }
        judges = {"nurbs_lab": lambda feed: feed.duration, "ruckig": float}
        measure = {"measure": "motion takes s", "judges": judges, "repeats": 3}
        yield compare("motion", f"S-curve, {name}", contestants, notes=notes, **measure)


def rows():
    """All rows of this room."""
    return [*steppers(), *accuracy(), *plans(), *s_curves(), *growth()]
