"""Every known rule for the next parameter, behind one signature; a file for each family."""

from nurbs_lab.motion.steppers import (  # noqa: F401  (each registers its own)
    adams,
    corrected,
    exact,
    multistep,
    one_step,
    predictor_corrector,
    tables,
)
from nurbs_lab.motion.steppers.registry import (
    STEPPERS,
    Job,
    Option,
    Rule,
    Stepper,
    Steps,
    find_stepper,
    register,
    run_whole,
    software_steppers,
)

__all__ = [
    "STEPPERS",
    "Job",
    "Option",
    "Rule",
    "Stepper",
    "Steps",
    "find_stepper",
    "register",
    "run_whole",
    "software_steppers",
]
