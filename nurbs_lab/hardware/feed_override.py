"""Twin of rtl/feed_override.v: hold and abort, in integers.

The rate r at which the plan is read follows the command o in [0, 1], once a period T. All are lengths per
period: V is the plan's speed at the path time, W = r V, V+ is V one period ahead at the rate r,
alpha = A T², beta = J T³; V- and W- are V and W of the period before; s is 1 if o >= r, else -1.

1. The gap is g = s (o V - W), and it was closed by q = s (W - W- - o (V - V-)) in the last period. The
   acceleration leaves most = alpha - s o (V+ - V) for closing it.
2. The gap is closed by x, the largest number from q - beta to q + beta from which steps that shrink by beta
   still end within the gap: at most g / n + (n - 1) beta / 2 for every n. That is least where n is the first
   number with n (n + 1) beta / 2 >= g. From 22 beta on, Newton's step (g - 2 beta) beta / x + (x - beta) / 2
   replaces the search for n. Then x = min(x, most).
3. r' = o if x = g or V+ = 0, else (W + o (V+ - V) + s x) / V+, cut to [0, 1]; the path time grows by the mean
   of r and r'. If nothing was cut, the numerator is the W of the next period.

A hold (o = 0) takes at most 1.05 times the least number of periods. The jerk is at most J while the tool
brakes to rest, and at most 2 J + 2 A² / v on the way to another command, but in the one period in which the
rate arrives what is left of the acceleration ends at once: where the tool rejoins a plan that brakes, up to
16 J. `nurbs_lab.motion.apply_override`, which knows the plan ahead, has no such jump.

A is kept along the path. What the plan takes across it, C at most, comes on top at a right angle, since the
tool is no faster than the plan: the vector, and with it each axis, takes up to the root of A² + C², which is
1.41 A for a plan that takes all of A in curves or at corners. To keep every acceleration within M, plan with
``acceleration=0.8 * M`` and ``centripetal_acceleration=0.6 * M``, or another pair with A² + C² = M². On ten
curves, 40 plans and 14,400 commands, it is then at most 1.004 M (1.40 M without), and the motion takes 3 to
11 % longer. Nothing bounds the jerk of an axis but its part of the jerk along the path.

The speed of the feed is not a formula here: within a period of the feed it changes evenly by half of what the
distances of its two neighbours differ. Against the feed's own speed it is wrong by at most A T / 8 where the
acceleration jumps, and by J T² / 12 elsewhere; rates and path time have 32 fraction bits.
"""

from math import ceil, inf, sqrt
from typing import NamedTuple

from nurbs_lab.hardware.arithmetic import Format
from nurbs_lab.motion.override import jerk_of

#: Periods of a hold, as a multiple of the least number; and those that have begun when a command comes.
LONGEST, ON_THE_WAY = 1.05, 8


class OverrideLimits(NamedTuple):
    """What ``feed_override`` is loaded with; a distance is in units of the feed's table."""

    #: A T², the largest change of a period's distance from one period to the next.
    alpha: int
    #: J T³, the largest change of that change.
    beta: int
    #: Distance of the period before the first: the negative of the first if the feed starts at rest.
    prior: int
    #: Periods in which the tool comes to rest, and those that are on their way.
    reserve: int


def override_limits(feed, period_s, unit, first, second, word) -> OverrideLimits:
    """The limits of a feed whose first periods move ``first`` and ``second``; ``unit`` is that of 1 mm."""
    most = 1 << word + Format.ramp_guard
    alpha, beta = most - 1, most // 2 - 1
    peak, stop = feed.peak * period_s * unit, 0.0
    if feed.limits is not None:
        alpha = max(1, min(round(feed.limits.acceleration * period_s**2 * unit), alpha))
        stop = peak / alpha
    if (jerk := jerk_of(feed)) < inf:
        jerk = max(jerk * period_s**3 * unit, most * 2.0**-29)  # less is rounding
        beta = min(round(jerk), beta)
        stop += 2.0 * min(alpha, sqrt(peak * beta)) / beta
    prior = -first if feed.speed(0.0) == 0.0 else max(2 * first - second, 0)
    return OverrideLimits(alpha, beta, prior, ceil(LONGEST * stop) + ON_THE_WAY)


