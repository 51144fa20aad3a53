"""Plan the fastest feed that keeps every limit."""

import numpy as np

from nurbs_lab.motion import _measure, _planning
from nurbs_lab.motion._checks import not_negative, positive
from nurbs_lab.motion.feed import from_knots, stretch
from nurbs_lab.motion.limits import Limits, scan
from nurbs_lab.motion.track import prepare

#: Rounds of 'measure the sampled path, slow down by the excess' before giving up.
_ROUNDS = 30


def plan_feed(
    curve,
    *,
    speed,
    acceleration,
    jerk=None,
    chord_error=None,
    period_s,
    start_speed=0.0,
    end_speed=0.0,
    centripetal_acceleration=None,
    axis_speed=None,
    axis_acceleration=None,
):
    """Plan the speed along a curve: as fast as the limits allow, and never faster.

    Without ``jerk`` the acceleration may step (trapezoid); with it the profile is made of seven-phase
    S-curves. The duration is a whole number of periods: the plan is stretched by less than one.

    Parameters
    ----------
    curve : NurbsCurve
        2-D or 3-D.
    speed : float
        Largest speed along the path, in mm/s.
    acceleration : float
        Largest acceleration along the path, in mm/s².
    jerk : float, optional
        Largest jerk along the path, in mm/s³.
    chord_error : float, optional
        Largest bow height of one period's chord, in mm.
    period_s : float
        Interpolation period, in s.
    start_speed, end_speed : float
        In mm/s. Stretching to whole periods may lower them by less than one period's part of the duration,
        where they lie at the limit themselves.
    centripetal_acceleration : float, optional
        Largest acceleration across the path, v² times curvature, in mm/s².
    axis_speed, axis_acceleration : float or array_like, optional
        Largest speed and acceleration of each machine axis.

    Returns
    -------
    FeedProfile

    Raises
    ------
    TypeError, ValueError
        Naming the limit that is no positive number, or the start or end speed that no plan can keep.

    Notes
    -----
    At a corner of the path the tool stops if accelerations across the path or of axes are limited.
    With ``jerk``, a limit of axis accelerations is kept by giving both the acceleration along and the one
    across the path 1/sqrt(2) of the smallest axis: safe, and slower than needed.
    """
    track = prepare(curve)
    dim = curve.control_points.shape[1]
    limits = Limits(
        speed=positive("speed", speed),
        acceleration=positive("acceleration", acceleration),
        period_s=positive("period_s", period_s),
        jerk=None if jerk is None else positive("jerk", jerk),
        chord_error=None if chord_error is None else positive("chord_error", chord_error),
        centripetal_acceleration=(
            None
            if centripetal_acceleration is None
            else positive("centripetal_acceleration", centripetal_acceleration)
        ),
        axis_speed=_per_axis("axis_speed", axis_speed, dim),
        axis_acceleration=_per_axis("axis_acceleration", axis_acceleration, dim),
    )
    path = scan(track, limits)
    ends = not_negative("start_speed", start_speed), not_negative("end_speed", end_speed)
    plan = _trapezoid(path, limits, ends)
    return _fit(track, limits, plan)


def _per_axis(name, value, dim):
    if value is None:
        return None
    values = (
        np.broadcast_to(np.asarray(value, dtype=object), (dim,)) if np.ndim(value) == 0 else np.asarray(value)
    )
    if values.shape != (dim,):
        raise ValueError(f"{name} must be one number or {dim}, one for each axis; got shape {values.shape}")
    return np.array([positive(name, one) for one in values])


def _fit(track, limits, plan):
    """Slow the plan down until the sampled path keeps every limit and it takes whole periods."""
    profile = plan
    for _ in range(_ROUNDS):
        excess = max(1.0, _excess(track, limits, profile))
        periods = max(2.0, np.ceil(profile.duration * excess / limits.period_s - 1e-9))
        factor = max(periods * limits.period_s / profile.duration, excess * (1.0 + 4e-16))
        if excess == 1.0 and factor < 1.0 + 1e-12:
            return profile
        profile = stretch(profile, factor)
    raise ValueError("no profile found within these limits; give a shorter period or a lower speed")


