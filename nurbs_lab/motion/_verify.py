"""By what a planned feed exceeds its limits, measured on the profile and on the curve."""

import numpy as np

from nurbs_lab.common.progress import step_blocks
from nurbs_lab.motion import _kernels
from nurbs_lab.motion.limits import NAMES
from nurbs_lab.motion.scan import arc_lengths, path_derivatives
from nurbs_lab.nurbs import span_kernels

#: Where limits are checked in a cell between two samples of the path, as parts of it.
_INSIDE = np.clip(np.linspace(0.0, 1.0, 5), 1e-9, 1.0 - 1e-9)
#: Chords are measured one by one up to this many periods. Beyond, a chord is so short beside the curve that
#: its error is given by the curvature, which is checked between all samples of the path.
_MOST_CHORDS = 500_000
#: Limits that follow from the curve and allow a speed, whatever the acceleration.
_BY_SPEED = "chord_error", "centripetal_acceleration", "axis_speed"
#: Lengths along the path are known to this part of the whole.
_ROUNDING = 1e-13
#: Start and end speeds, the length and joints of segments may differ by this part.
_EQUAL = 1e-9


def excesses(path, limits, profile):
    """Factors by which the profile is too fast, each limit by itself.

    A row holds the name of the limit, from where to where on the path each factor holds (mm), and the
    factors, which are 1 or less where the limit is kept. A motion slower by the factor keeps it.
    """
    found = _along(limits, profile)
    by_chords = limits.chord_error is not None and profile.duration <= _MOST_CHORDS * limits.period_s
    for k, track in enumerate(path.tracks):
        if limits.of_the_curve:
            found += _at_places(track, path.origins[k], path.u[path.curve == k], limits, profile, by_chords)
        if by_chords:
            found.append(_at_chords(track, path.origins[k], limits, profile))
    return [row for row in found if len(row[3])]


def _along(limits, profile):
    """Speed, acceleration and jerk along the path, from the segments."""
    _, h, s, v, a, j = profile.segments.T
    with np.errstate(divide="ignore", invalid="ignore"):
        level = np.clip(np.nan_to_num(-a / j), 0.0, h)
    fastest = np.max([v, v + h * (a + 0.5 * h * j), v + level * (a + 0.5 * level * j)], axis=0)
    stop = np.append(s[1:], profile.length)
    rows = [("speed", fastest / limits.speed)]
    steepest = np.maximum(np.abs(a), np.abs(a + j * h))
    rounded = 4.0 * np.spacing(fastest) / h  # in short segments rounding of the speed counts
    steepest -= np.where(rounded > _EQUAL * limits.acceleration, rounded, 0.0)
    rows.append(("acceleration", np.sqrt(np.maximum(steepest, 0.0) / limits.acceleration)))
    if limits.jerk is not None:
        rows.append(("jerk", np.cbrt(np.abs(j) / limits.jerk)))
    return [(name, s, stop, factors) for name, factors in rows]


