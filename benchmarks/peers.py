"""Steppers of the literature, registered as a reader registers one of his own: importing this is enough.

u is a piecewise polynomial of degree 7 in the arc length, fitted before the motion starts.

'inverse-length' matches u and its first three derivatives by length at both ends of every piece: C3, apart
from knots where the curve itself is less smooth. The idea, polynomials for the inverse length function, is
that of Lei, Sung, Lin & Huang, Int. J. Mach. Tools Manuf. 47 (2007), whose pieces are quintic as others cite
them; degree 7 and the halving are ours.

'feed-correction' is the feed correction polynomial of Erkorkmaz & Altintas, J. Manuf. Sci. Eng. 127 (2005)
339: degree 7, u and two derivatives matched at both ends, the two freedoms left fitted by least squares.
They solve 14 linear equations for the 8 powers and 6 multipliers; Erkorkmaz, ibid. 137 (2015) 044501, gives
a closed form. Ours is closed too, and its own: a quintic Hermite plus two polynomials that vanish threefold
at both ends. Only the abstracts of the two papers were at hand.

Both halve a piece until its error is within ``tolerance`` (mm along the path). A step then evaluates one
polynomial. The default tolerance is 1e-9 of the mean step, or the rounding error of u where that is larger.
"""

from functools import partial

import numpy as np

from nurbs_lab.common.kernels import kernel
from nurbs_lab.motion import STEPPERS, Option, Stepper, register, steps_of
from nurbs_lab.motion._kernels import displacement, settle
from nurbs_lab.nurbs.span_kernels import find_span, invert, speed_jet

#: Tolerance where none is given, as a fraction of the mean step.
_TOLERANCE = 1e-9
#: Where in a piece the fit is compared with the curve, and both ends.
_PLACES = np.linspace(0.0, 1.0, 17)
#: If more pieces than this remain to be halved, the tolerance counts as out of reach.
_MOST = 20_000


@kernel
def _inverse_jets(spans, which, u, out):
    """u and its first three derivatives by arc length."""
    for k in range(u.size):
        value, first, second = speed_jet(spans, which[k], u[k])
        out[k, 0] = u[k]
        out[k, 1] = 1.0 / value
        out[k, 2] = -first / value**3
        out[k, 3] = (3.0 * first * first - value * second) / value**5


@kernel
def _table(spans, feed, period, u, counts, lengths, coefficients):
    end, travelled = spans[0][-1], 0.0
    at = phase = 0
    for step in range(u.size - 1):
        t = step * period
        phase = find_span(feed[0], t, phase)
        travelled += displacement(feed, t, period, phase)
        if travelled >= lengths[-1]:
            following = end
        else:
            at = find_span(lengths, travelled, at)
            x = (travelled - lengths[at]) / (lengths[at + 1] - lengths[at])
            following = 0.0
            for k in range(7, -1, -1):
                following = following * x + coefficients[at, k]
        if not settle(u, step, following, end):
            break
    return step


def _matching(count):
    """Matrix from ``count`` derivatives at 0 and at 1 to eight powers, the higher ones zero."""
    size = 2 * count
    rows = np.zeros((size, size))
    for order in range(count):
        factors = np.array([np.prod(np.arange(k - order + 1, k + 1)) for k in range(size)], dtype=float)
        rows[order, order] = factors[order]
        rows[count + order] = factors * (np.arange(size) >= order)
    matrix = np.zeros((8, size))
    matrix[:size] = np.linalg.inv(rows)
    return matrix


#: By the highest derivative that is matched.
_HERMITE = {order: _matching(order + 1).T for order in (2, 3)}
_POWERS = np.vander(_PLACES[1:-1], 8, increasing=True)
#: x³ (1 - x)³ and the same times x - 1/2, as powers: what two matched derivatives leave free.
_FREE = np.array([[0, 0, 0, 1, -3, 3, -1, 0], [0, 0, 0, -0.5, 2.5, -4.5, 3.5, -1]], dtype=float).T
_FIT = np.linalg.pinv(_POWERS @ _FREE)


