"""Bad input is refused in words that name the argument, and nothing else ever happens."""

import numpy as np
import pytest

import nurbs_lab as nl
from nurbs_lab import nurbs

LINE = [(0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 1, 1), (4, 0, 1)]
KNOTS = [0, 0, 0, 0, 0.5, 1, 1, 1, 1]
GRID = np.stack(np.meshgrid(np.arange(5.0), np.arange(6.0), [0.0], indexing="ij"), axis=-1)[:, :, 0]
CURVE = nl.NurbsCurve(3, KNOTS, LINE)
SURFACE = nl.interpolate_surface(GRID)
PLANE = nl.interpolate_surface(GRID[..., :2])
LEG, CIRCLE = nl.NurbsCurve(1, [0, 0, 1, 1], [(0, 0, 0), (1, 2, 2)]), nurbs.circle(1.0, (0, 0))
THREAD = nl.NurbsSurface((1, 1), ([0, 0, 1, 1],) * 2, [[(0, 0, 0), (1, 0, 0)], [(2, 0, 0), (3, 0, 0)]])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: nl.NurbsCurve(3, KNOTS, LINE[:3]), r"control_points: degree 3 needs at least 4"),
        (lambda: nl.NurbsCurve(3, KNOTS[:-1], LINE), r"knots must have 9 entries"),
        (lambda: nl.NurbsCurve(3, [0, 0, 0, 0, 2, 1, 1, 1, 1], LINE), r"knots must not decrease.*knots\[5\]"),
        (lambda: nl.NurbsCurve(1, [0, 0, 0.5, 0.5, 0.6, 1, 1], LINE), r"knots holds 0.5 2 times"),
        (
            lambda: nl.NurbsCurve(3, KNOTS, LINE, [1, 1, 0, 1, 1]),
            r"weights\[2\] is 0.0; weights must be positive",
        ),
        (lambda: nl.NurbsCurve(3, KNOTS, LINE, [1, 1]), r"weights must have shape \(5,\)"),
        (lambda: nl.NurbsCurve(3, KNOTS, [*LINE[:4], (0, np.nan, 0)]), r"control_points\[4, 1\] is nan"),
        (lambda: CURVE(1.1), r"u = 1.1 is outside the domain \[0.0, 1.0\]"),
        (lambda: CURVE.insert_knot(0.5, 4), r"times must be 1 to 3"),
        (lambda: CURVE.parameter_at(1e3), r"length = 1000.0 is outside"),
        (
            lambda: nl.interpolate_curve([*LINE, LINE[-1]]),
            r"points repeat their neighbour at indices 4 and 5",
        ),
        (lambda: nl.interpolate_curve(LINE, parameters=[0, 1, 1, 2, 3]), r"parameters must increase"),
        (lambda: nl.approximate_curve(LINE, tolerance=-1), r"tolerance must not be negative"),
        (lambda: nl.interpolate_surface(GRID[[0, 1, 1, 2, 3]]), r"grid: rows 1 and 2 along u coincide"),
        (lambda: nl.skin([LINE, LINE], (3, 3)), r"needs at least 4 sections, got 2"),
        (lambda: SURFACE(0.5, 2.0), r"v = 2.0 is outside"),
        (lambda: SURFACE([0.1, 0.2], [0.1, 0.2, 0.3]), r"u and v must broadcast"),
        (lambda: SURFACE.split(0.5, direction="w"), r"direction must be one of u, v"),
        (lambda: PLANE.normal(0.5, 0.5), r"only shapes in 3-D have a normal, this one is in 2-D"),
        (lambda: THREAD.normal(0.5, 0.25), r"normal has no value at u = 0.5, v = 0.25"),
        (lambda: nl.interpolate_curve(LINE, 1, tangents={0: (1, 0, 0)}), r"degree 2 or more"),
        (
            lambda: nl.interpolate_curve(LINE, 2, tangents={0: (0, 1, 0), -5: (1, 0, 0)}),
            r"second one of point 0",
        ),
        (lambda: CURVE.refine([0.25] * 4), r"the knot 0.25 would be there more than 3 times"),
        (lambda: nurbs.revolve(CURVE, 7), r"angle must be at most a full turn"),
        (lambda: nurbs.arc(1, 0, 90), r"end must exceed start by at most a full turn, 2 pi"),
        *(
            (
                lambda name=name: getattr(LEG.elevate_degree(2), name)(0.3),
                r"no value at u = 0\.3: the curve is straight",
            )
            for name in ("normal", "binormal", "torsion")
        ),
        (
            lambda: nl.approximate_curve(LINE, tolerance=0),
            r"tolerance = 0.0 cannot be met: 5 control points.* reach",
        ),
        (lambda: CURVE.transform(np.ones((4, 4))), "matrix must end in the row 0"),
        (lambda: LEG.join(LEG), "other starts 3 away from the end"),
        (lambda: nl.NurbsCurve.from_scipy(5), r"spline must be a scipy\.interpolate\.BSpline"),
    ],
)
def test_values_are_refused_by_name(call, message):
    with pytest.raises((ValueError, TypeError), match=message):
        call()
