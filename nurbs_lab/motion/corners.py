"""Corners of a scanned path: zones of some periods in which the speed is held, or the motion nearly stops."""

from dataclasses import replace

import numpy as np

#: Arrays of a `Scan` with one entry for each sample.
ROWS = "curve", "u", "lengths", "speeds", "causes", "tangents", "curvatures", "parts", "tops"
#: A corner that takes a smaller part of the acceleration of a period is none.
_NEGLIGIBLE = 1e-7
#: Samples nearer to each other than this part of the length are one: rounding would be an acceleration.
_APART = 1e-10
#: A corner where it takes less time to stop is passed at this part of its speed. Beside it the motion takes
#: all of its jerk: periods that hold the corner see a mean of the directions before and behind it.
_STOP = 0.05


def sampled(limits, curve, u, lengths, tangents, curvatures):
    """Rows of a `Scan` at places of the path."""
    table = limits.speed_table(tangents, curvatures)[:-1]
    causes = np.array(limits.names, dtype=object)[table.argmin(axis=0)]
    rows = np.ones((len(u), 4)), np.full(len(u), limits.speed)
    values = curve, u, lengths, table.min(axis=0), causes, tangents, curvatures, *rows
    return dict(zip(ROWS, values, strict=True))


def slowed_at_corners(path, limits):
    """The path with its speeds lowered from a period, or two, before each corner to as long after it."""
    at, reach_s = path.kinks[:, 0], np.full(len(path.kinks), limits.period_s)
    held, names = limits.corner_speeds(at, path.kinks[:, 1:])
    if limits.axis_jerk is not None:  # third differences hold three periods, and see curvatures that jump
        first = np.flatnonzero(np.diff(path.lengths) == 0.0)
        steps = np.abs(path.curvatures[first + 1] - path.curvatures[first])
        with np.errstate(divide="ignore"):
            most = np.sqrt((0.5 * limits.axis_jerk * limits.period_s / steps).min(axis=1))
        part = np.where(_stops(path, limits, held), _STOP, 1.0)
        held, reach_s = part * held, 2.0 * limits.period_s * np.append(part, np.ones(len(first)))
        at = np.append(at, path.lengths[first])
        held, names = np.append(held, most), np.append(names, np.full(len(first), "axis_jerk", dtype=object))
        order = np.argsort(at, kind="stable")
        at, held, names, reach_s = at[order], held[order], names[order], reach_s[order]
    least = np.interp(at, path.lengths, path.speeds)
    tells = held * _NEGLIGIBLE < least
    if not tells.any():
        return path
    at, held, names, least, reach_s = (one[tells] for one in (at, held, names, least, reach_s))
    reach = np.minimum(held, least) * reach_s
    parts = np.minimum(least / held, 1.0)
    zones = np.column_stack([np.maximum(at - reach, 0.0), np.minimum(at + reach, path.length), held, parts])
    if not limits.soft:
        path = _with_samples(path, limits, at, reach)
    apart = _APART * path.length
    first = np.searchsorted(path.lengths, zones[:, 0] - apart)
    count = np.searchsorted(path.lengths, zones[:, 1] + apart) - first
    index = np.repeat(first - np.cumsum(count) + count, count) + np.arange(count.sum())
    order = np.argsort(-np.repeat(held, count), kind="stable")  # the slowest is written last
    index, speed, name = index[order], np.repeat(held, count)[order], np.repeat(names, count)[order]
    lower = speed < path.speeds[index]
    speeds, causes = path.speeds.copy(), path.causes.copy()
    speeds[index[lower]], causes[index[lower]] = speed[lower], name[lower]
    return replace(path, speeds=speeds, causes=causes, zones=zones)


def _stops(path, limits, held):
    """At which corners it takes less time to stop, or nearly so, than to hold their speed for four periods.

    A motion out of rest with the jerk J has gone ``J t**3 / 6`` when it has its acceleration, or is half way
    to the next corner. One that stops is slower if one that first holds the corner's speed is there sooner.
    """
    at, period, jerk = path.kinks[:, 0], limits.period_s, limits.axis_jerk.min()
    ways = np.diff(np.concatenate([[0.0], at, [path.length]])).clip(0.0)
    time = np.minimum(limits.acceleration / jerk, np.cbrt(3.0 * np.minimum(ways[1:], ways[:-1]) / jerk))
    left = np.maximum(time - 2.0 * period, 0.0)
    return 6.0 * held * time < jerk * (time**3 - left**3)


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
    if not len(new):
        return path
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