def _at_places(track, origin, samples, limits, profile, by_chords):
    """Limits that depend on the curve: inside every cell of the path, and where two segments meet."""
    breaks = track.spans[0]
    ends = np.union1d(samples, breaks)
    inside = (ends[:-1, None] + np.diff(ends)[:, None] * _INSIDE).ravel()
    names = [name for name in _BY_SPEED if getattr(limits, name) is not None]
    if by_chords:
        names.remove("chord_error")
    rows = []
    for u in (inside, *([_joints(track, origin, profile)] if names else [])):
        s = origin + arc_lengths(track, np.concatenate([breaks[:1], u, breaks[-1:]]))[1:-1]
        t = np.empty(len(s))
        _kernels.times_at(*profile.table, np.clip(s, 0.0, profile.length), t)
        seen = np.repeat(u[len(_INSIDE) // 2 :: len(_INSIDE)], len(_INSIDE)) if u is inside else u
        span = np.clip(np.searchsorted(breaks, seen, side="right") - 1, 0, len(breaks) - 2)
        tangents, curvatures = path_derivatives(track, span, u)
        v = profile.speed(t)
        v[(s < 0.0) | (s > profile.length)] = 0.0  # the profile begins or ends within the curve
        caps = dict(zip(NAMES, limits.speed_table(tangents, curvatures), strict=False)) if names else {}
        for name in names:
            factors = v / caps[name]
            rows.append((name, s, s, _with_peaks(factors) if u is inside else factors))
        if limits.axis_acceleration is not None and u is inside:  # at a joint the acceleration may jump
            cells, lengths = t.reshape(-1, len(_INSIDE)), s.reshape(-1, len(_INSIDE))
            widths = lengths[:, -1:] - lengths[:, :1]
            with np.errstate(divide="ignore"):  # else rounding decides on which side of a knot a place is
                part = np.minimum(1e-4 + _ROUNDING * profile.length / widths, 0.5)
            near = part * (cells[:, -1:] - cells[:, :1])
            a = profile.acceleration(np.clip(cells, cells[:, :1] + near, cells[:, -1:] - near).ravel())
            axes = np.abs(a[:, None] * tangents + v[:, None] ** 2 * curvatures) / limits.axis_acceleration
            rows.append(("axis_acceleration", s, s, np.where(v > 0.0, np.sqrt(axes.max(axis=1)), 0.0)))
    return rows


def _joints(track, origin, profile):
    """Parameters at which two segments of the profile meet."""
    met = profile.terms[1:, 0] - origin
    met = met[(met > 0.0) & (met < track.length)]
    joints = np.empty(len(met))
    span_kernels.invert(track.spans, track.panels, met, joints)
    return joints


def _with_peaks(factors):
    """The factors, raised where the parabola through three neighbours in a cell has its top between them."""
    raised = factors.reshape(-1, len(_INSIDE)).copy()
    left, middle, right = raised[:, :-2].copy(), raised[:, 1:-1].copy(), raised[:, 2:].copy()
    peak = (middle >= left) & (middle >= right) & (2.0 * middle > left + right)
    bending = np.where(peak, 2.0 * middle - left - right, 1.0)
    raised[:, 1:-1] += np.where(peak, (right - left) ** 2 / (8.0 * bending), 0.0)
    return raised.ravel()


def _at_chords(track, origin, limits, profile):
    """The chord error of every period on one curve."""
    count = 1 + int(np.ceil(profile.duration / limits.period_s - 1e-9))
    t = np.linspace(0.0, profile.duration, max(count, 2))
    s = np.clip(profile.displacement(t) - origin, 0.0, track.length)
    s = s[max(np.count_nonzero(s == 0.0) - 1, 0) : len(s) - max(np.count_nonzero(s == track.length) - 1, 0)]
    u = np.empty(len(s))
    for part in step_blocks(len(s), "checking"):
        span_kernels.invert(track.spans, track.panels, s[part], u[part])
    chords, errors = np.empty(len(u) - 1), np.empty(len(u) - 1)
    for part in step_blocks(len(chords), "checking"):
        ends = u[part.start : part.stop + 1]
        _kernels.chord_lengths_and_errors(track.spans, ends, chords[part], errors[part])
    return "chord_error", s[:-1] + origin, s[1:] + origin, np.sqrt(errors / limits.chord_error)


def worst(found):
    """Name, place and size of the largest factor."""
    name, start, _, factors = max(found, key=lambda row: row[3].max())
    at = int(factors.argmax())
    return name, float(start[at]), float(factors[at])


def require_motion(profile, length, ends):
    """Refuse a profile that is no continuous motion of the asked length between the asked speeds.

    Only the segments are looked at, so that this check shares nothing with the planner.
    """
    _, h, s, v, a, j = profile.segments.T
    reached, fastest = s + h * (v + h * (0.5 * a + h * j / 6.0)), max(profile.peak, np.max(ends))
    after = v + h * (a + 0.5 * h * j)
    late = 4.0 * np.spacing(profile.duration) * abs(a[-1])  # the speed gained while the time is rounded
    with np.errstate(divide="ignore", invalid="ignore"):
        level = np.clip(np.nan_to_num(-a / j), 0.0, h)
    faults = {
        "start_speed": abs(v[0] - ends[0]) / fastest,
        "end_speed": max(abs(after[-1] - ends[1]) - late, 0.0) / fastest,
        "length of the curve": abs(reached[-1] / length - 1.0),
        "continuity of the length": np.abs(reached[:-1] - s[1:]).max(initial=0.0) / length,
        "continuity of the speed": np.abs(after[:-1] - v[1:]).max(initial=0.0) / fastest,
        "forward motion": max(-np.min([v, after, v + level * (a + 0.5 * level * j)]) - late, 0.0) / fastest,
    }
    for name, fault in faults.items():
        if not fault <= _EQUAL:
            raise ValueError(
                f"no plan keeps {name} in double precision with these limits (relative error {fault:.2g}); "
                "choose speed, acceleration, jerk and period_s nearer to the size of the curve"
            )
