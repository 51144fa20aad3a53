"""Kernels of overrides: steps of constant jerk or acceleration that keep every limit of the plan.

A *spot* is a length, a speed and an acceleration of the tool; the speed, acceleration, jerk and segment of
the plan at this length, c and d of the part c + d v² of the limits that corners take, the node before it and
how far it is to the next. The *control* is the jerk or, without a limit of jerk, the acceleration.

A *task* is ``(feed, curve, nodes, hints, limits, step, soft)``: the feed table of the plan; spans and panels;
places equally far apart in the time of the plan: how many a second, which are filled (as they are needed),
tangents, curvature vectors, their rates and what corners add to curvatures, and corners; the panel and the
span of the last one filled; the limits along the path, of the vector and of axes, first of acceleration, then
of jerk; the time of a step; and whether there is a limit of jerk.
"""

from math import sqrt

import numpy as np

from nurbs_lab.common.kernels import ZERO, compiled, kernel
from nurbs_lab.motion._kernels import length_at, path_derivatives, plan_at
from nurbs_lab.nurbs.span_kernels import find_span, parameter_at

#: Rates of the plan that differ by no more are equal, and accelerations that do by no more of their limit.
EQUAL = 1e-9
#: Halvings towards a time or a rate, and towards a limit.
_HALVINGS, _TRIALS = 40, 4
#: Landings where a limit is in the way, and beyond the speed of the plan.
_NONE, _BEYOND = (np.nan, 0, 0.0), (2.0, 0, 0.0)


@compiled
def _fill(task, node, segment):
    """Fill a node with the geometry of the path."""
    feed, (spans, panels), (rate, filled, geometry, _), hints = task[:4]
    there = length_at(feed, node / rate, find_span(feed[0], node / rate, segment))
    u, (hints[0], hints[1]), _ = parameter_at(spans, panels, (hints[0], hints[1]), there)
    hints[1], one = find_span(spans[0], u, hints[1]), geometry[node]
    path_derivatives(spans, hints[1:2], np.full(1, u), one[:1], one[1:2], one[2:3])
    filled[node] = True


@compiled
def _spot(task, motion, segment):
    """The spot of a length, a speed and an acceleration, found from a segment near it."""
    rate, filled, _, corners = task[2]
    v, a, j, tau, segment = plan_at(task[0], motion[0], segment)
    place = min(max(tau * rate, 0.0), filled.size - 1.001)
    k = int(place)
    for node in range(k, k + 2):
        if not filled[node]:
            _fill(task, node, segment)
    return *motion, v, a, j, segment, np.maximum(corners[k], corners[k + 1]), k, place - k


@kernel
def _after(task, spot, control, h):
    """Length, speed and acceleration after a time under a control."""
    s, v, a = spot[:3]
    if not task[6]:
        return s + h * (v + 0.5 * h * control), v + h * control, control
    return s + h * (v + h * (0.5 * a + h * control / 6.0)), v + h * (a + 0.5 * h * control), a + h * control


@kernel
def _allowed(task, spot, v, a, jerk):
    """The least and the largest acceleration, or jerk, that all limits allow at a place, a speed and ``a``.

    What the plan itself takes at a constant rate is allowed: the limits are linear between nodes.
    """
    geometry, (along, vector, of_axes) = task[2][2], task[4][int(jerk)]
    planned, slope, change, _, corner, k, part = spot[3:]
    room = max(1.0 - corner[0] - corner[1] * v * v, 1e-9)
    rate = min(v / planned, 1.0) if planned > 0.0 else 0.0
    own, turn, turn_of_own, twist = slope * rate**2, v * v, v * v, 0.0
    if jerk:
        own, turn, turn_of_own, twist = change * rate**3, 3.0 * v * a, 3.0 * v * own, v**3
    high, across = max(along * room, abs(own)), 0.0
    low = -high
    for i in range(geometry.shape[2]):
        t = (1.0 - part) * geometry[k, 0, i] + part * geometry[k + 1, 0, i]
        n = (1.0 - part) * geometry[k, 1, i] + part * geometry[k + 1, 1, i]
        m = (1.0 - part) * geometry[k, 2, i] + part * geometry[k + 1, 2, i]
        if jerk:  # which sees corners that share a period as a curvature
            n += (1.0 - part) * geometry[k, 3, i] + part * geometry[k + 1, 3, i]
        across += (turn * n) ** 2
        most = max(of_axes[i] * room, abs(own * t + turn_of_own * n + twist * m))
        one, two = (-most - turn * n - twist * m) / t, (most - turn * n - twist * m) / t
        low, high = max(low, min(one, two)), min(high, max(one, two))
    if vector < np.inf:
        root = sqrt(max((vector * room) ** 2 - across, own * own))
        low, high = max(low, -root), min(high, root)
    return low, high


@compiled
def _extreme(task, spot, sign):
    """The control farthest in the direction of a sign that keeps the limits over a step; NaN if none does."""
    step, soft, (_, v, a) = task[5], task[6], spot[:3]
    end = _spot(task, _after(task, spot, 0.0 if soft else a, step), spot[6])
    low, high = first = _allowed(task, spot, v, a, soft)
    for _ in range(4):
        control = high if sign > 0.0 else low
        _, later, slope = _after(task, spot, control, step)
        low, high = _allowed(task, end, max(later, 0.0), slope, False)
        if soft:
            more = _allowed(task, end, max(later, 0.0), slope, True)
            low, high = max((low - a) / step, more[0]), min((high - a) / step, more[1])
        low, high = max(low, first[0]), min(high, first[1])
        if not low <= high:
            return np.nan
    return high if sign > 0.0 else low


