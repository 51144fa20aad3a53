"""By what a planned feed exceeds its limits, measured on the profile and on the curve."""

import numpy as np

from nurbs_lab.common.checks import largest
from nurbs_lab.common.checks import lengths as lengths_of
from nurbs_lab.motion import _kernels
from nurbs_lab.motion.feed import MOST_SAMPLES, largest_motion
from nurbs_lab.motion.limits import NAMES, OF_AXES
from nurbs_lab.motion.scan import SHARPEST, arc_lengths, path_derivatives

#: Where limits are checked in a cell between two samples of the path, as parts of it.
_INSIDE = np.clip(np.linspace(0.0, 1.0, 5), 1e-9, 1.0 - 1e-9)
#: Limits that follow from the curve and allow a speed, whatever the acceleration.
BY_SPEED = "chord_error", "centripetal_acceleration", "axis_speed"
#: So often the places are twice as dense where a limit may be exceeded between them.
_NEARER = 4


def excesses(path, limits, profile):
    """Factors by which the profile is too fast, each limit by itself.

    A row holds the name of the limit, from where to where on the path each factor holds (mm), and the
    factors, which are 1 or less where the limit is kept. A motion slower by the factor keeps it.
    """
    found, by_chords = _along(limits, profile), _has_chords(limits, profile)
    if limits.of_the_curve:
        found += _on_lines(path, limits, profile)
        for k in np.flatnonzero([not track.straight for track in path.tracks]):
            samples = path.u[path.curve == k]
            found += _on_curve(path.tracks[k], path.origins[k], samples, limits, profile, by_chords)
    return [row for row in found if len(row[3])] + chord_excesses(path, limits, profile)


def chord_excesses(path, limits, profile):
    """The rows of `excesses` that depend on where the periods end."""
    if not _has_chords(limits, profile):
        return []
    count = 1 + int(np.ceil(profile.duration / limits.period_s - 1e-9))
    times = limits.period_s * np.arange(max(count, 2))  # in a slow copy all chords are shorter
    periods = profile.displacement(np.minimum(times, profile.duration))
    rows = [_at_chords(*place, limits, periods) for place in zip(path.tracks, path.origins, strict=True)]
    return [row for row in rows if len(row[3])]


def _has_chords(limits, profile):
    """Whether the chords are looked at; of too many the curvature gives the error."""
    return limits.chord_error is not None and profile.duration <= MOST_SAMPLES * limits.period_s


def _along(limits, profile):
    """Speed, acceleration and jerk along the path, from the segments."""
    _, h, s, *motion = profile.segments.T
    fastest, steepest = largest_motion(h, *motion)
    stop = np.append(s[1:], profile.length)
    rows = [("speed", fastest / limits.speed), ("acceleration", np.sqrt(steepest / limits.acceleration))]
    if limits.jerk is not None:
        rows.append(("jerk", np.cbrt(np.abs(motion[2]) / limits.jerk)))
    return [(name, s, stop, factors) for name, factors in rows]


def _on_lines(path, limits, profile):
    """Limits of axes where the path is straight: those along it, by its direction."""
    straight = np.array([track.straight for track in path.tracks])[path.curve]
    if not (straight.any() and limits.of_axes):
        return []
    ends = np.unique(np.concatenate([path.lengths, profile.terms[:, 0]]).clip(0.0, profile.length))
    behind = np.searchsorted(path.lengths, 0.5 * (ends[1:] + ends[:-1]))  # on the same side of a knot
    cells = np.flatnonzero(straight[behind] & (np.diff(ends) > 1e-12 * path.length))
    (start, stop), times = (ends[cells], ends[cells + 1]), profile.time_at(ends)
    first, last = times[cells], times[cells + 1]
    t, _, _, v, a, j = profile.segments[np.searchsorted(profile.times, 0.5 * (first + last)) - 1].T
    gone, directions = first - t, path.tangents[behind[cells]]
    fastest, steepest = largest_motion(last - first, v + gone * (a + 0.5 * gone * j), a + gone * j, j)
    motion = (fastest, np.positive), (steepest, np.sqrt), (np.abs(j), np.cbrt)
    most = limits.axis_speed, limits.axis_acceleration, limits.axis_jerk
    return [
        (name, start, stop, root(largest(directions / limit) * size))
        for name, limit, (size, root) in zip(OF_AXES, most, motion, strict=True)
        if limit is not None
    ]


