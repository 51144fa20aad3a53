"""Feed override, hold and abort: the rate of path time follows a command within the plan's own limits.

The tool stays on the path: only the time tau at which the plan is read runs slower. With the rate
r = d tau / dt in [0, 1] and the plan's speed v(tau), the tool has the speed r v. A command o asks for the
speed o v(tau), which changes with the plan; the gap to it is closed in the least time that the acceleration A
and the jerk J of the plan allow.

For an override of 0 to 200 % of a programmed feed, plan with twice that feed and halve the commands: 0.5 is
then the programmed feed and 1 twice it, or what the limits leave of it. Every limit holds at every command.

The rule, once a period T, at path time tau with the rate r. All are lengths per period: V = v(tau) T,
W = r V, V+ = v(tau + r T) T, alpha = A T², beta = J T³; V-, W- are V and W of the period before.

1. The command o is the last row of the override whose time has come, at most 1; s is 1 if o >= r, else -1.
2. The gap is g = s (o V - W), and it was closed by q = s (W - W- - o (V - V-)) in the last period. The
   acceleration leaves most = alpha - s o (V+ - V) for closing it.
3. The gap is closed by x, the largest number from q - beta to q + beta from which steps that shrink by beta
   still end within the gap: at most g / n + (n - 1) beta / 2 for every n. That is least where n is the first
   number with n (n + 1) beta / 2 >= g. From 22 beta on, Newton's step (g - 2 beta) beta / x + (x - beta) / 2
   replaces the search for n. Then x = min(x, most). Without a limit of jerk x = min(g, most).
4. r' = o if x = g or V+ = 0, else (W + o (V+ - V) + s x) / V+, cut to [0, 1]; tau' = tau + (r + r') T / 2. If
   nothing was cut, the numerator is the W of the next period, so the steps x add up as the rule counts them.

`next_rate` states steps 2 to 4 for floating point and for the integers of ``hardware.feed_override``.

A hold has o = 0: the tool then brakes by itself, whatever the plan does. It resumes with the next command
above 0. An abort, or a stop after a fault, is a hold that no command follows: the motion ends where the tool
comes to rest.

A hold takes at most 1.05 times the least number of periods in which a machine that acts once a period comes
to rest: below 22 beta the rule closes as much in every period as any way to rest does, and above Newton's
step, a tangent's root for a gap 2 beta smaller, lies less than 3 beta² / x below that.

Bounds: the speed never exceeds the plan's. V+ is the plan's speed at a path time that differs from tau' by at
most |r' - r| T / 2, so the acceleration is at most A (1 + A T / v); in a period in which the plan's own
acceleration jumps, which needs a plan without a limit of jerk, at most twice A. The jerk of W is at most J
while the tool brakes to rest, and at most 2 J + 2 A² / v on the way to another command, whose speed o v(tau)
has a jerk of its own. In the one period in which the rate arrives, at its command or at an end of its range,
what is left of the acceleration ends at once: the acceleration changes by at most 2 A (1 + A T / v), a jerk
of at most that over T. It is that large only where the plan turns towards the tool just before: of 600 random
commands on two plans (2026-11) one in two exceeds J by more than 0.1 %, the median by nothing, the largest,
which rejoins a plan that brakes, reaches 16 J. There the growing rate makes the plan's braking change faster
than J allows, so that only a rule that looks ahead of tau' by the time of a full reversal could keep J.
"""

from dataclasses import replace

import numpy as np

from nurbs_lab.common.checks import as_floats, as_kind
from nurbs_lab.motion._kernels import feed_at, kernel
from nurbs_lab.motion.feed import MOST_SAMPLES, FeedProfile

#: Largest command; above 1 it acts as 1, because the plan is as fast as its limits allow.
LARGEST = 2.0
#: Periods computed before the arrays are extended for the first time; each time they double at least.
_BLOCK = 100_000


