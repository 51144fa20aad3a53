"""Kernels of the S-curve: the fastest speeds with limited jerk under a speed limit along the path.

The state is (s, v, a). At every tick the largest jerk is taken after which a *way out* remains: a seven-phase
S-curve down to one of the valleys of the speed limit, arriving level (a = 0) and never above the limit. From
a valley at its own speed the next way out exists by construction, because the valleys were lowered
from the last to the first by the same test. So the motion never gets stuck, follows the limit where the
limit is gentle, and brakes at the last moment where it is not.
"""

from math import sqrt

import numpy as np

from nurbs_lab.motion._kernels import find_span, kernel

_SLACK = 1.0 + 1e-9
#: Halvings of the jerk between the way out and the largest.
_HALVINGS = 26
#: Arrived when the way out leaves no more than this part of the whole length.
_ARRIVED = 1e-9


@kernel
def way_out(v, a, goal, acceleration, jerk, phases):
    """Durations and jerks of the S-curve from (v, a) to (goal, 0), or to a level speed below it."""
    peak = v + a * a / (2.0 * jerk)
    phases[:] = 0.0
    if a >= 0.0 and peak <= goal:
        phases[0, 0], phases[0, 1] = a / jerk, -jerk
        return
    if a < 0.0 and v - a * a / (2.0 * jerk) <= goal:
        phases[0, 0], phases[0, 1] = -a / jerk, jerk
        return
    brake = min(acceleration, sqrt(jerk * (peak - goal)))
    phases[0, 0], phases[0, 1] = max(a, 0.0) / jerk, -jerk
    phases[1, 0], phases[1, 1] = (brake + min(a, 0.0)) / jerk, -jerk
    phases[2, 0] = max((peak - goal) / brake - brake / jerk, 0.0)
    phases[3, 0], phases[3, 1] = brake / jerk, jerk


@kernel
def moved(state, duration, jerk):
    """The state after a time of constant jerk."""
    s, v, a = state
    s += duration * (v + duration * (0.5 * a + duration * jerk / 6.0))
    v += duration * (a + 0.5 * duration * jerk)
    return s, v, a + duration * jerk


@kernel
def _limit(limit, s, hint):
    """Squared speed limit at s, and the cell."""
    lengths, squares = limit
    hint = find_span(lengths, s, hint)
    share = (s - lengths[hint]) / (lengths[hint + 1] - lengths[hint])
    return squares[hint] + share * (squares[hint + 1] - squares[hint]), hint


@kernel
def _escapes(state, limit, valleys, first, goal, machine, cell, phases):
    """Whether the way out to valley ``goal`` stays within the limit; the distance then left, else -1."""
    acceleration, jerk, tick = machine
    least = (1e-9 * acceleration * tick) ** 2
    places, speeds = valleys
    way_out(state[1], state[2], speeds[goal], acceleration, jerk, phases)
    passing = first
    for phase in range(4):
        if phases[phase, 0] <= 0.0:
            continue
        parts = int(np.ceil(phases[phase, 0] / tick))
        part = phases[phase, 0] / parts
        for _ in range(parts):
            before = state
            state = moved(state, part, phases[phase, 1])
            s, v, _ = state
            if s > places[goal] + _ARRIVED * places[-1] * 1e-3:
                return -1.0
            while passing < goal and places[passing] < s:
                share = (places[passing] - before[0]) / (s - before[0])
                if before[1] + share * (v - before[1]) > speeds[passing] * _SLACK:
                    return -1.0
                passing += 1
            most, cell = _limit(limit, s, cell)
            if v < -1e-9 * acceleration * tick or v * v > most * _SLACK + least:
                return -1.0
    for k in range(passing, goal):
        if state[1] > speeds[k] * _SLACK:
            return -1.0
    return max(places[goal] - state[0], 0.0)


@kernel
def viable(state, limit, valleys, first, machine, cell, phases):
    """Nearest valley to which a way out exists, -1 if none does, and the distance left before it."""
    acceleration, jerk, _ = machine
    places = valleys[0]
    peak = state[1] + state[2] * state[2] / (2.0 * jerk)
    farthest = state[0] + 2.0 * peak * (peak / acceleration + 2.0 * acceleration / jerk)
    for goal in range(first, places.size):
        left = _escapes(state, limit, valleys, first, goal, machine, cell, phases)
        if left >= 0.0:
            return goal, left
        if places[goal] > farthest:
            break
    return -1, -1.0


@kernel
def lower_valleys(limit, valleys, machine):
    """Lower each valley's speed until a way out to a later one exists, from the last backwards."""
    places, speeds = valleys
    phases = np.zeros((4, 2))
    cell = 0
    for k in range(places.size - 2, -1, -1):
        cell = find_span(limit[0], places[k], cell)
        low, high = 0.0, speeds[k]
        trial = high
        for _ in range(50):
            goal, _ = viable((places[k], trial, 0.0), limit, valleys, k + 1, machine, cell, phases)
            if goal >= 0:
                low = trial
                if trial == high:
                    break
            else:
                high = trial
            trial = 0.5 * (low + high)
        speeds[k] = low


@kernel
def _follow(out, tick, state, durations, jerks, count):
    """Go along a way out for one tick, piece by piece, and take it off the way out."""
    left = tick
    for k in range(5):
        if k < 4:
            part, jerk = min(out[k, 0], left), out[k, 1]
            out[k, 0] -= part
        else:
            part, jerk = left, 0.0
        if part > 0.0:
            durations[count], jerks[count] = part, jerk
            state = moved(state, part, jerk)
            count += 1
            left -= part
    return state, count


@kernel
def climb(limit, valleys, machine, start, durations, jerks):
    """Durations and jerks of the whole motion: their count and the distance left; count -1 if none fits."""
    acceleration, jerk, tick = machine
    places = valleys[0]
    final = places.size - 1
    phases, out = np.zeros((4, 2)), np.zeros((4, 2))
    state = (0.0, start, 0.0)
    count = cell = first = 0
    goal, left = viable(state, limit, valleys, 0, machine, cell, phases)
    if goal < 0:
        return -1, 0.0
    while count + 10 < durations.size:
        while first < final and places[first] <= state[0]:
            first += 1
        cell = find_span(limit[0], state[0], cell)
        found, room = viable(state, limit, valleys, first, machine, cell, phases)
        if found >= 0:
            goal, left = found, room
            out[:] = phases
        if goal == final and left <= _ARRIVED * places[final]:
            break
        low, high = -jerk, min(jerk, (acceleration - state[2]) / tick)
        best = np.nan
        for trial in range(_HALVINGS):
            middle = high if trial == 0 else 0.5 * (low + high)
            found, _ = viable(moved(state, tick, middle), limit, valleys, first, machine, cell, phases)
            if found >= 0:
                best = low = middle
                if trial == 0:
                    break
            else:
                high = middle
        if np.isnan(best):
            state, count = _follow(out, tick, state, durations, jerks, count)
        else:
            durations[count], jerks[count] = tick, best
            state = moved(state, tick, best)
            count += 1
    else:
        return -1, 0.0
    for k in range(4):
        if out[k, 0] > 0.0:
            durations[count], jerks[count] = out[k, 0], out[k, 1]
            count += 1
    return count, left
