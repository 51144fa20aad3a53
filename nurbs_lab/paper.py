"""The paper's own curve and constants (section 4).

H. Zhu, M. Wang, K. Liu, W. Xu, 'NURBS modeling and curve interpolation optimization of 3D graphics',
Computers, Materials & Continua 66(2), 1799-1811, 2021, doi 10.32604/cmc.2020.012706, CC BY 4.0.
"""

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
#: Initial speed v_s, in mm/s.
START_SPEED = 0.0
#: Maximum chord error (the paper's bow height), in mm.
CHORD_ERROR = 1e-3
#: The paper's FPGA, an Altera Cyclone II.
CHIP = "EP2C8Q208"
#: Its clock, in Hz.
CLOCK_HZ = 50e6
#: Time the paper's module cu takes for one C(u), in s.
CU_TIME_S = 205e-6
