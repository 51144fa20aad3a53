"""How near a plan is to the least time: a lower bound that anyone can check, and the use of every limit.

Without a limit of jerk the fastest speed at every place is known: no motion is above it anywhere, so the time
along it, at samples closer than the plan's and under limits relaxed for what lies between them, is the bound.

With one, it is the least time of a convex problem on the grid of the plan that leaves more freedom (see
`_relaxation`), under limits without the plan's margin. What the grid hides is of the second order of its
cells, of which a period holds four.

Corners bound the speed at the corner alone, each as if it had the period to itself: a plan holds that speed
for some periods, or nearly stops, and is longer by what that takes.

Of 518 random plans (2026-11) of smooth curves without a jerk of axes all are within 1 % of it, but for the
whole period. With one, 9 of 36 are 1.5 to 8 % longer: at knots where the rate of the curvature jumps, the
freer problem may take its time.
"""

from dataclasses import dataclass, replace

import numpy as np

from nurbs_lab.common.values import Value
from nurbs_lab.motion import _scurve_kernels
from nurbs_lab.motion._scurve_problem import FALL, LIMITS, STEPS
from nurbs_lab.motion._verify import excesses
from nurbs_lab.motion.prepared_curve import prepare
from nurbs_lab.motion.scan import SCAN_TOLERANCE, TURN, scan
from nurbs_lab.motion.scurve import WHOLE, limits_on, s_curve
from nurbs_lab.motion.trapezoid import fastest

#: The bound without a limit of jerk has samples closer than those of a plan by this factor.
_FINER = 8.0
#: The bound with one may be lower than the least time by this part.
_GAP = 3e-4
#: The barrier's first weight, as a part of that at which time and all rooms count alike.
_FIRST = 0.1
#: A stage ends when one more Newton step would gain less than this part of its weight.
_NEAR = 0.1


@dataclass(frozen=True, eq=False, repr=False)
class Certificate(Value):
    """What `FeedProfile.certificate` found.

    Attributes
    ----------
    least_s : float
        No motion is shorter, in s, rounded up to whole periods, that keeps the limits between corners, and at
        each has at most the speed at which its velocity changes by what an acceleration within the limits
        makes of it in one period, or one that has grown for a period by the jerk of axes.
    gap : float
        By what part of that the plan is longer.
    uses : dict of str to float
        Largest use of each limit, 1.0 where it is taken in full.
    """

    least_s: float
    gap: float
    uses: dict


def certify(feed):
    """The certificate of a plan of one curve."""
    if feed.curve is None or feed.limits is None:
        raise ValueError("feed has no curve or no limits: only what plan_feed returns has a certificate")
    limits = feed.limits.in_dimensions(feed.curve.dim)
    track = prepare(feed.curve)
    path = scan(track, limits)
    ends = np.array([feed.speed(0.0), feed.speed(feed.duration)])
    uses = {}
    for name, _, _, factors in excesses(path, limits, feed):
        power = {"jerk": 3.0, "axis_jerk": 3.0, "speed": 1.0, "axis_speed": 1.0}.get(name, 2.0)
        uses[name] = max(uses.get(name, 0.0), float(factors.max()) ** power)
    hard = replace(limits, jerk=None, axis_jerk=None)
    least = _without_jerk(track, hard, ends)
    if limits.soft:
        relaxed = _relaxed(path, 1.0 / (1.0 - WHOLE.margin))
        motion = s_curve(relaxed, limits, ends, WHOLE)
        block = _free_block(motion.block, relaxed, limits, ends)
        least = max(least, _least_time(block, motion.middle))
    least = float(np.ceil(least / feed.period_s - 1e-6) * feed.period_s)
    return Certificate(least, feed.duration / least - 1.0, uses)


