"""What a controller makes of a polyline by itself: corners rounded within a tolerance, as by G64 P."""

import numpy as np

from nurbs_lab.common.checks import as_points, as_positive, lengths
from nurbs_lab.nurbs import NurbsCurve


def blend(points, *, tolerance):
    """A polyline ``(n, dim)`` with a parabola at every corner, as a controller in continuous mode runs it.

    Each parabola is as long as half of the shorter segment beside it allows, and the tolerance, which is the
    largest distance from a corner. The curve has degree 2 and a continuous tangent.

    Examples
    --------
    >>> import nurbs_lab as nl
    >>> corner = nl.interchange.blend([(0, 0), (10, 0), (10, 10)], tolerance=0.1)
    >>> round(float(corner.closest_point((10, 0))[1]), 9)
    0.1
    """
    points = as_points("points", points, 2)
    tolerance = as_positive("tolerance", tolerance)
    points = points[np.r_[True, np.diff(points, axis=0).any(axis=1)]]
    steps = np.diff(points, axis=0)
    long = lengths(steps)
    unit = steps / long[:, None]
    sine = lengths(unit[1:] - unit[:-1]) / 2
    reach = np.minimum(long[:-1], long[1:]) / 2
    reach = np.minimum(reach, 2 * tolerance / np.maximum(sine, 1e-12))[:, None]
    corner = points[1:-1]
    before, after = corner - reach * unit[:-1], corner + reach * unit[1:]
    straight = (np.vstack([points[:1], after]) + np.vstack([before, points[-1:]])) / 2
    inner = np.stack([straight[:-1], before, corner, after], axis=1).reshape(-1, points.shape[1])
    control = np.vstack([points[:1], inner, straight[-1:], points[-1:]])
    spans = lengths(np.diff(control, axis=0)).reshape(-1, 2).sum(axis=1)
    kept = spans > 1e-12 * spans.max()
    ends = np.r_[0.0, np.cumsum(spans[kept])]
    return NurbsCurve(2, np.r_[0.0, np.repeat(ends, 2), ends[-1]], control[np.r_[True, np.repeat(kept, 2)]])
