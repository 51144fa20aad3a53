"""Corners of a scanned path: zones of some periods in which the speed is held, or the motion nearly stops."""

from dataclasses import replace

import numpy as np

#: Arrays of a `Scan` with one entry for each sample.
ROWS = "curve", "u", "lengths", "speeds", "causes", "tangents", "curvatures", "parts", "tops"
#: A corner that takes a smaller part of the acceleration of a period is none.
_NEGLIGIBLE = 1e-7
#: Samples nearer to each other than this part of the length are one: rounding would be an acceleration.
_APART = 1e-10
#: With jerks of axes a corner where it takes less time to stop is passed at this part of its speed, without
#: at a negligible one. Beside it the motion takes all of its jerk, or of its acceleration: periods that hold
#: the corner see a mean of the directions before and behind it.
_STOP = 0.05
#: Without jerks of axes a stop that gains less than this part of the way until the motion has its speed again
#: is not made.
_WORTH = 0.02


def sampled(limits, curve, u, lengths, tangents, curvatures):
    """Rows of a `Scan` at places of the path."""
    table = limits.speed_table(tangents, curvatures)[:-1]
    causes = np.array(limits.names, dtype=object)[table.argmin(axis=0)]
    rows = np.ones((len(u), 4)), np.full(len(u), limits.speed)
    values = curve, u, lengths, table.min(axis=0), causes, tangents, curvatures, *rows
    return dict(zip(ROWS, values, strict=True))


def slowed_at_corners(path, limits):
    """The path with its speeds lowered in zones: from a period, or two, before each corner to as long after
    it, and in windows of two periods that begin or end at a corner where these hold no such zone.
    """
    at, least = path.kinks[:, 0], np.interp(path.kinks[:, 0], path.lengths, path.speeds)
    (begun, held, ended), names = limits.corner_speeds(at, path.kinks[:, 1:], least)
    reach_s = np.full(len(at), limits.period_s)
    middles = at + reach_s * np.minimum(begun, least), at - reach_s * np.minimum(ended, least)
    windows = [middles, (begun, ended), names[::2], (least, least), (reach_s, reach_s)]
    names = names[1]  # of the windows around corners, which are the zones
    if not limits.soft:
        stops = _stops(path, limits, held) & (names != "chord_error")
        held, reach_s = np.where(stops, _NEGLIGIBLE, 1.0) * held, np.where(stops, 0.0, reach_s)
    if limits.axis_jerk is not None:  # third differences hold three periods, and see curvatures that jump
        first = np.flatnonzero(np.diff(path.lengths) == 0.0)
        steps = np.abs(path.curvatures[first + 1] - path.curvatures[first])
        with np.errstate(divide="ignore"):
            most = np.sqrt((0.5 * limits.axis_jerk * limits.period_s / steps).min(axis=1))
        part = np.where(_stops(path, limits, held), _STOP, 1.0)
        held, reach_s = part * held, 2.0 * limits.period_s * np.append(part, np.ones(len(first)))
        at = np.append(at, path.lengths[first])
        held, names = np.append(held, most), np.append(names, np.full(len(first), "axis_jerk", dtype=object))
        least = np.interp(at, path.lengths, path.speeds)
    zones = _telling([at, held, names, least, reach_s])
    windows = _telling([np.concatenate(pair) for pair in windows])
    free = _without_zones(windows, zones)
    rows = [np.append(one, other[free]) for one, other in zip(zones, windows, strict=True)]
    order = np.argsort(rows[0], kind="stable")
    at, held, names, least, reach_s = (row[order] for row in rows)
    reach = np.minimum(held, least) * reach_s
    parts = np.minimum(least / held, 1.0)
    zones = np.column_stack([np.maximum(at - reach, 0.0), np.minimum(at + reach, path.length), held, parts])
    if not limits.soft:
        path = _with_samples(path, limits, at, reach)
    apart = np.where(reach > 0.0, _APART * path.length, 4.0 * np.spacing(path.length))  # stops are points
    first = np.searchsorted(path.lengths, zones[:, 0] - apart)
    beyond = np.searchsorted(path.lengths, zones[:, 1] + apart)
    slowest = np.full(len(path.u), -1)
    for k in np.argsort(-held, kind="stable"):  # the slowest is written last
        slowest[first[k] : beyond[k]] = k
    speeds = np.append(held, np.inf)[slowest]
    causes = np.where(speeds < path.speeds, np.append(names, "")[slowest], path.causes)
    return replace(path, speeds=np.minimum(speeds, path.speeds), causes=causes, zones=zones)


