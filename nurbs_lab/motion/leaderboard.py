"""Every stepper on every curve: accuracy beside cost."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from tqdm.auto import tqdm

from nurbs_lab.common.checks import as_count, as_positive, shown
from nurbs_lab.common.progress import hidden
from nurbs_lab.motion.curves import benchmark_curves
from nurbs_lab.motion.feed import constant_feed
from nurbs_lab.motion.plan import plan_feed
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.steppers import STEPPERS, Job, find_stepper
from nurbs_lab.motion.trace import path_of


@dataclass(frozen=True)
class Score:
    """One stepper on one curve; fluctuations relative, lag in mm.

    ``evaluations_per_step`` charges every stepper with the point that moves the tool, whether its rule makes
    use of that point or not.
    ``ns_per_step`` is the best of the repeats in processor time, tables made beforehand included. A stepper
    that breaks down has NaN for figures and says why in ``failure``.
    """

    stepper: str
    curve: str
    steps: int = 0
    chord_max: float = np.nan
    chord_rms: float = np.nan
    arc_max: float = np.nan
    arc_rms: float = np.nan
    final_lag: float = np.nan
    evaluations_per_step: float = np.nan
    ns_per_step: float = np.nan
    failure: str = ""


def leaderboard(curves=None, *, feed=10.0, period_s=1e-3, steppers=None, repeats=3):
    """Run steppers on curves and measure them.

    Parameters
    ----------
    curves : mapping of str to NurbsCurve, optional
        All of ``benchmark_curves()`` if left out.
    feed : float or mapping
        One constant speed in mm/s, or the limits that ``plan_feed`` takes, planned on each curve.
    period_s : float
        In s.
    steppers : sequence of str, optional
        All that run in software if left out.
    repeats : int
        Timed runs of each; the best one counts.

    Returns
    -------
    list of Score
        Best chord fluctuation first, curve by curve.
    """
    period_s, repeats = as_positive("period_s", period_s), as_count("repeats", repeats)
    curves = benchmark_curves() if curves is None else curves
    if not isinstance(curves, Mapping):
        raise TypeError(f"curves must be a mapping from names to curves, got {shown(curves)}")
    if not isinstance(feed, Mapping):
        feed = as_positive("feed", feed)
    names = [name for name in STEPPERS if name != "rtl"] if steppers is None else steppers
    if not isinstance(names, (list, tuple)):
        raise TypeError(f"steppers must be a list of names, got {shown(steppers)}")
    chosen = [find_stepper(name) for name in names]
    jobs = {name: _job(getattr(curve, "curve", curve), feed, period_s) for name, curve in curves.items()}
    rows = [(name, job, stepper) for name, job in jobs.items() for stepper in chosen]
    scores = [_score(*row, repeats) for row in tqdm(rows, "leaderboard", leave=False, disable=hidden())]
    place = {name: k for k, name in enumerate(jobs)}
    return sorted(scores, key=lambda s: (place[s.curve], np.isnan(s.chord_max), s.chord_max))


def _job(curve, feed, period_s):
    track = prepare(curve)
    if isinstance(feed, Mapping):
        return Job(track, plan_feed(curve, period_s=period_s, **feed), period_s)
    return Job(track, constant_feed(track.length, feed, period_s), period_s)


def _score(name, job, stepper, repeats):
    try:
        path = path_of(job, stepper, {})
    except ValueError as error:
        return Score(stepper.name, name, failure=str(error))
    times = []
    for _ in range(repeats):
        start = time.process_time()
        stepper.run(job)
        times.append(time.process_time() - start)
    steps = len(path.moved)
    chord, arc = np.abs(path.chord_fluctuation), np.abs(path.arc_fluctuation)
    return Score(
        stepper=stepper.name,
        curve=name,
        steps=steps,
        chord_max=chord.max(),
        chord_rms=np.sqrt(np.mean(chord**2)),
        arc_max=arc.max(),
        arc_rms=np.sqrt(np.mean(arc**2)),
        final_lag=path.final_lag,
        evaluations_per_step=path.evaluations_with_output / steps,
        ns_per_step=1e9 * min(times) / steps,
    )
