"""Checks of numbers that a person typed."""

from numbers import Real

import numpy as np

from nurbs_lab.nurbs._checks import LARGEST


def number(name, value):
    """The value as float, if it is one finite real number."""
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if isinstance(value, bool) or not isinstance(value, Real | np.number):
        raise TypeError(f"{name} must be a number, got {value!r}")
    if not abs(value) <= LARGEST:
        raise ValueError(f"{name} must be finite and at most {LARGEST:g}, got {value}")
    return float(value)


def positive(name, value):
    """The value as float, if it is above zero."""
    value = number(name, value)
    if value <= 0.0:
        raise ValueError(f"{name} must be above zero, got {value:g}")
    return value


def not_negative(name, value):
    """The value as float, if it is zero or more."""
    value = number(name, value)
    if value < 0.0:
        raise ValueError(f"{name} must not be negative, got {value:g}")
    return value


def count(name, value, least=1):
    """The value as int, if it is a whole number of at least ``least``."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name} must be a whole number, got {value!r}")
    if value < least:
        raise ValueError(f"{name} must be at least {least}, got {value}")
    return int(value)