def apply_override(feed, override):
    """The motion that a feed becomes under an override: a profile along the same path, as long or longer.

    Parameters
    ----------
    feed : FeedProfile
        With its limits of acceleration and jerk; where it has none, the rate follows the command at once.
    override : float or array_like, shape (n, 2)
        A constant rate, or rows (time in s, rate), each valid from its time on; before the first the rate is
        1. Rates lie in [0, 2]: 0 holds the tool, and above 1 acts as 1. If the last is 0, the motion is
        aborted: it ends where the tool comes to rest. The module's docstring says how to reach 200 % of a
        programmed feed.

    Returns
    -------
    FeedProfile
        Its samples at whole periods follow the rule in this module's docstring; while the rate changes, it is
        the cubic through positions and speeds of both ends of the period.

    Raises
    ------
    TypeError, ValueError
        Naming the rows that are no times that increase or no rates in [0, 2], or a motion that never begins
        or takes more than 5,000,000 periods.

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
    return _profile(feed, *_rates(feed, times, rates))


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
    return np.ascontiguousarray(times), np.minimum(rates, 1.0)


def _rates(feed, times, rates):
    """Rate and path time at the end of every period; the last path time is the end of the plan."""
    period = feed.period_s
    slowest = rates[rates > 0.0].min(initial=1.0)
    if times[-1] + feed.duration / slowest > MOST_SAMPLES * period:
        raise ValueError(
            f"override makes the motion longer than {MOST_SAMPLES} periods, with period_s = {period:g} s; "
            "raise its rates, the feed or period_s"
        )
    acceleration = np.inf if feed.limits is None else feed.limits.acceleration
    jerk = np.inf if feed.limits is None or feed.limits.jerk is None else feed.limits.jerk
    machine = period, acceleration * period**2, jerk * period**3
    first = rates[0] if times[0] == 0.0 and feed.speed(0.0) == 0.0 else 1.0
    rate, tau, count = np.array([first]), np.zeros(1), 0
    begin = max(feed.speed(0.0), 0.0) * period
    last = np.array([begin, first * begin, -1.0])  # `before` of `next_rate`
    while tau[-1] < feed.duration and not (rate[-1] == rates[-1] == 0.0 and count * period >= times[-1]):
        more = np.empty(_BLOCK + count)
        rate, tau = np.append(rate, more), np.append(tau, more)
        count = _follow(feed.table, feed.duration, machine, (times, rates), count, rate, tau, last)
        rate, tau = rate[: count + 1], tau[: count + 1]
    return rate, tau


def next_rate(rate, goal, v, ahead, before, limits, times, ratio):
    """The rate at the end of a period: steps 2 to 4 of the rule of this module, for numbers of any kind.

    It takes the rate r and the command o, the plan's speeds V and V+, those ``before``, and (alpha, beta).
    ``before`` holds V-, W- and W, or a negative number for W if the rate arrived; those of the next period
    replace them. ``times`` is the product of a length and a rate or of two lengths, ``ratio`` the
    quotient of two lengths as a rate, cut to [0, 1].
    """
    alpha, beta = limits
    w = before[2] if before[2] >= 0 else times(v, rate)
    wanted = times(v, goal)
    raised = times(ahead, goal) - wanted
    sign = 1 if goal >= rate else -1
    gap = sign * (wanted - w)
    closing = sign * (w - before[1] - wanted + times(before[0], goal))
    most = alpha - sign * raised
    before[0], before[1], before[2] = v, w, -1
    step = min(closing + beta, gap)
    if step >= 22 * beta:
        step = min(step, times(gap - 2 * beta, ratio(beta, step)) + times(step - beta, ratio(1, 2)))
    elif min(gap, 12 * step) > beta:
        level = total = beta
        while total < min(gap, 12 * step):
            level += beta
            total += level
        step = min(step, level - times(total - gap, ratio(beta, level)))
    step = min(max(step, closing - beta), most)
    if step == gap or ahead == 0:
        return goal
    left = w + raised + sign * step
    following = ratio(left, ahead)
    if left < ahead and following > 0:
        before[2] = left
    return following


@kernel
def _times(a, b):
    return a * b


@kernel
def _ratio(part, whole):
    return min(max(part / whole, 0.0), 1.0)


_next_rate = kernel(next_rate)


@kernel
def _follow(feed, duration, machine, commands, count, rate, tau, last):
    """Fill rates and path times from period ``count`` on, by the rule of this module: the last period filled.

    ``last`` is ``before`` of `next_rate`.
    """
    period, limits, (times, rates) = machine[0], machine[1:], commands
    row, hint = -1, 0
    while count + 1 < rate.size:
        r = rate[count]
        while row + 1 < times.size and times[row + 1] <= (count + 1e-9) * period:
            row += 1
        goal = rates[row] if row >= 0 else 1.0
        v, _, _, hint = feed_at(feed, tau[count], hint)
        ahead, _, _, _ = feed_at(feed, tau[count] + r * period, hint)
        v, ahead = max(v, 0.0) * period, max(ahead, 0.0) * period
        rate[count + 1] = _next_rate(r, goal, v, ahead, last, limits, _times, _ratio)
        tau[count + 1] = tau[count] + 0.5 * (r + rate[count + 1]) * period
        count += 1
        if tau[count] >= duration - 1e-9 * period:
            tau[count] = duration
            break
        if rate[count] == 0.0 and row == times.size - 1 and goal == 0.0:  # aborted
            break
    return count


def _profile(feed, rate, tau):
    """Segments of the plan where the rate is constant, cubics over the periods in which it changes."""
    if not tau[-1] > 0.0:
        raise ValueError("override holds the tool before it has moved, and for ever; add a row that resumes")
    start = feed.period_s * np.arange(len(rate))
    mean = 0.5 * (rate[-1] + rate[-2])
    start[-1] = start[-2] + (min(feed.period_s, (tau[-1] - tau[-2]) / mean) if mean > 0.0 else feed.period_s)
    if not start[-1] > start[-2]:  # the path ended with the sample before
        start, tau, rate = start[:-1], tau[:-1], rate[:-1]
    s, v = feed.displacement(tau), rate * feed.speed(tau)
    gone, h = np.diff(s), np.diff(start)
    square = (3.0 * gone / h - 2.0 * v[:-1] - v[1:]) / h
    cube = (v[:-1] + v[1:] - 2.0 * gone / h) / h**2
    cubics = np.column_stack([s[:-1], v[:-1], square, cube])
    even = rate[1:] == rate[:-1]
    cuts = np.flatnonzero(np.append(True, even[1:] != even[:-1]))
    times, terms, names = [], [], []
    for first, last in zip(cuts, np.append(cuts[1:], len(even)), strict=True):
        r = rate[first]
        if not even[first]:
            times.append(start[first:last])
            terms.append(cubics[first:last])
        elif not tau[last] > tau[first]:  # at rest, or too slow to move
            times.append(start[first : first + 1])
            terms.append([[s[first], 0.0, 0.0, 0.0]])
        else:
            part = feed.portion(tau[first], tau[last])
            times.append(start[first] + part.times[:-1] / r)
            terms.append(part.terms * r ** np.arange(4.0) + [s[first], 0.0, 0.0, 0.0])
        planned = even[first] and r == 1.0
        names += part.limited_by if planned else ["override"] * len(terms[-1])
    times.append(start[-1:])
    return replace(feed, times=np.concatenate(times), terms=np.concatenate(terms), limited_by=tuple(names))
