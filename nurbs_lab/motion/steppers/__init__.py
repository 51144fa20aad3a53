"""Every known rule for the next parameter, behind one signature; a file for each family."""

from nurbs_lab.motion.steppers import (  # noqa: F401  (each registers its own)
    adams,
    corrected,
    exact,
    history,
    predictor_corrector,
    quotient,
    runge_kutta,
    tables,
    taylor,
)
from nurbs_lab.motion.steppers.registry import STEPPERS, Job, Stepper, Steps, find_stepper, register

__all__ = ["STEPPERS", "Job", "Stepper", "Steps", "find_stepper", "register"]
