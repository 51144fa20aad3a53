"""One-step rules: the Taylor series of u(t), Runge-Kutta for u' = v(t) / |C'(u)|, and one with a corrector.

'rk2-pc' is the predictor-corrector of Erwinski, Wawrzak & Paprocki, IEEE TII 18 (2022). The predictor is
Heun's rule with the speed of the period in both slopes (their Eq. 1 and 2). The corrector asks
``|C(u) + C'(u) d - C(u_j)| = length`` of the change d, a quadratic (Eq. 5-8), with the chord to the predicted
point replaced by the arc by Simpson's rule. Its solution (Eq. 9) is printed with a^2 - 4ab under the root;
b^2 - 4ac is meant. It needs first derivatives only.
"""

from functools import partial
from math import sqrt

from nurbs_lab.motion._kernels import displacement, feed_at, settle
from nurbs_lab.motion.steppers.registry import Rule, Stepper, register
from nurbs_lab.nurbs.span_kernels import find_span, kernel, point, speed, speed_jet, velocity

TAYLOR, RUNGE_KUTTA, CORRECTED = range(3)


@kernel
def slope(spans, span, u, v):
    """v / |C'(u)|, with u kept on the curve."""
    breaks = spans[0]
    u = min(u, breaks[-1])
    return v / speed(spans, find_span(breaks, u, span), u)


@kernel
def _series(spans, feed, span, phase, u, t, period, counts, order):
    """Advance of u in a period: |C'| u' = v, differentiated once and twice for u'' and u'''."""
    v, a, j, _ = feed_at(feed, t, phase)
    for k in range(1, order + 1):
        counts[k] += 1
    if order == 1:
        return period * v / speed(spans, span, u)
    value, first, second = speed_jet(spans, span, u)
    du = v / value
    ddu = (a - first * du * du) / value
    dddu = (j - second * du**3 - 3.0 * first * du * ddu) / value if order == 3 else 0.0
    return period * (du + period * (0.5 * ddu + period * dddu / 6.0))


@kernel
def _midpoint(spans, feed, span, phase, u, t, period, counts):
    """Advance of u by one step of the midpoint rule."""
    v0, _, _, phase = feed_at(feed, t, phase)
    v1, _, _, _ = feed_at(feed, t + 0.5 * period, phase)
    counts[1] += 2
    return period * slope(spans, span, u + 0.5 * period * slope(spans, span, u, v0), v1)


@kernel
def classical(spans, feed, span, phase, u, t, period, counts):
    """Advance of u by one step of the classical Runge-Kutta rule of fourth order (Eq. 19)."""
    v0, _, _, phase = feed_at(feed, t, phase)
    v1, _, _, _ = feed_at(feed, t + 0.5 * period, phase)
    v2, _, _, _ = feed_at(feed, t + period, phase)
    k1 = slope(spans, span, u, v0)
    k2 = slope(spans, span, u + 0.5 * period * k1, v1)
    k3 = slope(spans, span, u + 0.5 * period * k2, v1)
    k4 = slope(spans, span, u + period * k3, v2)
    counts[1] += 4
    return period / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@kernel
def _corrected(spans, span, u, length, counts):
    """The next parameter by Heun's rule and the quadratic corrector."""
    breaks = spans[0]
    end = breaks[-1]
    first = speed(spans, span, u)
    ahead = min(u + length / first, end)
    second = speed(spans, find_span(breaks, ahead, span), ahead)
    trial = min(u + 0.5 * length * (1.0 / first + 1.0 / second), end)
    middle = 0.5 * (u + trial)
    between = speed(spans, find_span(breaks, middle, span), middle)
    there = find_span(breaks, trial, span)
    dx, dy, dz = velocity(spans, there, trial)
    last = sqrt(dx * dx + dy * dy + dz * dz)
    arc = (trial - u) / 6.0 * (first + 4.0 * between + last)
    here, reached = point(spans, span, u), point(spans, there, trial)
    counts[0] += 2
    counts[1] += 4
    a = last * last
    b = 2.0 * ((reached[0] - here[0]) * dx + (reached[1] - here[1]) * dy + (reached[2] - here[2]) * dz)
    c = arc * arc - length * length
    # the root next to zero, written without cancellation
    following = trial - 2.0 * c / (b + sqrt(max(b * b - 4.0 * a * c, 0.0)))
    return following if following > u else trial  # Simpson's arc is wrong over a jump of |C'|


@kernel
def _one_step(spans, feed, period, offset, done, until, u, counts, family, order):
    breaks = spans[0]
    span = phase = 0
    for step in range(done, until):
        t = (offset + step) * period
        span = find_span(breaks, u[step], span)
        phase = find_span(feed[0], t, phase)
        if family == CORRECTED:
            following = _corrected(spans, span, u[step], displacement(feed, t, period, phase), counts)
        elif family == RUNGE_KUTTA and order == 4:
            following = u[step] + classical(spans, feed, span, phase, u[step], t, period, counts)
        elif family == RUNGE_KUTTA:
            following = u[step] + _midpoint(spans, feed, span, phase, u[step], t, period, counts)
        else:
            advance = _series(spans, feed, span, phase, u[step], t, period, counts, order)
            if not advance > 0.0:  # at rest, and in the last moments of braking: the planned length instead
                advance = displacement(feed, t, period, phase) / speed(spans, span, u[step])
            following = u[step] + advance
        if not settle(u, step, following, breaks[-1]):
            break
    return step


def _run(job, *, family, order):
    return Rule(_one_step, (family, order))


_ROWS = (
    ("taylor1", "Taylor series of u(t) up to t", (0, 1, 0, 0), TAYLOR, 1),
    ("taylor2", "Taylor series of u(t) up to t², the slope of the feed included", (0, 1, 1, 0), TAYLOR, 2),
    ("taylor3", "Taylor series of u(t) up to t³, the jerk of the feed included", (0, 1, 1, 1), TAYLOR, 3),
    ("rk2", "Runge-Kutta of order 2, the midpoint rule", (0, 2, 0, 0), RUNGE_KUTTA, 2),
    ("rk4", "Runge-Kutta of order 4 (Eq. 19), exact |C'|", (0, 4, 0, 0), RUNGE_KUTTA, 4),
    (
        "rk2-pc",
        "Heun predictor, one quadratic corrector on Simpson's arc (Erwinski 2022)",
        (2, 4, 0, 0),
        CORRECTED,
        None,
    ),
)
for _name, _summary, _evaluations, _family, _order in _ROWS:
    _call = partial(_run, family=_family, order=_order or 2)
    register(Stepper(_name, _summary, _evaluations, _call, _order))