def _excess(track, limits, profile):
    """By what factor the sampled path is too fast: 1 or less where every limit holds."""
    t = np.linspace(0.0, profile.duration, 1 + int(np.ceil(profile.duration / limits.period_s - 1e-9)))
    t = t if len(t) > 1 else np.array([0.0, profile.duration])
    v, a = profile.speed(t), profile.acceleration(t)
    u = np.empty(len(t))
    _measure.invert(track.spans, track.panels, np.minimum(profile.displacement(t), track.length), u)
    span = np.clip(np.searchsorted(track.spans[0], u, side="right") - 1, 0, len(track.spans[0]) - 2)
    tangents, curvatures = np.empty((len(u), 3)), np.empty((len(u), 3))
    _measure.bends(track.spans, span, u, tangents, curvatures)
    bend = np.linalg.norm(curvatures, axis=1)
    terms = profile.terms
    accelerations = np.append(
        2.0 * terms[:, 2], 2.0 * terms[:, 2] + 6.0 * terms[:, 3] * np.diff(profile.times)
    )
    ratios = [v.max() / limits.speed, np.sqrt(np.abs(accelerations).max() / limits.acceleration)]
    if limits.jerk is not None:
        ratios.append(np.cbrt(6.0 * np.abs(terms[:, 3]).max() / limits.jerk))
    if limits.centripetal_acceleration is not None:
        ratios.append(np.sqrt((v**2 * bend).max() / limits.centripetal_acceleration))
    if limits.axis_speed is not None:
        ratios.append((np.abs(v[:, None] * tangents[:, : len(limits.axis_speed)]) / limits.axis_speed).max())
    if limits.axis_acceleration is not None:
        axes = (a[:, None] * tangents + v[:, None] ** 2 * curvatures)[:, : len(limits.axis_acceleration)]
        ratios.append(np.sqrt((np.abs(axes) / limits.axis_acceleration).max()))
    if limits.chord_error is not None:
        chords, rises = np.empty(len(u) - 1), np.empty(len(u) - 1)
        _measure.chord_lengths_and_rises(track.spans, u, chords, rises)
        ratios.append(np.sqrt(rises.max() / limits.chord_error))
    return max(ratios)


def _trapezoid(path, limits, ends):
    axis = np.empty(0) if limits.axis_acceleration is None else limits.axis_acceleration
    machine = path.tangents, path.curvatures, limits.acceleration, axis
    lengths, squares, nodes = _planning.braking(path.lengths, path.speeds**2, *machine, ends[1] ** 2)
    largest = squares[0]
    lengths, squares, nodes = _planning.starting(lengths, squares, nodes, *machine, ends[0] ** 2)
    speeds = np.sqrt(squares)
    _refuse_ends(ends, np.sqrt(largest), speeds[-1], path)
    times = np.concatenate([[0.0], np.cumsum(2.0 * np.diff(lengths) / (speeds[1:] + speeds[:-1]))])
    held = speeds >= path.speeds[nodes] * (1.0 - 1e-9)
    both = held[1:] & held[:-1]
    causes = np.where(both, path.causes[nodes[:-1]], "acceleration")
    return from_knots(times, speeds, limits.period_s, causes)


def _refuse_ends(ends, first, last, path):
    if ends[0] > first * (1.0 + 1e-9):
        raise ValueError(
            f"start_speed {ends[0]:g} mm/s is above what the limits allow: at most {first:.6g} mm/s, set by "
            f"{path.causes[0] if path.speeds[0] <= first * (1 + 1e-9) else 'braking before what follows'}"
        )
    if ends[1] > last * (1.0 + 1e-9):
        reason = path.causes[-1] if path.speeds[-1] <= last * (1 + 1e-9) else "the distance to gain speed"
        raise ValueError(
            f"end_speed {ends[1]:g} mm/s cannot be reached: at most {last:.6g} mm/s, set by {reason}"
        )
