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
FLAT = nl.NurbsCurve(3, KNOTS, [point[:2] for point in LINE])
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
        (lambda: nl.NurbsCurve(3, [0] * 9, LINE), r"empty domain"),
        (
            lambda: nl.NurbsCurve(3, KNOTS, LINE, [1, 1, 0, 1, 1]),
            r"weights\[2\] is 0.0; weights must be positive",
        ),
        (lambda: nl.NurbsCurve(3, KNOTS, LINE, [1, 1]), r"weights must have shape \(5,\)"),
        (lambda: nl.NurbsCurve(3, KNOTS, [*LINE[:4], (0, np.nan, 0)]), r"control_points\[4, 1\] is nan"),
        (lambda: CURVE(1.1), r"u = 1.1 is outside the domain \[0.0, 1.0\]"),
        (lambda: CURVE([0.5, np.inf]), r"u\[1\] is inf"),
        (lambda: CURVE.insert_knot(0.5, 4), r"times = 4"),
        (lambda: CURVE.insert_knot(0.0), r"u = 0.0 must lie inside"),
        (lambda: CURVE.remove_knot(0.3, 1), r"u = 0.3 is no knot"),
        (lambda: CURVE.parameter_at(1e3), r"length = 1000.0 is outside"),
        (lambda: CURVE.closest_point([[1, 2]]), r"points must have shape \(..., 3\)"),
        (lambda: nl.interpolate_curve(LINE[:3]), r"points: degree 3 needs at least 4 points, got 3"),
        (
            lambda: nl.interpolate_curve([*LINE, LINE[-1]]),
            r"points repeat their neighbour at indices 4 and 5",
        ),
        (lambda: nl.interpolate_curve([LINE[0], *LINE, LINE[-1]]), r"indices 0 and 1, 5 and 6"),
        (
            lambda: nl.interpolate_curve(LINE, parametrization="arc"),
            r"parametrization must be one of uniform",
        ),
        (lambda: nl.interpolate_curve(LINE, parameters=[0, 1, 1, 2, 3]), r"parameters must increase"),
        (lambda: nl.interpolate_curve([LINE[0]] * 5), r"points repeat"),
        (lambda: nl.approximate_curve(LINE, tolerance=-1), r"tolerance must not be negative"),
        (lambda: nl.interpolate_surface(GRID[:2]), r"grid: degree 3 along u needs at least 4 points"),
        (lambda: nl.interpolate_surface(GRID[[0, 1, 1, 2, 3]]), r"grid: rows 1 and 2 along u coincide"),
        (lambda: nl.interpolate_surface(np.zeros((5, 5, 3))), r"grid: all its points coincide along u"),
        (lambda: nl.skin([LINE, LINE]), r"needs at least 4 sections, got 2"),
        (lambda: nl.skin([LINE] * 4), r"curves_or_contours: .* points coincide along v"),
        (lambda: nl.skin([[(0, 0, 1)]] * 4), r"curves_or_contours: .* points coincide along u"),
        (
            lambda: nl.skin([LINE, LINE, LINE, [*LINE, LINE[0]]]),
            r"curves_or_contours\[3\] is closed and \[2\] is open",
        ),
        (
            lambda: nl.skin([[(0, 0), (1, 0), (1, 1), (0, 1)]] * 4),
            r"curves_or_contours\[0\] must have points",
        ),
        (lambda: SURFACE(0.5, 2.0), r"v = 2.0 is outside"),
        (lambda: SURFACE([0.1, 0.2], [0.1, 0.2, 0.3]), r"u and v must broadcast"),
        (lambda: SURFACE.split(0.5, direction="w"), r"direction must be one of u, v"),
        (lambda: SURFACE.iso_curve(), r"give either u or v"),
        (lambda: PLANE.normal(0.5, 0.5), r"only shapes in 3-D have a normal, this one is in 2-D"),
        (lambda: THREAD.normal(0.5, 0.25), r"normal has no value at u = 0.5, v = 0.25"),
        (lambda: PLANE.to_pyvista(), r"only surfaces in 3-D can be drawn"),
        (lambda: nurbs.revolve(CURVE).to_scipy(), r"weights differ, and a SciPy NdBSpline has none"),
        (
            lambda: nl.NurbsSurface((3, 3), SURFACE.knots, GRID[:3]),
            r"degree 3 in direction u needs at least 4",
        ),
        (lambda: nl.NurbsSurface((3, 3), SURFACE.knots, GRID[..., :0]), r"one coordinate or more, got shape"),
        (lambda: nl.NurbsCurve(1, [0, 0, 1, 1], np.empty((2, 0))), r"one coordinate or more, got \(2, 0\)"),
        (lambda: nl.NurbsCurve(3, [0, 0, 0, 0, 1e-300, 1, 1, 1, 1], LINE), r"knots\[4\] differ by rounding"),
        (lambda: nl.approximate_curve(LINE[:3], tolerance=1), r"points: degree 3 needs at least 4 points"),
        (lambda: nl.interpolate_surface(np.empty((0, 5, 3))), r"grid must hold points"),
        (lambda: nl.interpolate_curve(LINE, 1, tangents={0: (1, 0, 0)}), r"degree 2 or more"),
        (
            lambda: nl.interpolate_curve(LINE, tangents={0: (1, 0)}),
            r"\[0\] must have 3 coordinates",
        ),
        (lambda: nl.skin([FLAT] * 4), r"curves_or_contours\[0\] must be a curve in 3-D, got 2-D"),
        (lambda: CURVE.refine([0.25] * 4), r"the knot 0.25 would be there more than 3 times"),
        (lambda: CURVE.transform(np.eye(2)), r"matrix must have shape \(m, 3\)"),
        (lambda: CURVE.transform(np.eye(3), [1, 2]), r"offset must have 3 coordinates, got 2"),
        (lambda: nurbs.circle(1, center=(0, 0, 0, 0)), r"center must have 2 or 3 coordinates"),
        (lambda: nurbs.circle(1, normal=(0, 0, 0)), r"normal must not be zero"),
        (lambda: nurbs.revolve(CURVE, 7), r"angle must be at most a full turn"),
        (lambda: nurbs.circle(-1), r"radius must be positive"),
        (lambda: nurbs.arc(1, 2, 1), r"end must exceed start"),
        (lambda: nurbs.revolve(FLAT), r"profile must be a NurbsCurve in 3-D"),
        (lambda: nl.NurbsSurface(3, (KNOTS, KNOTS), GRID), r"degrees must be a pair"),
        *(
            (lambda degrees=degrees: nl.interpolate_surface(GRID, degrees), r"degrees\[[01]\] must")
            for degrees in ((10, 3), (3, 10), (0, 3))
        ),
        *(
            (
                lambda name=name: getattr(LEG.elevate_degree(2), name)(0.3),
                r"no value at u = 0\.3: the curve is straight",
            )
            for name in ("normal", "binormal", "torsion")
        ),
        (lambda: CIRCLE.torsion(0.0), "only shapes in 3-D have a torsion"),
        (lambda: CIRCLE.to_scipy(), "weights"),
        (lambda: nurbs.sphere()(1.5, 1.5), r"v = 1\.5 is outside the domain"),
        (lambda: nl.interpolate_curve([(1, 2)], closed=True), "got 1"),
        (
            lambda: nl.approximate_curve(LINE, tolerance=0),
            r"tolerance = 0.0 cannot be met: 5 control points.* reach",
        ),
        (lambda: CURVE.transform(np.ones((4, 4))), "matrix must end in the row 0"),
        (lambda: SURFACE.transform(np.ones((4, 4))), "matrix must end in the row 0"),
        (lambda: LEG.join(LEG), "other starts 3 away from the end"),
        (lambda: LEG.join(3), "other must be a NurbsCurve"),
        (lambda: nl.NurbsCurve.from_scipy(5), r"spline must be a scipy\.interpolate\.BSpline"),
        (lambda: nl.NurbsSurface.from_scipy(5), r"spline must be a scipy\.interpolate\.NdBSpline"),
    ],
)
def test_values_are_refused_by_name(call, message):
    with pytest.raises((ValueError, TypeError), match=message):
        call()
