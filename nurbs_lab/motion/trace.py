"""From a curve, a feed and a stepper to a tool path."""

import numpy as np

from nurbs_lab.common.checks import as_kind, as_number, as_positive, extent
from nurbs_lab.common.executor import one_or_many
from nurbs_lab.motion import _kernels
from nurbs_lab.motion.feed import MOST_SAMPLES, FeedProfile, constant_feed
from nurbs_lab.motion.override import apply_override
from nurbs_lab.motion.prepared_curve import EQUAL_WITHIN, prepare
from nurbs_lab.motion.steppers.registry import Job, find_stepper, run
from nurbs_lab.motion.toolpath import ToolPath
from nurbs_lab.nurbs import NurbsCurve, span_kernels

#: A step that is longer than this times the longest that is commanded leaps over a part of the curve.
_LEAP = 10.0


@one_or_many("feed")
def trace(curve, feed, *, stepper="adams", period_s=None, override=None, **options):
    """Step along a curve, one sample a period.

    Parameters
    ----------
    curve : NurbsCurve or list of NurbsCurve
        2-D or 3-D, any degree, rational or not.
    feed : FeedProfile or float, or a list of them
        From ``plan_feed``; or one speed in mm/s, commanded from the first instant to the last. A list has one
        entry for each curve, and each is a motion of its own: ``FeedProfile.join`` makes those of a program
        one, along one curve.
    stepper : str
        A name in ``STEPPERS``.
    period_s : float, optional
        In s. Needed for a feed given as one number; a plan brings its own, and no other is taken for it.
    override : float or array_like, shape (n, 2), optional
        Feed override and hold: a rate, or rows (time in s, rate); see ``motion.apply_override``.
    **options
        Those that the stepper declares in ``STEPPERS[name].options``, such as ``trials=2`` of
        'chord-corrected'.

    Returns
    -------
    ToolPath
        A list of them for a list of curves.

    Raises
    ------
    TypeError, ValueError
        Unknown stepper or option, a feed planned for another curve or period, a curve shorter than one step
        or with a cusp, more than 5,000,000 steps, a stepper that gives no forward step, is late at the end by
        a twentieth of the time, leaps ahead by more than ten times the longest step of a plan or is early
        there by a twentieth (one with an ``order``), or one without ``keeps`` on a curve with a double end
        point.

    Notes
    -----
    Only steppers with ``keeps`` in their entry of ``STEPPERS`` are fit for a machine: 'exact' keeps every
    limit of a plan; 'history-arc' and 'adams-arc' exceed some by up to 0.2 %, jerks by 0.7 %. These three end
    on its schedule. 'chord-corrected' makes every chord as long as commanded, so it runs ahead by what the
    arcs are longer, and exceeds accelerations at corners. Overrides keep all limits of a plan.
    ``path.feed.certificate().uses`` tells by how much.

    Most steppers sample ``|C'|`` and suppose that it changes little within a step. Where it changes much,
    they move another length than was commanded: at 50 mm/s and 1 ms, 'history' moves 1.3 times that length in
    one step of the butterfly. This error is the stepper's own; ``ToolPath.arc_fluctuation`` holds it.
    Where C' vanishes at an end (a double end point), the path begins or ends 1e-10 of the length beside it.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> path = nl.trace(nl.paper.CURVE, 4.0, stepper="paper", period_s=1e-3)
    >>> len(path.moved)
    1986
    """
    stepper = find_stepper(stepper)
    options, job = stepper.checked(options), job_of(curve, feed, period_s, override)
    if job.last_step > MOST_SAMPLES:
        raise ValueError(
            f"period_s = {job.period_s:g} s makes a path of {job.last_step} steps; at most "
            f"{MOST_SAMPLES} are kept: raise period_s or feed, or split the curve"
        )
    return path_of(job, stepper, options)