@kernel
def _drift(spot):
    """By how much the acceleration is above that of a constant rate of the plan, and that rate."""
    rate = spot[1] / spot[3] if spot[3] > 0.0 else 0.0
    return spot[2] - spot[4] * rate * rate, rate


@compiled
def _moved(task, spot, control):
    """The spot after a step, and whether the plan may go on from it at a constant rate."""
    joints, after = task[0][1], _spot(task, _after(task, spot, control, task[5]), spot[6])
    good = after[1] <= (1.0 + EQUAL) * after[3] and after[0] < joints[-1, 0]
    for i in range(spot[6] + 1, after[6] + 1):  # it may stop inside of the step
        good = good and joints[i, 1] >= (1.0 - 1e-6) * min(spot[1], after[1])
    return after, good


@compiled
def _landing(task, spot):
    """The constant rate at which the motion arrives if it stops changing it; in how many steps, and a part.

    The rate is NaN where a limit is in the way, 2 where the motion gets too fast for the plan, and negative
    where it would turn round.
    """
    drift, rate = _drift(spot)
    if not task[6] or abs(drift) <= EQUAL * task[4][0][0]:
        return rate, 0, 0.0
    steps = 0
    while True:
        control = _extreme(task, spot, -drift)
        if np.isnan(control):
            return _NONE
        after, good = _moved(task, spot, control)
        if not good:
            return _BEYOND
        if drift * _drift(after)[0] <= 0.0:
            low, high = 0.0, task[5]
            for _ in range(_HALVINGS):
                middle = 0.5 * (low + high)
                after = _spot(task, _after(task, spot, control, middle), spot[6])
                if drift * _drift(after)[0] > 0.0:
                    low = middle
                else:
                    high = middle
            return _drift(after)[1], steps, high
        if after[1] <= 0.0:
            return -1.0, 0, 0.0
        spot, steps = after, steps + 1


@kernel
def _fits(landing, sign, goal):
    """Whether a landing is on the way to a goal."""
    return 0.0 <= landing[0] <= 1.0 + EQUAL and sign * (goal - landing[0]) >= 0.0


@compiled
def _steps_at_once(task, spot, sign, out):
    """The spot after steps of the extreme control, one for each row of ``out``, and its landing."""
    for k in range(len(out)):
        control = _extreme(task, spot, sign)
        if np.isnan(control):
            return spot, _NONE
        out[k] = *spot[:3], control
        spot, good = _moved(task, spot, control)
        if not good:
            return spot, _NONE
    return spot, _landing(task, spot)


@compiled
def _mixed_step(task, spot, sign, goal, landing, out):
    """A step of as much of the extreme control as may be, the rest being what keeps or finds a rate."""
    (drift, rate), least, most = _drift(spot), _extreme(task, spot, -1.0), _extreme(task, spot, 1.0)
    extreme = most if sign > 0.0 else least
    safe = min(max(spot[5] * rate**3 if task[6] else spot[4] * rate**2, least), most)
    if task[6] and abs(drift) > EQUAL * task[4][0][0]:
        safe = least if drift > 0.0 else most
    low, high, lower, upper, end, best = 0.0, 1.0, landing[0], np.nan, spot, _NONE
    for k in range(0 if np.isnan(extreme) else _HALVINGS):
        if k > _TRIALS and np.isnan(upper):
            break
        part, guess = 0.5 * (low + high), low + (high - low) * (goal - lower) / (upper - lower)
        if k % 3 and 0.0 <= upper <= 1.0 and low < guess < high:
            part = guess
        after, good = _moved(task, spot, safe + part * (extreme - safe))
        found = _landing(task, after) if good else _BEYOND
        if _fits(found, sign, goal):
            low, lower, end, best = part, found[0], after, found
            out[0] = *spot[:3], safe + part * (extreme - safe)
            if abs(goal - lower) <= EQUAL:
                break
        else:
            high, upper = part, found[0]
    return end, best


@compiled
def approach(task, motion, goal, out):
    """Fill rows of ``out`` with motions and controls of steps until the tool has a constant rate.

    Their number, the time of the last one, the motion after them and the rate are returned; the rate is NaN
    if there are too few rows.
    """
    done, block, spot = 0, 1, _spot(task, motion, ZERO)
    landing = _landing(task, spot)
    if np.isnan(landing[0]):
        landing = _drift(spot)[1], 0, 0.0
    while done < len(out):
        sign, end, ahead = 1.0 if goal > landing[0] else -1.0, spot, _NONE
        if abs(goal - landing[0]) > EQUAL:
            block = min(block, len(out) - done)
            end, ahead = _steps_at_once(task, spot, sign, out[done : done + block])
            if not _fits(ahead, sign, goal):
                block //= 2
                if block:
                    continue
                block = 1
                end, ahead = _mixed_step(task, spot, sign, goal, landing, out[done:])
        if _fits(ahead, sign, goal):
            spot, landing, done, block = end, ahead, done + block, 2 * block
            continue
        h = task[5] if landing[1] else landing[2]
        if h == 0.0:
            return done, task[5], spot[:3], landing[0]
        control = _extreme(task, spot, -_drift(spot)[0])
        out[done] = *spot[:3], control
        spot, done = _spot(task, _after(task, spot, control, h), spot[6]), done + 1
        if not landing[1]:
            return done, h, spot[:3], landing[0]
        landing = landing[0], landing[1] - 1, landing[2]
    return done, task[5], spot[:3], np.nan