def _on_curve(track, origin, samples, limits, profile, by_chords):
    """Limits that depend on the curve, inside every cell between samples, knots and ends of segments.

    They are checked at places, which are denser where a limit may be exceeded between two.
    """
    breaks, rows = track.spans[0], []
    # one of three where these are phases of one acceleration
    met = profile.terms[1 :: 3 if limits.soft and limits.axis_jerk is None else 1, 0] - origin
    met = met[(met > 0.0) & (met < track.length)]
    ends = np.unique(np.concatenate([samples, breaks, track.parameters_at(met)]))
    wide = np.diff(ends) > 1e-12 * (breaks[-1] - breaks[0])  # in others rounding takes one side for the other
    cells = np.column_stack([ends[:-1], ends[1:]])[wide]
    for _ in range(1 + _NEARER):
        places = cells[:, :1] + np.diff(cells, axis=1) * _INSIDE
        u, inside = places.ravel(), np.repeat(places[:, len(_INSIDE) // 2], len(_INSIDE))
        s = origin + arc_lengths(track, np.concatenate([breaks[:1], u, breaks[-1:]]))[1:-1]
        geometry, t = path_derivatives(track, track.spans_at(inside), u), np.empty(len(s))
        _kernels.times_at(*profile.table, np.clip(s, 0.0, profile.length), t)
        within = _off_the_joints(profile, s, t)
        motion = np.stack([profile.speed(t), profile.acceleration(within), profile.jerk(within)])
        motion *= (s >= 0.0) & (s <= profile.length)  # it begins or ends within the curve
        found = [(name, s, s, used) for name, used in _used(geometry, limits, motion, by_chords)]
        rows, cells = rows + found, _doubtful(places, found)
        if not len(cells):
            break
    return rows


def _doubtful(places, rows):
    """Pieces of cells ``(n, 2)`` in which a limit may be exceeded between the places.

    A parabola through the largest factor of a limit in the cell and those beside it, or through the three at
    that end of the cell, has its top between them and passes 1.
    """
    used = np.maximum.reduce([np.zeros(places.size), *(row[3] for row in rows)]).reshape(places.shape)
    at = np.clip(used.argmax(axis=1), 1, len(_INSIDE) - 2)[:, None] + [-1, 0, 1]
    left, top, right = np.take_along_axis(used, at, axis=1).T
    second = left - 2.0 * top + right
    with np.errstate(divide="ignore", invalid="ignore"):
        highest = top - (right - left) ** 2 / (8.0 * second)
    inside = np.abs(right - left) <= -2.0 * second
    return np.take_along_axis(places, at[:, [0, 2]], axis=1)[inside & (highest > 1.0)]


def _used(geometry, limits, motion, by_chords):
    """Factors by which a motion (v, a, j) is too fast for each limit that the curve decides."""
    (tangents, curvatures, rates), (v, a, j) = geometry, (one[:, None] for one in motion)
    caps = dict(zip(NAMES, limits.speed_table(tangents, curvatures), strict=False))
    given = [name for name in BY_SPEED if getattr(limits, name) is not None]
    rows = [(name, motion[0] / caps[name]) for name in given if not (by_chords and name == "chord_error")]
    vector = a * tangents + v * v * curvatures
    if not limits.tangential_only:
        rows.append(("acceleration", np.sqrt(lengths_of(vector) / limits.acceleration)))
    if limits.axis_acceleration is not None:
        rows.append(("axis_acceleration", np.sqrt(largest(vector / limits.axis_acceleration))))
    if limits.axis_jerk is not None:
        change = j * tangents + v * (3.0 * a * curvatures + v * v * rates)
        rows.append(("axis_jerk", np.cbrt(largest(change / limits.axis_jerk))))
    return rows


def _off_the_joints(profile, lengths, times):
    """Times moved off the ends of their cells, where rounding decides on which side of a knot a place is."""
    t, s = times.reshape(-1, len(_INSIDE)), lengths.reshape(-1, len(_INSIDE))
    with np.errstate(divide="ignore"):
        part = np.minimum(1e-4 + SHARPEST * profile.length / (s[:, -1:] - s[:, :1]), 0.5)
    near = part * (t[:, -1:] - t[:, :1])
    return np.clip(t, t[:, :1] + near, t[:, -1:] - near).ravel()


def _at_chords(track, origin, limits, periods):
    """The chord error of every period on one curve, from the lengths at the ends of all periods."""
    first, last = np.searchsorted(periods, [origin, origin + track.length], side="right") - [1, 0]
    s = np.clip(periods[max(first, 0) : last + 1] - origin, 0.0, track.length)
    u = track.parameters_at(s)
    chords, errors = np.empty(len(u) - 1), np.empty(len(u) - 1)
    _kernels.chord_lengths_and_errors(track.spans, u, chords, errors)
    return "chord_error", s[:-1] + origin, s[1:] + origin, np.sqrt(errors / limits.chord_error)


def worst(found):
    """Name, place and size of the largest factor."""
    if not found:
        return "", 0.0, 0.0
    name, start, _, factors = max(found, key=lambda row: row[3].max())
    at = int(factors.argmax())
    return name, float(start[at]), float(factors[at])
