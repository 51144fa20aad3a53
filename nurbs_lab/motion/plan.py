"""Plan the fastest feed that keeps every limit."""

import itertools
from dataclasses import replace

import numpy as np

from nurbs_lab.motion import _jerk, _measure, _planning
from nurbs_lab.motion._blocks import blocks
from nurbs_lab.motion._checks import not_negative, positive
from nurbs_lab.motion.feed import from_jerks, from_speeds, stretch
from nurbs_lab.motion.limits import Limits, scan
from nurbs_lab.motion.track import prepare
from nurbs_lab.nurbs._checks import as_floats

#: Rounds of 'measure the sampled path, slow down by the excess' before giving up.
_ROUNDS = 30
#: An S-curve is planned in ticks of one period, but in at least so many for a ramp of the acceleration ...
_TICKS = 10
#: ... and in at most so many for the whole motion.
_MOST_TICKS = 100_000


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
    planned = limits.shared_between_axes() if limits.jerk is not None else limits
    path = scan(track, planned)
    ends = np.array([not_negative("start_speed", start_speed), not_negative("end_speed", end_speed)])
    shape = _trapezoid if limits.jerk is None else _s_curve
    _refuse_ends(ends, path, *_fastest(path, planned, ends))
    factor = 1.0
    for _ in range(_ROUNDS if ends.any() else 1):  # stretching slows the ends: plan them faster by as much
        asked = np.minimum(ends * factor, path.speeds[[0, -1]])
        plan = shape(path, planned, asked, *_fastest(path, planned, asked))
        profile = _fit(track, limits, plan)
        before, factor = factor, profile.duration / plan.duration
        if abs(factor - before) < 1e-12:
            break
    if profile.speed(profile.duration) < 0.99 * ends[1]:
        raise ValueError(
            f"end_speed {ends[1]:g} mm/s cannot be reached with this jerk over {track.length:g} mm"
        )
    return profile


def _per_axis(name, value, dim):
    if value is None:
        return None
    values = as_floats(name, value)
    if values.ndim == 0:
        values = np.broadcast_to(values, (dim,))
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
    u, tangents, curvatures = np.empty(len(t)), np.empty((len(t), 3)), np.empty((len(t), 3))
    lengths = np.minimum(profile.displacement(t), track.length)
    for first, stop in blocks(len(t), "checking"):
        part = slice(first, stop)
        _measure.invert(track.spans, track.panels, lengths[part], u[part])
        span = np.clip(np.searchsorted(track.spans[0], u[part], side="right") - 1, 0, len(track.spans[0]) - 2)
        _measure.bends(track.spans, span, u[part], tangents[part], curvatures[part])
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
        for first, stop in blocks(len(chords), "checking"):
            steps = slice(first, stop)
            _measure.chord_lengths_and_rises(track.spans, u[first : stop + 1], chords[steps], rises[steps])
        ratios.append(np.sqrt(rises.max() / limits.chord_error))
    return max(ratios)


def _fastest(path, limits, ends):
    """Largest v² along the path with limited acceleration: lengths, v² and the scan's node of each."""
    axis = np.empty(0) if limits.axis_acceleration is None else limits.axis_acceleration
    machine = path.tangents, path.curvatures, limits.acceleration, axis
    lengths, squares, nodes = _planning.braking(path.lengths, path.speeds**2, *machine, ends[1] ** 2)
    return _planning.starting(lengths, squares, nodes, *machine, ends[0] ** 2)


def _trapezoid(path, limits, ends, lengths, squares, nodes):
    speeds = np.sqrt(squares)
    times = np.concatenate([[0.0], np.cumsum(2.0 * np.diff(lengths) / (speeds[1:] + speeds[:-1]))])
    held = speeds >= path.speeds[nodes] * (1.0 - 1e-9)
    causes = np.where(held[1:] & held[:-1], path.causes[nodes[:-1]], "acceleration")
    return from_speeds(times, speeds, limits.period_s, causes)


def _s_curve(path, limits, ends, lengths, squares, nodes):
    """S-curves from rest to rest: a path with stops on the way is planned between them."""
    stops = np.flatnonzero(squares[1:-1] == 0.0) + 1
    bounds = np.concatenate([[0], stops, [len(squares) - 1]])
    pieces = []
    for start, stop in itertools.pairwise(bounds):
        block = slice(start, stop + 1)
        from_speed = ends[0] if start == 0 else 0.0
        to_speed = ends[1] if stop == len(squares) - 1 else 0.0
        pieces.append(_block(limits, lengths[block] - lengths[start], squares[block], from_speed, to_speed))
    durations, jerks = (np.concatenate([piece[k] for piece in pieces]) for k in range(2))
    profile = from_jerks(durations, jerks, ends[0], lengths[-1], limits.period_s)
    at = np.searchsorted(lengths, profile.terms[:, 0], side="right") - 1
    held = profile.terms[:, 1] >= path.speeds[nodes[at]] * (1.0 - 1e-3)
    full = np.abs(2.0 * profile.terms[:, 2]) >= limits.acceleration * (1.0 - 1e-6)
    causes = np.where(held, path.causes[nodes[at]], np.where(full, "acceleration", "jerk"))
    return replace(profile, limited_by=tuple(causes))


def _block(limits, lengths, squares, start, end):
    duration = np.sum(2.0 * np.diff(lengths) / (np.sqrt(squares[1:]) + np.sqrt(squares[:-1])))
    duration += 4.0 * limits.acceleration / limits.jerk + 4.0 * np.cbrt(lengths[-1] / limits.jerk)
    tick = min(limits.period_s, limits.acceleration / limits.jerk / _TICKS)
    tick = max(tick, duration / _MOST_TICKS)
    dips = _valleys(squares)
    places = np.append(lengths[dips], lengths[-1])
    valleys = places, np.append(np.sqrt(squares[dips]), end)
    machine = limits.acceleration, limits.jerk, tick
    limit = lengths, squares
    _jerk.lower_valleys(limit, valleys, machine)
    durations, jerks = np.empty(20 * _MOST_TICKS), np.empty(20 * _MOST_TICKS)
    count = _jerk.climb(limit, valleys, machine, start, durations, jerks)[0]
    if count < 0:
        raise ValueError(
            f"no S-curve fits between start_speed {start:g} mm/s and end_speed {end:g} mm/s in "
            f"{lengths[-1]:g} mm; raise jerk or lower these speeds"
        )
    return durations[:count], jerks[:count]


def _valleys(values):
    """Where values stop falling before they rise; of a level floor, its first sample."""
    steps = 1 + np.flatnonzero(np.abs(np.diff(values)) > 1e-9 * np.maximum(values[1:], values[:-1]))
    at = np.concatenate([[0], steps])
    inner = values[at[1:-1]]
    return at[1:-1][(inner < values[at[:-2]]) & (inner < values[at[2:]])]


def _refuse_ends(ends, path, lengths, squares, nodes):
    for name, asked, square, at in (
        ("start_speed", ends[0], squares[0], 0),
        ("end_speed", ends[1], squares[-1], -1),
    ):
        most = np.sqrt(square)
        if asked > most * (1.0 + 1e-9):
            held = path.speeds[at] <= most * (1.0 + 1e-9)
            reason = (
                path.causes[at] if held else "acceleration, over the distance to the other end and the bends"
            )
            raise ValueError(
                f"{name} {asked:g} mm/s is above what the limits allow: at most {most:.6g} mm/s, by {reason}"
            )
