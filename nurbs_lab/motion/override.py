"""Feed override and feed hold: the rate of path time follows a command within the plan's own limits.

The tool stays on the path: only the time tau at which the plan is read runs slower. With the rate
r = d tau / dt in [0, 1] and the plan's v(tau), a(tau), j(tau), the tool has

    speed         r v                                  <= v
    acceleration  r² a + r' v
    jerk          r³ j + 3 r r' a + r'' v

The rule, once a period T, from rate r and slew c (the change of speed that the last period's change of rate
made) to the rate at the end of the period. V = v(tau) T, alpha = A T², beta = J T³, all lengths per period:

1. The command o is the last row of the override whose time has come, at most 1; s is the sign of o - r.
2. room = |o - r| V is the change of speed still to make, and
   most = max(alpha - max(s r² a(tau) T², s r² a(tau + r T) T²), 0) what the acceleration A leaves for it.
3. Without a limit of jerk the new slew is c' = min(room, most).
   With it, and q = s c: c' is the first of q + beta, q, q - beta that is at most ``most`` and from which
   steps of beta still end at zero within the room, c' (c' + beta) <= 2 beta room (c' <= 0 always does), or
   else q - beta; then it is cut to at most ``most`` and ``room``. If q and room are at most beta, c' = room.
4. r' = o if c' = room, else r + s c' / V; and tau' = tau + (r + r') T / 2. The slew kept is s c'.

Bounds: the speed never exceeds the plan's. The change of speed in a period is r²a T² + c' but for
c' |V' - V| / V and for what the plan's acceleration does within the period beside its two ends: so the
acceleration is at most A (1 + 3 A T / v), because c' is at most 2 A T². The jerk is at most 2 J while the
plan itself has jerk J; a slew that reaches its goal early, because the plan brakes at the same time, ends at
once. A hold during even motion takes at most three periods more than v / A + A / J, the least time that the
limits allow.
"""

from dataclasses import replace

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind
from nurbs_lab.motion._kernels import feed_at, kernel
from nurbs_lab.motion.feed import FeedProfile
from nurbs_lab.motion.prepared_curve import MOST_PERIODS

#: Largest command; above 1 it acts as 1, because the plan is as fast as its limits allow.
LARGEST = 2.0
#: Periods computed between two extensions of the arrays.
_BLOCK = 100_000


def apply_override(feed, override):
    """The motion that a feed becomes under an override: a profile along the same path, as long or longer.

    Parameters
    ----------
    feed : FeedProfile
        With its limits of acceleration and jerk; where it has none, the rate follows the command at once.
    override : float or array_like, shape (n, 2)
        A constant rate, or rows (time in s, rate), each valid from its time on; before the first the rate is
        1. Rates lie in [0, 2]: 0 holds the tool, and above 1 acts as 1. The last must not be 0.

    Returns
    -------
    FeedProfile
        Its samples at whole periods follow the rule in this module's docstring; while the rate changes, it is
        the cubic through positions and speeds of both ends of the period.

    Raises
    ------
    TypeError, ValueError
        Naming the rows that are no times that increase or no rates in [0, 2], or a motion that never ends or
        takes more than 1e8 periods.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> feed = nl.plan_feed(nl.paper.CURVE, speed=4.0, acceleration=40.0, period_s=1e-3)
    >>> held = nl.motion.apply_override(feed, [(0.5, 0.0), (1.0, 1.0)])  # half a second's hold
    >>> round(held.duration - feed.duration, 3)  # 0.5 s at rest and two ramps of 0.1 s at half the speed
    0.5
    """
    as_kind("feed", feed, FeedProfile)
    times, rates = _commands(override)
    if not (rates < 1.0).any():
        return feed
    rate, tau = _rates(feed, times, rates)
    return _profile(feed, rate, tau)


def _commands(override):
    given = as_floats("override", override)
    rows = np.array([[0.0, float(given)]]) if given.ndim == 0 else given
    if rows.ndim != 2 or rows.shape[1] != 2 or not len(rows):
        raise ValueError(f"override must be one rate or rows (time, rate), got shape {given.shape}")
    times, rates = rows.T
    if times[0] < 0.0 or (np.diff(times) <= 0.0).any():
        raise ValueError(f"override must have times that increase from 0 or later, got {times.tolist()}")
    wrong = rates[(rates < 0.0) | (rates > LARGEST)]
    if wrong.size:
        raise ValueError(f"override must have rates from 0 (hold) to {LARGEST:g}, got {wrong[0]:g}")
    if rates[-1] == 0.0:
        raise ValueError("override ends with the rate 0: the tool would never arrive; add a row that resumes")
    return np.ascontiguousarray(times), np.minimum(rates, 1.0)