def _without_jerk(track, limits, ends):
    """The bound without a limit of jerk.

    On a path that turns by h between two samples a motion may use, from one to the next, at most the part
    h / 2 more of the acceleration than `fastest` does, which keeps the limit at both.
    """
    path = scan(track, limits, finer=_FINER)
    speeds = limits.speed_table(path.tangents, path.curvatures)[:-1].min(axis=0)
    for side in ("left", "right"):
        at = np.searchsorted(path.lengths, path.kinks[:, 0], side) - (side == "right")
        np.minimum.at(speeds, at, _corner_speeds(path, limits))
    path = replace(path, speeds=speeds, zones=path.zones[:0])
    relaxed = _relaxed(path, 1.0 + 0.5 * TURN / _FINER, _FINER)
    caps = (relaxed.speeds * relaxed.parts[:, 0]) ** 2
    lengths, squares = fastest(relaxed, limits, ends, caps)
    speeds = np.sqrt(squares)
    return float(np.sum(2.0 * np.diff(lengths) / (speeds[1:] + speeds[:-1])))


def _relaxed(path, factor, finer=1.0):
    """The path with limits a little higher: those of speed by what the samples hide, the others more."""
    hidden = 1.0 + 2.0 * SCAN_TOLERANCE / finer
    return replace(path, parts=path.parts * (hidden, hidden * factor, hidden * factor, 1.0))


def _free_block(block, path, limits, ends):
    """The block without the zones of corners: the speed is limited at the corners that are nodes, alone."""
    bare, limits = replace(path, zones=path.zones[:0]), replace(limits, jerk=float(block.jerk.max()))
    free = dict(zip(LIMITS, limits_on(bare, limits, block.nodes, ends, WHOLE.margin), strict=True))
    most = np.zeros(len(block.nodes))
    at = np.searchsorted(block.nodes, path.kinks[:, 0] * (1.0 - 1e-12)).clip(max=len(most) - 1)
    there = np.abs(block.nodes[at] - path.kinks[:, 0]) < 1e-12 * path.length
    np.maximum.at(most, at[there], _corner_speeds(path, limits)[there] ** -2.0)
    free["along"] = np.column_stack([free["along"], np.zeros(len(most))])
    free["across"] = np.column_stack([free["across"], most])
    return replace(block, **free, parts=np.ones(len(most) - 1))


def _least_time(block, middle):
    """The bound on a grid, from ordinates that keep the limits.

    Where time minus weight times the logarithms of all M rooms is least, the time exceeds the least one by at
    most weight times M.
    """
    middle, (widths, *others, turns, _) = middle.copy(), block.problem
    first, last, half = turns[:, ::2], turns[:, 1::2], 0.5 * widths[:, None]
    mean, ways = 0.5 * (first + last)[..., 0], [half * end[..., 1] for end in (first, last)]
    free = half * first[..., 2], half * last[..., 2], ways[0] - mean, ways[1] + mean
    problem = widths, *others, turns[:, :0].copy(), np.stack(free, axis=2)
    count = 2 * (len(middle) - 2) + (1 + block.along.shape[1]) * (len(middle) - 1)
    count += (1 + turns.shape[1]) * len(middle)
    weight = _FIRST * block.time(middle) / count
    block.centre(middle, weight)  # away from all limits Newton's method gets under way sooner
    while True:
        _, decrement = _scurve_kernels.centre(problem, middle, weight, _NEAR, STEPS, (1.0, 0.0))
        if not decrement <= _NEAR * weight:
            return 0.0  # nothing is known
        if weight * count <= _GAP * block.time(middle):
            break
        weight *= FALL
    time, _ = _scurve_kernels.potential(problem, middle, weight, *np.empty((2, len(middle) + 1)))
    return time + sum(block.ramp_times) - weight * (count + np.sqrt(count * decrement / weight))


def _corner_speeds(path, limits):
    """The largest speed at every corner, as if it were alone or beside the others, which may cancel it."""
    if limits.axis_jerk is not None:  # of which a plan uses half
        limits = replace(limits, axis_jerk=2.0 * limits.axis_jerk)
    at, steps, most = path.kinks[:, 0], path.kinks[:, 1:], np.full(len(path.kinks), limits.speed)
    alone = limits.corner_speeds(1e99 * np.arange(len(at)), steps, most)[0][1]
    return np.maximum(alone, limits.corner_speeds(at, steps, most)[0][1])