def _hermite(ends, samples, order):
    """Powers of the polynomial with the derivatives of both ends up to ``order``; (pieces, 8)."""
    return ends[:, :, : order + 1].reshape(len(ends), -1) @ _HERMITE[order]


def _least_squares(ends, samples):
    base = _hermite(ends, samples, 2)
    return base + (samples - base @ _POWERS.T) @ _FIT.T @ _FREE.T


def _fitted(track, fit, tolerance, rounding):
    """Ends of the pieces by length, and their powers; a piece may also be off by ``rounding`` of u."""
    breaks, nodes, totals = track.spans[0], *track.panels
    edges = totals[np.searchsorted(nodes, breaks)]
    pending = np.column_stack([edges[:-1], edges[1:], np.arange(len(edges) - 1)])

    def inverted(places):
        """Parameters at places of the pending pieces, each within its span."""
        lengths = pending[:, :1] + (pending[:, 1:2] - pending[:, :1]) * places
        u = np.empty(lengths.size)
        invert(track.spans, track.panels, lengths.ravel(), u)
        which = pending[:, 2].astype(np.int64)
        return np.clip(u.reshape(lengths.shape), breaks[which, None], breaks[which + 1, None])

    every_second, done = inverted(_PLACES[::2]), []
    while len(pending):
        if len(pending) > _MOST:
            raise ValueError(f"tolerance {tolerance:g} mm is out of reach on this curve; give a larger one")
        samples = np.empty((len(pending), len(_PLACES)))
        samples[:, ::2], samples[:, 1::2] = every_second, inverted(_PLACES[1::2])
        which = pending[:, 2].astype(np.int64)
        width = (pending[:, 1] - pending[:, 0])[:, None]
        jets = np.empty((2, len(pending), 4))
        for side, column in ((0, 0), (1, -1)):
            _inverse_jets(track.spans, which, np.ascontiguousarray(samples[:, column]), jets[side])
        ends = jets.transpose(1, 0, 2) * width[:, None] ** np.arange(4)
        powers = fit(ends, samples[:, 1:-1])
        error = np.abs(powers @ _POWERS.T - samples[:, 1:-1]).max(axis=1)
        good = error <= tolerance * jets[:, :, 1].min(axis=0) + rounding * np.abs(samples).max(axis=1)
        done.append((pending[good, 0], powers[good]))
        pending = np.repeat(pending[~good], 2, axis=0)
        pending[::2, 1] = pending[1::2, 0] = 0.5 * (pending[::2, 0] + pending[::2, 1])
        halves = samples[~good, :9], samples[~good, 8:]
        every_second = np.stack(halves, axis=1).reshape(-1, 9)
    starts, powers = (np.concatenate([one[k] for one in done]) for k in range(2))
    order = np.argsort(starts)
    return np.append(starts[order], track.length), np.ascontiguousarray(powers[order])


def _run(job, *, fit, tolerance=None):
    rounding = 0.0
    if tolerance is None:
        tolerance, rounding = _TOLERANCE * job.track.length / job.last_step, 2.0**-48
    lengths, coefficients = _fitted(job.track, fit, tolerance, rounding)
    return steps_of(job, _table, lengths, coefficients, details={"pieces": len(coefficients)})


_OPTIONS = (Option("tolerance", float, None, (1e-300, 1e100), "largest error of a piece, in mm of the path"),)
_ROWS = (
    (
        "inverse-length",
        "u(s) by adaptive C3 pieces of degree 7, made beforehand (after Lei et al. 2007)",
        partial(_hermite, order=3),
    ),
    (
        "feed-correction",
        "feed correction polynomials of degree 7, made beforehand (Erkorkmaz & Altintas 2005, 2015)",
        _least_squares,
    ),
)
NAMES = tuple(row[0] for row in _ROWS)
for _name, _summary, _fit in _ROWS:
    _call = partial(_run, fit=_fit)
    register(Stepper(_name, _summary, (0, 0, 0, 0), _call, options=_OPTIONS, keeps=STEPPERS["exact"].keeps))