def _rates(feed, times, rates):
    """Rate and path time at the end of every period; the last path time is the end of the plan."""
    period = feed.period_s
    slowest = rates[rates > 0.0].min()
    if times[-1] + feed.duration / slowest > MOST_PERIODS * period:
        raise ValueError(
            f"override makes the motion longer than {MOST_PERIODS:g} periods of {period:g} s; raise its rates"
        )
    acceleration = np.inf if feed.acceleration_limit is None else feed.acceleration_limit
    jerk = np.inf if feed.jerk_limit is None else feed.jerk_limit
    machine = period, acceleration * period**2, jerk * period**3
    first = rates[0] if times[0] == 0.0 and feed.speed(0.0) == 0.0 else 1.0
    rate, tau, slew, count = np.array([first]), np.zeros(1), np.zeros(1), 0
    while tau[-1] < feed.duration:
        rate = np.append(rate, np.empty(_BLOCK))
        tau = np.append(tau, np.empty(_BLOCK))
        count = _follow(feed.table, feed.duration, machine, times, rates, count, rate, tau, slew)
        rate, tau = rate[: count + 1], tau[: count + 1]
    return rate, tau


@kernel
def _follow(feed, duration, machine, times, rates, count, rate, tau, slew):
    """Fill rates and path times from period ``count`` on, by the rule of this module: the last period."""
    period, alpha, beta = machine
    row, hint = -1, 0
    while count + 1 < rate.size:
        r = rate[count]
        while row + 1 < times.size and times[row + 1] <= (count + 1e-9) * period:
            row += 1
        goal = rates[row] if row >= 0 else 1.0
        v, a, _, hint = feed_at(feed, tau[count], hint)
        _, ahead, _, _ = feed_at(feed, tau[count] + r * period, hint)
        sign = 1.0 if goal >= r else -1.0
        moved = max(v, 0.0) * period
        room = abs(goal - r) * moved
        used = (r * period) ** 2
        most = max(alpha - max(sign * a * used, sign * ahead * used), 0.0)
        step = room
        if beta < np.inf:
            q = sign * slew[0]
            if q > beta or room > beta:
                step = q - beta
                for trial in (q + beta, q):
                    if trial <= most and (trial <= 0.0 or trial * (trial + beta) <= 2.0 * beta * room):
                        step = trial
                        break
        step = min(step, most, room)
        slew[0] = sign * step
        rate[count + 1] = goal if step == room else min(max(r + sign * step / moved, 0.0), 1.0)
        tau[count + 1] = tau[count] + 0.5 * (r + rate[count + 1]) * period
        count += 1
        if tau[count] >= duration - 1e-9 * period:
            tau[count] = duration
            break
    return count


def _profile(feed, rate, tau):
    """Segments of the plan where the rate is constant, cubics over the periods in which it changes."""
    period = feed.period_s
    mean = 0.5 * (rate[1:] + rate[:-1])
    start = period * np.arange(len(rate))
    start[-1] = start[-2] + min(period, (tau[-1] - tau[-2]) / mean[-1])
    s, w = feed.displacement(tau), rate * feed.speed(tau)
    even = rate[1:] == rate[:-1]
    cuts = np.flatnonzero(np.append(True, even[1:] != even[:-1]) | np.append(True, ~even[1:]))
    rows = []  # (start time, terms, name of the limit)
    for first, last in zip(cuts, np.append(cuts[1:], len(mean)), strict=True):
        if not even[first]:
            gone, h = s[last] - s[first], start[last] - start[first]
            square = (3.0 * gone / h - 2.0 * w[first] - w[last]) / h
            cube = (w[first] + w[last] - 2.0 * gone / h) / h**2
            rows.append(([start[first]], [[s[first], w[first], square, cube]], ("override",)))
        elif rate[first] == 0.0:
            rows.append(([start[first]], [[s[first], 0.0, 0.0, 0.0]], ("override",)))
        else:
            r = rate[first]
            part = feed.portion(tau[first], tau[last])
            terms = part.terms * r ** np.arange(4.0)
            terms[:, 0] += s[first]
            names = part.limited_by if r == 1.0 else ("override",) * len(terms)
            rows.append((start[first] + part.times[:-1] / r, terms, names))
    times = np.append(np.concatenate([row[0] for row in rows]), start[-1])
    terms = np.concatenate([row[1] for row in rows])
    return replace(feed, times=times, terms=terms, limited_by=sum((tuple(row[2]) for row in rows), ()))
