"""Closed form that the holds of `motion` and of its twin in `hardware` are compared with."""

import numpy as np


def least_stop(speed, acceleration, limit, jerk):
    """Least time to rest from a speed and an acceleration, alone on a straight line."""
    if jerk is None:
        return speed / limit
    level = speed + acceleration**2 / (2.0 * jerk)  # speed where the acceleration is, or was, zero
    ramps = level / limit + limit / jerk if level * jerk >= limit**2 else 2.0 * np.sqrt(level / jerk)
    return ramps + acceleration / jerk
