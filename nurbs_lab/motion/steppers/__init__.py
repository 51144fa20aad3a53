"""Every known rule for the next parameter, behind one signature; a file for each family."""

from nurbs_lab.motion.steppers import adams, quotient, runge_kutta, taylor  # noqa: F401  (they register)
from nurbs_lab.motion.steppers.registry import STEPPERS, Job, Stepper, Steps, find_stepper, register

__all__ = ["STEPPERS", "Job", "Stepper", "Steps", "find_stepper", "register"]