def _telling(rows):
    """Those of zones (places, speeds, names, speeds by other limits, reaches in s) that take a part."""
    tells = rows[1] * _NEGLIGIBLE < rows[3]
    return [row[tells] for row in rows]


def _without_zones(windows, zones):
    """Which windows hold no whole zone; the motion takes two periods for one, and so more for the others."""
    (start, stop), (first, last) = (
        at + np.minimum(held, least) * reach_s * [[-1.0], [1.0]]
        for at, held, _, least, reach_s in (zones, windows)
    )
    order, near = np.argsort(start), 1e-9 * (last - first)
    ends = np.minimum.accumulate(np.append(stop[order], np.inf)[::-1])[::-1]
    return ends[np.searchsorted(start[order], first - near)] > last + near


def _stops(path, limits, held):
    """At which corners it takes less time to stop, or nearly so, than to hold their speed.

    It is held for two periods, with jerks of axes for four. A motion out of rest with the acceleration A or
    the jerk J has gone ``A t**2 / 2`` or ``J t**3 / 6`` when it has its speed or its acceleration, or is half
    way to the next corner. One that stops is slower if one that first holds the corner's speed is there
    sooner.
    """
    ways = np.diff(np.concatenate([[0.0], path.kinks[:, 0], [path.length]])).clip(0.0)
    half, power = 0.5 * np.minimum(ways[1:], ways[:-1]), 3.0 if limits.soft else 2.0
    factor, rate, most, held_s = power * (power - 1.0), limits.acceleration, limits.speed, limits.period_s
    if limits.soft:
        rate, most, held_s = limits.axis_jerk.min(), limits.acceleration, 2.0 * held_s
    elif limits.axis_acceleration is not None:
        rate = min(rate, limits.axis_acceleration.min())
    time = np.minimum(most / rate, (factor * half / rate) ** (1.0 / power))
    left = np.maximum(time - held_s, 0.0)
    least = 1.0 if limits.soft else 1.0 - _WORTH
    return factor * held * time < rate * (least * time**power - left**power)


def _with_samples(path, limits, at, reach):
    """The path with samples where the speed of a corner begins and ends to be held, and just beyond."""
    least = _APART * path.length
    ways = np.concatenate([-reach - 2.0 * least, -reach, reach, reach + 2.0 * least])
    new = np.unique(np.tile(at, 4) + ways)
    after = np.searchsorted(path.lengths, new).clip(1, len(path.u) - 1)
    apart = np.minimum(np.abs(new - path.lengths[after - 1]), np.abs(path.lengths[after] - new))
    near = np.append(np.diff(new) < least, False)
    kept = (new > 0.0) & (new < path.length) & (apart > least) & ~near
    new, after = new[kept], after[kept]
    u, tangents, curvatures, _ = path.geometry(new, new)
    curve = np.clip(np.searchsorted(path.origins, new, side="right") - 1, 0, None)
    rows = sampled(limits, curve, u, new, tangents, curvatures)
    # One of the two neighbours may lie between two curves, where the lower limit counts.
    rows["tops"] = np.maximum(path.tops[after - 1], path.tops[after])
    rows["causes"][rows["tops"] < rows["speeds"]] = "speed"
    rows["speeds"] = np.minimum(rows["speeds"], rows["tops"])
    rows = {name: np.concatenate([getattr(path, name), row]) for name, row in rows.items()}
    order = np.argsort(rows["lengths"], kind="stable")
    return replace(path, **{name: row[order] for name, row in rows.items()})