def job_of(curve, feed, period_s, override=None):
    """What a stepper is asked to do, checked."""
    if period_s is not None:
        period_s = as_positive("period_s", period_s)
    as_kind("curve", curve, NurbsCurve)
    track = prepare(curve)
    if not isinstance(feed, FeedProfile):
        if period_s is None:
            raise ValueError("period_s is missing: a feed given as one number has no period of its own")
        speed = as_positive("feed", feed)
        as_number("the time that feed takes", track.length / speed)
        feed = constant_feed(track.length, speed, period_s)
    elif period_s is not None and abs(period_s - feed.period_s) > EQUAL_WITHIN * feed.period_s:
        raise ValueError(
            f"period_s = {period_s:g} s is not that of the plan, {feed.period_s:g} s, which its limit of the "
            "chord error rests on; plan the feed with the period wanted, or leave period_s out"
        )
    if abs(feed.length - track.length) > EQUAL_WITHIN * track.length:
        raise ValueError(
            f"feed covers {feed.length:.9g} mm but the curve is {track.length:.9g} mm long; "
            "plan the feed on this curve"
        )
    if feed.curve is not None and not _same_way(curve, feed.curve):
        raise ValueError("feed was planned for another curve of the same length; plan it on this one")
    if feed.duration < feed.period_s * (1.0 - 1e-9):
        raise ValueError(
            f"curve is shorter than one step: it takes {feed.duration:g} s, period_s is {feed.period_s:g} "
            "s; lower feed or period_s, or join the feeds of a program"
        )
    if override is not None:
        planned, feed = feed, apply_override(feed, override)
        left_over = planned.length - feed.length
        if left_over > 1e-14 * track.length:  # aborted
            track = track.until(track.length - left_over)
    return Job(track, feed, feed.period_s)


def _same_way(curve, planned):
    """Whether two curves of one length run through the same points, in whatever form they are given."""
    if curve is planned or curve.dim != planned.dim:
        return curve is planned
    places = np.linspace(0.0, 1.0, 33)
    one, other = (c(c.parameter_at(places * c.length())) for c in (curve, planned))
    return np.abs(one - other).max() <= EQUAL_WITHIN * extent(other)


def path_of(job, stepper, options):
    """The measured tool path of a job that is known to be possible."""
    steps = run(stepper, job, options)
    track, feed, period_s = job.track, job.feed, job.period_s
    u, count = np.asarray(steps.u), len(steps.u) - 1
    moved, chord, chord_error, commanded = (np.empty(count) for _ in range(4))
    span_kernels.moved_lengths(track.spans, track.panels, u, moved)
    leap = int(moved.argmax())
    early = feed.duration / period_s > 1.05 * count + 16.0  # by as much as `Job.last_step` lets it be late
    if None not in (stepper.order, feed.limits) and (early or moved[leap] > _LEAP * feed.peak * period_s):
        raise ValueError(
            f"step {leap} at u = {u[leap]:.9g}: {stepper.name!r} leaps {moved[leap]:.3g} mm ahead, as |C'| "
            f"is less there than after it, and takes {count} steps for {feed.duration / period_s:.6g} "
            "periods; take one that keeps the limits of a plan, such as 'exact'"
        )
    _kernels.chord_lengths_and_errors(track.spans, u, chord, chord_error)
    _kernels.commanded_lengths(feed.table, period_s, commanded)
    if not feed.rests:  # the last step is commanded what was left
        commanded[-1] = moved[-1]
    lag = np.concatenate([[0.0], commanded[:-1] - moved[:-1]]).cumsum()
    return ToolPath(
        curve=track.curve,
        feed=feed,
        stepper=stepper.name,
        period_s=period_s,
        t=period_s * np.arange(count + 1.0),
        u=u,
        points=track.curve(u) if steps.points is None else steps.points,
        commanded=commanded,
        moved=moved,
        chord=chord,
        chord_error=chord_error,
        lag=lag,
        evaluations_by_order=np.array(steps.evaluations),
        details=dict(steps.details),
    )
