"""Every stepper on every curve: accuracy beside cost."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.checks import as_count, as_kind, as_positive, as_sequence
from nurbs_lab.common.executor import map_items
from nurbs_lab.motion.curves import benchmark_curves
from nurbs_lab.motion.plan import plan_feed
from nurbs_lab.motion.steppers.registry import find_stepper, run, software_steppers
from nurbs_lab.motion.trace import job_of, path_of


@dataclass(frozen=True)
class Score:
    """One stepper on one curve; fluctuations relative, lag in mm.

    ``arc_max_undisturbed`` leaves out steps that meet a knot or a corner of v(t), and the eight after.

    ``evaluations_per_step`` charges every stepper with the point that moves the tool, whether its rule makes
    use of that point or not.
    ``ns_per_step`` is the best of the repeats in processor time, with tables made beforehand, without that
    point where the rule does not use it. A stepper that breaks down has NaN and says why in ``failure``.
    """

    stepper: str
    curve: str
    steps: int = 0
    chord_max: float = np.nan
    chord_rms: float = np.nan
    chord_p99: float = np.nan
    chord_last: float = np.nan
    arc_max: float = np.nan
    arc_rms: float = np.nan
    arc_p99: float = np.nan
    arc_last: float = np.nan
    arc_max_undisturbed: float = np.nan
    final_lag: float = np.nan
    evaluations_per_step: float = np.nan
    ns_per_step: float = np.nan
    failure: str = ""


def leaderboard(curves=None, *, feed=10.0, period_s=1e-3, steppers=None, repeats=3, executor=None):
    """Run steppers on curves and measure them.

    Parameters
    ----------
    curves : mapping of str to NurbsCurve, optional
        All of ``benchmark_curves()`` by default.
    feed : float or mapping
        One constant speed in mm/s, or the limits that ``plan_feed`` takes, planned on each curve.
    period_s : float
        In s.
    steppers : sequence of str, or mapping of str to str, optional
        Names, or labels with the name of each. By default all that run in software.
    repeats : int
        Timed runs of each, in turns; the best one counts.
    executor : concurrent.futures.Executor, optional
        Workers for the pairs of a stepper and a curve; this process by default. All figures but the times
        are the same, bit for bit.

    Returns
    -------
    list of Score
        Best chord fluctuation first, curve by curve.
    """
    period_s, repeats = as_positive("period_s", period_s), as_count("repeats", repeats)
    curves = benchmark_curves() if curves is None else as_kind("curves", curves, Mapping)
    names = software_steppers() if steppers is None else steppers
    if not isinstance(names, Mapping):
        names = {name: name for name in as_sequence("steppers", names)}
    chosen = [(label, find_stepper(name).name) for label, name in names.items()]
    jobs = {}
    for name, curve in curves.items():
        curve = getattr(curve, "curve", curve)
        planned = plan_feed(curve, period_s=period_s, **feed) if isinstance(feed, Mapping) else feed
        jobs[name] = job_of(curve, planned, period_s)
    rows = [(name, job, *choice) for name, job in jobs.items() for choice in chosen]
    scores = map_items(_score, rows, executor, what="run")
    # The runs of all take turns: a machine that is slow for a while is so for each of them.
    seconds = map_items(_seconds, rows * repeats, executor, what="time")
    scores = [
        replace(one, ns_per_step=1e9 * min(seconds[k :: len(rows)]) / max(one.steps, 1))
        for k, one in enumerate(scores)
    ]
    place = {name: k for k, name in enumerate(jobs)}
    return sorted(scores, key=lambda s: (place[s.curve], np.isnan(s.chord_max), s.chord_max))


def _score(row):
    name, job, label, stepper = row
    stepper = find_stepper(stepper)
    try:
        path = path_of(job, stepper, {})
    except ValueError as error:
        return Score(label, name, failure=str(error))
    unused = len(path.moved) - path.evaluations_by_order[0]  # points that move the tool and nothing else
    figures = {
        f"{metric}_{kind}": value
        for metric in ("chord", "arc")
        for kind, value in path.statistics(metric).items()
    }
    return Score(
        stepper=label,
        curve=name,
        steps=len(path.moved),
        **figures,
        arc_max_undisturbed=path.statistics(undisturbed=True)["max"],
        final_lag=path.final_lag,
        evaluations_per_step=(path.evaluations + max(unused, 0)) / len(path.moved),
    )


def _seconds(row):
    """Processor time of one run; NaN for a stepper that breaks down."""
    _, job, _, stepper = row
    start = time.process_time()
    try:
        run(find_stepper(stepper), job, {})
    except ValueError:
        return np.nan
    return time.process_time() - start
