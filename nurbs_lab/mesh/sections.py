"""One tube of contours as one surface: seams aligned, a common fit around, interpolation across.

Every contour is taken at the same shares of its length, from a seam that follows the one below with the least
twist, and fitted by least squares on one common knot vector. So the sections need no knot union, and the
surface passes through every one of them (NURBS Book 10.3 with compatible sections).
"""

import numpy as np
from scipy.linalg import solveh_banded

from nurbs_lab.nurbs import NurbsCurve, NurbsSurface, interpolate_curve

DEGREE = 3
_SEAM_SAMPLES = 256
_OVERSAMPLING = 4
_MOST_SPANS = 6000


class _Path:
    """A contour by the share of its length; a closed one goes round again beyond 1."""

    def __init__(self, contour):
        points = contour.points
        if contour.closed:
            points = np.vstack([points, points[:1]])
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        self.contour, self.closed = contour, contour.closed
        self.points, self.shares = points, along / along[-1]
        self.seam = 0.0

    def at(self, shares):
        """Points ``(n, 2)`` at shares counted from the seam."""
        shares = (shares + self.seam) % 1.0 if self.closed else shares
        return np.column_stack([np.interp(shares, self.shares, self.points[:, d]) for d in range(2)])

    def own(self):
        """The vertices of the contour, and their shares counted from the seam."""
        count = len(self.contour.points)
        shares = (self.shares[:count] - self.seam) % 1.0 if self.closed else self.shares
        return self.contour.points, shares


def _align_seams(paths):
    """Start every closed contour so that it is twisted least against the one below.

    The shift minimises the summed squared distance of points at equal shares; it is the top of a circular
    correlation, placed between samples by a parabola.
    """
    shares = np.arange(_SEAM_SAMPLES) / _SEAM_SAMPLES
    below = np.fft.fft(paths[0].at(shares) @ [1.0, 1j])
    for path in paths[1:]:
        match = np.fft.ifft(np.fft.fft(path.at(shares) @ [1.0, 1j]) * below.conj()).real
        top = int(np.argmax(match))
        left, middle, right = match[top - 1], match[top], match[(top + 1) % _SEAM_SAMPLES]
        bend = left - 2.0 * middle + right
        path.seam = (top + (0.5 * (left - right) / bend if bend < 0.0 else 0.0)) / _SEAM_SAMPLES % 1.0
        below = np.fft.fft(path.at(shares) @ [1.0, 1j])


def fit_sections(contours, tolerance) -> tuple[list[NurbsCurve], float]:
    """Cubic curves on common knots, none farther than ``tolerance`` from its contour's vertices.

    Returns the curves in space and the largest distance between a vertex and its curve at the same share of
    the length, which the true distance cannot exceed.

    Notes
    -----
    The number of knot spans grows by half until the hardest contour is fitted, then all are; if another one
    turns out to be harder, the growth goes on with that.
    """
    paths = [_Path(contour) for contour in contours]
    if paths[0].closed:
        _align_seams(paths)
    spans = 8
    hardest = max(paths, key=lambda path: len(path.points))
    while True:
        while _fit([hardest], spans)[1][0] > tolerance and spans < _MOST_SPANS:
            spans = spans * 3 // 2
        rows, errors = _fit(paths, spans)
        if errors.max() <= tolerance or spans >= _MOST_SPANS:
            break
        hardest = paths[int(np.argmax(errors))]
        spans = spans * 3 // 2
    knots = np.arange(-DEGREE, spans + DEGREE + 1) / spans
    curves = [
        NurbsCurve(DEGREE, knots, row @ contour.frame[:2] + contour.height * contour.frame[2])
        for row, contour in zip(rows, contours, strict=True)
    ]
    return curves, float(errors.max())


def _fit(paths, spans):
    """Least squares on common uniform knots: coefficients ``(paths, n, 2)``, and the error of each path."""
    closed = paths[0].closed
    phases = np.arange(_OVERSAMPLING) / _OVERSAMPLING
    shares = (np.arange(spans)[:, None] + phases).ravel() / spans
    samples = np.stack([path.at(shares) for path in paths]).reshape(len(paths), spans, _OVERSAMPLING, 2)
    solve = _least_squares_closed if closed else _least_squares_open
    rows = solve(samples, _basis(phases))

    points, own = zip(*(path.own() for path in paths), strict=True)
    starts = np.cumsum([0, *map(len, points)])
    own = np.concatenate(own) * spans
    span = np.minimum(own.astype(int), spans - 1)
    which = np.repeat(np.arange(len(paths)), np.diff(starts))
    fitted = sum(b[:, None] * rows[which, span + k] for k, b in enumerate(_basis(own - span)))
    return rows, np.maximum.reduceat(np.hypot(*(fitted - np.concatenate(points)).T), starts[:-1])


def _basis(t):
    """The four cubic B-splines of a uniform span at places t in [0, 1] of it: ``(4, len(t))``."""
    return np.array([(1 - t) ** 3, 3 * t**3 - 6 * t**2 + 4, -3 * t**3 + 3 * t**2 + 3 * t + 1, t**3]) / 6


def _least_squares_closed(samples, basis):
    """Circulant normal equations, by Fourier transform; the first coefficients come again at the end."""
    spans = samples.shape[1]
    gram = basis @ basis.T
    row = np.zeros(spans)
    for k in range(4):
        for m in range(4):
            row[(m - k) % spans] += gram[k, m]
    right = sum(np.roll(samples, k, axis=1).swapaxes(2, 3) @ basis[k] for k in range(4))
    rows = np.fft.irfft(np.fft.rfft(right, axis=1) / np.fft.rfft(row)[:, None], spans, axis=1)
    return np.concatenate([rows, rows[:, :DEGREE]], axis=1)


def _least_squares_open(samples, basis):
    """Banded normal equations."""
    count, spans = samples.shape[:2]
    gram = basis @ basis.T
    band = np.zeros((4, spans + DEGREE))
    right = np.zeros((spans + DEGREE, count, 2))
    for k in range(4):
        right[k : k + spans] += (samples.swapaxes(2, 3) @ basis[k]).swapaxes(0, 1)
        for m in range(k, 4):
            band[m - k, k : k + spans] += gram[k, m]
    rows = solveh_banded(band, right.reshape(spans + DEGREE, -1), lower=True)
    return rows.reshape(spans + DEGREE, count, 2).swapaxes(0, 1)


def skin_sections(curves) -> tuple[NurbsSurface, np.ndarray]:
    """The surface through sections on common knots, and the parameter v of every section."""
    rows = np.stack([curve.control_points for curve in curves])
    chords = np.linalg.norm(np.diff(rows, axis=0), axis=2).mean(axis=1)
    v = np.concatenate([[0.0], np.cumsum(chords)])
    v /= v[-1]
    degree = min(DEGREE, len(curves) - 1)
    across = interpolate_curve(rows.reshape(len(rows), -1), degree, parameters=v)
    net = across.control_points.reshape(rows.shape).swapaxes(0, 1)
    return NurbsSurface((DEGREE, degree), (curves[0].knots, across.knots), net), v
