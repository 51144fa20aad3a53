"""The paper's own curve, constants and tables (section 4)."""

from nurbs_lab.nurbs import NurbsCurve

#: Quadratic test curve of section 4, control points in mm.
CURVE = NurbsCurve(
    degree=2,
    knots=[0, 0, 0, 1 / 5, 2 / 5, 3 / 5, 4 / 5, 1, 1, 1],
    control_points=[(1, 2), (1.5, 1), (3, 3), (4, 3.5), (5, 3), (6.5, 1), (7, 2)],
)
#: Interpolation period T, in s.
PERIOD_S = 1e-3
#: Maximum feed speed v_m, in mm/s.
SPEED = 4.0
#: Maximum bow height, in mm.
CHORD_ERROR = 1e-3
#: Clock of the paper's FPGA, in Hz.
CLOCK_HZ = 50e6
#: Time the paper's module cu takes for one C(u), in s.
CU_TIME_S = 205e-6