class FeedOverride:
    """Path time, its rate, and the distance of each period of the machine.

    ``moves`` are the distances of the feed's periods.
    """

    def __init__(self, moves, limits, word):
        # With the two after the last period, in which nothing moves, and at -1 the one before the first.
        self.moves, self.count, self.limits = [*moves, 0, 0, limits.prior], len(moves), limits
        self.one, self.dropped = 1 << word + 27, word - 5
        self.number = self.tau = self.given = 0
        self.rate = self.one
        self.before = None

    def run(self, commands):
        """Yield the distance of each period under its command of 0 to 256, or None to abort."""
        for command in commands:
            if command is None and self.rate == 0:
                yield 0
                return
            yield self.step(command or 0)
            if self.arrived:
                return

    @property
    def arrived(self):
        """Whether the feed has ended."""
        return self.number == self.count

    def scaled(self, value, factor):
        """The product with a fraction of 32 bits, rounded down."""
        return value * (factor >> self.dropped) >> 32

    def terms(self, number, tau):
        """Four times the speed at the start of a period of the feed, and half of its gain until tau."""
        four = 4 * self.moves[number]
        gain = min(max(self.moves[number + 1] - self.moves[number - 1], -four), four)
        return four - gain, self.scaled(gain, tau)

    def speed(self, number, tau):
        """Speed of the feed, as the distance of a period."""
        start, gained = self.terms(number, tau)
        return start + 2 * gained >> 2

    def step(self, command):
        """Distance of the next period under a command of 0 to 256."""
        goal = min(command, 256) * self.one >> 8
        if self.rate == goal == self.one and self.tau == 0:
            self.before = None
            self.number += 1
            return self.moves[self.number - 1]
        rate = self.follow(goal)
        tau = self.tau + (self.rate + rate >> 1)
        self.rate = rate
        moved = -self.given
        self.given = 0
        if tau >= self.one:
            tau -= self.one
            moved += self.moves[self.number]
            self.number += 1
        self.tau = tau
        if not self.arrived:
            start, gained = self.terms(self.number, tau)
            self.given = self.scaled(start + gained, tau) >> 2
        return moved + self.given

    def follow(self, goal):
        """The rate after the period, by steps 1 to 3: g, q, x, s, o are ``gap, closing, step, sign, goal``.

        ``before`` holds V-, W- and W, or a negative number for W if the rate arrived.
        """
        alpha, beta, prior, _ = self.limits
        v = self.speed(self.number, self.tau)
        if self.before is None and self.number == 0:
            if prior < 0:
                self.rate = goal
            self.before = [v, self.scaled(v, self.rate), -1]
        elif self.before is None:
            self.before = [*[self.speed(self.number - 1, 0)] * 2, -1]
        ahead = self.tau + self.rate
        passes = ahead >= self.one
        v_ahead = self.speed(self.number + passes, ahead - passes * self.one)
        before, scaled = self.before, self.scaled
        w = before[2] if before[2] >= 0 else scaled(v, self.rate)
        wanted = scaled(v, goal)
        raised = scaled(v_ahead, goal) - wanted
        sign = 1 if goal >= self.rate else -1
        gap = sign * (wanted - w)
        closing = sign * (w - before[1] - wanted + scaled(before[0], goal))
        self.before = [v, w, -1]
        step = min(closing + beta, gap)
        if step >= 22 * beta:
            tangent = scaled(gap - 2 * beta, self.ratio(beta, step)) + scaled(step - beta, self.ratio(1, 2))
            step = min(step, tangent)
        elif min(gap, 12 * step) > beta:
            level = total = beta
            while total < min(gap, 12 * step):
                level += beta
                total += level
            step = min(step, level - scaled(total - gap, self.ratio(beta, level)))
        step = min(max(step, closing - beta), alpha - sign * raised)
        if step == gap or v_ahead == 0:
            return goal
        left = w + raised + sign * step
        following = self.ratio(left, v_ahead)
        if left < v_ahead and following > 0:
            self.before[2] = left
        return following

    def ratio(self, part, whole):
        """The quotient of two distances as a rate of 32 fraction bits, rounded down and cut to [0, 1]."""
        return min(max((part << 32) // whole, 0), 1 << 32) << self.dropped
