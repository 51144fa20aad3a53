"""Every known rule for the next parameter, behind one signature; a file for each family.

Importing this package fills the catalogue of `registry`.
"""

from nurbs_lab.motion.steppers import adams, corrected, exact, multistep, one_step  # noqa: F401
