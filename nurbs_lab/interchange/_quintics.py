"""Curves as few polynomial pieces of degree five, end to end with one tangent, within a tolerance."""

from math import comb

import numpy as np

from nurbs_lab.common.checks import lengths
from nurbs_lab.interchange import _kernels_pieces, _kernels_quintics
from nurbs_lab.interchange._pieces import evaluated, split_until
from nurbs_lab.nurbs.refinement import lift

PLACES = 12  # samples of a cubic piece
MARGIN = 0.99  # of the tolerance, kept where a piece is compared with the curve
TURN = 0.3  # radians: a piece turns by less between two samples
NEAR = 0.01  # of the tolerance: distance of a piece from cubics with the tangents at its samples
CORNER = 1e-3  # radians: where the tangents of two pieces differ by more, they meet in a corner
SAMPLES = np.arange(PLACES + 1) / PLACES
BETWEEN = (SAMPLES[1:] + SAMPLES[:-1]) / 2
#: Powers of x, of the Bernstein polynomials of degree five.
_POWERS = np.array([[comb(5, k) * comb(k, i) * (-1) ** (k - i) for i in range(6)] for k in range(6)], float)


def quintic_rows(cubics, tolerance):
    """Bezier pieces ``(n, 6, dim)`` within the tolerance of cubic ones ``(m, 4, dim)``, as few as it allows.

    The curvature jumps where two of them meet, the tangent does not.
    """
    cubics = cubics[lengths(np.diff(cubics, axis=1)).sum(axis=1) > 0]
    if not len(cubics):
        return np.empty((0, 6, cubics.shape[-1]))

    def fits(rows):
        points, tangents = evaluated(rows, SAMPLES), _tangents(rows)
        steps, chords = _steps(points, tangents)
        middles = (points[:, :-1] + points[:, 1:]) / 2
        middles += steps[..., None] / 8 * (tangents[:, :-1] - tangents[:, 1:])
        off = evaluated(rows, BETWEEN) - middles
        along = (off * chords).sum(-1) / np.maximum((chords**2).sum(-1), 1e-300)
        away = lengths(off - along[..., None] * chords).max(axis=1)
        short = steps.sum(axis=1) <= NEAR * tolerance
        return short | ((away <= NEAR * tolerance) & (_turns(tangents).max(axis=1) < TURN))

    rows = split_until(_lifted(cubics), fits)
    points, tangents = evaluated(rows, SAMPLES), _tangents(rows)
    joints = np.stack([tangents[:-1, -1], tangents[1:, 0]], axis=1)
    corners = 1 + np.flatnonzero(_turns(joints)[:, 0] > CORNER)
    return np.concatenate(
        [
            _along(*run, tolerance)
            for run in zip(np.split(points, corners), np.split(tangents, corners), strict=True)
        ]
    )


def _along(points, tangents, tolerance):
    """The pieces along samples ``(m, PLACES + 1, dim)`` of pieces without a corner between them."""
    points, tangents = (
        np.concatenate([of[:, :-1].reshape(-1, of.shape[-1]), of[-1, -1:]]) for of in (points, tangents)
    )
    t = np.concatenate([[0.0], np.cumsum(np.maximum(_steps(points, tangents)[0], 1e-300))])
    ends = _kernels_pieces.longest(t, points, tangents, MARGIN * tolerance)
    return _kernels_quintics.quintics(t, points, tangents, ends, MARGIN * tolerance)


def _lifted(points):
    return lift(points, np.ones(points.shape[:2]))


def _tangents(rows):
    """Unit tangents at the samples ``(m, PLACES + 1, dim)``, along the chord where there is none."""
    steps = np.diff(rows[..., :-1], axis=1)
    slopes, chords = evaluated(_lifted(steps), SAMPLES), steps.sum(axis=1, keepdims=True)
    slopes = np.where(lengths(slopes)[..., None] > 1e-12 * lengths(chords)[..., None], slopes, chords)
    return slopes / np.maximum(lengths(slopes), 1e-300)[..., None]


def _steps(points, tangents):
    """Lengths of the arcs between successive samples, and their chords."""
    chords = np.diff(points, axis=-2)
    return lengths(chords) * (1.0 + _turns(tangents) ** 2 / 24.0), chords


def _turns(tangents):
    """Angles between successive unit tangents, in radians."""
    return 2.0 * np.arcsin(np.minimum(lengths(np.diff(tangents, axis=-2)) / 2.0, 1.0))


def powers(rows):
    """Coefficients ``(n, 6, dim)`` of the powers of x, which runs from 0 to 1 along each Bezier piece."""
    return _POWERS @ rows


def polynomial(start, end, powers):
    """Control points ``(6, dim)`` between two points; ``powers (4, dim)`` are the coefficients from 2 to 5.

    The linear coefficient follows from the ends.
    """
    linear = np.subtract(end, start) - powers.sum(axis=0)
    return [start, *np.linalg.solve(_POWERS, np.vstack([start, linear, powers]))[1:-1], end]
